//! What is compared: linear RGB pixels.

/// A picture of finite values in linear Rec. 709.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixels {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row by row, row 0 at the top; the length is `width` · `height`.
    pub rgb: Vec<[f32; 3]>,
}

impl Pixels {
    /// A picture computed from each pixel's column and row.
    pub fn from_fn(width: usize, height: usize, mut f: impl FnMut(usize, usize) -> [f32; 3]) -> Self {
        let mut rgb = Vec::with_capacity(width * height);
        for y in 0..height {
            rgb.extend((0..width).map(|x| f(x, y)));
        }
        Self { width, height, rgb }
    }

    /// The pixel at column `x` and row `y`.
    ///
    /// # Panics
    /// If it lies below the picture.
    pub fn at(&self, x: usize, y: usize) -> [f32; 3] {
        self.rgb[y * self.width + x]
    }

    /// Whether two pictures have the same width and height.
    pub fn same_size(&self, other: &Self) -> bool {
        self.width == other.width && self.height == other.height
    }
}

/// Luminance of linear Rec. 709 (IEC 61966-2-1).
pub(crate) fn luminance(rgb: [f32; 3]) -> f32 {
    0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
}

/// sRGB decoding of one value (IEC 61966-2-1).
pub(crate) fn srgb_to_linear(v: f32) -> f32 {
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

/// sRGB encoding of one value (IEC 61966-2-1).
pub(crate) fn linear_to_srgb(v: f32) -> f32 {
    if v <= 0.003_130_8 { v * 12.92 } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}
