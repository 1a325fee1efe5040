//! The published numbers of Hošek and Wilkie's models, see `README.md` beside this file.

use std::sync::LazyLock;

const TURBIDITIES: usize = 10;
/// The wavelengths of the sun's data, 360 to 720 nm.
pub(super) const WAVELENGTHS: usize = 10;
/// Heights of the sun at which its irradiance is known: 2° to 89°.
const HEIGHTS: usize = 30;
/// Pieces of the curves of the sun's radiance over height.
const SEGMENTS: usize = 45;
/// Coefficients of the limb's darkening.
pub(super) const LIMB: usize = 6;
/// Control points of the sky's curves over height.
const CONTROL: usize = 6;
/// Parameters of the sky's distribution.
pub(super) const PARAMETERS: usize = 9;
const CHANNELS: usize = 3;
const ALBEDOS: usize = 2;

/// The numbers, in the order of the file.
struct Data {
    /// By turbidity, albedo, control point, channel, parameter.
    sky: Vec<f64>,
    /// By turbidity, albedo, control point, channel.
    sky_radiance: Vec<f64>,
    /// By turbidity, segment, wavelength, power.
    sun: Vec<f64>,
    /// By wavelength, power.
    limb: Vec<f64>,
    /// By turbidity, height, wavelength.
    irradiance: Vec<f64>,
}

static DATA: LazyLock<Data> = LazyLock::new(|| {
    let bytes = include_bytes!("hosek-wilkie.bin");
    let mut numbers = bytes.chunks_exact(4).map(|b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])));
    let mut take = |count: usize| -> Vec<f64> { numbers.by_ref().take(count).collect() };
    Data {
        sky: take(TURBIDITIES * ALBEDOS * CONTROL * CHANNELS * PARAMETERS),
        sky_radiance: take(TURBIDITIES * ALBEDOS * CONTROL * CHANNELS),
        sun: take(TURBIDITIES * SEGMENTS * WAVELENGTHS * 4),
        limb: take(WAVELENGTHS * LIMB),
        irradiance: take(TURBIDITIES * HEIGHTS * WAVELENGTHS),
    }
});

/// The two rows between which `x` lies, of `count`, and the share of the second.
fn between(x: f64, count: usize) -> (usize, usize, f64) {
    let x = x.clamp(0.0, (count - 1) as f64);
    let low = x as usize;
    (low, (low + 1).min(count - 1), x - low as f64)
}

fn mix(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

/// The sky of one channel: the parameters of its distribution, and the factor on it.
pub(super) fn sky(channel: usize, turbidity: f64, albedo: f64, height: f64) -> ([f64; PARAMETERS], f64) {
    let (hazy, hazier, share) = between(turbidity - 1.0, TURBIDITIES);
    // Bernstein polynomials of the fifth degree in the cube root of the height.
    let x = (height.max(0.0) / std::f64::consts::FRAC_PI_2).cbrt().min(1.0);
    let weights: [f64; CONTROL] = std::array::from_fn(|i| {
        [1.0, 5.0, 10.0, 10.0, 5.0, 1.0][i] * x.powi(i as i32) * (1.0 - x).powi((CONTROL - 1 - i) as i32)
    });
    let curve = |data: &[f64], per_channel: usize, k: usize| {
        let at = |turbidity: usize, albedo: usize, control: usize| {
            let row = (turbidity * ALBEDOS + albedo) * CONTROL + control;
            data[(row * CHANNELS + channel) * per_channel + k]
        };
        let ground = |albedo: usize, i: usize| mix(at(hazy, albedo, i), at(hazier, albedo, i), share);
        (0..CONTROL).map(|i| weights[i] * mix(ground(0, i), ground(1, i), albedo)).sum()
    };
    (std::array::from_fn(|k| curve(&DATA.sky, PARAMETERS, k)), curve(&DATA.sky_radiance, 1, 0))
}

/// Irradiance of the sun on a plane that faces it, by wavelength, as Mitsuba 3 looks it up: linear between heights of
/// 3° distance, and that of 2° below.
pub(super) fn irradiance(turbidity: f64, height: f64) -> [f64; WAVELENGTHS] {
    let (hazy, hazier, share) = between(turbidity - 1.0, TURBIDITIES);
    let (low, high, up) = between((height.to_degrees() - 2.0) / 3.0, HEIGHTS);
    let at = |t: usize, h: usize, l: usize| DATA.irradiance[(t * HEIGHTS + h) * WAVELENGTHS + l];
    std::array::from_fn(|l| {
        mix(
            mix(at(hazy, low, l), at(hazier, low, l), share),
            mix(at(hazy, high, l), at(hazier, high, l), share),
            up,
        )
    })
}

/// Radiance of the middle of the sun seen at `height`, by wavelength.
pub(super) fn radiance(turbidity: f64, height: f64) -> [f64; WAVELENGTHS] {
    use std::f64::consts::FRAC_PI_2;
    let (hazy, hazier, share) = between(turbidity - 1.0, TURBIDITIES);
    let height = height.max(0.0);
    let segment = (((height / FRAC_PI_2).cbrt() * SEGMENTS as f64) as usize).min(SEGMENTS - 1);
    let x = height - FRAC_PI_2 * (segment as f64 / SEGMENTS as f64).powi(3);
    let cubic = |t: usize, l: usize| {
        let first = ((t * SEGMENTS + segment) * WAVELENGTHS + l) * 4;
        DATA.sun[first..first + 4].iter().rev().fold(0.0, |sum, c| sum * x + c)
    };
    std::array::from_fn(|l| mix(cubic(hazy, l), cubic(hazier, l), share))
}

/// The share of the radiance of the sun's middle that is left where the cosine between its surface and the view is
/// `cosine`, by wavelength.
pub(super) fn darkening(cosine: f64) -> [f64; WAVELENGTHS] {
    std::array::from_fn(|l| DATA.limb[l * LIMB..][..LIMB].iter().rev().fold(0.0, |sum, c| sum * cosine + c))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_holds_all_numbers_and_no_more() {
        let data = &*DATA;
        let read = [&data.sky, &data.sky_radiance, &data.sun, &data.limb, &data.irradiance];
        let count: usize = read.iter().map(|list| list.len()).sum();
        assert_eq!(count, 3240 + 360 + 18_000 + 60 + 3000);
        assert_eq!(include_bytes!("hosek-wilkie.bin").len(), 4 * count);
        assert!(read.iter().all(|list| list.iter().all(|v| v.is_finite())));
        // Of the middle nothing is missing, as far as the polynomials fit: worst at 360 nm.
        assert!(darkening(1.0).iter().all(|v| (v - 1.0).abs() < 2e-3), "{:?}", darkening(1.0));
    }

    /// The curves of the radiance meet where the pieces do: by 0.1 % above 5°, where they are steep by 1 %.
    #[test]
    fn the_sun_rises_without_jumps() {
        for turbidity in [1.0, 3.4, 10.0] {
            for k in 18..SEGMENTS {
                let height = std::f64::consts::FRAC_PI_2 * (k as f64 / SEGMENTS as f64).powi(3);
                let [below, above] = [height - 1e-9, height + 1e-9].map(|h| radiance(turbidity, h));
                for (a, b) in below.into_iter().zip(above) {
                    assert!((a - b).abs() <= 0.01 * b.abs().max(1.0), "{turbidity} {k}: {a} {b}");
                }
            }
        }
    }
}
