use super::{Mapping, Param, Pattern, Site, Textures};
use crate::math::Color;

/// Unit cells by the parity of floor(u) + floor(v) (pbrt's `checkerboard`).
#[derive(Clone, Debug)]
pub struct UnitChecks {
    /// Of the two kinds of cell.
    pub colors: [Param; 2],
    /// From a point of the surface to the plane of the texture.
    pub mapping: Mapping,
}

impl Pattern for UnitChecks {
    fn eval(&self, textures: &Textures, at: &Site) -> Color {
        let t = self.mapping.apply(at).floor();
        let odd = (t.x + t.y).rem_euclid(2.0) >= 1.0;
        textures.eval(self.colors[usize::from(odd)], at)
    }

    fn inputs(&self) -> Vec<Param> {
        self.colors.to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::super::UvTransform;
    use super::*;
    use crate::math::Vec2;

    const IDENTITY: UvTransform = UvTransform { u: [1.0, 0.0, 0.0], v: [0.0, 1.0, 0.0] };

    #[test]
    fn unit_checks_alternate_on_both_sides_of_zero() {
        let checks =
            UnitChecks { colors: [Param::gray(0.2), Param::gray(0.8)], mapping: Mapping::Uv(IDENTITY) };
        for (u, v, expected) in [(0.5, 0.5, 0.2), (1.5, 0.5, 0.8), (-0.5, 0.5, 0.8), (-0.5, -0.5, 0.2)] {
            assert_eq!(
                checks.eval(&Textures::default(), &Site::flat(Vec2::new(u, v))).lanes()[0],
                expected,
                "{u} {v}"
            );
        }
    }
}
