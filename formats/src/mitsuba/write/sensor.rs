//! Sensors and samplers.

use super::Writer;
use super::element::{Element, number};
use crate::ir::{EmitterKind, Film, Fov, FovAxis, Projection, Sampler, Sensor, SunPosition, Transform};
use crate::write::WriteError;

/// Samplers of Mitsuba 3.
const SAMPLERS: &[&str] = &["independent", "stratified", "multijitter", "orthogonal", "ldsampler"];

/// What we read: enough for any picture.
const MOST_SAMPLES: u32 = 1 << 30;

impl Writer<'_, '_> {
    pub fn sensor(&mut self, s: &Sensor) -> Result<Element, WriteError> {
        // Mitsuba's lens has its picture in the middle.
        let shifted = s.principal_point_offset != [0.0; 2]
            || s.screen_window.is_some_and(|[x0, x1, y0, y1]| x0 != -x1 || y0 != -y1);
        let lens = s.lens.filter(|_| !shifted || s.projection == Projection::Orthographic);
        if lens.is_none() && s.lens.is_some() {
            self.out.lose(
                s.origin,
                "the lens of a camera whose picture is shifted",
                "sharp focus everywhere",
            );
        }
        let plugin = self.sensor_plugin(s, lens.is_some());
        let mut element = Element::plugin("sensor", plugin).id(s.name.as_deref());
        let mut to_world = s.to_world;
        let aspect = f64::from(s.film.width) / f64::from(s.film.height);
        let mut offset = s.principal_point_offset;
        let window = s.screen_window.map(|[x0, x1, y0, y1]| {
            // A window whose sides are exchanged shows a mirrored picture.
            let mirror = [x0 > x1, y0 > y1].map(|turned| if turned { -1.0 } else { 1.0 });
            to_world = to_world.after(&Transform::scale([mirror[0], mirror[1], 1.0]));
            [x0 * mirror[0], x1 * mirror[0], y0 * mirror[1], y1 * mirror[1]]
        });
        match s.projection {
            Projection::Perspective { fov: angle, axis } => {
                to_world = self.unit_axes(s, &to_world);
                let (angle, axis) = match window {
                    None => (angle, axis),
                    Some(window @ [x0, x1, y0, y1]) => {
                        // The picture moves by fractions of itself to the left and upwards.
                        offset[0] += 0.5 * (x0 + x1) / (x1 - x0);
                        offset[1] -= 0.5 * (y0 + y1) / (y1 - y0);
                        (self.windowed(s, angle, window, aspect), FovAxis::X)
                    }
                };
                element = fov(element, angle, axis);
            }
            Projection::Ray => to_world = self.unit_axes(s, &to_world),
            Projection::Orthographic => {
                if let Some([x0, x1, y0, y1]) = window {
                    // pbrt's x grows to the right, ours to the left.
                    let (half, middle) = (0.5 * (x1 - x0), [-0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.0]);
                    self.check_aspect(s, (x1 - x0) / (y1 - y0), aspect);
                    let window = Transform::translate(middle).after(&Transform::scale([half, half, 1.0]));
                    to_world = to_world.after(&window);
                }
                // The picture moves by fractions of itself; Mitsuba has no such parameter here.
                let [dx, dy] = std::mem::take(&mut offset);
                to_world = to_world.after(&Transform::translate([-2.0 * dx, -2.0 * dy / aspect, 0.0]));
            }
        }
        element = element.transform("to_world", &to_world);
        if s.projection != Projection::Ray {
            element = element
                .float_unless("near_clip", s.near_clip, 0.01)
                .float_unless("far_clip", s.far_clip, 10_000.0)
                .float_unless("principal_point_offset_x", offset[0], 0.0)
                .float_unless("principal_point_offset_y", offset[1], 0.0);
        }
        if let (Some(lens), Projection::Perspective { .. }) = (lens, s.projection) {
            element = element.float("aperture_radius", lens.aperture_radius).float_unless(
                "focus_distance",
                lens.focus_distance,
                s.far_clip,
            );
        }
        if let Some([open, close]) = self.shutter() {
            element = element.float("shutter_open", open).float("shutter_close", close);
        }
        let film = self.sensor_film(s);
        let element = element.child(film).child(self.sampler(s, &s.sampler));
        Ok(element.children(s.medium.map(|id| self.medium(None, id)).transpose()?))
    }

