//! Models made of other models.

use crate::diagnostic::Diagnostic;
use crate::ir::{
    Bitmap, BsdfKind, Color, ColorInput, FloatInput, Id, Mapping, PerturbedShading, Texture, TextureEncoding,
    TextureKind, Transform,
};
use crate::mitsuba::number;
use crate::mitsuba::object::Class;
use crate::mitsuba::props::{Nested, Props};
use crate::mitsuba::reader::Reader;
use crate::mitsuba::version::Dialect;

pub(super) fn two_sided<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    let allowed = props.boolean("allow_transmission", false);
    let Some(front) = props.child(Class::Bsdf) else {
        props.needs("a nested bsdf");
        return None;
    };
    let back = props.child(Class::Bsdf);
    let mut side = |nested: Nested| {
        let id = reader.bsdf(nested.index);
        if !allowed && reader.query.bsdf(&reader.scene.bsdfs, id).transmits {
            let text = "twosided takes only materials that let no light through";
            reader.problems.push(Diagnostic::error(text, Some(nested.span)));
        }
        id
    };
    Some(BsdfKind::TwoSided { front: side(front), back: back.map(side) })
}

pub(super) fn mask<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    let opacity = reader.float_input(props, "opacity", 0.5);
    let Some(nested) = props.only_child(Class::Bsdf) else {
        props.needs("a nested bsdf");
        return None;
    };
    Some(BsdfKind::Mask { opacity, nested: reader.bsdf(nested.index) })
}

/// The flags of Mitsuba 3, which also apply to files of version 2; 0.6 has neither.
fn perturbed<'a>(reader: &Reader<'a>, props: &mut Props<'a>) -> PerturbedShading {
    let new = reader.dialect != Dialect::Old;
    PerturbedShading {
        flip_invalid_normals: props.boolean("flip_invalid_normals", new),
        shadowing: props.boolean("use_shadowing_function", new),
    }
}

impl<'a> Reader<'a> {
    /// A nested texture of numbers, or a spectrum plugin. 0.6 reads images here without decoding them.
    fn numbers(&mut self, nested: Nested) -> Option<ColorInput> {
        let input = self.nested_color(nested.index)?;
        let ColorInput::Texture(id) = input else { return Some(input) };
        let mut texture = self.scene.textures[id].clone();
        match &mut texture.kind {
            TextureKind::Bitmap(b) if self.dialect == Dialect::Old && b.encoding == TextureEncoding::Auto => {
                b.encoding = TextureEncoding::Linear;
                Some(ColorInput::Texture(self.scene.textures.push(texture)))
            }
            _ => Some(ColorInput::Texture(id)),
        }
    }
}

pub(super) fn bump_map<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    let scale = props.float("scale", 1.0);
    let shading = perturbed(reader, props);
    let (texture, nested) = (props.only_texture(), props.only_child(Class::Bsdf));
    let Some(nested) = nested else {
        props.needs("a nested bsdf");
        return None;
    };
    let height = match texture {
        Some(texture) => reader.numbers(texture),
        None => {
            props.needs("a nested texture: the heights");
            None
        }
    };
    // The same height everywhere is a flat surface.
    let height = match height {
        Some(ColorInput::Texture(id)) => FloatInput::Texture(id),
        Some(ColorInput::Color(_)) | None => FloatInput::Value(0.0),
    };
    Some(BsdfKind::BumpMap { height, scale, shading, nested: reader.bsdf(nested.index) })
}

/// How a renderer that came from Mitsuba samples glints and specular chains of a normal map.
const GLINTS: &[&str] = &["use_slopes", "lean_fallback", "lean_fallback_alpha"];

pub(super) fn normal_map<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    let shading = perturbed(reader, props);
    props.ignore(GLINTS);
    // By name in Mitsuba 3, by its kind in 0.6.
    let (texture, nested) = (props.only_texture(), props.only_child(Class::Bsdf));
    let Some(nested) = nested else {
        props.needs("a nested bsdf");
        return None;
    };
    let normals = match texture {
        Some(texture) => reader.numbers(texture),
        None if props.has("filename") => own_picture(reader, props).map(ColorInput::Texture),
        None => {
            props.needs("a nested texture `normalmap`");
            None
        }
    };
    // (½, ½, 1) tilts nothing.
    let flat = ColorInput::Color(Color::Rgb([0.5, 0.5, 1.0]));
    let normals = normals.unwrap_or(flat);
    Some(BsdfKind::NormalMap { normals, shading, nested: reader.bsdf(nested.index) })
}

/// The normals of a fork (specular manifold sampling): a file of the BSDF itself, repeated.
fn own_picture<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<Id<Texture>> {
    let origin = props.origin();
    let path = reader.asset(props, "texture");
    let tiles = props.positive("tiles", 1.0);
    let mapping = Mapping::Uv(Transform::scale([tiles; 3]));
    let kind = TextureKind::Bitmap(Bitmap::raw(path?, mapping));
    Some(reader.scene.textures.push(Texture { name: None, origin, kind }))
}

pub(super) fn blend<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    if reader.dialect != Dialect::Old && !props.has("weight") {
        props.needs("the parameter `weight`");
    }
    let weight = reader.float_input(props, "weight", 0.5);
    let (Some(first), Some(second)) = (props.child(Class::Bsdf), props.child(Class::Bsdf)) else {
        props.needs("two nested bsdfs");
        return None;
    };
    Some(BsdfKind::Blend { weight, first: reader.bsdf(first.index), second: reader.bsdf(second.index) })
}

pub(super) fn mixture<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    let Some((text, span)) = props.optional_string("weights") else {
        props.needs("the parameter `weights`");
        return None;
    };
    let mut nested = Vec::new();
    while let Some(child) = props.child(Class::Bsdf) {
        nested.push(reader.bsdf(child.index));
    }
    let words = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|w| !w.is_empty());
    let weights: Option<Vec<f64>> = words.map(|w| number::float(w).filter(|w| *w >= 0.0)).collect();
    let Some(weights) = weights.filter(|w| w.len() == nested.len() && !w.is_empty()) else {
        let text = format!("`weights` must be {} numbers from 0, one for each nested bsdf", nested.len());
        props.problems.push(Diagnostic::error(text, Some(span)));
        return None;
    };
    if weights.iter().sum::<f64>() > 1.0 {
        let text = "the weights sum to more than 1: they are scaled down";
        props.problems.push(Diagnostic::warning(text, Some(span)));
    }
    Some(BsdfKind::Mixture { parts: weights.into_iter().zip(nested).collect() })
}
