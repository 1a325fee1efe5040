//! Sensors and samplers.

use super::number;
use super::object::{Class, ObjectIndex};
use super::props::Props;
use super::reader::Reader;
use super::version::Dialect;
use crate::diagnostic::Diagnostic;
use crate::ir::{Film, Fov, FovAxis, Lens, Projection, Sampler, Sensor, Transform};
use crate::plugin::{Plugin, read, unsupported};

/// What is special to a sensor.
#[derive(Clone, Copy)]
pub(super) enum Optics {
    /// The number is `far_clip`.
    Camera(fn(&mut Props<'_>, f64) -> (Projection, Option<Lens>)),
    /// A ray from somewhere, which meets all that is in its way.
    Ray,
}

pub(super) const SENSORS: &[Plugin<Optics>] = &[
    read("perspective", Optics::Camera(pinhole)),
    read("thinlens", Optics::Camera(thin_lens)),
    read("orthographic", Optics::Camera(orthographic)),
    read("radiancemeter", Optics::Ray),
    unsupported("irradiancemeter"),
    unsupported("distant"),
    unsupported("batch"),
    unsupported("spherical"),
    unsupported("telecentric"),
    unsupported("perspective_rdist"),
    unsupported("fluencemeter"),
    // Of renderers that came from Mitsuba.
    unsupported("realistic"),
    unsupported("realisticlens"),
    unsupported("nlos_capture_meter"),
];

/// Accepted for their sample counts only: we use our own sample points.
pub(super) const SAMPLERS: &[Plugin<()>] = &[
    read("independent", ()),
    read("stratified", ()),
    read("multijitter", ()),
    read("orthogonal", ()),
    read("ldsampler", ()),
    read("halton", ()),
    read("hammersley", ()),
    read("sobol", ()),
];

pub(super) const AXES: &[(&str, FovAxis)] = &[
    ("x", FovAxis::X),
    ("y", FovAxis::Y),
    ("diagonal", FovAxis::Diagonal),
    ("smaller", FovAxis::Smaller),
    ("larger", FovAxis::Larger),
];

impl<'a> Reader<'a> {
    /// Reads a sensor of the scene.
    pub fn sensor(&mut self, index: ObjectIndex) {
        let Some(optics) = self.plugin(SENSORS, index, "it is skipped") else { return };
        let mut props = self.props(index);
        let (seen, projection, lens, to_world) = match optics {
            Optics::Camera(optics) => {
                let seen @ [_, far] = clips(&mut props);
                let (projection, lens) = optics(&mut props, far);
                (seen, projection, lens, props.transform("to_world"))
            }
            Optics::Ray => ([0.0, ENDLESS], Projection::Ray, None, along(&mut props)),
        };
        let [near_clip, far_clip] = seen;
        if projection != Projection::Orthographic {
            check_rigid(&mut props, &to_world);
        }
        let principal_point_offset =
            [props.float("principal_point_offset_x", 0.0), props.float("principal_point_offset_y", 0.0)];
        props.ignore(&["shutter_open", "shutter_close", "shutter_open_time", "focus_distance"]);
        props.ignore_with_warning(&["srf"], "the response of the sensor is that of linear RGB");
        let medium = self.medium_around(&mut props);
        let film = props.only_child(Class::Film).map(|nested| nested.index);
        let sampler = props.only_child(Class::Sampler).map(|nested| nested.index);
        let sensor = Sensor {
            name: props.name(),
            origin: props.origin(),
            to_world,
            projection,
            screen_window: None,
            near_clip,
            far_clip,
            principal_point_offset,
            lens,
            film: self.film(film, props.origin()),
            sampler: self.sampler(sampler),
            medium,
        };
        if let Some(nested) = props.child(Class::Rfilter) {
            let text = "a reconstruction filter belongs inside the <film>, not beside it: it is ignored";
            props.problems.push(Diagnostic::warning(text, Some(nested.span)));
        }
        self.finish(props);
        self.check_film(&sensor);
        self.scene.sensors.push(sensor);
    }

    /// As Mitsuba 3 does.
    fn check_film(&mut self, sensor: &Sensor) {
        let Film { width, height, origin, .. } = sensor.film;
        if self.dialect != Dialect::Old && sensor.projection == Projection::Ray && width != 1 && height != 1 {
            let text =
                format!("a radiancemeter sees along one ray: its film has 1×1 pixels, not {width}×{height}");
            let help = "write <integer name=\"width\" value=\"1\"/> and <integer name=\"height\" value=\"1\"/> \
                        in its <film>";
            self.problems.push(Diagnostic::error(text, origin.0).help(help));
        }
    }

    fn sampler(&mut self, index: Option<ObjectIndex>) -> Sampler {
        let mut sampler = Sampler { plugin: "independent".to_owned(), sample_count: 4, seed: 0 };
        let Some(index) = index else { return sampler };
        let mut props = self.props(index);
        let known = self.plugin(SAMPLERS, index, "independent samples are used").is_some();
        sampler.sample_count = sample_count(&mut props);
        sampler.seed = props.optional_integer("seed").map_or(0, i64::cast_unsigned);
        props.ignore(&["jitter", "strength", "dimension", "scramble", "light_samples", "wrap"]);
        if known {
            sampler.plugin.clone_from(&props.object.plugin);
        }
        self.finish(props);
        sampler
    }
}

/// More samples than anyone can wait for stand for "until stopped".
fn sample_count(props: &mut Props<'_>) -> u32 {
    const MOST: u32 = 1 << 30;
    match props.optional_integer("sample_count") {
        Some(count) if count > i64::from(MOST) => {
            let text = format!("`sample_count` of {count} is cut to {MOST}");
            let place = props.entry("sample_count").map(|entry| entry.span);
            props.problems.push(Diagnostic::warning(text, place));
            MOST
        }
        _ => props.count("sample_count", 4, 1..=MOST),
    }
}

/// Farther than any scene reaches.
const ENDLESS: f64 = 1e30;

fn clips(props: &mut Props<'_>) -> [f64; 2] {
    let near_clip = props.positive("near_clip", 0.01);
    let far_clip = props.positive("far_clip", 10_000.0);
    if near_clip >= far_clip {
        let text = format!("`near_clip` ({near_clip}) must be below `far_clip` ({far_clip})");
        props.complain("near_clip", text);
    }
    [near_clip, far_clip]
}

/// The place of a ray: `to_world`, or without it `origin` and `direction`.
fn along(props: &mut Props<'_>) -> Transform {
    let (from, direction) = (props.triple("origin"), props.triple("direction"));
    if props.has("to_world") {
        return props.transform("to_world");
    }
    let (from, direction) = match (from, direction) {
        (Some(from), Some(direction)) => (from, direction),
        (None, None) => return Transform::IDENTITY,
        (from, _) => {
            let given = if from.is_some() { "origin" } else { "direction" };
            props.complain(given, "a radiancemeter takes both `origin` and `direction`, or neither");
            return Transform::IDENTITY;
        }
    };
    let target = std::array::from_fn(|i| from[i] + direction[i]);
    // What lies beside the ray is not seen, so which way is up is no matter.
    let up = if direction[0].abs() < direction[1].abs() { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    Transform::look_at(from, target, up).unwrap_or_else(|| {
        props.complain("direction", "`direction` has no length");
        Transform::IDENTITY
    })
}

fn pinhole(props: &mut Props<'_>, _: f64) -> (Projection, Option<Lens>) {
    props.ignore_with_warning(&["aperture_radius"], "a perspective sensor has no lens; thinlens has");
    (perspective(props), None)
}

fn orthographic(_: &mut Props<'_>, _: f64) -> (Projection, Option<Lens>) {
    (Projection::Orthographic, None)
}

fn thin_lens(props: &mut Props<'_>, far_clip: f64) -> (Projection, Option<Lens>) {
    let focus_distance = props.positive("focus_distance", far_clip);
    let radius = props.optional_float("aperture_radius");
    match radius {
        None if !props.has("aperture_radius") => {
            props.complain("aperture_radius", "thinlens needs the parameter `aperture_radius`");
        }
        Some(r) if r < 0.0 => {
            props.complain("aperture_radius", format!("`aperture_radius` must be positive, not {r}"));
        }
        _ => {}
    }
    // Mitsuba replaces a zero radius by a tiny one; its limit is a pinhole.
    let lens = radius.filter(|r| *r > 0.0).map(|aperture_radius| Lens { aperture_radius, focus_distance });
    (perspective(props), lens)
}

fn perspective(props: &mut Props<'_>) -> Projection {
    let fov = fov(props);
    Projection::Perspective { fov, axis: props.choice("fov_axis", FovAxis::X, AXES) }
}

pub(super) fn fov(props: &mut Props<'_>) -> Fov {
    props.exclusive("fov", "focal_length");
    let length = props.optional_string("focal_length");
    if let Some(degrees) = props.optional_float("fov") {
        if degrees <= 0.0 || degrees >= 180.0 {
            props.complain("fov", format!("`fov` must lie between 0 and 180 degrees, not {degrees}"));
        }
        return Fov::Degrees(degrees);
    }
    let Some((text, _)) = length else { return Fov::FocalLength(50.0) };
    match number::float(text.trim().trim_end_matches("mm")) {
        Some(length) if length > 0.0 => Fov::FocalLength(length),
        _ => {
            props.complain("focal_length", format!("`{text}` is not a focal length; write it as in 50mm"));
            Fov::FocalLength(50.0)
        }
    }
}

/// Rays of a scaled camera would not have unit length; Mitsuba refuses it as well. Mirroring is fine.
fn check_rigid(props: &mut Props<'_>, to_world: &Transform) {
    let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| to_world.vector(axis));
    let length = columns.map(|c| (c[0] * c[0] + c[1] * c[1] + c[2] * c[2]).sqrt());
    if length.iter().any(|l| (l - 1.0).abs() > 1e-3) {
        let text =
            format!("`to_world` of a sensor may not scale, but scales by {:?}", length.map(|l| l as f32));
        props.complain("to_world", text);
    }
}
