use crate::math::{Affine, Vec3};
use crate::texture::perlin;

/// pbrt's density of a cloud: noise at the bottom of its box, thinner upwards.
#[derive(Clone, Copy, Debug)]
pub struct Cloud {
    /// From the world to the space of the noise, whose y points up.
    pub to_noise: Affine,
    /// From the world to the box, which is the unit cube; there is no cloud beyond.
    pub to_box: Affine,
    /// Factor on the noise.
    pub density: f32,
    /// How far a finer noise moves the place of the lookup.
    pub wispiness: f32,
    /// Waves per unit of length.
    pub frequency: f32,
}

/// Ratio of the frequencies of two octaves.
const LACUNARITY: f32 = 1.99;

impl Cloud {
    /// Between 0 and 1.
    pub fn density(&self, p: Vec3) -> f32 {
        let inside = self.to_box.transform_point3a(p);
        if !(inside.cmpge(Vec3::ZERO).all() && inside.cmple(Vec3::ONE).all()) {
            return 0.0;
        }
        let p = self.to_noise.transform_point3a(p);
        let mut at = p * self.frequency;
        if self.wispiness > 0.0 {
            let (mut far, mut fine) = (0.05 * self.wispiness, 10.0);
            for _ in 0..2 {
                at += far * slope(at * fine);
                far *= 0.5;
                fine *= LACUNARITY;
            }
        }
        let (mut sum, mut strength, mut fine) = (0.0, 0.5, 1.0);
        for _ in 0..5 {
            sum += strength * perlin(at * fine);
            strength *= 0.5;
            fine *= LACUNARITY;
        }
        let lumps = ((1.0 - p.y) * 4.5 * self.density * sum).clamp(0.0, 1.0);
        (lumps + 2.0 * (0.5 - p.y).max(0.0)).clamp(0.0, 1.0)
    }
}

/// The noise's change along each axis, by differences.
fn slope(p: Vec3) -> Vec3 {
    const STEP: f32 = 0.01;
    let here = perlin(p);
    let along = |axis: Vec3| (perlin(p + axis * STEP) - here) / STEP;
    Vec3::new(along(Vec3::X), along(Vec3::Y), along(Vec3::Z))
}
