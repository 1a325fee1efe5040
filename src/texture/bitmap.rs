use super::{Mapping, Pattern, Site, Textures};
use crate::math::Color;
use crate::spectrum::rgb;

/// What lies outside the unit square.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The picture again.
    Repeat,
    /// The picture mirrored.
    Mirror,
    /// The nearest texel of the edge.
    Clamp,
    /// Black.
    Zero,
    /// White.
    One,
}

/// Linear texels, row 0 at v = 0; texel centres at (i + ½)/width (Mitsuba's convention).
#[derive(Clone, Debug)]
pub struct Bitmap {
    /// In texels.
    pub width: usize,
    /// In texels.
    pub height: usize,
    /// Row by row.
    pub texels: Texels,
    /// Between four texels; else the nearest.
    pub bilinear: bool,
    /// Along u and along v.
    pub wrap: [Wrap; 2],
    /// From a point of the surface to the plane of the texture.
    pub mapping: Mapping,
    /// Values may be outside of [0, 1].
    pub leaves_unit: bool,
}

/// How texels are stored.
#[derive(Clone, Debug)]
pub enum Texels {
    /// Linear colours.
    Floats(Vec<[f32; 3]>),
    /// Bytes as a file holds them, a quarter of the memory and nothing to convert.
    Bytes(Box<Bytes>),
}

/// Texels as a file holds them.
#[derive(Clone, Debug)]
pub struct Bytes {
    /// Row by row.
    pub data: Vec<u8>,
    /// Bytes a pixel, and which of them are red, green and blue.
    pub stride: usize,
    /// See `stride`.
    pub channels: [usize; 3],
    /// What each byte means.
    pub table: [f32; 256],
}

impl Texels {
    #[inline]
    fn get(&self, i: usize) -> Color {
        match self {
            Self::Floats(texels) => rgb(texels[i]),
            Self::Bytes(b) => rgb(b.channels.map(|c| b.table[usize::from(b.data[i * b.stride + c])])),
        }
    }
}

#[derive(Clone, Copy)]
enum Texel {
    /// Number of a texel along an axis.
    At(usize),
    /// Outside, where nothing of the picture is seen.
    Constant(f32),
}

#[inline(always)]
fn wrapped(i: i64, n: usize, mode: Wrap) -> Texel {
    let n = n as i64;
    let inside = (0..n).contains(&i);
    let at = match mode {
        _ if inside => i,
        Wrap::Repeat => i.rem_euclid(n),
        Wrap::Mirror => {
            let m = i.rem_euclid(2 * n);
            if m < n { m } else { 2 * n - 1 - m }
        }
        Wrap::Clamp => i.clamp(0, n - 1),
        Wrap::Zero => return Texel::Constant(0.0),
        Wrap::One => return Texel::Constant(1.0),
    };
    Texel::At(at as usize)
}

impl Bitmap {
    #[inline(always)]
    fn column(&self, x: i64) -> Texel {
        wrapped(x, self.width, self.wrap[0])
    }

    #[inline(always)]
    fn row(&self, y: i64) -> Texel {
        wrapped(y, self.height, self.wrap[1])
    }

    #[inline(always)]
    fn texel(&self, x: Texel, y: Texel) -> Color {
        match (x, y) {
            (Texel::At(x), Texel::At(y)) => self.texels.get(y * self.width + x),
            (Texel::Constant(c), _) | (_, Texel::Constant(c)) => Color::splat(c),
        }
    }
}

impl Pattern for Bitmap {
    fn eval(&self, _textures: &Textures, at: &Site) -> Color {
        let uv = self.mapping.apply(at);
        // uv of a degenerate or hostile mesh may be huge or NaN; the cast saturates, NaN becomes 0.
        let (x, y) = (uv.x * self.width as f32, uv.y * self.height as f32);
        if !self.bilinear {
            return self.texel(self.column(x.floor() as i64), self.row(y.floor() as i64));
        }
        let (x, y) = (x - 0.5, y - 0.5);
        let (x0, y0) = (x.floor(), y.floor());
        let (fx, fy) = (x - x0, y - y0);
        let (i, j) = ((x0 as i64).clamp(-1 << 40, 1 << 40), (y0 as i64).clamp(-1 << 40, 1 << 40));
        let ([left, right], [upper, lower]) =
            ([i, i + 1].map(|x| self.column(x)), [j, j + 1].map(|y| self.row(y)));
        let top = self.texel(left, upper) * (1.0 - fx) + self.texel(right, upper) * fx;
        let bottom = self.texel(left, lower) * (1.0 - fx) + self.texel(right, lower) * fx;
        top * (1.0 - fy) + bottom * fy
    }

    fn bytes(&self) -> usize {
        match &self.texels {
            Texels::Floats(texels) => size_of_val(texels.as_slice()),
            Texels::Bytes(bytes) => bytes.data.len(),
        }
    }

    fn may_leave_unit(&self, _: &Textures) -> bool {
        self.leaves_unit
    }
}

#[cfg(test)]
mod tests {
    use super::super::UvTransform;
    use super::*;
    use crate::math::Vec2;

    fn ramp(wrap: Wrap, bilinear: bool) -> Bitmap {
        Bitmap {
            width: 4,
            height: 1,
            texels: Texels::Floats((0..4).map(|i| [i as f32; 3]).collect()),
            bilinear,
            wrap: [wrap, Wrap::Clamp],
            mapping: Mapping::Uv(UvTransform { u: [1.0, 0.0, 0.0], v: [0.0, 1.0, 0.0] }),
            leaves_unit: true,
        }
    }

    #[test]
    fn wrap_modes_continue_the_ramp_as_named() {
        let at = |w, u| ramp(w, false).eval(&Textures::default(), &Site::flat(Vec2::new(u, 0.5))).lanes()[0];
        assert_eq!(at(Wrap::Repeat, 1.1), 0.0);
        assert_eq!(at(Wrap::Mirror, 1.1), 3.0);
        assert_eq!(at(Wrap::Mirror, -0.3), 1.0);
        assert_eq!(at(Wrap::Clamp, 7.0), 3.0);
        assert_eq!(at(Wrap::Zero, -0.1), 0.0);
        assert_eq!(at(Wrap::One, -0.1), 1.0);
    }

    #[test]
    fn bilinear_reproduces_texel_centres_and_interpolates_between() {
        let b = ramp(Wrap::Repeat, true);
        assert_eq!(b.eval(&Textures::default(), &Site::flat(Vec2::new(0.375, 0.5))).lanes()[0], 1.0);
        assert_eq!(b.eval(&Textures::default(), &Site::flat(Vec2::new(0.5, 0.5))).lanes()[0], 1.5);
        assert_eq!(b.eval(&Textures::default(), &Site::flat(Vec2::new(0.0, 0.5))).lanes()[0], 1.5);
        assert!(
            b.eval(&Textures::default(), &Site::flat(Vec2::new(f32::NAN, f32::INFINITY))).is_finite()
                || b.bilinear
        );
    }
}
