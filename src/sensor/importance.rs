//! The sensor as light paths see it: its importance, how densely it is sampled, and the film position of a
//! point.
//!
//! The importance We is that of a film which receives 1 from radiance 1 all around (Veach 1997, §4.7; Pharr,
//! Jakob and Humphreys 2023, §16.1): ∫∫ We·cosθ dA dω = 1 over the lens, or over the plane of an orthographic
//! sensor, and over all directions that the whole film shows, θ being the angle to the optical axis.

use super::{Sensor, ThinLens};
use crate::math::{Ray, Vec2, Vec3};
use crate::sampling::{Density, warp};

/// What a ray is worth to the sensor.
#[derive(Clone, Copy, Debug)]
pub struct Importance {
    /// Film position in [0, 1]² (x right, y down, over the full film).
    pub film: Vec2,
    /// We in 1/(m²·sr); where a density is a delta, its mass is integrated already.
    pub we: f32,
    /// Density of the place where the ray starts, for film positions and places on the lens that are drawn
    /// evenly: per area of the lens, or of an orthographic sensor's plane; a delta for a pinhole.
    pub position: Density,
    /// Density of its direction, given the place; a delta for an orthographic sensor without a lens. With
    /// one it is the place that depends on the direction, and the product is the same.
    pub direction: Density,
}

/// What a point sends to the sensor along one direction.
#[derive(Clone, Copy, Debug)]
pub struct SensorSample {
    /// Unit, from the point towards the sensor.
    pub dir: Vec3,
    /// Where the camera's rays start: the shadow ray ends there.
    pub target: Vec3,
    /// Radiance L that a surface sends along `dir` brings L·`value`·cosθ·dA to the film, θ being the angle at
    /// the surface and dA its area; the mean over the places on the lens.
    pub value: f32,
    /// Of the ray that comes to the point.
    pub importance: Importance,
}

/// A line in camera space: where it crosses the plane z = 0, and x and y for each z.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// x and y at z = 0.
    pub at: Vec2,
    /// How x and y grow with z.
    pub slope: Vec2,
}

impl Line {
    fn point(self, z: f32) -> Vec3 {
        let p = self.at + self.slope * z;
        Vec3::new(p.x, p.y, z)
    }
}

impl Sensor {
    /// Importance of a ray that starts at the sensor; `None` where the film does not show it. What a delta
    /// leaves no choice of is taken for granted: that the ray passes the pinhole, or runs along the axis.
    pub fn importance(&self, ray: &Ray) -> Option<Importance> {
        let d = self.to_camera(ray.d);
        if d.z <= 0.0 {
            return None;
        }
        let o = self.to_camera(ray.o - self.position);
        let slope = Vec2::new(d.x, d.y) / d.z;
        let at = Vec2::new(o.x, o.y) - slope * o.z;
        self.importance_of(Line { at, slope }, d.z / ray.d.length())
    }

    /// What the world point `p` sends through the place of the lens that `aperture` in [0, 1]² chooses.
    /// `None` where the film does not show it: beyond its edges, and nearer than `near` or beyond `far`.
    pub fn connect(&self, p: Vec3, aperture: Vec2) -> Option<SensorSample> {
        let local = self.to_camera(p - self.position);
        if local.z <= 0.0 || local.z < self.near || local.z > self.far {
            return None;
        }
        let lens = match &self.lens {
            Some(lens) => warp::disk(aperture) * lens.aperture_radius,
            None => Vec2::ZERO,
        };
        let line = self.projection.through(local, lens, self.focus());
        let d = self.to_world(Vec3::new(line.slope.x, line.slope.y, 1.0));
        let (d, cos) = (d.normalize(), 1.0 / d.length());
        let importance = self.importance_of(line, cos)?;
        let start = self.position + self.to_world(line.point(0.0));
        let value = if self.projection.is_parallel() {
            importance.position.factor() / cos
        } else {
            importance.direction.factor() / p.distance_squared(start)
        };
        let target = self.position + self.to_world(line.point(self.near));
        Some(SensorSample { dir: -d, target, value, importance })
    }

