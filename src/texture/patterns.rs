use super::{Mapping, Param, Site, Textures, UvTransform};
use crate::math::Color;
use crate::spectrum::luminance;

/// Lines of half-width `line` (in uv) along the borders of unit cells (Mitsuba 0.6 `gridtexture`).
#[derive(Clone, Debug)]
pub struct Grid {
    /// Cells, lines.
    pub colors: [Param; 2],
    pub line: f32,
    pub to_uv: UvTransform,
}

impl Grid {
    pub fn eval(&self, textures: &Textures, at: &Site) -> Color {
        let t = self.to_uv.apply(at.uv);
        let near = |x: f32| (x - x.round()).abs() < self.line;
        textures.eval(self.colors[usize::from(near(t.x) || near(t.y))], at)
    }
}

/// Unit cells by the parity of floor(u) + floor(v) (pbrt's `checkerboard`).
#[derive(Clone, Debug)]
pub struct UnitChecks {
    pub colors: [Param; 2],
    pub mapping: Mapping,
}

impl UnitChecks {
    pub fn eval(&self, textures: &Textures, at: &Site) -> Color {
        let t = self.mapping.apply(at).floor();
        let odd = (t.x + t.y).rem_euclid(2.0) >= 1.0;
        textures.eval(self.colors[usize::from(odd)], at)
    }
}

/// Bilinear between four corners.
#[derive(Clone, Debug)]
pub struct Bilerp {
    /// At (u, v) = 00, 01, 10, 11.
    pub corners: [Color; 4],
    pub mapping: Mapping,
}

impl Bilerp {
    pub fn eval(&self, at: &Site) -> Color {
        let t = self.mapping.apply(at);
        let along = |a: Color, b: Color| a * (1.0 - t.y) + b * t.y;
        let [c00, c01, c10, c11] = self.corners;
        along(c00, c01) * (1.0 - t.x) + along(c10, c11) * t.x
    }
}

/// (1 − amount)·first + amount·second.
#[derive(Clone, Debug)]
pub struct Mix {
    pub inputs: [Param; 2],
    pub amount: Param,
}

impl Mix {
    pub fn eval(&self, textures: &Textures, at: &Site) -> Color {
        let amount = luminance(textures.eval(self.amount, at));
        let [first, second] = self.inputs.map(|p| textures.eval(p, at));
        first * (1.0 - amount) + second * amount
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec2;

    const IDENTITY: UvTransform = UvTransform { u: [1.0, 0.0, 0.0], v: [0.0, 1.0, 0.0] };

    fn colors() -> [Param; 2] {
        [Param::gray(0.2), Param::gray(0.8)]
    }

    #[test]
    fn grid_lines_run_along_the_borders_of_cells() {
        let grid = Grid { colors: colors(), line: 0.1, to_uv: IDENTITY };
        for (u, v, expected) in
            [(0.5, 0.5, 0.2), (0.05, 0.5, 0.8), (0.95, 0.5, 0.8), (3.5, -2.04, 0.8), (1.2, 1.2, 0.2)]
        {
            assert_eq!(
                grid.eval(&Textures::default(), &Site::flat(Vec2::new(u, v))).lanes()[0],
                expected,
                "{u} {v}"
            );
        }
    }

    #[test]
    fn unit_checks_alternate_on_both_sides_of_zero() {
        let checks = UnitChecks { colors: colors(), mapping: Mapping::Uv(IDENTITY) };
        for (u, v, expected) in [(0.5, 0.5, 0.2), (1.5, 0.5, 0.8), (-0.5, 0.5, 0.8), (-0.5, -0.5, 0.2)] {
            assert_eq!(
                checks.eval(&Textures::default(), &Site::flat(Vec2::new(u, v))).lanes()[0],
                expected,
                "{u} {v}"
            );
        }
    }

    #[test]
    fn corners_and_amounts_are_met() {
        let corners = [1.0, 2.0, 3.0, 4.0].map(Color::splat);
        let b = Bilerp { corners, mapping: Mapping::Uv(IDENTITY) };
        for (u, v, expected) in
            [(0.0, 0.0, 1.0), (0.0, 1.0, 2.0), (1.0, 0.0, 3.0), (1.0, 1.0, 4.0), (0.5, 0.5, 2.5)]
        {
            assert_eq!(b.eval(&Site::flat(Vec2::new(u, v))).lanes()[0], expected);
        }
        let mix = Mix { inputs: colors(), amount: Param::gray(0.25) };
        assert!((mix.eval(&Textures::default(), &Site::flat(Vec2::ZERO)).lanes()[0] - 0.35).abs() < 1e-6);
    }
}
