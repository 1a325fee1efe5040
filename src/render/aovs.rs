//! Pictures of the surfaces that camera rays meet first.
//!
//! Every camera sample sends one ray more for them, whatever the integrator does with its own, so their values are
//! the same for all integrators, and a render that makes none pays nothing.

use crate::bsdf::{Range, Transport};
use crate::film::{Aov, Visible};
use crate::integrator::CameraSample;
use crate::math::{Color, Ray, Vec2, Vec3};
use crate::scene::{Hit, Scene, Surface, View};
use crate::spectrum::to_rgb;

/// What fills the AOVs of a view.
#[derive(Clone, Copy)]
pub(super) struct Eye<'a> {
    scene: &'a Scene,
    view: &'a View,
    /// Of a pixel, as a share of the film.
    pixel: Vec2,
}

/// Where a camera ray comes from on the film and on the lens.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start {
    pub place: Vec2,
    pub aperture: Vec2,
}

/// A surface that a camera ray met.
struct Seen<'a> {
    eye: &'a Eye<'a>,
    start: Start,
    ray: &'a Ray,
    hit: Hit,
    s: Surface,
}

/// Surfaces that light passes straight through before one is taken that does not let it.
const MOST_PASSED: usize = 256;

impl<'a> Eye<'a> {
    /// `None` where no AOV is asked for.
    pub fn new(scene: &'a Scene, view: &'a View) -> Option<Self> {
        let pixel = Vec2::new(1.0 / view.film.width as f32, 1.0 / view.film.height as f32);
        (!view.aovs.is_empty()).then_some(Self { scene, view, pixel })
    }

    /// Adds a finished sample to the sums of its pixel: `weight` is its filter's, `share` that of one sample in a
    /// pass. Counts its rays.
    pub fn add(&self, sample: &CameraSample, start: Start, weight: f32, share: f64, sums: &mut [f64]) -> u64 {
        let ray = &sample.ray;
        let Some(hit) = self.scene.geometry.closest(ray) else { return 1 };
        let seen = Seen { eye: self, start, ray, hit, s: self.scene.surface(ray, &hit) };
        let (mut sums, mut rays) = (sums, 1);
        for aov in &self.view.aovs {
            let (own, rest) = sums.split_at_mut(aov.numbers());
            sums = rest;
            if let Aov::GBuffer { world } = *aov {
                rays += self.add_visible(sample, start, world, [f64::from(weight), share], own);
                continue;
            }
            let values = seen.values(*aov);
            if values.iter().all(|v| v.is_finite()) {
                own.iter_mut().zip(values).for_each(|(sum, v)| *sum += v * f64::from(weight) * share);
            }
        }
        rays
    }

    /// pbrt looks through what a texture cuts out, and through surfaces without a material.
    fn add_visible(
        &self,
        sample: &CameraSample,
        start: Start,
        world: bool,
        [weight, share]: [f64; 2],
        sums: &mut [f64],
    ) -> u64 {
        let light = sample.out.sum();
        let (mut ray, mut sampler) = (sample.ray, sample.sampler);
        for rays in 1..=MOST_PASSED as u64 {
            let Some(hit) = self.scene.geometry.closest(&ray) else { return rays };
            let s = self.scene.surface(&ray, &hit);
            let through = self.scene.closure(&s, s.frame.to_local(-ray.d)).transparency();
            if through > 0.0 && sampler.next_1d() < through {
                ray = Ray { tmax: ray.tmax - hit.t, ..s.leave(ray.d) };
                continue;
            }
            let seen = Seen { eye: self, start, ray: &ray, hit, s };
            let visible = Visible { rgb: to_rgb(light), ..seen.visible(world) };
            if light.is_finite() && visible.is_finite() {
                visible.add_to(sums, weight, share);
            }
            return rays;
        }
        MOST_PASSED as u64
    }

    /// A direction in the frame of the camera, whose axes have length 1 there.
    fn to_camera(self, v: Vec3) -> Vec3 {
        let axes = self.view.sensor.axes.map(|axis| axis.normalize_or_zero());
        Vec3::new(axes[0].dot(v), axes[1].dot(v), axes[2].dot(v))
    }
}