    /// Of a line whose cosine to the axis is `cos`.
    fn importance_of(&self, line: Line, cos: f32) -> Option<Importance> {
        // The sharp ray and the one from another place of the lens meet on the plane of focus.
        let on_window = self.projection.window_point(line.point(self.focus()));
        let on_lens = line.at - self.projection.start(on_window);
        if self.lens.as_ref().is_some_and(|lens| on_lens.length() > lens.aperture_radius * ROUNDED) {
            return None;
        }
        let film = self.projection.window().inverse(on_window) - self.principal_point_offset;
        // Where the window has no extent, nothing is on the film.
        if !(film.cmpge(Vec2::ZERO).all() && film.cmple(Vec2::ONE).all()) {
            return None;
        }
        let scale = self.axes[0].cross(self.axes[1]).length();
        let [position, direction] = self.projection.densities(cos, scale, self.lens.as_ref());
        Some(Importance { film, we: position.factor() * direction.factor() / cos, position, direction })
    }

    fn focus(&self) -> f32 {
        self.lens.as_ref().map_or(1.0, |lens| lens.focus_distance)
    }

    /// The camera's axes are orthogonal.
    pub(super) fn to_camera(&self, v: Vec3) -> Vec3 {
        let [x, y, z] = self.axes.map(|axis| v.dot(axis) / axis.length_squared());
        Vec3::new(x, y, z)
    }

    pub(super) fn to_world(&self, v: Vec3) -> Vec3 {
        self.axes[0] * v.x + self.axes[1] * v.y + self.axes[2] * v.z
    }
}

/// A place on the very rim of the lens is on it.
const ROUNDED: f32 = 1.0 + 1e-5;

impl ThinLens {
    /// Area in camera space.
    pub(super) fn area(&self) -> f32 {
        std::f32::consts::PI * self.aperture_radius * self.aperture_radius
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Axis, Orthographic, Perspective, Projection};
    use super::*;
    use crate::sampling::CounterRng;

    /// Pinhole, lens, parallel projection with scaled axes, and a lens before it, all off the middle of the
    /// window.
    fn sensors() -> Vec<(&'static str, Sensor)> {
        let z = Vec3::new(0.3, -0.2, 0.9).normalize();
        let x = z.cross(Vec3::Y).normalize();
        let y = z.cross(x);
        let sensor = |projection: Projection, lens, scale: [f32; 2]| Sensor {
            projection,
            lens,
            axes: [x * scale[0], y * scale[1], z],
            position: Vec3::new(0.4, 0.5, -0.6),
            near: 0.1,
            far: 100.0,
            principal_point_offset: Vec2::new(0.05, -0.1),
        };
        let pinhole = || Perspective::new(50.0, Axis::X, 1.5).into();
        let parallel = || Orthographic::new(1.5).into();
        let lens = || Some(ThinLens { aperture_radius: 0.2, focus_distance: 2.5 });
        vec![
            ("perspective", sensor(pinhole(), None, [1.0; 2])),
            ("thinlens", sensor(pinhole(), lens(), [1.0; 2])),
            ("orthographic", sensor(parallel(), None, [0.7, 1.8])),
            ("orthographic with a lens", sensor(parallel(), lens(), [0.7, 1.8])),
        ]
    }

    fn random(n: u64) -> impl Iterator<Item = [Vec2; 3]> {
        (0..n).map(|i| {
            let mut rng = CounterRng::new(17, i);
            std::array::from_fn(|_| Vec2::from(rng.next_2d()))
        })
    }

