use super::noise::perlin;
use super::{Mapping, Param, Site, Textures, ToTexture};
use crate::math::{Color, Vec2, Vec3};

/// Unit cubes by the parity of floor(x) + floor(y) + floor(z).
#[derive(Clone, Copy, Debug)]
pub struct SolidChecks {
    pub colors: [Param; 2],
    pub to_texture: ToTexture,
}

impl SolidChecks {
    pub fn eval(&self, textures: &Textures, at: &Site) -> Color {
        let cell = self.to_texture.point(at.p).floor();
        let odd = (cell.x + cell.y + cell.z).rem_euclid(2.0) >= 1.0;
        textures.eval(self.colors[usize::from(odd)], at)
    }
}

/// Disks scattered over unit cells, in two of five (pbrt's `dots`).
#[derive(Clone, Copy, Debug)]
pub struct Dots {
    /// Outside, inside.
    pub colors: [Param; 2],
    pub mapping: Mapping,
}

const RADIUS: f32 = 0.35;

impl Dots {
    pub fn eval(&self, textures: &Textures, at: &Site) -> Color {
        let inside = Self::hits(self.mapping.apply(at));
        textures.eval(self.colors[usize::from(inside)], at)
    }

    fn hits(st: Vec2) -> bool {
        let cell = (st + 0.5).floor();
        // Places where the noise of a cell is read: pbrt's, so that the dots are where it puts them.
        let chance = |s: f32, t: f32| perlin(Vec3::new(cell.x + s, cell.y + t, 0.5));
        if chance(0.5, 0.5) <= 0.0 {
            return false;
        }
        let shift = Vec2::new(chance(1.5, 2.8), chance(4.5, 9.8)) * (0.5 - RADIUS);
        st.distance_squared(cell + shift) < RADIUS * RADIUS
    }
}

/// (1 − |n·direction|)·first + |n·direction|·second.
#[derive(Clone, Copy, Debug)]
pub struct DirectionMix {
    pub inputs: [Param; 2],
    pub direction: Vec3,
}

impl DirectionMix {
    pub fn eval(&self, textures: &Textures, at: &Site) -> Color {
        let amount = at.n.dot(self.direction).abs().min(1.0);
        let [first, second] = self.inputs.map(|p| textures.eval(p, at));
        first * (1.0 - amount) + second * amount
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAME: ToTexture = ToTexture([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]);

    fn site(p: [f32; 3]) -> Site {
        Site { p: Vec3::from(p), ..Site::flat(Vec2::ZERO) }
    }

    #[test]
    fn cubes_alternate_along_every_axis() {
        let checks = SolidChecks { colors: [Param::gray(0.2), Param::gray(0.8)], to_texture: SAME };
        for (p, expected) in [
            ([0.5, 0.5, 0.5], 0.2),
            ([1.5, 0.5, 0.5], 0.8),
            ([0.5, -0.5, 0.5], 0.8),
            ([0.5, 1.5, 2.5], 0.8),
            ([-0.5, 0.5, -0.5], 0.2),
        ] {
            assert_eq!(checks.eval(&Textures::default(), &site(p)).lanes()[0], expected, "{p:?}");
        }
    }

    /// In the middle of a cell the noise is an eighth of a sum of sixteen ±½, which is positive with
    /// probability (1 − C(16, 8)/2¹⁶)/2 = 0.402; a dot covers π·0.35² of its cell: 0.155 of the plane.
    /// Cells share corners, so the share of 200² of them is known to a few percent only.
    #[test]
    fn dots_cover_their_share_and_stay_in_their_cells() {
        let n = 1600;
        let mut inside = 0;
        for i in 0..n * n {
            let st = Vec2::new((i % n) as f32, (i / n) as f32) * 0.1250077;
            inside += u32::from(Dots::hits(st));
        }
        let share = f64::from(inside) / f64::from(n * n);
        assert!((share - 0.155).abs() < 0.02, "{share}");
        for i in 0..1000 {
            assert!(!Dots::hits(Vec2::new(0.5 + (i / 40) as f32, 0.04 * i as f32)), "a dot crosses its cell");
        }
    }

    #[test]
    fn surfaces_across_the_direction_show_the_first() {
        let mix = DirectionMix { inputs: [Param::gray(0.0), Param::gray(1.0)], direction: Vec3::Y };
        for (n, expected) in
            [(Vec3::X, 0.0), (Vec3::Y, 1.0), (-Vec3::Y, 1.0), (Vec3::new(0.6, 0.8, 0.0), 0.8)]
        {
            let at = Site { n, ..site([0.0; 3]) };
            assert_eq!(mix.eval(&Textures::default(), &at).lanes()[0], expected);
        }
    }
}
