//! White balance: makes a scene lit by daylight of a given temperature look as if lit by D65.

use super::convert::xyz_to_rgb;
use super::integrate::rgb_to_xyz_of_white;

type Matrix = [[f64; 3]; 3];

/// Bradford's cone responses to XYZ, and back.
const CONES: Matrix = [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];
const FROM_CONES: Matrix = [
    [0.986_992_9, -0.147_054_3, 0.159_962_7],
    [0.432_305_3, 0.518_360_3, 0.049_291_2],
    [-0.008_528_7, 0.040_042_8, 0.968_486_7],
];

/// XYZ of linear Rec.709.
const XYZ: Matrix =
    [[0.412_453, 0.357_580, 0.180_423], [0.212_671, 0.715_160, 0.072_169], [0.019_334, 0.119_193, 0.950_227]];

/// Rows of the matrix for linear Rec.709 by which daylight of `kelvin` (CIE D, 4000 to 25000; its formula serves below
/// as in pbrt) becomes white: each cone's response times a factor (von Kries), as pbrt's `PixelSensor` does.
pub fn white_balance(kelvin: f64) -> Matrix {
    let [source, white] = [daylight(kelvin), rgb_to_xyz_of_white()].map(|xyz| apply(&CONES, xyz));
    let image = |rgb: [f64; 3]| {
        let cones = apply(&CONES, apply(&XYZ, rgb));
        let balanced = std::array::from_fn(|i| cones[i] * white[i] / source[i]);
        xyz_to_rgb(apply(&FROM_CONES, balanced))
    };
    let columns = [image([1.0, 0.0, 0.0]), image([0.0, 1.0, 0.0]), image([0.0, 0.0, 1.0])];
    std::array::from_fn(|row| columns.map(|column| column[row]))
}

/// XYZ of the CIE's daylight with luminance 1.
fn daylight(kelvin: f64) -> [f64; 3] {
    // Planck's second constant was changed since the CIE named the temperatures.
    let t = kelvin * 1.4388 / 1.4380;
    let x = if t <= 7000.0 {
        -4.6070e9 / t.powi(3) + 2.9678e6 / t.powi(2) + 0.09911e3 / t + 0.244_063
    } else {
        -2.0064e9 / t.powi(3) + 1.9018e6 / t.powi(2) + 0.24748e3 / t + 0.237_040
    };
    let y = -3.0 * x * x + 2.870 * x - 0.275;
    [x / y, 1.0, (1.0 - x - y) / y]
}

fn apply(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The light itself becomes gray of its own luminance, and D65 stays as it is.
    #[test]
    fn what_is_balanced_becomes_white() {
        for kelvin in [2800.0, 4000.0, 5000.0, 6500.0, 10000.0] {
            let balanced = apply(&white_balance(kelvin), xyz_to_rgb(daylight(kelvin)));
            assert!(balanced.iter().all(|c| (c - 1.0).abs() < 2e-5), "{kelvin} K: {balanced:?}");
        }
        let identity = white_balance(6500.0);
        for (row, values) in identity.iter().enumerate() {
            for (column, value) in values.iter().enumerate() {
                let wanted = f64::from(u8::from(row == column));
                // 6500 K is D65 to three digits of x and y.
                assert!((value - wanted).abs() < 3e-3, "{identity:?}");
            }
        }
    }
}