    /// A point anywhere on the ray of a film position lies there on the film, seen through the same place of
    /// the lens, and the densities are those of the ray.
    #[test]
    fn a_point_of_a_ray_lies_where_the_ray_comes_from() {
        for (what, sensor) in sensors() {
            for [film, aperture, along] in random(4000) {
                let ray = sensor.ray(film, aperture);
                let p = ray.at(0.01 + 8.0 * along.x);
                let direct = sensor.importance(&ray).unwrap_or_else(|| panic!("{what}: {film} not seen"));
                let back = sensor.connect(p, aperture).unwrap_or_else(|| panic!("{what}: {film} is gone"));
                for importance in [direct, back.importance] {
                    assert!((importance.film - film).length() < 2e-5, "{what}: {film} {}", importance.film);
                    assert!((importance.we / direct.we - 1.0).abs() < 1e-3, "{what}");
                }
                assert!((back.dir + ray.d.normalize()).length() < 1e-4, "{what}");
                assert!((back.target - ray.o).length() < 1e-4, "{what}");
                let cos = ray.d.normalize().dot(sensor.axes[2]);
                let whole = direct.we * cos / (direct.position.factor() * direct.direction.factor());
                assert!((whole - 1.0).abs() < 1e-5, "{what}: {whole}");
            }
        }
    }

    /// ∫∫ We·cosθ dA dω by even choices from more than the sensor: a square around the lens or the plane, and
    /// the half sphere around the axis. The choices whose rays the film shows are a share s of at least 2 % (a
    /// fifth of them for the lens alone), so 2·10⁶ know the integral to √(few/(s·2·10⁶)), 1 %.
    #[test]
    fn importance_integrates_to_one_over_the_film() {
        for (what, sensor) in sensors() {
            let n = 2_000_000;
            let parallel = sensor.projection.is_parallel();
            let lens = sensor.lens.as_ref().map_or(0.0, |lens| lens.aperture_radius);
            // Half of the square, in camera space, and its area in the world.
            let half = lens + if parallel { 1.4 } else { 0.0 };
            let scale = sensor.axes[0].cross(sensor.axes[1]).length();
            let area = if half > 0.0 { 4.0 * half * half * scale } else { 1.0 };
            let fixed_direction = parallel && sensor.lens.is_none();
            // Directions of the lens of a parallel sensor are few: those to the rim of 0.36/2.5.
            let gap = if parallel { 0.02 } else { 0.4 };
            let axis = crate::math::Frame::from_normal(sensor.axes[2]);
            let mut sum = 0.0f64;
            for [place, direction, _] in random(n) {
                let at = (place * 2.0 - 1.0) * half;
                let o = sensor.position + sensor.to_world(Vec3::new(at.x, at.y, 0.0));
                let d = if fixed_direction { Vec3::Z } else { warp::cone(direction, gap) };
                let ray = Ray::new(o, axis.to_world(d));
                let Some(importance) = sensor.importance(&ray) else { continue };
                let solid = if fixed_direction { 1.0 } else { 2.0 * std::f32::consts::PI * gap };
                sum += f64::from(importance.we * d.z * area * solid) / n as f64;
            }
            assert!((sum - 1.0).abs() < 0.02, "{what}: {sum}");
        }
    }

    /// All points of a plane that the film shows bring it 1 together when each sends radiance 1: the same
    /// integral, over the surface that is seen. The plane is tilted by 0.2, and chosen from evenly within a
    /// square of which the film shows a tenth or more: 10⁶ choices know it to 1 %.
    #[test]
    fn what_a_plane_sends_to_the_film_is_its_radiance() {
        for (what, sensor) in sensors() {
            let center = sensor.position + sensor.axes[2] * 2.0;
            let plane = crate::math::Frame::from_normal((sensor.axes[2] + Vec3::X * 0.2).normalize());
            let (n, half) = (1_000_000, 3.2f32);
            let mut sum = 0.0f64;
            for [place, aperture, _] in random(n) {
                let at = (place * 2.0 - 1.0) * half;
                let p = center + plane.s * at.x + plane.t * at.y;
                let Some(sample) = sensor.connect(p, aperture) else { continue };
                let cos = sample.dir.dot(plane.n).abs();
                sum += f64::from(sample.value * cos * 4.0 * half * half) / n as f64;
            }
            assert!((sum - 1.0).abs() < 0.02, "{what}: {sum}");
        }
    }
}
