//! Participating media and the interfaces between them.

use super::color::Use;
use super::directive::{Directive, Param, ParamType};
use super::params::Params;
use super::policy::Fault;
use super::reader::{Reader, text};
use super::state::Named;
use crate::diagnostic::{Diagnostic, Span};
use crate::ir::{
    Cloud, Coefficients, Color, GridSamples, GridValues, Id, Medium, MediumEmission, MediumInterface, Origin,
    Phase, Volume, VolumeData, VolumeFile, VolumeFilter, VolumeFormat, VolumeGrid, WrapMode,
};
use crate::plugin::{Plugin, read};
use crate::spectrum::{Reduced, reduced_medium, reduced_medium_names};
use crate::volume;

use ParamType as T;

/// What is special to a type of media.
struct Contents {
    coefficients: Coefficients,
    density: Option<Volume>,
    emission: Option<MediumEmission>,
}

type ReadMedium = fn(&mut Reader<'_>, &mut Params) -> Option<Contents>;

pub(super) const MEDIA: &[Plugin<MediumReader>] = &[
    read("homogeneous", MediumReader(homogeneous)),
    read("uniformgrid", MediumReader(uniform_grid)),
    read("rgbgrid", MediumReader(rgb_grid)),
    read("cloud", MediumReader(cloud)),
    read("nanovdb", MediumReader(nano_vdb)),
    // Of pbrt-v3.
    read("heterogeneous", MediumReader(uniform_grid)),
];

/// A row's reader.
#[derive(Clone, Copy)]
pub(super) struct MediumReader(ReadMedium);

/// Luminance of pbrt's spectra of luminance 1 before they are scaled to it: the integral of ȳ, nm.
pub(super) const Y_INTEGRAL: f64 = 106.856_895;

/// Parameters of a temperature, where there is none.
const HEAT: &[&str] = &["temperatureoffset", "temperaturecutoff", "temperaturescale"];

impl Reader<'_> {
    pub fn medium(&mut self, d: &Directive, params: Vec<Param>) {
        self.report_moving("a medium", d.span);
        let (name, span) = (text(d, 0).to_owned(), d.arguments[0].span);
        let named = self.named_medium(&name);
        let earlier = self.media.get_mut(&name).and_then(|named| named.defined.replace(span));
        self.redefined("medium", &name, span, earlier);
        let Some(mut p) = self.named_entity("medium", d, params) else { return };
        let medium = self.plugin(MEDIA, &mut p, "vacuum is used").and_then(|MediumReader(reader)| {
            let g = p.float("g", 0.0);
            let scale = p.float("scale", 1.0);
            for (name, value, sound) in [("g", g, -1.0 < g && g < 1.0), ("scale", scale, scale >= 0.0)] {
                if !sound {
                    let range = if name == "g" { "lie between -1 and 1" } else { "not be negative" };
                    p.complain(name, format!("`{name}` must {range}, but is {value}"));
                }
            }
            let Contents { coefficients, density, emission } = reader(self, &mut p)?;
            let phase = if g == 0.0 { Phase::Isotropic } else { Phase::HenyeyGreenstein { g } };
            let (name, origin) = (Some(name), Origin(Some(span)));
            Some(Medium { name, origin, coefficients, density, scale, emission, phase, orientation: None })
        });
        self.done(p);
        if let Some(medium) = medium {
            self.scene.media[named] = medium;
        }
    }

    /// The medium of a name, which may be defined later.
    fn named_medium(&mut self, name: &str) -> Id<Medium> {
        if let Some(named) = self.media.get(name) {
            return named.id;
        }
        let none = || Volume::number(0.0);
        let id = self.scene.media.push(Medium {
            name: Some(name.to_owned()),
            origin: Origin(None),
            coefficients: Coefficients::Parts { sigma_a: none(), sigma_s: none() },
            density: None,
            scale: 1.0,
            emission: None,
            phase: Phase::Isotropic,
            orientation: None,
        });
        self.media.insert(name.to_owned(), Named { id, defined: None, used: None });
        id
    }

    /// Makes the named media, of which `""` is vacuum, those inside and outside of what follows.
    pub fn medium_interface(&mut self, d: &Directive) {
        let sides = [0, d.arguments.len() - 1];
        self.state.media = sides.map(|at| {
            let (name, span) = (text(d, at), d.arguments[at].span);
            if name.is_empty() {
                return None;
            }
            let id = self.named_medium(name);
            self.media.get_mut(name).expect("it was just named").used.get_or_insert(span);
            Some(id)
        });
    }

    /// The media that the next shape parts; `None` where both are one.
    pub fn media_of_shape(&self) -> Option<MediumInterface> {
        let [interior, exterior] = self.state.media;
        (interior != exterior).then_some(MediumInterface { interior, exterior })
    }

    /// Reports names that were used and never defined.
    pub fn check_media(&mut self) {
        let missing = self.media.iter().filter(|(_, named)| named.defined.is_none());
        let mut missing: Vec<(String, Span)> =
            missing.filter_map(|(name, named)| Some((name.clone(), named.used?))).collect();
        missing.sort_by(|a, b| a.0.cmp(&b.0));
        if self.incomplete {
            return;
        }
        for (name, span) in missing {
            let problem = Diagnostic::error(format!("no medium named `{name}`"), Some(span));
            let known = self.media.iter().filter(|(_, named)| named.defined.is_some());
            let problem = problem.suggest_or(&name, known.map(|(name, _)| name.as_str()), || {
                "MakeNamedMedium defines one".to_owned()
            });
            self.problems.push(self.policy.judge(Fault::Mistake, problem, "vacuum is used"));
        }
    }

    /// σa and σs; both are 1 where nothing is given, and those of whole milk in pbrt-v3.
    fn parts(&mut self, p: &mut Params) -> Coefficients {
        let old = self.policy.is_three();
        let preset = self.preset(p);
        // A preset wins in pbrt-v4; in pbrt-v3 it is what holds for the one that is not given.
        let mut one = |name, of: fn(&Reduced) -> [f64; 3]| {
            let given = self.color(p, name, Use::Unbounded);
            let fixed = preset.as_ref().map(|preset| Color::Rgb(of(preset)));
            let chosen = if old { given.or(fixed) } else { fixed.or(given) };
            Volume::Constant(chosen.unwrap_or(Color::Gray(1.0)))
        };
        Coefficients::Parts { sigma_a: one("sigma_a", |m| m.sigma_a), sigma_s: one("sigma_s", |m| m.sigma_s) }
    }

    fn preset(&mut self, p: &mut Params) -> Option<Reduced> {
        let default = if self.policy.is_three() { reduced_medium("Wholemilk") } else { None };
        let Some((name, span)) = p.optional_string("preset").filter(|(name, _)| !name.is_empty()) else {
            return default;
        };
        let preset = reduced_medium(&name);
        if preset.is_none() {
            let text = format!("no medium named `{name}`: it counts as not given");
            let problem = Diagnostic::warning(text, Some(span));
            p.problems.push(problem.suggest(&name, reduced_medium_names()));
        }
        preset.or(default)
    }

    /// `Le` as pbrt scales it, to luminance 1.
    fn emission(&mut self, p: &mut Params, scale: Volume) -> Option<MediumEmission> {
        let radiance = self.color(p, "Le", Use::Illuminant)?;
        let dark = matches!(radiance, Color::Rgb([0.0, 0.0, 0.0]));
        (!dark).then_some(MediumEmission::Radiance { radiance: Volume::Constant(radiance), scale })
    }

    /// A grid in the box of `p0` and `p1`.
    fn grid(&self, p: &mut Params, data: VolumeData, bounds: Option<[[f64; 3]; 2]>) -> VolumeGrid {
        let to_world = self.state.ctm[0];
        if to_world.inverse().is_none() {
            p.problems.push(Diagnostic::error(
                "the transform flattens the medium: it has no inverse",
                Some(p.span),
            ));
        }
        VolumeGrid {
            data,
            bounds,
            to_world,
            filter: VolumeFilter::Trilinear,
            wrap: WrapMode::Zero,
            samples: GridSamples::Centers,
        }
    }
}

