//! What stands before `WorldBegin`: camera, film, filter, sampler and integrator.

use super::Writer;
use super::text::{Params, transform};
use crate::ir::{
    ComponentFormat, CoordinateSystem, Film, Filter, Fov, FovAxis, HideEmitters, Integrator, Projection,
    Scalar, Sensor, Transform, has_passages, passages_count,
};
use crate::pbrt::integrator::UNLIMITED;
use crate::write::number;

/// A filter of pbrt and its parameters for a filter that it can express.
type Express = fn(&Filter) -> Option<Params>;

const FILTERS: [(&str, Express); 5] =
    [("box", even), ("triangle", triangle), ("gaussian", gaussian), ("mitchell", mitchell), ("sinc", sinc)];

/// Half of the side of the square that stands for a ray.
const NARROW: f64 = 1e-6;

impl Writer<'_, '_> {
    pub fn head(&mut self, text: &mut String) {
        let scene = self.scene;
        match &scene.integrator {
            Some(integrator) => self.integrator(text, integrator),
            // pbrt would stop after 5 bounces.
            None => {
                Params::default().integer("maxdepth", UNLIMITED).write(text, "", "Integrator", &["volpath"]);
            }
        }
        let Some(sensor) = scene.sensors.get(scene.default_sensor) else { return };
        for (i, other) in scene.sensors.iter().enumerate() {
            if i != scene.default_sensor {
                self.out.lose(other.origin, "a further sensor", "only the one that renders");
            }
        }
        self.camera(text, sensor);
        self.film(text, &sensor.film);
        let known = ["zsobol", "paddedsobol", "sobol", "halton", "pmj02bn", "independent"];
        let plugin = match known.iter().find(|name| **name == sensor.sampler.plugin) {
            Some(name) => name,
            None => {
                let what = format!("the sampler `{}`", sensor.sampler.plugin);
                self.out.lose(sensor.origin, what, format!("`{}` with as many samples", known[0]));
                known[0]
            }
        };
        let count = i64::from(sensor.sampler.sample_count).min(i32::MAX.into());
        let mut p = Params::default().integer("pixelsamples", count);
        if let Ok(seed @ 1..) = i32::try_from(sensor.sampler.seed) {
            p = p.integer("seed", i64::from(seed));
        }
        p.write(text, "", "Sampler", &[plugin]);
    }

    fn camera(&mut self, text: &mut String, sensor: &Sensor) {
        let film = &sensor.film;
        let aspect = f64::from(film.width) / f64::from(film.height);
        self.place(text, "", sensor.origin);
        let to_world = &sensor.to_world;
        // pbrt's +X is on the right of the picture.
        let mirror = Transform::scale([-1.0, 1.0, 1.0]);
        // As its author wrote it, or from Mitsuba's side.
        let looks = [("", to_world.after(&mirror)), ("Scale -1 1 1\n", *to_world)];
        let written = looks.iter().find_map(|(before, m)| Some(format!("{before}{}", look_at(m)?)));
        match written {
            Some(line) => text.push_str(&line),
            None => {
                let inverse = to_world.inverse().unwrap_or(Transform::IDENTITY);
                transform(text, "", &mirror.after(&inverse));
            }
        }
        let mut p = Params::default();
        let name = match sensor.projection {
            Projection::Perspective { fov, axis } => {
                p = p.float("fov", smaller_fov(fov, axis, aspect));
                "perspective"
            }
            Projection::Orthographic => "orthographic",
            Projection::Ray => {
                let instead = format!("an orthographic camera that sees a square of side {}", 2.0 * NARROW);
                self.out.lose(sensor.origin, "a radiancemeter, which sees along one ray", instead);
                "orthographic"
            }
        };
        let mut window = sensor.screen_window;
        if sensor.projection == Projection::Ray {
            window = Some([-NARROW, NARROW, -NARROW, NARROW]);
        }
        if sensor.projection == Projection::Orthographic && window.is_none() {
            // Ours shows the width as ±1.
            window = Some([-1.0, 1.0, -1.0 / aspect, 1.0 / aspect]);
        }
        let [dx, dy] = sensor.principal_point_offset;
        if dx != 0.0 || dy != 0.0 {
            let whole = if aspect > 1.0 {
                [-aspect, aspect, -1.0, 1.0]
            } else {
                [-1.0, 1.0, -1.0 / aspect, 1.0 / aspect]
            };
            let [x0, x1, y0, y1] = window.unwrap_or(whole);
            // The picture moves by fractions of itself to the left and upwards.
            let (sx, sy) = (dx * (x1 - x0), -dy * (y1 - y0));
            window = Some([x0 + sx, x1 + sx, y0 + sy, y1 + sy]);
        }
        if let Some(window) = window {
            p = p.numbers("float", "screenwindow", window);
        }
        if let Some(lens) = sensor.lens {
            p = p.float("lensradius", lens.aperture_radius).float("focaldistance", lens.focus_distance);
        }
        if sensor.medium.is_some() {
            self.around(text, "", sensor.medium);
        }
        p.write(text, "", "Camera", &[name]);
        if sensor.medium.is_some() {
            self.around(text, "", None);
        }
        if sensor.near_clip > 0.011 || sensor.far_clip < 9999.0 {
            let what = format!("near and far clip at {} and {}", sensor.near_clip, sensor.far_clip);
            self.out.lose(sensor.origin, what, "everything in front of the camera is seen");
        }
    }

