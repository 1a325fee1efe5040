use super::{Param, Pattern, Site, Textures};
use crate::math::{Color, Vec3};

/// (1 − |n·direction|)·first + |n·direction|·second.
#[derive(Clone, Copy, Debug)]
pub struct DirectionMix {
    /// The two that are mixed.
    pub inputs: [Param; 2],
    /// Unit, in world space.
    pub direction: Vec3,
}

impl Pattern for DirectionMix {
    fn eval(&self, textures: &Textures, at: &Site) -> Color {
        let amount = at.n.dot(self.direction).abs().min(1.0);
        let [first, second] = self.inputs.map(|p| textures.eval(p, at));
        first * (1.0 - amount) + second * amount
    }

    fn inputs(&self) -> Vec<Param> {
        self.inputs.to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec2;

    #[test]
    fn surfaces_across_the_direction_show_the_first() {
        let mix = DirectionMix { inputs: [Param::gray(0.0), Param::gray(1.0)], direction: Vec3::Y };
        for (n, expected) in
            [(Vec3::X, 0.0), (Vec3::Y, 1.0), (-Vec3::Y, 1.0), (Vec3::new(0.6, 0.8, 0.0), 0.8)]
        {
            let at = Site { n, ..Site::flat(Vec2::ZERO) };
            assert_eq!(mix.eval(&Textures::default(), &at).lanes()[0], expected);
        }
    }
}
