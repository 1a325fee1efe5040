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
    /// It changes the image; the text says what is lost.
    Lose(&'static str),
    /// How v4 says it, and the conversion of the parameter at an index.
    With(&'static str, fn(&mut Directive, usize)),
}

impl Change {
    /// `uv` and `amount` are old under another type, or in old company.
    pub fn concerns(&self, param: &Param, d: &Directive) -> bool {
        match param.name.as_str() {
            "uv" => param.kind == ParamType::Float,
            "amount" => d.params.iter().any(|p| p.name == "namedmaterial1"),
            _ => true,
        }
    }
}

use Change::{Drop, Lose, Rename, With};

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

const BLACK: &str = "the material is not tinted by it";

pub(super) const ROWS: &[Row] = &[
    // Materials.
    Row {
        params: &[],
        defaults: &[("roughness", &[0.01])],
        ..becomes("Material", "material", "metal", "conductor")
    },
    Row {
        params: &[("Kr", Lose(BLACK)), ("Kt", Lose(BLACK)), ("index", Rename("eta"))],
        ..becomes("Material", "material", "glass", "dielectric")
    },
    Row {
        params: &[("Kr", Rename("reflectance"))],
        defaults: &[("reflectance", &[0.9; 3])],
        ..becomes("Material", "material", "mirror", "conductor")
    },
    Row {
        params: &[("Kd", Rename("reflectance")), ("Kr", Drop), ("Kt", Drop)],
        ..becomes("Material", "material", "kdsubsurface", "subsurface")
    },
    same(
        "Material",
        "material",
        "mix",
        &[
            ("amount", With("the weight of the second material", second_weight)),
            ("namedmaterial1", With("\"string materials\"", mix_names)),
        ],
    ),
    same("Material", "material", "", &[("bumpmap", Rename("displacement"))]),
    // Textures.
    same(
        "Texture",
        "texture",
        "imagemap",
        &[("trilinear", Drop), ("noFiltering", Drop), ("gamma", With("`encoding`", gamma))],
    ),
    same("Texture", "texture", "checkerboard", &[("aamode", Drop)]),
    same("Texture", "texture", "scale", &[("tex1", With("`tex` and `scale`", scale_operands))]),
    // Lights.
    same("LightSource", "light", "", &[("nsamples", Drop), ("samples", Drop)]),
    same(
        "LightSource",
        "light",
        "goniometric",
        &[("mapname", Lose("its picture is of latitude and longitude; the light shines evenly"))],
    ),
    same("LightSource", "light", "projection", &[("mapname", Rename("filename"))]),
    same(
        "LightSource",
        "light",
        "infinite",
        &[("mapname", With("`filename`, of a square equal-area image", |_, _| {}))],
    ),
    becomes("LightSource", "light", "exinfinite", "infinite"),
    becomes("AreaLightSource", "area light", "area", "diffuse"),
    same("AreaLightSource", "area light", "", &[("nsamples", Drop), ("samples", Drop)]),
    // Camera, film, filter, sampler, integrator.
    Row { params: &[], ..becomes("Camera", "camera", "environment", "spherical") },
    same("Camera", "camera", "perspective", &[("halffov", With("`fov`", half_fov))]),
    becomes("Film", "film", "image", "rgb"),
    same(
        "Film",
        "film",
        "",
        &[("scale", With("`iso`", film_scale)), ("maxsampleluminance", Rename("maxcomponentvalue"))],
    ),
    same("PixelFilter", "filter", "", &[("xwidth", Rename("xradius")), ("ywidth", Rename("yradius"))]),
    same("PixelFilter", "filter", "gaussian", &[("alpha", With("`sigma`", gaussian_sigma))]),
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
    same(
        "Integrator",
        "integrator",
        "sppm",
        &[("numiterations", Lose("the sampler's count is used")), ("imagewritefrequency", Drop)],
    ),
    same("Integrator", "integrator", "", &[("rrthreshold", Drop), ("pixelbounds", Drop)]),
    // Shapes.
    same(
        "Shape",
        "shape",
        "trianglemesh",
        &[("uv", With("`point2 uv`", uv)), ("st", With("`point2 uv`", st)), ("shadowalpha", Drop)],
    ),
    same("Shape", "shape", "plymesh", &[("shadowalpha", Drop)]),
    same("Shape", "shape", "loopsubdiv", &[("nlevels", Rename("levels"))]),
];

/// v3 weighs the first of the two.
fn second_weight(d: &mut Directive, index: usize) {
    let param = &mut d.params[index];
    if let Values::Floats(v) = &mut param.values {
        *v = vec![1.0 - v.iter().sum::<f64>() / v.len().max(1) as f64];
        param.kind = ParamType::Float;
    }
}

fn mix_names(d: &mut Directive, index: usize) {
    let second = d.params.iter().position(|p| p.name == "namedmaterial2");
    let second = second.map(|at| d.params.remove(at));
    let at =
        d.params.iter().position(|p| p.name == "namedmaterial1").unwrap_or(index.min(d.params.len() - 1));
    let param = &mut d.params[at];
    "materials".clone_into(&mut param.name);
    if let (Values::Texts(names), Some(Values::Texts(more))) = (&mut param.values, second.map(|p| p.values)) {
        names.extend(more);
    }
}

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

/// A texture times a number: the number becomes `scale`.
fn scale_operands(d: &mut Directive, index: usize) {
    let first_is_texture = d.params[index].kind == ParamType::Texture;
    for p in &mut d.params {
        let is_texture = p.kind == ParamType::Texture;
        let new = match (p.name.as_str(), first_is_texture, is_texture) {
            ("tex1", true, _) | ("tex2", false, true) => "tex",
            ("tex2", true, _) | ("tex1", false, _) => "scale",
            _ => continue,
        };
        new.clone_into(&mut p.name);
        if new == "scale"
            && p.kind == ParamType::Rgb
            && let Values::Floats(v) = &mut p.values
        {
            *v = vec![v.iter().sum::<f64>() / v.len().max(1) as f64];
            p.kind = ParamType::Float;
        }
    }
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
