//! Participating media.

use super::color::times;
use super::object::{Class, ObjectIndex, Value};
use super::props::Props;
use super::reader::Reader;
use super::version::Dialect;
use crate::diagnostic::Diagnostic;
use crate::ir::{
    Coefficients, Color, ColorSlot, GridSamples, GridValues, Id, Medium, MediumInterface, Phase, Transform,
    Volume, VolumeData, VolumeFilter, VolumeGrid, WrapMode, rounded,
};
use crate::plugin::{Plugin, read};
use crate::spectrum::{medium_preset, medium_preset_names, to_linear_rgb};

/// What is special to a type of media.
pub(super) struct Contents {
    coefficients: Coefficients,
    density: Option<Volume>,
    orientation: Option<Volume>,
}

type ReadMedium = for<'a> fn(&mut Reader<'a>, &mut Props<'a>) -> Option<Contents>;

pub(super) const MEDIA: &[Plugin<ReadMedium>] =
    &[read("homogeneous", homogeneous), read("heterogeneous", heterogeneous)];

/// How a medium is sampled and stored; ignored.
const HARMLESS: &[&str] = &[
    "sample_emitters",
    "has_spectral_extinction",
    "majorant_resolution_factor",
    "majorant_factor",
    "majorant_grid",
    "strategy",
    "channel",
    "sampling_density",
    "medium_sampling_weight",
    "method",
    "step_size",
];

impl<'a> Reader<'a> {
    /// The medium at `index`; `None` after reporting why there is none.
    pub fn medium(&mut self, index: ObjectIndex) -> Option<Id<Medium>> {
        if let Some(id) = self.media.get(&index) {
            return *id;
        }
        let id = self.new_medium(index);
        self.media.insert(index, id);
        id
    }

    fn new_medium(&mut self, index: ObjectIndex) -> Option<Id<Medium>> {
        let reader = self.plugin(MEDIA, index, "vacuum is used")?;
        let mut props = self.props(index);
        let phase = props.only_child(Class::Phase);
        // Early versions of 0.x and 2.x had other names for it.
        let scale = ["scale", "density_scale", "density_multiplier"].map(|name| props.optional_float(name));
        let scale = scale.into_iter().flatten().next().unwrap_or(1.0);
        if scale < 0.0 {
            props.complain("scale", format!("`scale` must not be negative, but is {scale}"));
        }
        props.ignore(HARMLESS);
        let text = "all channels are rendered";
        if props.boolean("monochromatic", false) {
            props.ignore_with_warning(&["monochromatic"], text);
        }
        let contents = reader(self, &mut props);
        let phase = phase.and_then(|nested| self.phase(nested.index)).unwrap_or(Phase::Isotropic);
        let (name, origin) = (props.name(), props.origin());
        if let Some(contents) = &contents
            && contents.orientation.is_none()
            && phase.has_flakes()
        {
            props.needs("a volume `orientation` for its phase function");
        }
        self.finish(props);
        let Contents { coefficients, density, orientation } = contents?;
        let medium =
            Medium { name, origin, coefficients, density, scale, emission: None, phase, orientation };
        Some(self.scene.media.push(medium))
    }

    /// The media that a shape parts; `None` where it is no boundary.
    pub fn media_of(&mut self, props: &mut Props<'a>) -> Option<MediumInterface> {
        let sides = ["interior", "exterior"].map(|side| {
            let entry = props.entry(side)?;
            Some(match entry.value {
                Value::Object(index) if self.objects[index].class == Class::Medium => self.medium(index),
                _ => props.wrong(entry, "a medium"),
            })
        });
        while let Some(nested) = props.child(Class::Medium) {
            let text = "a medium of a shape needs the name `interior` or `exterior`";
            props.problems.push(Diagnostic::error(text, Some(nested.span)));
        }
        let [interior, exterior] = sides;
        (interior.is_some() || exterior.is_some())
            .then(|| MediumInterface { interior: interior.flatten(), exterior: exterior.flatten() })
    }

    /// The medium around an emitter or a sensor.
    pub fn medium_around(&mut self, props: &mut Props<'a>) -> Option<Id<Medium>> {
        props.only_child(Class::Medium).and_then(|nested| self.medium(nested.index))
    }
}

