use super::{Mapping, Pattern, Site, Textures};
use crate::math::Color;

/// Bilinear between four corners.
#[derive(Clone, Debug)]
pub struct Bilerp {
    /// At (u, v) = 00, 01, 10, 11.
    pub corners: [Color; 4],
    /// From a point of the surface to the plane of the texture.
    pub mapping: Mapping,
}

impl Pattern for Bilerp {
    fn eval(&self, _textures: &Textures, at: &Site) -> Color {
        let t = self.mapping.apply(at);
        let along = |a: Color, b: Color| a * (1.0 - t.y) + b * t.y;
        let [c00, c01, c10, c11] = self.corners;
        along(c00, c01) * (1.0 - t.x) + along(c10, c11) * t.x
    }

    /// Beyond its corners it goes on as it was between them.
    fn may_leave_unit(&self, _: &Textures) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::UvTransform;
    use super::*;
    use crate::math::Vec2;

    const IDENTITY: UvTransform = UvTransform { u: [1.0, 0.0, 0.0], v: [0.0, 1.0, 0.0] };

    #[test]
    fn corners_are_met() {
        let corners = [1.0, 2.0, 3.0, 4.0].map(Color::splat);
        let b = Bilerp { corners, mapping: Mapping::Uv(IDENTITY) };
        for (u, v, expected) in
            [(0.0, 0.0, 1.0), (0.0, 1.0, 2.0), (1.0, 0.0, 3.0), (1.0, 1.0, 4.0), (0.5, 0.5, 2.5)]
        {
            assert_eq!(b.eval(&Textures::default(), &Site::flat(Vec2::new(u, v))).lanes()[0], expected);
        }
    }
}
