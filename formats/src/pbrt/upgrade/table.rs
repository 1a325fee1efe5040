//! pbrt-v3's types and parameters, one row each.

use super::super::directive::{Directive, Param, ParamType, Values};

/// The conversion of a type of pbrt-v3; `from: ""` is any type of the class.
pub(super) struct Row {
    /// The directive.
    pub class: &'static str,
    pub noun: &'static str,
    pub from: &'static str,
    pub to: &'static str,
    /// How the new type differs; empty when it is the same.
    pub loss: &'static str,
    pub params: &'static [(&'static str, Change)],
    /// Defaults that v4 changed: one value is a float, three are rgb.
    pub defaults: &'static [(&'static str, &'static [f64])],
}

pub(super) enum Change {
    Rename(&'static str),
    /// It does not change the image.
    Drop,
    /// The conversion of the parameter at an index.
    With(fn(&mut Directive, usize)),
}

impl Change {
    /// `uv` is old under another type only.
    pub fn concerns(&self, param: &Param) -> bool {
        param.name != "uv" || param.kind == ParamType::Float
    }
}

use Change::{Drop, Rename, With};

const fn same(
    class: &'static str,
    noun: &'static str,
    kind: &'static str,
    params: &'static [(&'static str, Change)],
) -> Row {
    Row { class, noun, from: kind, to: kind, loss: "", params, defaults: &[] }
}

const fn becomes(class: &'static str, noun: &'static str, from: &'static str, to: &'static str) -> Row {
    Row { class, noun, from, to, loss: "", params: &[], defaults: &[] }
}

/// Directives, with the types that only pbrt-v3 and older versions have; none: the directive itself.
pub(super) const ONLY_THREE: &[(&str, &[&str])] = &[
    (
        "Material",
        &[
            "matte",
            "metal",
            "glass",
            "mirror",
            "plastic",
            "substrate",
            "uber",
            "translucent",
            "kdsubsurface",
            "disney",
            "fourier",
            "shinymetal",
            "brushedmetal",
            "bluepaint",
            "clay",
            "felt",
            "primer",
            "skin",
        ],
    ),
    ("Film", &["image"]),
    ("Volume", &[]),
];

/// The same for pbrt-v4.
pub(super) const ONLY_FOUR: &[(&str, &[&str])] = &[
    (
        "Material",
        &[
            "diffuse",
            "coateddiffuse",
            "conductor",
            "coatedconductor",
            "dielectric",
            "thindielectric",
            "diffusetransmission",
            "interface",
        ],
    ),
    ("Film", &["rgb", "gbuffer", "spectral"]),
    ("Sampler", &["zsobol", "paddedsobol", "pmj02bn", "independent"]),
    ("Integrator", &["simplepath", "simplevolpath", "lightpath", "randomwalk"]),
    ("Attribute", &[]),
    ("ColorSpace", &[]),
    ("Option", &[]),
    ("Import", &[]),
];

pub(super) const ROWS: &[Row] = &[
    // Materials.
    Row {
        params: &[("Kd", Rename("reflectance")), ("Kr", Drop), ("Kt", Drop)],
        ..becomes("Material", "material", "kdsubsurface", "subsurface")
    },
    // Textures.
    same(
        "Texture",
        "texture",
        "imagemap",
        &[("trilinear", Drop), ("noFiltering", Drop), ("gamma", With(gamma))],
    ),
    same("Texture", "texture", "checkerboard", &[("aamode", Drop)]),
    // Lights.
    same("LightSource", "light", "", &[("nsamples", Drop), ("samples", Drop)]),
    becomes("LightSource", "light", "exinfinite", "infinite"),
    becomes("AreaLightSource", "area light", "area", "diffuse"),
    same("AreaLightSource", "area light", "", &[("nsamples", Drop), ("samples", Drop)]),
    // Camera, film, filter, sampler, integrator.
    Row { params: &[], ..becomes("Camera", "camera", "environment", "spherical") },
    same("Camera", "camera", "perspective", &[("halffov", With(half_fov))]),
    becomes("Film", "film", "image", "rgb"),
    same(
        "Film",
        "film",
        "",
        &[("scale", With(film_scale)), ("maxsampleluminance", Rename("maxcomponentvalue"))],
    ),
    same("PixelFilter", "filter", "", &[("xwidth", Rename("xradius")), ("ywidth", Rename("yradius"))]),
    same("PixelFilter", "filter", "gaussian", &[("alpha", With(gaussian_sigma))]),
    becomes("Sampler", "sampler", "random", "independent"),
    becomes("Sampler", "sampler", "02sequence", "paddedsobol"),
    becomes("Sampler", "sampler", "lowdiscrepancy", "paddedsobol"),
    becomes("Sampler", "sampler", "bestcandidate", "paddedsobol"),
    becomes("Sampler", "sampler", "maxmindist", "pmj02bn"),
    same("Sampler", "sampler", "", &[("dimensions", Drop), ("samplepixelcenter", Drop)]),
    Row {
        loss: "light is followed as far as everywhere else",
        params: &[("strategy", Drop)],
        ..becomes("Integrator", "integrator", "directlighting", "path")
    },
    Row {
        loss: "all light paths are traced, not only mirror reflections",
        ..becomes("Integrator", "integrator", "whitted", "path")
    },
    becomes("Integrator", "integrator", "ao", "ambientocclusion"),
    same("Integrator", "integrator", "path", &[("lightsamplestrategy", Rename("lightsampler"))]),
    same("Integrator", "integrator", "volpath", &[("lightsamplestrategy", Rename("lightsampler"))]),
    same("Integrator", "integrator", "bdpt", &[("lightsamplestrategy", Drop)]),
    same("Integrator", "integrator", "sppm", &[("imagewritefrequency", Drop)]),
    same("Integrator", "integrator", "", &[("rrthreshold", Drop), ("pixelbounds", Drop)]),
    // Shapes.
    same("Shape", "shape", "trianglemesh", &[("uv", With(uv)), ("st", With(st))]),
    same("Shape", "shape", "loopsubdiv", &[("nlevels", Rename("levels"))]),
];

fn gamma(d: &mut Directive, index: usize) {
    let param = &mut d.params[index];
    let encoding = match &param.values {
        Values::Bools(v) if v.first() == Some(&false) => "linear".to_owned(),
        Values::Floats(v) => format!("gamma {}", v.first().unwrap_or(&1.0)),
        _ => "sRGB".to_owned(),
    };
    "encoding".clone_into(&mut param.name);
    (param.kind, param.values) = (ParamType::String, Values::Texts(vec![encoding]));
}

fn single(d: &mut Directive, index: usize, name: &str, convert: impl Fn(f64) -> f64) {
    let param = &mut d.params[index];
    name.clone_into(&mut param.name);
    if let Values::Floats(v) = &mut param.values {
        v.iter_mut().for_each(|v| *v = convert(*v));
    }
}

fn half_fov(d: &mut Directive, index: usize) {
    single(d, index, "fov", |half| 2.0 * half);
}

fn film_scale(d: &mut Directive, index: usize) {
    single(d, index, "iso", |scale| 100.0 * scale);
}

/// exp(−α·x²) is a Gaussian of σ = 1/√(2α).
fn gaussian_sigma(d: &mut Directive, index: usize) {
    single(d, index, "sigma", |alpha| 1.0 / (2.0 * alpha).sqrt());
}

fn uv(d: &mut Directive, index: usize) {
    d.params[index].kind = ParamType::Point2;
}

fn st(d: &mut Directive, index: usize) {
    "uv".clone_into(&mut d.params[index].name);
    d.params[index].kind = ParamType::Point2;
}