fn homogeneous<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<Contents> {
    let coefficients = if reader.dialect == Dialect::Old {
        measured(reader, props)?
    } else if props.has("sigma_a") || props.has("sigma_s") {
        parts(reader, props)?
    } else {
        let sigma_t = reader.volume_or(props, "sigma_t", 1.0);
        if sigma_t.varies() {
            props.complain("sigma_t", "`sigma_t` of a homogeneous medium is the same everywhere");
        }
        Coefficients::Extinction { sigma_t, albedo: reader.volume_or(props, "albedo", 0.75) }
    };
    Some(Contents { coefficients, density: None, orientation: None })
}

/// σa and σs in a file of Mitsuba 2 or 3, which know neither; both are needed.
fn parts<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<Coefficients> {
    let sigma_a = reader.optional_color(props, "sigma_a", ColorSlot::Unbounded);
    let sigma_s = reader.optional_color(props, "sigma_s", ColorSlot::Unbounded);
    for name in ["sigma_a", "sigma_s"] {
        if !props.has(name) {
            props.needs(&format!("`{name}` as well"));
        }
    }
    Some(Coefficients::Parts { sigma_a: Volume::Constant(sigma_a?), sigma_s: Volume::Constant(sigma_s?) })
}

/// The coefficients of 0.6: those of a measured material, some of which may be given. Its scattering is reduced by
/// the mean cosine `g`, because the phase function is another matter.
fn measured<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<Coefficients> {
    let by_parts = props.has("sigma_a") || props.has("sigma_s");
    let by_extinction = props.has("sigma_t") || props.has("albedo");
    for (a, b) in
        [("sigma_a", "sigma_t"), ("sigma_a", "albedo"), ("sigma_s", "sigma_t"), ("sigma_s", "albedo")]
    {
        props.exclusive(a, b);
    }
    for name in ["sigma_a", "sigma_s", "sigma_t", "albedo"] {
        props.exclusive("material", name);
    }
    let material = props.optional_string("material");
    let name = material.map_or("skin1", |(name, _)| name);
    let Some(preset) = medium_preset(name.trim()) else {
        let known = medium_preset_names();
        let problem = Diagnostic::error(format!("no medium named `{name}`"), material.map(|(_, span)| span));
        props.problems.push(problem.suggest_or(name, known, || "`skin1` is the default".to_owned()));
        return None;
    };
    // 0.6 takes the numbers of 1/mm for 1/cm.
    let [preset_s, preset_a] = [preset.sigma_s, preset.sigma_a].map(|v| v.map(|c| rounded(c * 100.0)));
    let mut color = |name, default: [f64; 3]| {
        reader.optional_color(props, name, ColorSlot::Unbounded).unwrap_or(Color::Rgb(default))
    };
    let given = if by_extinction {
        let [sum, albedo] = [0, 1].map(|which| {
            [0, 1, 2].map(|i| {
                let sum = preset_a[i] + preset_s[i];
                if which == 0 { sum } else { preset_s[i] / sum }
            })
        });
        Given::Extinction(color("sigma_t", sum), color("albedo", albedo))
    } else {
        Given::Parts(color("sigma_a", preset_a), color("sigma_s", preset_s))
    };
    let g = match reader.optional_color(props, "g", ColorSlot::Unbounded) {
        Some(color) => reader.linear(props, "g", &color)?,
        None if by_parts || by_extinction => [0.0; 3],
        None => preset.g,
    };
    if g.iter().any(|g| !(-1.0 < *g && *g < 1.0)) {
        props.complain("g", "`g` must lie between -1 and 1");
        return None;
    }
    given.reduced(reader, props, g)
}

enum Given {
    Extinction(Color, Color),
    Parts(Color, Color),
}

