//! Textures. A `constant` one is its value; the others enter the scene.

use std::rc::Rc;

use super::color::Use;
use super::depths::MAX_DEPTH;
use super::directive::{Directive, Param, ParamType};
use super::params::Params;
use super::policy::Fault;
use super::reader::{Reader, text};
use crate::diagnostic::{Diagnostic, Span};
use crate::ir::{
    Bitmap, Color, ColorInput, FloatInput, Mapping, MixAmount, NoiseKind, Texture, TextureEncoding,
    TextureFilter, TextureKind, Transform, WrapMode,
};
use crate::plugin::{Plugin, read, unsupported};

use ParamType as T;

/// Whether a texture gives numbers or colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TextureType {
    Float,
    Spectrum,
}

pub(super) enum Made {
    Texture(Box<TextureKind>),
    /// A plain value.
    Input(ColorInput),
}

fn made(kind: TextureKind) -> Made {
    Made::Texture(Box::new(kind))
}

type ReadTexture = fn(&mut Reader<'_>, &mut Params, TextureType) -> Option<Made>;

pub(super) const TEXTURES: &[Plugin<ReadTexture>] = &[
    read("constant", |r, p, k| Some(Made::Input(r.operand(p, "value", k, 1.0)))),
    read("scale", scale),
    read("mix", mix),
    read("directionmix", direction_mix),
    read("bilerp", bilerp),
    read("checkerboard", checkerboard),
    read("dots", dots),
    read("fbm", |r, p, k| noise(r, p, k, TextureType::Float, |p| with_octaves(p, fbm))),
    read("wrinkled", |r, p, k| noise(r, p, k, TextureType::Float, |p| with_octaves(p, wrinkled))),
    read("windy", |r, p, k| noise(r, p, k, TextureType::Float, |_| NoiseKind::Windy)),
    read("marble", |r, p, k| noise(r, p, k, TextureType::Spectrum, marble)),
    read("imagemap", imagemap),
    unsupported("ptex"),
    unsupported("uv"),
];

const FILTERS: &[(&str, TextureFilter)] = &[
    ("point", TextureFilter::Nearest),
    ("bilinear", TextureFilter::Bilinear),
    ("trilinear", TextureFilter::Bilinear),
    ("ewa", TextureFilter::Bilinear),
    ("EWA", TextureFilter::Bilinear),
];

const WRAPS: &[(&str, Option<WrapMode>)] = &[
    ("repeat", Some(WrapMode::Repeat)),
    ("clamp", Some(WrapMode::Clamp)),
    ("black", Some(WrapMode::Zero)),
    ("octahedralsphere", None),
];

/// Noise of more octaves than this has no detail left in f32.
const MAX_OCTAVES: u32 = 64;

impl Reader<'_> {
    pub fn texture(&mut self, d: &Directive, params: Vec<Param>) {
        let name = text(d, 0).to_owned();
        let name_span = d.arguments[0].span;
        let kind = match text(d, 1) {
            "float" => TextureType::Float,
            "spectrum" => TextureType::Spectrum,
            other => {
                let text = format!("a texture is \"float\" or \"spectrum\", not `{other}`");
                return self.error(text, d.arguments[1].span);
            }
        };
        if self.state.moves() {
            self.warn("a texture moves: its transform at the start time is used", d.span);
        }
        let mut p = Params::new("texture", text(d, 2), d.arguments[2].span, params, self.common());
        if let Some(inherited) = self.state.attributes.get("texture") {
            p.inherit(inherited);
        }
        let reader = self.plugin(TEXTURES, &mut p, "gray 0.5 is used");
        let made = reader.and_then(|reader| reader(self, &mut p, kind));
        self.done(p);
        let input = match made {
            Some(Made::Input(input)) => input,
            Some(Made::Texture(kind)) => {
                let origin = crate::ir::Origin(Some(name_span));
                let below = self.depths.below(&*kind);
                if below == MAX_DEPTH {
                    let text = format!("textures refer to each other more than {MAX_DEPTH} deep");
                    return self.error(text, name_span);
                }
                let id = self.scene.textures.push(Texture { name: Some(name.clone()), origin, kind: *kind });
                self.depths.set(id, below + 1);
                ColorInput::Texture(id)
            }
            None => ColorInput::Color(Color::Gray(0.5)),
        };
        let names = Rc::make_mut(&mut self.names);
        let earlier = match kind {
            TextureType::Float => {
                let input = match input {
                    ColorInput::Color(Color::Gray(v)) => FloatInput::Value(v),
                    ColorInput::Color(_) => FloatInput::Value(0.5),
                    ColorInput::Texture(id) => FloatInput::Texture(id),
                };
                names.float_textures.insert(name.clone(), (input, name_span)).map(|(_, span)| span)
            }
            TextureType::Spectrum => {
                names.color_textures.insert(name.clone(), (input, name_span)).map(|(_, span)| span)
            }
        };
        self.redefined("texture", &name, name_span, earlier);
    }

    /// Reports a second definition.
    pub fn redefined(&mut self, what: &str, name: &str, span: Span, earlier: Option<Span>) {
        if let Some(earlier) = earlier {
            let problem = Diagnostic::error(format!("{what} `{name}` is defined twice"), Some(span));
            let problem = problem.label(earlier, "first here");
            self.problems.push(self.policy.judge(Fault::Mistake, problem, "this one is meant from here on"));
        }
    }

    /// A value of the texture's kind, or a texture of it.
    fn operand(&mut self, p: &mut Params, name: &'static str, kind: TextureType, default: f64) -> ColorInput {
        match kind {
            TextureType::Spectrum => self.color_input(p, name, Use::Unbounded, default),
            TextureType::Float => as_color(self.float_input(p, name, default)),
        }
    }

    /// World → texture space.
    fn world_to_texture(&mut self, p: &mut Params) -> Transform {
        self.state.ctm[0].inverse().unwrap_or_else(|| {
            let text = "the transform of this texture flattens space: it has no inverse";
            p.problems.push(Diagnostic::error(text, Some(p.span)));
            Transform::IDENTITY
        })
    }

    fn mapping(&mut self, p: &mut Params) -> Mapping {
        let name = p.optional_string("mapping");
        let kind = name.as_ref().map_or("uv", |(text, _)| text.as_str());
        match kind {
            "uv" => {
                let (su, sv) = (p.float("uscale", 1.0), p.float("vscale", 1.0));
                let (du, dv) = (p.float("udelta", 0.0), p.float("vdelta", 0.0));
                let m = Transform::translate([du, dv, 0.0]).after(&Transform::scale([su, sv, 1.0]));
                Mapping::Uv(m)
            }
            "planar" => Mapping::Planar {
                to_texture: self.world_to_texture(p),
                axes: [
                    p.triple("v1", T::Vector3).unwrap_or([1.0, 0.0, 0.0]),
                    p.triple("v2", T::Vector3).unwrap_or([0.0, 1.0, 0.0]),
                ],
                offset: [p.float("udelta", 0.0), p.float("vdelta", 0.0)],
            },
            "spherical" => Mapping::Spherical { to_texture: self.world_to_texture(p) },
            "cylindrical" => Mapping::Cylindrical { to_texture: self.world_to_texture(p) },
            other => {
                let text =
                    format!("a texture is mapped by uv, planar, spherical or cylindrical, not `{other}`");
                p.complain("mapping", text);
                Mapping::Uv(Transform::IDENTITY)
            }
        }
    }
}