fn homogeneous(r: &mut Reader<'_>, p: &mut Params) -> Option<Contents> {
    let coefficients = r.parts(p);
    let scale = Volume::number(p.float("Lescale", 1.0));
    Some(Contents { coefficients, density: None, emission: r.emission(p, scale) })
}

fn bounds(p: &mut Params) -> [[f64; 3]; 2] {
    let bounds =
        [p.triple("p0", T::Point3).unwrap_or([0.0; 3]), p.triple("p1", T::Point3).unwrap_or([1.0; 3])];
    if (0..3).any(|i| bounds[0][i] >= bounds[1][i]) {
        p.complain("p1", "the box from `p0` to `p1` is empty");
    }
    bounds
}

/// `nx`, `ny` and `nz`, with their product.
fn resolution(p: &mut Params) -> ([u32; 3], u64) {
    let resolution = [p.count("nx", 1, 1), p.count("ny", 1, 1), p.count("nz", 1, 1)];
    (resolution, resolution.iter().fold(1, |product, &n| product.saturating_mul(u64::from(n))))
}

/// The values of list `name`, if there is one value for each of `points` points.
fn values(
    p: &mut Params,
    name: &'static str,
    kind: ParamType,
    (resolution, points): ([u32; 3], u64),
) -> Option<GridValues> {
    let values = p.number_list(name, kind)?;
    let channels = if kind == T::Rgb { 3 } else { 1 };
    if values.len() as u64 != points.saturating_mul(u64::from(channels)) {
        let [x, y, z] = resolution;
        let text = format!("`{name}` has {} numbers, but a grid of {x} × {y} × {z} points", values.len());
        p.complain(name, text);
        return None;
    }
    if let Some(bad) = values.iter().find(|v| !v.is_finite() || **v < 0.0) {
        p.complain(name, format!("`{name}` must not be negative, but has {bad}"));
        return None;
    }
    Some(GridValues { resolution, channels, values })
}

