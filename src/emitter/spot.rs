use std::f32::consts::PI;

use super::{DirectSample, Emission, EmissionBounds, Light, SceneSphere, just_before};
use crate::math::{Color, Frame, Vec2, Vec3};
use crate::sampling::warp;
use crate::texture::{Param, Site, Textures};

/// How the intensity falls from `beam` to `cutoff`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Falloff {
    /// Linear in the angle (Mitsuba).
    Linear,
    /// 3x² − 2x³ of the cosine's share of the way (pbrt-v4).
    Smoothstep,
    /// x⁴ of it (pbrt-v3).
    Quartic,
}

/// Point light with a cone: full intensity (W/sr) up to the angle `beam`, none from `cutoff` on (radians).
#[derive(Clone, Debug)]
pub struct Spot {
    /// In the world.
    pub position: Vec3,
    /// `n` is the axis; `s` and `t` orient the texture.
    pub frame: Frame,
    /// In place of `frame`, the inverse of a transform that stretches the cone.
    pub stretched: Option<Stretched>,
    /// W/sr within the beam.
    pub intensity: Color,
    /// Half angle of the cone, radians.
    pub cutoff: f32,
    /// Half angle of full intensity, radians.
    pub beam: f32,
    /// Between the two.
    pub falloff: Falloff,
    /// Scales the intensity, thrown along the axis.
    pub texture: Option<Param>,
}

/// A linear map of directions and its inverse, by columns.
#[derive(Clone, Copy, Debug)]
pub struct Stretched {
    /// Columns of M.
    pub to_world: [Vec3; 3],
    /// Columns of the inverse of M.
    pub to_local: [Vec3; 3],
}

impl Stretched {
    fn map(m: &[Vec3; 3], d: Vec3) -> Vec3 {
        m[0] * d.x + m[1] * d.y + m[2] * d.z
    }

    /// Of the local unit direction `d`: the direction in the world, and how much solid angle a unit of the local one
    /// covers there, |det M| / |M d|³.
    fn leave(&self, d: Vec3) -> (Vec3, f32) {
        let world = Self::map(&self.to_world, d);
        let [x, y, z] = self.to_world;
        let length = world.length();
        (world / length, (x.cross(y).dot(z).abs() / length.powi(3)))
    }
}

impl Spot {
    /// The local direction of a direction in the world.
    fn local(&self, d: Vec3) -> Vec3 {
        match &self.stretched {
            None => self.frame.to_local(d),
            Some(m) => Stretched::map(&m.to_local, d).normalize(),
        }
    }

    /// Intensity towards the local unit direction `d`.
    fn toward(&self, textures: &Textures, d: Vec3) -> Color {
        // atan2 keeps small angles that acos(z) would round to zero.
        let angle = d.truncate().length().atan2(d.z);
        if angle >= self.cutoff {
            return Color::ZERO;
        }
        let falloff = match self.falloff {
            _ if angle <= self.beam => 1.0,
            Falloff::Linear => (self.cutoff - angle) / (self.cutoff - self.beam),
            Falloff::Smoothstep | Falloff::Quartic => {
                let (edge, full) = (self.cutoff.cos(), self.beam.cos());
                let x = ((d.z - edge) / (full - edge)).clamp(0.0, 1.0);
                let end = if self.falloff == Falloff::Quartic { x * x } else { 3.0 - 2.0 * x };
                x * x * end
            }
        };
        let color = self.texture.map_or(Color::ONE, |t| {
            let scale = 0.5 / (d.z * self.cutoff.tan());
            textures.eval(t, &Site::flat(Vec2::new(0.5 + d.x * scale, 0.5 + d.y * scale)))
        });
        self.intensity * color * falloff
    }
}

impl Light for Spot {
    fn sample_direct(&self, textures: &Textures, p: Vec3, _u: Vec2) -> Option<DirectSample> {
        let d = self.position - p;
        let d2 = d.length_squared();
        let dir = d / d2.sqrt();
        let value = self.toward(textures, self.local(-dir)) / d2;
        (d2 > 0.0 && value.max_element() > 0.0).then_some(DirectSample {
            dir,
            target: Some(just_before(self.position, d)),
            value,
            pdf: 0.0,
        })
    }

    fn sample_emission(
        &self,
        textures: &Textures,
        bounds: &EmissionBounds<'_>,
        _place: Vec2,
        direction: Vec2,
    ) -> Option<Emission> {
        let gap = 2.0 * (self.cutoff * 0.5).sin().powi(2);
        let Some(m) = &self.stretched else {
            let even = 1.0 / (2.0 * PI * gap);
            let own = |u| self.frame.to_world(warp::cone(u, gap));
            let inside = |d: Vec3| if self.frame.to_local(d).z >= 1.0 - gap { even } else { 0.0 };
            let headed = bounds.head(self.position, direction, own, inside);
            let flux = self.toward(textures, self.frame.to_local(headed.0)) / even;
            return Emission::headed(headed, self.position, flux, even);
        };
        let local = warp::cone(direction, gap);
        let (d, area) = m.leave(local);
        let solid = 2.0 * PI * gap * area;
        let flux = self.toward(textures, local) * solid;
        (flux.max_element() > 0.0).then(|| Emission::from_point(self.position, d, flux, 1.0 / solid))
    }

