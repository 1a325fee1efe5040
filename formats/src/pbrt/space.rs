//! pbrt's colour spaces and their way to linear Rec.709.

/// The colour space of `rgb` values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum ColorSpace {
    #[default]
    Srgb,
    DciP3,
    Rec2020,
    Aces2065,
}

use ColorSpace as C;

const NAMES: &[(&str, ColorSpace)] =
    &[("srgb", C::Srgb), ("dci-p3", C::DciP3), ("rec2020", C::Rec2020), ("aces2065-1", C::Aces2065)];

type Matrix = [[f64; 3]; 3];

const D65: [f64; 2] = [0.3127, 0.3290];
const D60: [f64; 2] = [0.321_68, 0.337_67];

impl ColorSpace {
    pub fn named(name: &str) -> Option<Self> {
        NAMES.iter().find(|row| row.0.eq_ignore_ascii_case(name)).map(|row| row.1)
    }

    pub fn names() -> impl Iterator<Item = &'static str> {
        NAMES.iter().map(|row| row.0)
    }

    pub fn name(self) -> &'static str {
        NAMES.iter().find(|row| row.1 == self).map_or("", |row| row.0)
    }

    /// Chromaticities of red, green, blue (the standards' own) and of white.
    fn primaries(self) -> ([[f64; 2]; 3], [f64; 2]) {
        match self {
            C::Srgb => ([[0.64, 0.33], [0.3, 0.6], [0.15, 0.06]], D65),
            C::DciP3 => ([[0.68, 0.32], [0.265, 0.69], [0.15, 0.06]], D65),
            C::Rec2020 => ([[0.708, 0.292], [0.17, 0.797], [0.131, 0.046]], D65),
            C::Aces2065 => ([[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.077]], D60),
        }
    }

    fn to_xyz(self) -> Matrix {
        let (primaries, white) = self.primaries();
        let columns = primaries.map(xyz);
        let matrix: Matrix = std::array::from_fn(|row| std::array::from_fn(|c| columns[c][row]));
        let scale = apply(&inverse(&matrix), xyz(white));
        matrix.map(|row| std::array::from_fn(|c| row[c] * scale[c]))
    }

    /// Emitted light: the same stimulus, so the space's own white keeps its tint.
    pub fn light_to_rec709(self, rgb: [f64; 3]) -> [f64; 3] {
        if self == C::Srgb {
            return rgb;
        }
        apply(&inverse(&C::Srgb.to_xyz()), apply(&self.to_xyz(), rgb))
    }

    /// Reflectance: what is white stays white (Bradford adaptation between the two whites).
    pub fn reflectance_to_rec709(self, rgb: [f64; 3]) -> [f64; 3] {
        if self == C::Srgb {
            return rgb;
        }
        let (from, to) = (apply(&BRADFORD, xyz(self.primaries().1)), apply(&BRADFORD, xyz(D65)));
        let mut cone = apply(&BRADFORD, apply(&self.to_xyz(), rgb));
        for i in 0..3 {
            cone[i] *= to[i] / from[i];
        }
        apply(&inverse(&C::Srgb.to_xyz()), apply(&inverse(&BRADFORD), cone))
    }
}

/// Lam 1985.
const BRADFORD: Matrix = [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];

/// XYZ of luminance 1.
fn xyz([x, y]: [f64; 2]) -> [f64; 3] {
    [x / y, 1.0, (1.0 - x - y) / y]
}

fn apply(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// By cofactors; the matrices here are far from singular.
fn inverse(m: &Matrix) -> Matrix {
    let cofactor = |r: usize, c: usize| {
        let (r1, r2, c1, c2) = ((r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3);
        m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1]
    };
    let determinant: f64 = (0..3).map(|c| m[0][c] * cofactor(0, c)).sum();
    std::array::from_fn(|r| std::array::from_fn(|c| cofactor(c, r) / determinant))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: [f64; 3], b: [f64; 3], tolerance: f64) {
        assert!((0..3).all(|i| (a[i] - b[i]).abs() <= tolerance), "{a:?} {b:?}");
    }

    /// Published matrices (ITU-R BT.2087 for Rec.2020 to Rec.709) have four decimals.
    #[test]
    fn known_matrices() {
        let red = C::Rec2020.light_to_rec709([1.0, 0.0, 0.0]);
        close(red, [1.6605, -0.1246, -0.0182], 1e-4);
        let green = C::Rec2020.light_to_rec709([0.0, 1.0, 0.0]);
        close(green, [-0.5876, 1.1329, -0.1006], 1e-4);
    }

    #[test]
    fn white_stays_white_unless_it_is_the_light_of_another_white() {
        for space in [C::Srgb, C::DciP3, C::Rec2020, C::Aces2065] {
            close(space.reflectance_to_rec709([1.0; 3]), [1.0; 3], 1e-12);
        }
        close(C::DciP3.light_to_rec709([1.0; 3]), [1.0; 3], 1e-12);
        let warm = C::Aces2065.light_to_rec709([1.0; 3]);
        assert!(warm[0] > 1.02 && warm[2] < 0.95, "{warm:?}");
    }
}