    fn film(&mut self, text: &mut String, f: &Film) {
        let gbuffer = f.gbuffer.or_else(|| self.layers());
        let extension = match f.file_format.as_str() {
            "png" | "pfm" if gbuffer.is_some() => {
                self.out.lose(f.origin, format!("layers in a `{}` file", f.file_format), "openexr");
                "exr"
            }
            "png" => "png",
            "pfm" => "pfm",
            _ => "exr",
        };
        let mut p = Params::default()
            .integer("xresolution", f.width.into())
            .integer("yresolution", f.height.into())
            .string("filename", &format!("picture.{extension}"));
        if let Some(c) = f.crop {
            p = p.integers("pixelbounds", [c.x, c.x + c.width, c.y, c.y + c.height]);
        }
        p = p.float_unless("iso", 100.0 * f.imaging_ratio, 100.0);
        p = p.float_unless("whitebalance", f.white_balance.unwrap_or(0.0), 0.0);
        p = p.boolean_unless("savefp16", f.component_format != ComponentFormat::Float32, true);
        let name = match gbuffer {
            None => "rgb",
            Some(system) => {
                let world = system == CoordinateSystem::World;
                p = p.string("coordinatesystem", if world { "world" } else { "camera" });
                "gbuffer"
            }
        };
        p.write(text, "", "Film", &[name]);
        let filter = FILTERS.iter().find_map(|(name, of)| Some((*name, of(&f.filter)?)));
        let (name, p) = filter.unwrap_or_else(|| {
            self.out.lose(f.origin, "a filter that pbrt does not have", "its gaussian");
            ("gaussian", Params::default())
        });
        p.write(text, "", "PixelFilter", &[name]);
    }

    /// Where Mitsuba's layers can be: in a `gbuffer` film, which has those of its own.
    fn layers(&mut self) -> Option<CoordinateSystem> {
        let integrator = self.scene.integrator.as_ref().filter(|i| !i.aovs.is_empty())?;
        let names: Vec<String> = integrator.aovs.iter().map(|aov| format!("`{}`", aov.name)).collect();
        let what = format!("the choice of layers: {}", names.join(", "));
        let instead = "a gbuffer film with the layers that pbrt has, in the coordinates of the world";
        self.out.lose(integrator.aovs[0].origin, what, instead);
        Some(CoordinateSystem::World)
    }

    fn integrator(&mut self, text: &mut String, i: &Integrator) {
        let media = !self.scene.media.is_empty();
        let plugin = match i.plugin.as_str() {
            // pbrt's `sppm` looks through media.
            "sppm" | "ppm" | "photonmapper" if !media => "sppm",
            // As in Mitsuba, so in pbrt.
            "path" | "direct" if media => "path",
            _ => "volpath",
        };
        let photons = plugin == "sppm";
        if !photons && !matches!(i.plugin.as_str(), "path" | "volpath" | "volpathmis" | "direct") {
            self.out.lose(i.origin, format!("the integrator `{}`", i.plugin), "`volpath`");
        }
        // Lamp, surface, camera.
        let mut depth = if i.plugin == "direct" { 2 } else { -1 };
        let mut p = Params::default();
        for (name, setting) in &i.settings {
            match (name.as_str(), &setting.value) {
                ("max_depth", Scalar::Integer(v)) => depth = *v,
                ("initial_radius", Scalar::Float(v)) if photons => p = p.float("radius", *v),
                ("photon_count", Scalar::Integer(v)) if photons => {
                    p = p.integer("photonsperiteration", (*v).min(i32::MAX.into()));
                }
                // Fixed in pbrt.
                ("alpha", Scalar::Float(v)) if photons && (v - 2.0 / 3.0).abs() < 1e-9 => {}
                ("hide_emitters", Scalar::Boolean(false)) => {}
                ("hide_emitters", _) => {
                    let what = match self.scene.hide_emitters {
                        HideEmitters::Emission => "lights whose emission the camera does not see",
                        HideEmitters::Surface => "lights that the camera looks through",
                    };
                    self.out.lose(setting.origin, what, "visible lights");
                }
                _ => self.out.lose(setting.origin, format!("the setting `{name}`"), "what pbrt does"),
            }
        }
        if depth > 0 && has_passages(self.scene) && passages_count(self.scene) {
            let what = "that passing a mask or a null surface counts towards max_depth";
            self.out.lose(i.origin, what, "only scattering does, as always in pbrt");
        }
        let bounces = if depth < 0 { UNLIMITED } else { (depth - 1).clamp(0, i64::from(i32::MAX)) };
        p.integer("maxdepth", bounces).write(text, "", "Integrator", &[plugin]);
    }
}