fn temperature(p: &mut Params, kelvin: Volume, scale: Volume) -> MediumEmission {
    let old_name = p.optional_float("temperaturecutoff");
    let offset = p.optional_float("temperatureoffset").or(old_name).unwrap_or(0.0);
    MediumEmission::Temperature {
        kelvin,
        offset,
        factor: p.float("temperaturescale", 1.0),
        peak: Y_INTEGRAL,
        scale,
    }
}

fn uniform_grid(r: &mut Reader<'_>, p: &mut Params) -> Option<Contents> {
    let coefficients = r.parts(p);
    let (bounds, size) = (bounds(p), resolution(p));
    if !p.has("density") {
        p.complain("density", format!("{} needs the parameter \"float density\"", p.what()));
    }
    let grid = |p: &mut Params, name| {
        let values = values(p, name, T::Float, size)?;
        Some(Volume::Grid(r.grid(p, VolumeData::Inline(values.into()), Some(bounds))))
    };
    let density = grid(p, "density");
    let kelvin = grid(p, "temperature");
    // As pbrt has it: one value in the middle, from which the emission falls to half of it at the sides of the box.
    let tent = || GridValues { resolution: [1; 3], channels: 1, values: vec![1.0] };
    let scale = match p.has("Lescale") {
        true => grid(p, "Lescale"),
        false if p.has("Le") || kelvin.is_some() => {
            Some(Volume::Grid(r.grid(p, VolumeData::Inline(tent().into()), Some(bounds))))
        }
        false => None,
    };
    let scale = scale.unwrap_or(Volume::number(1.0));
    if p.has("Le") && p.has("temperature") {
        p.complain("Le", format!("{} takes either `Le` or `temperature`, not both", p.what()));
    }
    let emission = match kelvin {
        Some(kelvin) => {
            p.ignore(&["Le"]);
            Some(temperature(p, kelvin, scale))
        }
        None => {
            p.ignore(HEAT);
            r.emission(p, scale)
        }
    };
    Some(Contents { coefficients, density: Some(density?), emission })
}

