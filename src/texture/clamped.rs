use super::{Param, Pattern, Site, Textures};
use crate::math::Color;

/// A parameter within [0, 1], lane by lane.
#[derive(Clone, Copy, Debug)]
pub struct Clamped(pub Param);

impl Pattern for Clamped {
    fn eval(&self, textures: &Textures, at: &Site) -> Color {
        textures.eval(self.0, at).max(Color::ZERO).min(Color::ONE)
    }

    fn inputs(&self) -> Vec<Param> {
        vec![self.0]
    }

    fn may_leave_unit(&self, _: &Textures) -> bool {
        false
    }
}
