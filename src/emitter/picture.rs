use crate::math::Color;
use crate::spectrum::{luminance, rgb};

/// The picture of an emitter: linear, row 0 at the top.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Texels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    texels: Vec<[f32; 3]>,
}

impl Picture {
    /// Light is neither negative nor infinite: such texels become black.
    pub fn new(width: usize, height: usize, mut texels: Vec<[f32; 3]>) -> Self {
        for value in texels.iter_mut().flatten() {
            *value = if value.is_finite() { value.max(0.0) } else { 0.0 };
        }
        Self { width, height, texels }
    }

    /// The value of a texel.
    #[inline]
    pub fn texel(&self, x: usize, y: usize) -> Color {
        rgb(self.texels[y * self.width + x])
    }

    /// The Rec. 709 luminance of a texel.
    pub fn luminance(&self, x: usize, y: usize) -> f32 {
        luminance(self.texel(x, y))
    }

    /// Multiplies all texels.
    pub fn scale(&mut self, factor: f32) {
        self.texels.iter_mut().flatten().for_each(|v| *v *= factor);
    }

    /// The texel that holds a point of the unit square, row 0 at v = 0.
    #[inline]
    pub fn at(&self, u: f32, v: f32) -> [usize; 2] {
        // The cast saturates: negative and NaN give 0.
        [
            ((u * self.width as f32) as usize).min(self.width - 1),
            ((v * self.height as f32) as usize).min(self.height - 1),
        ]
    }

    /// Memory of the texels.
    pub fn bytes(&self) -> usize {
        size_of_val(self.texels.as_slice())
    }
}
