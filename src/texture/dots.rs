use super::noise::perlin;
use super::{Mapping, Param, Pattern, Site, Textures};
use crate::math::{Color, Vec2, Vec3};

/// Disks scattered over unit cells, in two of five (pbrt's `dots`).
#[derive(Clone, Copy, Debug)]
pub struct Dots {
    /// Outside, inside.
    pub colors: [Param; 2],
    /// From a point of the surface to the plane of the texture.
    pub mapping: Mapping,
}

const RADIUS: f32 = 0.35;

impl Dots {
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

impl Pattern for Dots {
    fn eval(&self, textures: &Textures, at: &Site) -> Color {
        let inside = Self::hits(self.mapping.apply(at));
        textures.eval(self.colors[usize::from(inside)], at)
    }

    fn inputs(&self) -> Vec<Param> {
        self.colors.to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