impl Seen<'_> {
    /// The numbers of an AOV, as many as it has channels.
    fn values(&self, aov: Aov) -> [f64; 3] {
        let (scene, s) = (self.eye.scene, &self.s);
        let one = |v: f32| [f64::from(v), 0.0, 0.0];
        let pair = |v: Vec2| [f64::from(v.x), f64::from(v.y), 0.0];
        match aov {
            Aov::Albedo => to_rgb(scene.reflectance(s, self.wi())).map(f64::from),
            Aov::Depth => one(self.hit.t),
            Aov::Distance => one(self.hit.t + self.before()),
            Aov::Position => self.position(),
            Aov::RelPosition => self.relative().map(f64::from),
            Aov::Uv => pair(s.uv),
            Aov::GeoNormal => triple(s.ng),
            Aov::ShNormal => triple(scene.shown_normal(s, self.wi(), false)),
            Aov::DpDu => triple(scene.partials(&self.hit, s)[0]),
            Aov::DpDv => triple(scene.partials(&self.hit, s)[1]),
            Aov::DuvDx => pair(self.uv_change(self.moved(Vec2::X))),
            Aov::DuvDy => pair(self.uv_change(self.moved(Vec2::Y))),
            Aov::PrimIndex => [f64::from(scene.primitive_number(s)), 0.0, 0.0],
            Aov::ShapeIndex => [f64::from(scene.shape_number(&self.hit, s)), 0.0, 0.0],
            Aov::ShapeNumber => [f64::from(scene.shape_number(&self.hit, s)) - 1.0, 0.0, 0.0],
            Aov::GBuffer { .. } => [0.0; 3],
        }
    }

    /// All of a G-buffer but the sample itself.
    fn visible(&self, world: bool) -> Visible {
        let (scene, s, eye) = (self.eye.scene, &self.s, self.eye);
        let wi = self.wi();
        let closure = scene.closure(s, wi);
        let solid = 1.0 - closure.transparency();
        let specular: Color = closure.deltas(wi, Transport::Radiance).iter().map(|l| l.weight).sum();
        let albedo = closure.smooth_albedo(wi, Range::ALL) + specular * solid;
        // pbrt's camera has +X on the right.
        let mirrored = |v: Vec3| Vec3::new(-v.x, v.y, v.z);
        let turned = |v: Vec3| if world { v } else { mirrored(eye.to_camera(v)) };
        let facing = |n: Vec3| turned(if n.dot(self.ray.d) > 0.0 { -n } else { n }).to_array();
        let at = if world { self.position() } else { triple(turned(s.p - eye.view.sensor.position)) };
        Visible {
            albedo: to_rgb(albedo),
            p: at,
            dz: [Vec2::X, Vec2::Y].map(|step| turned(self.moved(step)).z),
            n: facing(s.ng),
            ns: facing(scene.shown_normal(s, wi, true)),
            uv: s.uv.to_array(),
            rgb: [0.0; 3],
        }
    }

    /// Where the camera is, in the shading frame.
    fn wi(&self) -> Vec3 {
        self.s.frame.to_local(-self.ray.d)
    }

    /// In the author's coordinates.
    fn position(&self) -> [f64; 3] {
        let (p, origin) = (triple(self.s.p), self.eye.scene.origin);
        std::array::from_fn(|i| p[i] + origin[i])
    }

    /// In the coordinates of the camera, which may scale.
    fn relative(&self) -> [f32; 3] {
        let sensor = &self.eye.view.sensor;
        let p = self.s.p - sensor.position;
        sensor.axes.map(|axis| axis.dot(p) / axis.length_squared())
    }

    /// Length of the camera ray before the near plane, where it starts.
    fn before(&self) -> f32 {
        let sensor = &self.eye.view.sensor;
        sensor.near / sensor.axes[2].normalize_or_zero().dot(self.ray.d)
    }

    /// How far the neighbouring pixel's ray meets the tangent plane from here; `step` is in pixels.
    fn moved(&self, step: Vec2) -> Vec3 {
        let (s, eye) = (&self.s, self.eye);
        let sensor = &eye.view.sensor;
        let other = sensor.ray(self.start.place + step * eye.pixel, self.start.aperture);
        // All rays of a pinhole are taken to start where this one does.
        let o = if sensor.projection.is_parallel() { other.o } else { self.ray.o };
        let t = s.ng.dot(s.p - o) / s.ng.dot(other.d);
        o + other.d * t - s.p
    }

    /// The change of uv along `dp`, by least squares; 0 where there is no parametrisation.
    fn uv_change(&self, dp: Vec3) -> Vec2 {
        let [du, dv] = self.eye.scene.partials(&self.hit, &self.s);
        let (a, b, c) = (du.length_squared(), du.dot(dv), dv.length_squared());
        let inverse = 1.0 / (a * c - b * b);
        if !inverse.is_finite() {
            return Vec2::ZERO;
        }
        let (x, y) = (du.dot(dp), dv.dot(dp));
        Vec2::new(c * x - b * y, a * y - b * x) * inverse
    }
}

fn triple(v: Vec3) -> [f64; 3] {
    v.to_array().map(f64::from)
}
