use super::{Param, Pattern, Site, Textures};
use crate::math::Color;
use crate::spectrum::luminance;

/// (1 − amount)·first + amount·second.
#[derive(Clone, Debug)]
pub struct Mix {
    /// The two that are mixed.
    pub inputs: [Param; 2],
    /// Share of the second; of a colour, its luminance.
    pub amount: Param,
}

impl Pattern for Mix {
    fn eval(&self, textures: &Textures, at: &Site) -> Color {
        let amount = luminance(textures.eval(self.amount, at));
        let [first, second] = self.inputs.map(|p| textures.eval(p, at));
        first * (1.0 - amount) + second * amount
    }

    fn inputs(&self) -> Vec<Param> {
        vec![self.inputs[0], self.inputs[1], self.amount]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec2;

    #[test]
    fn the_amount_is_that_of_the_second() {
        let mix = Mix { inputs: [Param::gray(0.2), Param::gray(0.8)], amount: Param::gray(0.25) };
        assert!((mix.eval(&Textures::default(), &Site::flat(Vec2::ZERO)).lanes()[0] - 0.35).abs() < 1e-6);
    }
}