impl Given {
    /// With scattering times 1 − g.
    fn reduced<'a>(self, reader: &Reader<'a>, props: &mut Props<'a>, g: [f64; 3]) -> Option<Coefficients> {
        let constant = Volume::Constant;
        Some(match self {
            Self::Extinction(sigma_t, albedo) if g == [0.0; 3] => {
                Coefficients::Extinction { sigma_t: constant(sigma_t), albedo: constant(albedo) }
            }
            Self::Extinction(sigma_t, albedo) => {
                let sigma_t = reader.linear(props, "sigma_t", &sigma_t)?;
                let albedo = reader.linear(props, "albedo", &albedo)?;
                let by_lane = |f: fn(f64, f64, f64) -> f64| {
                    constant(Color::Rgb([0, 1, 2].map(|i| rounded(f(sigma_t[i], albedo[i], g[i])))))
                };
                Coefficients::Parts {
                    sigma_a: by_lane(|t, a, _| t * (1.0 - a)),
                    sigma_s: by_lane(|t, a, g| t * a * (1.0 - g)),
                }
            }
            Self::Parts(sigma_a, sigma_s) => {
                let sigma_s = match g {
                    [0.0, 0.0, 0.0] => sigma_s,
                    [r, g, b] if r == g && g == b => times(sigma_s, 1.0 - r),
                    _ => {
                        let sigma_s = reader.linear(props, "sigma_s", &sigma_s)?;
                        Color::Rgb([0, 1, 2].map(|i| rounded(sigma_s[i] * (1.0 - g[i]))))
                    }
                };
                Coefficients::Parts { sigma_a: constant(sigma_a), sigma_s: constant(sigma_s) }
            }
        })
    }
}

impl<'a> Reader<'a> {
    fn linear(&self, props: &mut Props<'a>, name: &str, color: &Color) -> Option<[f64; 3]> {
        let linear = to_linear_rgb(color, ColorSlot::Unbounded, self.dialect.spectrum_rule());
        linear.map_err(|e| props.complain(name, e.to_string())).ok()
    }
}

fn heterogeneous<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<Contents> {
    if reader.dialect == Dialect::Old && props.has("density") {
        let sigma_t = reader.volume(props, "density");
        let albedo = reader.volume(props, "albedo");
        let orientation = reader.volume(props, "orientation");
        if !props.has("albedo") {
            props.needs("a volume `albedo`");
        }
        let coefficients = Coefficients::Extinction { sigma_t: sigma_t?, albedo: albedo? };
        return Some(Contents { coefficients, density: None, orientation });
    }
    if reader.dialect == Dialect::Old && !props.has("sigma_t") {
        props.ignore(&["albedo", "orientation"]);
        props.needs("a volume `density`");
        return None;
    }
    let bounds = extent(reader, props);
    let sigma_t = reader.volume_or(props, "sigma_t", 1.0);
    let albedo = reader.volume_or(props, "albedo", 0.75);
    let orientation = reader.volume(props, "orientation");
    // Mitsuba 2 and 3 bound a medium by the box of its extinction, which is the unit cube where that is constant.
    let density = (!sigma_t.varies()).then(|| Volume::Grid(unit_cube(bounds)));
    Some(Contents { coefficients: Coefficients::Extinction { sigma_t, albedo }, density, orientation })
}

/// The `to_world` of a constant volume `sigma_t`.
fn extent(reader: &Reader<'_>, props: &Props<'_>) -> Transform {
    let entries = &props.object.entries;
    let sigma_t = entries.iter().rev().find(|entry| entry.name.as_deref() == Some("sigma_t"));
    let Some(Value::Object(index)) = sigma_t.map(|entry| &entry.value) else { return Transform::IDENTITY };
    let place = reader.objects[*index].entries.iter().rev().find(|e| e.name.as_deref() == Some("to_world"));
    match place.map(|entry| &entry.value) {
        Some(Value::Transform(to_world)) => *to_world,
        _ => Transform::IDENTITY,
    }
}

/// 1 in the unit cube.
fn unit_cube(to_world: Transform) -> VolumeGrid {
    VolumeGrid {
        data: VolumeData::Inline(GridValues { resolution: [1; 3], channels: 1, values: vec![1.0] }.into()),
        bounds: Some([[0.0; 3], [1.0; 3]]),
        to_world,
        filter: VolumeFilter::Nearest,
        wrap: WrapMode::Clamp,
        samples: GridSamples::Centers,
    }
}
