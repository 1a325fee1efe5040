//! The Gaussian, the error function and its inverse, in single precision.

/// exp(−x²) from x², at least 10⁻³⁵: numbers that underflow take several times as long.
#[inline]
pub fn gauss(squared: f32) -> f32 {
    (-squared.min(80.0)).exp()
}

/// erf to 1.5e-7 (Abramowitz and Stegun 7.1.26).
pub fn erf(x: f32) -> f32 {
    let t = 1.0 / (1.0 + 0.327_591_1 * x.abs());
    let poly =
        t * (0.254_829_6 + t * (-0.284_496_74 + t * (1.421_413_7 + t * (-1.453_152 + t * 1.061_405_4))));
    (1.0 - poly * gauss(x * x)).copysign(x)
}

/// Inverse of erf on (−1, 1) (Giles 2012, single precision).
pub fn erf_inv(x: f32) -> f32 {
    let x = x.clamp(-0.999_999_9, 0.999_999_9);
    let w = -((1.0 - x) * (1.0 + x)).ln();
    let horner = |w: f32, c: [f32; 9]| c.iter().fold(0.0, |p, c| p * w + c);
    let p = if w < 5.0 {
        horner(
            w - 2.5,
            [
                2.810_226_4e-8,
                3.432_739_4e-7,
                -3.523_387_7e-6,
                -4.391_506_5e-6,
                0.000_218_580_87,
                -0.001_253_725,
                -0.004_177_681_6,
                0.246_640_73,
                1.501_409_4,
            ],
        )
    } else {
        horner(
            w.sqrt() - 3.0,
            [
                -0.000_200_214_26,
                0.000_100_950_56,
                0.001_349_343_2,
                -0.003_673_428_4,
                0.005_739_507_7,
                -0.007_622_461_3,
                0.009_438_870_5,
                1.001_674_1,
                2.832_976_8,
            ],
        )
    };
    p * x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_function_and_its_inverse_undo_each_other() {
        for i in -29..30 {
            let x = i as f32 * 0.1;
            // Near ±1 erf is flat: a rounding of 6e-8 there is 6e-8/(2/√π·e^(−x²)) in x.
            let flat = (x * x).exp() * 3e-7;
            assert!((erf_inv(erf(x)) - x).abs() < 2e-6 + flat, "{x}");
        }
        assert!((erf(0.5) - 0.520_499_9).abs() < 2e-7);
    }
}
