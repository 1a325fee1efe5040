//! The scene as a pbrt-v4 file: one module per concept, as for reading.
//!
//! Materials and textures are named and stand before the shapes that use them.

mod film;
mod light;
mod lobes;
mod material;
mod medium;
mod metal;
mod model;
mod picture;
mod relief;
mod shape;
mod text;
mod texture;

use std::collections::{HashMap, HashSet};
use std::fmt::Write;

use text::Params;

use crate::ir::{
    Bsdf, Color, ColorInput, ColorSlot, FloatInput, Id, Origin, Query, Scene, ShapeGroup, Texture,
};
use crate::write::{Names, Output, WriteError};

pub(crate) fn write(output: &mut Output<'_>) -> Result<String, WriteError> {
    let scene = output.scene;
    Writer {
        out: output,
        scene,
        definitions: String::new(),
        body: String::new(),
        materials: HashMap::new(),
        interfaces: HashSet::new(),
        textures: HashMap::new(),
        objects: HashMap::new(),
        media: Vec::new(),
        taken: Names::default(),
        query: Query::default(),
    }
    .document()
}

struct Writer<'o, 'a> {
    out: &'o mut Output<'a>,
    scene: &'a Scene,
    /// Textures, materials and objects, each before its first use.
    definitions: String,
    body: String,
    materials: HashMap<Id<Bsdf>, String>,
    /// Materials that light passes through; their shapes do not emit any.
    interfaces: HashSet<String>,
    /// By kind: colours, or numbers (`true`).
    textures: HashMap<(Id<Texture>, bool), String>,
    objects: HashMap<Id<ShapeGroup>, String>,
    /// By arena index.
    media: Vec<String>,
    taken: Names,
    query: Query,
}

impl Writer<'_, '_> {
    fn document(mut self) -> Result<String, WriteError> {
        let scene = self.scene;
        let mut head = String::new();
        if let Some(title) = self.out.title() {
            let _ = writeln!(head, "# Converted from {title} by caustica {}.", env!("CARGO_PKG_VERSION"));
        }
        self.name_media();
        self.head(&mut head);
        self.define_media(&mut head)?;
        for (id, _) in scene.groups.iter() {
            self.group(id)?;
        }
        for shape in &scene.shapes {
            self.shape(shape)?;
        }
        for emitter in &scene.emitters {
            self.emitter(emitter)?;
        }
        Ok(format!("{head}\nWorldBegin\n\n{}\n{}", self.definitions, self.body))
    }

    /// `name`, or one made from it or from `kind` that is not taken.
    fn free(&mut self, name: &Option<String>, kind: &str) -> String {
        self.taken.free_or_numbered(name.as_deref(), kind)
    }

    /// A comment on where a thing comes from.
    fn place(&self, text: &mut String, indent: &str, origin: Origin) {
        if let Some(place) = self.out.place(origin) {
            let _ = writeln!(text, "{indent}# {place}");
        }
    }

    fn color(&mut self, p: Params, name: &str, color: &Color, slot: ColorSlot, origin: Origin) -> Params {
        match color {
            Color::Library(library) if slot != ColorSlot::Emission => p.spectrum(name, library),
            _ => {
                let rgb = self.out.rgb(color, slot, origin);
                p.rgb(name, self.within(rgb, slot, origin))
            }
        }
    }

    /// What pbrt accepts: nothing negative, and no reflectance above 1.
    fn within(&mut self, rgb: [f64; 3], slot: ColorSlot, origin: Origin) -> [f64; 3] {
        let most = if slot == ColorSlot::Reflectance { 1.0 } else { f64::INFINITY };
        let clamped = rgb.map(|v| v.clamp(0.0, most));
        if clamped != rgb {
            let what = match slot {
                ColorSlot::Reflectance => format!("reflectance {rgb:?} outside 0..1"),
                _ => format!("the negative colour {rgb:?}"),
            };
            self.out.lose(origin, what, format!("rgb {clamped:?}"));
        }
        clamped
    }

    fn color_input(
        &mut self,
        p: Params,
        name: &str,
        input: &ColorInput,
        slot: ColorSlot,
        origin: Origin,
    ) -> Result<Params, WriteError> {
        Ok(match input {
            ColorInput::Color(color) => self.color(p, name, color, slot, origin),
            ColorInput::Texture(id) => {
                let texture = self.texture(*id, false)?;
                p.texture(name, &texture)
            }
        })
    }

    fn float_input(&mut self, p: Params, name: &str, input: &FloatInput) -> Result<Params, WriteError> {
        Ok(match input {
            FloatInput::Value(v) => p.float(name, *v),
            FloatInput::Texture(id) => {
                let texture = self.texture(*id, true)?;
                p.texture(name, &texture)
            }
        })
    }
}
