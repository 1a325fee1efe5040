//! Sensors and samplers.

use super::Writer;
use super::element::{Element, number};
use crate::ir::{Fov, FovAxis, Projection, Sampler, Sensor, Transform};

/// Samplers of Mitsuba 3.
const SAMPLERS: &[&str] = &["independent", "stratified", "multijitter", "orthogonal", "ldsampler"];

impl Writer<'_, '_> {
    pub fn sensor(&mut self, s: &Sensor) -> Element {
        let plugin = match (s.projection, s.lens) {
            (Projection::Perspective { .. }, None) => "perspective",
            (Projection::Perspective { .. }, Some(_)) => "thinlens",
            (Projection::Orthographic, lens) => {
                if lens.is_some() {
                    self.out.lose(s.origin, "the lens of an orthographic sensor", "sharp focus everywhere");
                }
                "orthographic"
            }
        };
        let mut element = Element::plugin("sensor", plugin).id(s.name.as_deref());
        let mut to_world = s.to_world;
        let aspect = f64::from(s.film.width) / f64::from(s.film.height);
        let mut offset = s.principal_point_offset;
        match s.projection {
            Projection::Perspective { fov: angle, axis } => {
                to_world = self.unit_axes(s);
                let (angle, axis) = match s.screen_window {
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
            Projection::Orthographic => {
                if let Some([x0, x1, y0, y1]) = s.screen_window {
                    // pbrt's x grows to the right, ours to the left.
                    let (half, middle) = (0.5 * (x1 - x0), [-0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.0]);
                    self.check_aspect(s, (x1 - x0) / (y1 - y0), aspect);
                    let window = Transform::translate(middle).after(&Transform::scale([half, half, 1.0]));
                    to_world = to_world.after(&window);
                }
            }
        }
        element = element
            .transform("to_world", &to_world)
            .float_unless("near_clip", s.near_clip, 0.01)
            .float_unless("far_clip", s.far_clip, 10_000.0)
            .float_unless("principal_point_offset_x", offset[0], 0.0)
            .float_unless("principal_point_offset_y", offset[1], 0.0);
        if let (Some(lens), Projection::Perspective { .. }) = (s.lens, s.projection) {
            element = element.float("aperture_radius", lens.aperture_radius).float_unless(
                "focus_distance",
                lens.focus_distance,
                s.far_clip,
            );
        }
        let film = self.film(&s.film);
        element.child(film).child(self.sampler(s, &s.sampler))
    }

    /// `to_world` without the scale of its axes, which Mitsuba refuses and we leave out.
    fn unit_axes(&mut self, s: &Sensor) -> Transform {
        let mut m = s.to_world;
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
        let element = element.integer("sample_count", i64::from(sampler.sample_count));
        match sampler.seed {
            0 => element,
            seed => element.integer("seed", seed.cast_signed()),
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