fn rgb_grid(r: &mut Reader<'_>, p: &mut Params) -> Option<Contents> {
    let (bounds, size) = (bounds(p), resolution(p));
    let given = ["sigma_a", "sigma_s", "Le"].map(|name| p.has(name));
    if !given[0] && !given[1] {
        p.complain("sigma_a", format!("{} needs the parameter \"rgb sigma_a\" or \"rgb sigma_s\"", p.what()));
    }
    if given[2] && !given[0] {
        p.complain("Le", format!("`Le` of {} needs `sigma_a` as well", p.what()));
    }
    let space = p.space;
    let grid = |p: &mut Params, name: &'static str| {
        let mut values = values(p, name, T::Rgb, size)?;
        for rgb in values.values.as_chunks_mut::<3>().0 {
            let wide = rgb.map(f64::from);
            let linear =
                if name == "Le" { space.light_to_rec709(wide) } else { space.reflectance_to_rec709(wide) };
            *rgb = linear.map(|c| c.max(0.0) as f32);
        }
        Some(Volume::Grid(r.grid(p, VolumeData::Inline(values.into()), Some(bounds))))
    };
    let [sigma_a, sigma_s, radiance] = ["sigma_a", "sigma_s", "Le"].map(|name| grid(p, name));
    // Unlike `Le` of other media, this one is not scaled to luminance 1.
    let scale = p.float("Lescale", 1.0) * Y_INTEGRAL;
    let [sigma_a, sigma_s] = [(given[0], sigma_a), (given[1], sigma_s)]
        .map(|(given, grid)| if given { grid } else { Some(Volume::number(1.0)) });
    let emission =
        radiance.map(|radiance| MediumEmission::Radiance { radiance, scale: Volume::number(scale) });
    let coefficients = Coefficients::Parts { sigma_a: sigma_a?, sigma_s: sigma_s? };
    Some(Contents { coefficients, density: None, emission })
}

fn cloud(r: &mut Reader<'_>, p: &mut Params) -> Option<Contents> {
    let coefficients = r.parts(p);
    let [density, wispiness, frequency] = [("density", 1.0), ("wispiness", 1.0), ("frequency", 5.0)]
        .map(|(name, default)| p.float(name, default));
    let cloud = Cloud { density, wispiness, frequency, bounds: bounds(p), to_world: r.state.ctm[0] };
    if cloud.to_world.inverse().is_none() {
        let text = "the transform flattens the medium: it has no inverse";
        p.problems.push(Diagnostic::error(text, Some(p.span)));
    }
    Some(Contents { coefficients, density: Some(Volume::Cloud(cloud)), emission: None })
}

fn nano_vdb(r: &mut Reader<'_>, p: &mut Params) -> Option<Contents> {
    let coefficients = r.parts(p);
    let path = r.asset(p, "filename", "volume");
    let name = |p: &mut Params, name, default: &str| {
        p.optional_string(name).map_or_else(|| default.to_owned(), |(name, _)| name)
    };
    let density = name(p, "gridname", "density");
    let heat = name(p, "temperaturename", "temperature");
    let scale = p.float("Lescale", 1.0);
    let grid = |r: &Reader<'_>, p: &mut Params, path, grid| {
        let format = VolumeFormat::NanoVdb { grid };
        Volume::Grid(r.grid(p, VolumeData::File(VolumeFile { path, format }), None))
    };
    let Some(path) = path else {
        p.ignore(HEAT);
        return None;
    };
    // What is wrong with the file is said where it is read in full.
    let names = r.files.read(&path).map(|bytes| volume::grid_names(&bytes).unwrap_or_default());
    let hot = names.is_ok_and(|names| names.contains(&heat)) && scale > 0.0;
    let kelvin = hot.then(|| grid(r, p, path.clone(), heat));
    let emission = match kelvin {
        Some(kelvin) => Some(temperature(p, kelvin, Volume::number(scale))),
        None => {
            p.ignore(HEAT);
            None
        }
    };
    Some(Contents { coefficients, density: Some(grid(r, p, path, density)), emission })
}