pub(super) fn as_color(input: FloatInput) -> ColorInput {
    match input {
        FloatInput::Value(v) => ColorInput::Color(Color::Gray(v)),
        FloatInput::Texture(id) => ColorInput::Texture(id),
    }
}

/// pbrt's images have t = 0 at the bottom, ours v = 0 at the top.
pub(super) fn upside_down(mapping: Mapping) -> Mapping {
    let flip =
        Transform([[1.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, 1.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]);
    match mapping {
        Mapping::Uv(m) => Mapping::Uv(flip.after(&m)),
        Mapping::Planar { to_texture, axes, offset } => Mapping::Planar {
            to_texture,
            axes: [axes[0], axes[1].map(|x| -x)],
            offset: [offset[0], 1.0 - offset[1]],
        },
        // t is the angle about z: −y turns it around.
        Mapping::Spherical { to_texture } => {
            Mapping::Spherical { to_texture: Transform::scale([1.0, -1.0, 1.0]).after(&to_texture) }
        }
        // t is the height; 1 − z and −z are the same when the image repeats.
        Mapping::Cylindrical { to_texture } => {
            Mapping::Cylindrical { to_texture: Transform::scale([1.0, 1.0, -1.0]).after(&to_texture) }
        }
        Mapping::Solid { to_texture } => Mapping::Solid { to_texture },
    }
}

fn scale(r: &mut Reader<'_>, p: &mut Params, kind: TextureType) -> Option<Made> {
    if r.policy.is_three() && !p.has("tex") && !p.has("scale") {
        let (value, factor) = (r.operand(p, "tex1", kind, 1.0), r.operand(p, "tex2", kind, 1.0));
        return Some(made(TextureKind::Scale { value, factor }));
    }
    let value = r.operand(p, "tex", kind, 1.0);
    let factor = as_color(r.float_input(p, "scale", 1.0));
    Some(made(TextureKind::Scale { value, factor }))
}

fn mix(r: &mut Reader<'_>, p: &mut Params, kind: TextureType) -> Option<Made> {
    Some(made(TextureKind::Mix {
        first: r.operand(p, "tex1", kind, 0.0),
        second: r.operand(p, "tex2", kind, 1.0),
        amount: MixAmount::Input(r.float_input(p, "amount", 0.5)),
    }))
}

/// `tex1` where the normal lies along `dir`.
fn direction_mix(r: &mut Reader<'_>, p: &mut Params, kind: TextureType) -> Option<Made> {
    let tex1 = r.operand(p, "tex1", kind, 0.0);
    let tex2 = r.operand(p, "tex2", kind, 1.0);
    let dir = r.state.ctm[0].vector(p.triple("dir", T::Vector3).unwrap_or([0.0, 1.0, 0.0]));
    let length = dir.iter().map(|x| x * x).sum::<f64>().sqrt();
    if !length.is_normal() {
        p.complain("dir", "`dir` is zero");
        return None;
    }
    let amount = MixAmount::Direction(dir.map(|x| x / length));
    Some(made(TextureKind::Mix { first: tex2, second: tex1, amount }))
}

fn bilerp(r: &mut Reader<'_>, p: &mut Params, kind: TextureType) -> Option<Made> {
    let mut corner = |name, default: f64| {
        let color = match kind {
            TextureType::Spectrum => r.color(p, name, Use::Unbounded),
            TextureType::Float => p.optional_float(name).map(Color::Gray),
        };
        color.unwrap_or(Color::Gray(default))
    };
    let corners = [corner("v00", 0.0), corner("v01", 1.0), corner("v10", 0.0), corner("v11", 1.0)];
    Some(made(TextureKind::Bilerp { corners, mapping: r.mapping(p) }))
}

fn checkerboard(r: &mut Reader<'_>, p: &mut Params, kind: TextureType) -> Option<Made> {
    let color0 = r.operand(p, "tex1", kind, 1.0);
    let color1 = r.operand(p, "tex2", kind, 0.0);
    let mapping = match p.optional_integer("dimension").unwrap_or(2) {
        2 => r.mapping(p),
        3 => Mapping::Solid { to_texture: r.world_to_texture(p) },
        other => {
            p.complain("dimension", format!("a checkerboard has 2 or 3 dimensions, not {other}"));
            return None;
        }
    };
    Some(made(TextureKind::MappedCheckerboard { color0, color1, mapping }))
}

fn dots(r: &mut Reader<'_>, p: &mut Params, kind: TextureType) -> Option<Made> {
    // pbrt passes them to its texture in the wrong order, in all versions.
    let outside = r.operand(p, "inside", kind, 1.0);
    let inside = r.operand(p, "outside", kind, 0.0);
    Some(made(TextureKind::Dots { inside, outside, mapping: r.mapping(p) }))
}

fn noise(
    r: &mut Reader<'_>,
    p: &mut Params,
    kind: TextureType,
    wanted: TextureType,
    make: fn(&mut Params) -> NoiseKind,
) -> Option<Made> {
    let noise = make(p);
    if r.policy.is_three() && kind == TextureType::Spectrum && wanted == TextureType::Float {
        // pbrt-v3 has them as gray spectra too; in pbrt-v4 such a spectrum is white times a float.
        let (origin, to_texture) = (p.origin(), r.world_to_texture(p));
        let kind = TextureKind::Noise { kind: noise, to_texture };
        let id = r.scene.textures.push(Texture { name: None, origin, kind });
        let [value, factor] = [ColorInput::Color(Color::Gray(1.0)), ColorInput::Texture(id)];
        return Some(made(TextureKind::Scale { value, factor }));
    }
    if kind != wanted {
        let only = if wanted == TextureType::Float { "float" } else { "spectrum" };
        let text = format!("texture `{}` exists as \"{only}\" only", p.kind);
        p.problems.push(Diagnostic::error(text, Some(p.span)));
        return None;
    }
    Some(made(TextureKind::Noise { kind: noise, to_texture: r.world_to_texture(p) }))
}

fn with_octaves(p: &mut Params, make: fn(u32, f64) -> NoiseKind) -> NoiseKind {
    let octaves = p.count("octaves", 8, 1).min(MAX_OCTAVES);
    make(octaves, p.float("roughness", 0.5))
}

fn fbm(octaves: u32, roughness: f64) -> NoiseKind {
    NoiseKind::Fbm { octaves, roughness }
}

fn wrinkled(octaves: u32, roughness: f64) -> NoiseKind {
    NoiseKind::Wrinkled { octaves, roughness }
}

fn marble(p: &mut Params) -> NoiseKind {
    NoiseKind::Marble {
        octaves: p.count("octaves", 8, 1).min(MAX_OCTAVES),
        roughness: p.float("roughness", 0.5),
        scale: p.float("scale", 1.0),
        variation: p.float("variation", 0.2),
    }
}

fn imagemap(r: &mut Reader<'_>, p: &mut Params, _: TextureType) -> Option<Made> {
    let path = r.asset(p, "filename", "texture");
    let filter = p.choice("filter", TextureFilter::Bilinear, FILTERS);
    let wrap = p.choice("wrap", Some(WrapMode::Repeat), WRAPS).unwrap_or_else(|| {
        p.warn("wrap", "wrap `octahedralsphere` is approximated by `clamp`");
        WrapMode::Clamp
    });
    p.ignore(&["maxanisotropy"]);
    let encoding = p.optional_string("encoding").map_or(TextureEncoding::Auto, |(text, _)| {
        encoding(&text).unwrap_or_else(|| {
            p.complain(
                "encoding",
                format!("`{text}` is not an encoding: sRGB, linear, or `gamma` and a number"),
            );
            TextureEncoding::Auto
        })
    });
    let bitmap = Bitmap {
        path: path.clone().unwrap_or_default(),
        filter,
        wrap_u: wrap,
        wrap_v: wrap,
        encoding,
        channel: None,
        mapping: upside_down(r.mapping(p)),
        scale: p.float("scale", 1.0),
        invert: p.boolean("invert", false),
    };
    path?;
    Some(made(TextureKind::Bitmap(bitmap)))
}

fn encoding(text: &str) -> Option<TextureEncoding> {
    match text {
        "sRGB" => Some(TextureEncoding::Srgb),
        "linear" => Some(TextureEncoding::Linear),
        _ => {
            let gamma: f64 = text.strip_prefix("gamma ")?.trim().parse().ok()?;
            (gamma > 0.0 && gamma.is_finite()).then_some(TextureEncoding::Gamma(gamma))
        }
    }
}
