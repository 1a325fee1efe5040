use super::{Param, Pattern, Site, Textures};
use crate::math::Color;

/// One parameter times another.
#[derive(Clone, Copy, Debug)]
pub struct Product(pub [Param; 2]);

impl Pattern for Product {
    fn eval(&self, textures: &Textures, at: &Site) -> Color {
        textures.eval(self.0[0], at) * textures.eval(self.0[1], at)
    }

    fn inputs(&self) -> Vec<Param> {
        self.0.to_vec()
    }
}
