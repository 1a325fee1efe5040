use super::{Param, Pattern, Site, Textures, ToTexture};
use crate::math::Color;

/// Unit cubes by the parity of floor(x) + floor(y) + floor(z).
#[derive(Clone, Copy, Debug)]
pub struct SolidChecks {
    /// Of the two kinds of cell.
    pub colors: [Param; 2],
    /// From world space to that of the cells.
    pub to_texture: ToTexture,
}

impl Pattern for SolidChecks {
    fn eval(&self, textures: &Textures, at: &Site) -> Color {
        let cell = self.to_texture.point(at.p).floor();
        let odd = (cell.x + cell.y + cell.z).rem_euclid(2.0) >= 1.0;
        textures.eval(self.colors[usize::from(odd)], at)
    }

    fn inputs(&self) -> Vec<Param> {
        self.colors.to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Vec2, Vec3};

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
}
