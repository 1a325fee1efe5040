//! Camera, sampler, and the sensor they make with the film.

use super::params::Params;
use super::reader::Reader;
use crate::diagnostic::Span;
use crate::ir::{Film, Fov, FovAxis, Lens, Projection, Sampler, Sensor, Transform};
use crate::plugin::{Plugin, read, unsupported};

type ReadCamera = fn(&mut Params) -> Projection;

pub(super) const CAMERAS: &[Plugin<ReadCamera>] = &[
    read("perspective", perspective),
    read("orthographic", |_| Projection::Orthographic),
    unsupported("spherical"),
    unsupported("realistic"),
    // ISET3d's cameras of several lenses and of ray transfer functions.
    unsupported("omni"),
    unsupported("rtf"),
];

type ReadSampler = fn(&mut Params) -> u32;

pub(super) const SAMPLERS: &[Plugin<ReadSampler>] = &[
    read("zsobol", |p| p.count("pixelsamples", 16, 1)),
    read("paddedsobol", |p| p.count("pixelsamples", 16, 1)),
    read("sobol", |p| p.count("pixelsamples", 16, 1)),
    read("halton", |p| p.count("pixelsamples", 16, 1)),
    read("pmj02bn", |p| p.count("pixelsamples", 16, 1)),
    read("independent", |p| p.count("pixelsamples", 4, 1)),
    read("stratified", |p| p.count("xsamples", 4, 1).saturating_mul(p.count("ysamples", 4, 1))),
];

/// pbrt clips nothing; these keep everything of a scene in sight.
const NEAR: f64 = 1e-5;
const FAR: f64 = 1e12;

impl Reader<'_> {
    /// Reads what stood before WorldBegin.
    pub fn sensor(&mut self, world: Span) {
        let (camera, place, medium) = self.head.camera.take().unwrap_or_else(|| {
            let p = Params::new("camera", "perspective", world, Vec::new(), self.common());
            (p, Transform::IDENTITY, None)
        });
        let mut p = camera;
        let reader = self.plugin(CAMERAS, &mut p, "a perspective camera is used").unwrap_or(perspective);
        let open = p.float("shutteropen", 0.0);
        let close = p.float("shutterclose", 1.0);
        // The shutter of pbrt-v3 decides how far things move, never how bright the picture is.
        let old = self.policy.is_three();
        if close <= open && !old {
            p.complain("shutterclose", format!("the shutter must close after it opens, {open}"));
        }
        let film = self.film(world, if old { 1.0 } else { (close - open).max(0.0) });
        let aspect = f64::from(film.width) / f64::from(film.height);
        let projection = reader(&mut p);
        let screen_window = window(&mut p, aspect);
        let lens_radius = p.float("lensradius", 0.0);
        let focus_distance = p.positive("focaldistance", 1e6);
        if lens_radius < 0.0 {
            p.complain("lensradius", format!("`lensradius` must not be negative, but is {lens_radius}"));
        }
        let mut to_world = place.after(&Transform::scale([-1.0, 1.0, 1.0]));
        // pbrt's shorter side shows ±1, ours the width.
        if projection == Projection::Orthographic && screen_window.is_none() && aspect > 1.0 {
            to_world = to_world.after(&Transform::scale([aspect, aspect, 1.0]));
        }
        let sensor = Sensor {
            name: None,
            origin: p.origin(),
            to_world,
            projection,
            screen_window,
            near_clip: NEAR,
            far_clip: FAR,
            principal_point_offset: [0.0; 2],
            lens: (lens_radius > 0.0).then_some(Lens { aperture_radius: lens_radius, focus_distance }),
            film,
            sampler: self.sampler(world),
            medium,
        };
        self.done(p);
        self.scene.sensors.push(sensor);
    }

    fn sampler(&mut self, world: Span) -> Sampler {
        let common = self.common();
        let mut p = self
            .head
            .sampler
            .take()
            .unwrap_or_else(|| Params::new("sampler", "zsobol", world, Vec::new(), common));
        let reader = self.plugin(SAMPLERS, &mut p, "16 samples a pixel are taken");
        let sample_count = reader.map_or(16, |reader| reader(&mut p));
        let seed = p.optional_integer("seed").unwrap_or(self.head.seed);
        // Our own sample points replace them all.
        p.ignore(&["randomization", "jitter"]);
        let plugin = p.kind.clone();
        self.done(p);
        Sampler { plugin, sample_count, seed: i64::from(seed).cast_unsigned() }
    }
}

fn perspective(p: &mut Params) -> Projection {
    let fov = p.float("fov", 90.0);
    if !(fov > 0.0 && fov < 180.0) {
        p.complain("fov", format!("`fov` must lie between 0 and 180 degrees, not {fov}"));
    }
    Projection::Perspective { fov: Fov::Degrees(fov), axis: FovAxis::Smaller }
}

/// `None` where the film's own shape gives the window.
fn window(p: &mut Params, film_aspect: f64) -> Option<[f64; 4]> {
    let aspect = p.optional_float("frameaspectratio").filter(|aspect| *aspect > 0.0);
    // Any other count is as good as none in pbrt.
    if let Some(window) = p.floats_or_warn::<4>("screenwindow") {
        if window[0] == window[1] || window[2] == window[3] {
            p.complain("screenwindow", "`screenwindow` is empty");
            return None;
        }
        return Some(window);
    }
    let aspect = aspect.filter(|aspect| (aspect / film_aspect - 1.0).abs() > 1e-6)?;
    Some(if aspect > 1.0 { [-aspect, aspect, -1.0, 1.0] } else { [-1.0, 1.0, -1.0 / aspect, 1.0 / aspect] })
}

/// Used when nothing is said about the film.
pub(super) fn default_film() -> Film {
    use crate::ir::{ComponentFormat, Filter, Origin, PixelFormat};
    Film {
        origin: Origin(None),
        width: 1280,
        height: 720,
        crop: None,
        filter: Filter::TruncatedGaussian { sigma: 0.5, radius: [1.5; 2] },
        pixel_format: PixelFormat::Rgb,
        component_format: ComponentFormat::Float16,
        file_format: "openexr".to_owned(),
        sample_border: false,
        imaging_ratio: 1.0,
        white_balance: None,
        tonemap: None,
        gbuffer: None,
    }
}