    fn sensor_plugin(&mut self, s: &Sensor, lens: bool) -> &'static str {
        match s.projection {
            Projection::Perspective { .. } if lens => "thinlens",
            Projection::Perspective { .. } => "perspective",
            Projection::Orthographic => {
                if lens {
                    self.out.lose(s.origin, "the lens of an orthographic sensor", "sharp focus everywhere");
                }
                "orthographic"
            }
            Projection::Ray => "radiancemeter",
        }
    }

    /// Mitsuba 3 wants one pixel for a ray.
    fn sensor_film(&mut self, s: &Sensor) -> Element {
        if s.projection != Projection::Ray || s.film.width == 1 || s.film.height == 1 {
            return self.film(&s.film);
        }
        let what = "a radiancemeter with more than one pixel";
        self.out.lose(s.origin, what, "the pixel that all of them are");
        self.film(&Film { width: 1, height: 1, crop: None, ..s.film.clone() })
    }

    /// When a light that changes with the time is seen, if there is one.
    fn shutter(&self) -> Option<[f64; 2]> {
        self.scene.emitters.iter().find_map(|e| match &e.kind {
            EmitterKind::SunSky(light) => match light.sun {
                SunPosition::Days { shutter, .. } => Some(shutter),
                _ => None,
            },
            _ => None,
        })
    }

    /// `to_world` without the scale of its axes, which Mitsuba refuses and we leave out.
    fn unit_axes(&mut self, s: &Sensor, to_world: &Transform) -> Transform {
        let mut m = *to_world;
        let mut scaled = false;
        for j in 0..3 {
            let length = (0..3).map(|i| m.0[i][j] * m.0[i][j]).sum::<f64>().sqrt();
            if length.is_normal() && (length - 1.0).abs() > 1e-9 {
                scaled = true;
                (0..3).for_each(|i| m.0[i][j] /= length);
            }
        }
        if scaled {
            self.out.lose(s.origin, "the scale in a sensor's to_world, which has no effect", "none");
        }
        if straightened(&mut m) {
            self.out.lose(s.origin, "a sheared camera", "one that looks the same way, without shear");
        }
        m
    }

    /// The full horizontal angle of a window on the screen plane.
    fn windowed(&mut self, s: &Sensor, angle: Fov, [x0, x1, y0, y1]: [f64; 4], aspect: f64) -> Fov {
        self.check_aspect(s, (x1 - x0) / (y1 - y0), aspect);
        match angle {
            Fov::Degrees(degrees) => {
                let half = (0.5 * degrees).to_radians().tan() * 0.5 * (x1 - x0);
                Fov::Degrees(2.0 * half.atan().to_degrees())
            }
            Fov::FocalLength(_) => angle,
        }
    }

    fn check_aspect(&mut self, s: &Sensor, window: f64, film: f64) {
        if (window / film - 1.0).abs() > 1e-6 {
            self.out.lose(s.origin, "pixels that are not square", "square ones of the same width");
        }
    }

    fn sampler(&mut self, s: &Sensor, sampler: &Sampler) -> Element {
        let plugin = match SAMPLERS.iter().find(|name| **name == sampler.plugin) {
            Some(name) => name,
            None => {
                let what = format!("the sampler `{}`", sampler.plugin);
                self.out.lose(s.origin, what, "`independent` with as many samples");
                "independent"
            }
        };
        let element = Element::plugin("sampler", plugin);
        let count = sampler.sample_count.min(MOST_SAMPLES);
        if count != sampler.sample_count {
            let what = format!("{} samples a pixel", sampler.sample_count);
            self.out.lose(s.origin, what, format!("{count}, the most that fit"));
        }
        let element = element.integer("sample_count", i64::from(count));
        match u32::try_from(sampler.seed) {
            Ok(0) => element,
            Ok(seed) => element.integer("seed", i64::from(seed)),
            Err(_) => {
                let what = format!("the seed {} of the sampler", sampler.seed.cast_signed());
                self.out.lose(s.origin, what, "the seed 0: other noise");
                element
            }
        }
    }
}

/// The angle of view of a sensor or projector.
pub(super) fn fov(element: Element, angle: Fov, axis: FovAxis) -> Element {
    let axis = match axis {
        FovAxis::X => None,
        FovAxis::Y => Some("y"),
        FovAxis::Diagonal => Some("diagonal"),
        FovAxis::Smaller => Some("smaller"),
        FovAxis::Larger => Some("larger"),
    };
    let element = match angle {
        Fov::Degrees(degrees) => element.float("fov", degrees),
        Fov::FocalLength(mm) => element.string("focal_length", &format!("{}mm", number(mm))),
    };
    match axis {
        None => element,
        Some(axis) => element.string("fov_axis", axis),
    }
}

/// Makes axes of length 1 perpendicular: forward stays, then upwards. Whether they were not.
fn straightened(m: &mut Transform) -> bool {
    let axis = |m: &Transform, j: usize| [0, 1, 2].map(|i| m.0[i][j]);
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let sheared = [(0, 1), (1, 2), (0, 2)].iter().any(|&(i, j)| dot(axis(m, i), axis(m, j)).abs() > 1e-6);
    if sheared {
        for (j, before) in [(1, 2..3), (0, 1..3)] {
            let mut v = axis(m, j);
            for other in before {
                let other = axis(m, other);
                let along = dot(v, other);
                v = std::array::from_fn(|i| v[i] - along * other[i]);
            }
            let length = dot(v, v).sqrt();
            (0..3).for_each(|i| m.0[i][j] = v[i] / length);
        }
    }
    sheared
}
