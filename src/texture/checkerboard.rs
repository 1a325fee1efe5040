use super::{Param, Pattern, Site, Textures, UvTransform};
use crate::math::Color;

/// Two colours by the parity of floor(2u) and floor(2v) (Mitsuba's `checkerboard`).
#[derive(Clone, Debug)]
pub struct Checkerboard {
    /// Of the two kinds of cell.
    pub colors: [Param; 2],
    /// From the uv of the surface to that of the cells.
    pub to_uv: UvTransform,
}

impl Pattern for Checkerboard {
    fn eval(&self, textures: &Textures, at: &Site) -> Color {
        let t = self.to_uv.apply(at.uv);
        let upper = |x: f32| x - x.floor() > 0.5;
        let color = self.colors[usize::from(upper(t.x) != upper(t.y))];
        textures.eval(color, at)
    }

    fn inputs(&self) -> Vec<Param> {
        self.colors.to_vec()
    }
}
