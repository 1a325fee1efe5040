use super::{Param, Pattern, Site, Textures, leaves_unit};
use crate::math::Color;

/// A parameter times a constant.
#[derive(Clone, Copy, Debug)]
pub struct Scaled {
    /// What is multiplied.
    pub input: Param,
    /// By lane.
    pub factor: Color,
}

impl Pattern for Scaled {
    fn eval(&self, textures: &Textures, at: &Site) -> Color {
        textures.eval(self.input, at) * self.factor
    }

    fn inputs(&self) -> Vec<Param> {
        vec![self.input]
    }

    fn may_leave_unit(&self, textures: &Textures) -> bool {
        leaves_unit(self.factor) || textures.may_leave_unit(self.input)
    }
}
