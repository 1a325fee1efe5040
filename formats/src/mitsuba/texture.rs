//! Textures.

use super::object::ObjectIndex;
use super::props::Props;
use super::reader::Reader;
use super::version::Dialect;
use crate::ir::{
    Bitmap, Color, ColorInput, ColorSlot, Id, Mapping, Texture, TextureEncoding, TextureFilter, TextureKind,
    Transform, WrapMode,
};
use crate::plugin::{Plugin, read, unsupported};

type ReadTexture = for<'a> fn(&mut Reader<'a>, &mut Props<'a>) -> Option<TextureKind>;

pub(super) const TEXTURES: &[Plugin<ReadTexture>] = &[
    read("bitmap", bitmap),
    read("checkerboard", checkerboard),
    read("scale", scale),
    read("mesh_attribute", mesh_attribute),
    unsupported("volume"),
    read("gridtexture", grid),
    unsupported("vertexcolors"),
    unsupported("wireframe"),
    unsupported("curvature"),
];

const WRAP_MODES: &[(&str, WrapMode)] = &[
    ("repeat", WrapMode::Repeat),
    ("mirror", WrapMode::Mirror),
    ("clamp", WrapMode::Clamp),
    ("zero", WrapMode::Zero),
    ("black", WrapMode::Zero),
    ("one", WrapMode::One),
    ("white", WrapMode::One),
];

pub(super) fn is_texture_plugin(name: &str) -> bool {
    TEXTURES.iter().any(|row| row.name == name)
}

impl<'a> Reader<'a> {
    /// The texture at `index`; `None` after reporting why there is none.
    pub fn texture(&mut self, index: ObjectIndex) -> Option<Id<Texture>> {
        if let Some(id) = self.textures.get(&index) {
            return Some(*id);
        }
        let reader = self.plugin(TEXTURES, index, "gray 0.5 is used")?;
        let mut props = self.props(index);
        let kind = reader(self, &mut props);
        let (name, origin) = (props.name(), props.origin());
        self.finish(props);
        let id = self.scene.textures.push(Texture { name, origin, kind: kind? });
        self.textures.insert(index, id);
        Some(id)
    }
}

/// `to_uv`, or the offsets and scales of 0.6.
fn to_uv(props: &mut Props<'_>, dialect: Dialect) -> Transform {
    let given = props.optional_transform("to_uv");
    let both = props.float("uvscale", 1.0);
    let scale = [props.float("uscale", both), props.float("vscale", both), 1.0];
    let offset = [props.float("uoffset", 0.0), props.float("voffset", 0.0), 0.0];
    given.unwrap_or_else(|| {
        let (scale, offset) = (Transform::scale(scale), Transform::translate(offset));
        // 0.6 scales first; Mitsuba 2 and 3 upgrade these parameters the other way round.
        if dialect == Dialect::Old { offset.after(&scale) } else { scale.after(&offset) }
    })
}

/// The encoding of a picture by its `gamma` in 0.6: 0 is what the file says, −1 sRGB.
pub(super) fn gamma(props: &mut Props<'_>) -> TextureEncoding {
    match props.float("gamma", 0.0) {
        0.0 => TextureEncoding::Auto,
        1.0 => TextureEncoding::Linear,
        -1.0 => TextureEncoding::Srgb,
        gamma if gamma > 0.0 => TextureEncoding::Gamma(gamma),
        gamma => {
            props.complain("gamma", format!("`gamma` must be positive, 0 or -1, not {gamma}"));
            TextureEncoding::Auto
        }
    }
}

fn bitmap<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<TextureKind> {
    let path = reader.asset(props, "texture");
    let filters = [
        ("bilinear", TextureFilter::Bilinear),
        ("nearest", TextureFilter::Nearest),
        ("trilinear", TextureFilter::Bilinear),
        ("ewa", TextureFilter::Bilinear),
    ];
    let filter = props.choice("filter_type", TextureFilter::Bilinear, &filters);
    let wrap = props.choice("wrap_mode", WrapMode::Repeat, WRAP_MODES);
    let wrap_u = props.choice("wrap_mode_u", wrap, WRAP_MODES);
    let wrap_v = props.choice("wrap_mode_v", wrap, WRAP_MODES);
    let raw = props.boolean("raw", false);
    let gamma = gamma(props);
    let encoding = if raw { TextureEncoding::Linear } else { gamma };
    let channels = ["r", "g", "b", "a", "x", "y", "z"].map(|name| (name, name.chars().next()));
    let channel = props.optional_choice("channel", &channels).flatten();
    let to_uv = to_uv(props, reader.dialect);
    props.ignore(&["cache", "max_anisotropy", "format", "accel"]);
    Some(TextureKind::Bitmap(Bitmap {
        path: path?,
        filter,
        wrap_u,
        wrap_v,
        encoding,
        channel,
        mapping: Mapping::Uv(to_uv),
        scale: 1.0,
        invert: false,
    }))
}

fn checkerboard<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<TextureKind> {
    let color0 = reader.color_input(props, "color0", ColorSlot::Reflectance, 0.4);
    let color1 = reader.color_input(props, "color1", ColorSlot::Reflectance, 0.2);
    Some(TextureKind::Checkerboard { color0, color1, to_uv: to_uv(props, reader.dialect) })
}

fn scale<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<TextureKind> {
    let factor = ColorInput::Color(reader.color(props, "scale", ColorSlot::Unbounded, 1.0));
    let value = if props.has("value") {
        reader.color_input(props, "value", ColorSlot::Unbounded, 1.0)
    } else if let Some(nested) = props.only_texture() {
        reader.nested_color(nested.index).unwrap_or(ColorInput::Color(Color::Gray(0.5)))
    } else {
        props.needs("a nested texture or the parameter `value`");
        return None;
    };
    Some(TextureKind::Scale { value, factor })
}

fn grid<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<TextureKind> {
    Some(TextureKind::Grid {
        color0: reader.color_input(props, "color0", ColorSlot::Reflectance, 0.2),
        color1: reader.color_input(props, "color1", ColorSlot::Reflectance, 0.4),
        line_width: props.positive("line_width", 0.01),
        to_uv: to_uv(props, reader.dialect),
    })
}

fn mesh_attribute<'a>(_: &mut Reader<'a>, props: &mut Props<'a>) -> Option<TextureKind> {
    let Some((name, _)) = props.optional_string("name") else {
        props.needs("the parameter `name`");
        return None;
    };
    if !(name.starts_with("vertex_") || name.starts_with("face_")) {
        props.complain("name", format!("an attribute is called `vertex_…` or `face_…`, not `{name}`"));
        return None;
    }
    Some(TextureKind::MeshAttribute { name: name.to_owned(), scale: props.float("scale", 1.0) })
}