fn wide([x, y]: [f64; 2]) -> Params {
    Params::default().float("xradius", x).float("yradius", y)
}

fn even(filter: &Filter) -> Option<Params> {
    match *filter {
        Filter::Box { radius } => Some(wide([radius; 2])),
        Filter::WideBox { radius } => Some(wide(radius)),
        _ => None,
    }
}

fn triangle(filter: &Filter) -> Option<Params> {
    match *filter {
        Filter::Tent { radius } => Some(wide([radius; 2])),
        Filter::WideTent { radius } => Some(wide(radius)),
        _ => None,
    }
}

fn gaussian(filter: &Filter) -> Option<Params> {
    let (sigma, radius) = match *filter {
        Filter::Gaussian { stddev } => (stddev, [4.0 * stddev; 2]),
        Filter::TruncatedGaussian { sigma, radius } => (sigma, radius),
        _ => return None,
    };
    Some(wide(radius).float("sigma", sigma))
}

fn mitchell(filter: &Filter) -> Option<Params> {
    let (b, c, radius) = match *filter {
        Filter::Mitchell { b, c } => (b, c, [2.0; 2]),
        Filter::CatmullRom => (0.0, 0.5, [2.0; 2]),
        Filter::ScaledMitchell { b, c, radius } => (b, c, radius),
        _ => return None,
    };
    Some(wide(radius).float("B", b).float("C", c))
}

fn sinc(filter: &Filter) -> Option<Params> {
    let (tau, radius) = match *filter {
        Filter::Lanczos { lobes } => (f64::from(lobes), [f64::from(lobes); 2]),
        Filter::WindowedSinc { tau, radius } => (tau, radius),
        _ => return None,
    };
    Some(wide(radius).float("tau", tau))
}

/// The directive whose camera stands like this, where there is one.
fn look_at(m: &Transform) -> Option<String> {
    let column = |c: usize| [0, 1, 2].map(|r| m.0[r][c]);
    let (eye, up, ahead) = (column(3), column(1), column(2));
    let target = [0, 1, 2].map(|i| eye[i] + ahead[i]);
    near(&Transform::look_at(eye, target, up)?, m).then(|| {
        let numbers = |v: [f64; 3]| v.map(number).join(" ");
        format!("LookAt {}  {}  {}\n", numbers(eye), numbers(target), numbers(up))
    })
}

/// Full angle along the shorter side, in degrees.
pub fn smaller_fov(fov: Fov, axis: FovAxis, aspect: f64) -> f64 {
    let (degrees, axis) = match fov {
        Fov::Degrees(degrees) => (degrees, axis),
        // On 36 × 24 mm.
        Fov::FocalLength(f) => (2.0 * (36f64.hypot(24.0) / 2.0 / f).atan().to_degrees(), FovAxis::Diagonal),
    };
    // Half sizes of the film where the shorter one is 1.
    let (x, y) = if aspect > 1.0 { (aspect, 1.0) } else { (1.0, 1.0 / aspect) };
    let along = match axis {
        FovAxis::X => x,
        FovAxis::Y => y,
        FovAxis::Smaller => 1.0,
        FovAxis::Larger => x.max(y),
        FovAxis::Diagonal => x.hypot(y),
    };
    if along == 1.0 {
        return degrees;
    }
    2.0 * ((degrees.to_radians() / 2.0).tan() / along).atan().to_degrees()
}

/// Equal up to rounding, so that a look-at says the whole transform.
fn near(a: &Transform, b: &Transform) -> bool {
    let size = b.0.as_flattened().iter().fold(1.0, |m: f64, v| m.max(v.abs()));
    a.0.as_flattened().iter().zip(b.0.as_flattened()).all(|(a, b)| (a - b).abs() <= 1e-9 * size)
}