    /// Without the texture: 2π∫ falloff·sinθ dθ, in closed form.
    fn place(&self, _: Vec2) -> Option<Vec3> {
        Some(self.position)
    }

    fn power(&self, _textures: &Textures, _scene: &SceneSphere) -> Color {
        let (b, c) = (f64::from(self.beam), f64::from(self.cutoff));
        let ramp = match self.falloff {
            Falloff::Linear if c > b => b.cos() - (c.sin() - b.sin()) / (c - b),
            Falloff::Linear => 0.0,
            // The step is symmetric: half of the rim's solid angle counts.
            Falloff::Smoothstep => 0.5 * (b.cos() - c.cos()),
            Falloff::Quartic => 0.2 * (b.cos() - c.cos()),
        };
        self.intensity * (2.0 * std::f64::consts::PI * (1.0 - b.cos() + ramp)) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spot() -> Spot {
        Spot {
            position: Vec3::ZERO,
            frame: Frame::from_normal(Vec3::Z),
            stretched: None,
            intensity: Color::ONE,
            cutoff: 20f32.to_radians(),
            beam: 15f32.to_radians(),
            falloff: Falloff::Linear,
            texture: None,
        }
    }

    /// Falloff measured on Mitsuba 3.9.1 for cutoff 20°, beam 15°.
    #[test]
    fn falloff_is_linear_in_the_angle() {
        for (degrees, expected) in [(10.0f32, 1.0), (16.0, 0.8), (17.5, 0.5), (19.0, 0.2), (21.0, 0.0)] {
            let a = degrees.to_radians();
            let got = spot().toward(&Textures::default(), Vec3::new(a.sin(), 0.0, a.cos())).lanes()[0];
            assert!((got - expected).abs() < 1e-4, "{degrees}: {got}");
        }
    }

    /// The mean of 64² stratified emissions of a piecewise linear integrand errs by less than 1/64².
    #[test]
    fn sampled_flux_adds_up_to_the_power() {
        for falloff in [Falloff::Linear, Falloff::Smoothstep] {
            adds_up(&Spot { falloff, ..spot() });
        }
    }

    fn adds_up(s: &Spot) {
        let textures = Textures::default();
        let scene = SceneSphere { center: Vec3::ZERO, radius: 1.0 };
        let bounds = EmissionBounds::even(scene);
        let n = 64;
        let mut sum = 0.0;
        for i in 0..n * n {
            let u = Vec2::new(((i % n) as f32 + 0.5) / n as f32, ((i / n) as f32 + 0.5) / n as f32);
            sum += s
                .sample_emission(&textures, &bounds, Vec2::ZERO, u)
                .map_or(0.0, |e| f64::from(e.flux.lanes()[0]));
        }
        let mean = sum / f64::from(n * n);
        let power = s.power(&textures, &scene).lanes()[0];
        assert!((mean / f64::from(power) - 1.0).abs() < 2.5e-4, "{mean} {power}");
    }
    /// What a spot through a stretching transform emits is what it lights a sphere around it with: the mean of
    /// 128² emissions against the integral of direct light over 512² places. Either sum of a piecewise smooth
    /// integrand errs by less than a percent.
    #[test]
    fn a_stretched_spot_emits_what_arrives_around_it() {
        let textures = Textures::default();
        let bounds = EmissionBounds::even(SceneSphere { center: Vec3::ZERO, radius: 1.0 });
        let to_world = [Vec3::X * 3.0, Vec3::Y, Vec3::Z];
        let to_local = [Vec3::X / 3.0, Vec3::Y, Vec3::Z];
        let s = Spot { stretched: Some(Stretched { to_world, to_local }), ..spot() };
        let mean = |n: u32, of: &dyn Fn(Vec2) -> f32| {
            let at = |i: u32| (i as f32 + 0.5) / n as f32;
            let sum: f64 = (0..n * n).map(|i| f64::from(of(Vec2::new(at(i % n), at(i / n))))).sum();
            sum / f64::from(n * n)
        };
        let emitted = mean(128, &|u| {
            s.sample_emission(&textures, &bounds, Vec2::ZERO, u).map_or(0.0, |e| e.flux.lanes()[0])
        });
        let arrived = mean(512, &|u| {
            let lit = s.sample_direct(&textures, warp::sphere(u), Vec2::ZERO);
            lit.map_or(0.0, |l| l.value.lanes()[0] * 4.0 * PI)
        });
        assert!((emitted / arrived - 1.0).abs() < 0.01, "{emitted} {arrived}");
        assert!(
            arrived
                > 2.0
                    * mean(512, &|u| {
                        let lit = spot().sample_direct(&textures, warp::sphere(u), Vec2::ZERO);
                        lit.map_or(0.0, |l| l.value.lanes()[0] * 4.0 * PI)
                    })
        );
    }
}
