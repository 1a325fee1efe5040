use super::sum;
use crate::pixels::Pixels;
use rayon::prelude::*;
use serde::Serialize;

/// Added to the squared reference in relMSE (Rousselle et al. 2011, "Adaptive sampling and
/// reconstruction using greedy error minimization", §5).
const RELMSE_EPSILON: f64 = 0.01;
/// Added to the reference's magnitude in MAPE.
const MAPE_EPSILON: f64 = 0.01;
/// Share of the pixels, those with the largest errors, that trimmed relMSE leaves out.
const TRIM: f64 = 0.001;

/// Per-pixel errors, averaged over all pixels and channels.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Errors {
    /// `√mean((x − ref)²)` per channel (R, G, B).
    pub rmse: [f64; 3],
    /// The same over all channels.
    pub rmse_all: f64,
    /// `mean((x − ref)² / (ref² + 0.01))` over pixels and channels.
    pub relmse: f64,
    /// relMSE without the 0.1 % of the pixels (rounded down) with the largest mean over the channels: the
    /// error without fireflies.
    pub relmse_trimmed: f64,
    /// `mean(|x − ref| / (|ref| + 0.01))`.
    pub mape: f64,
    /// `10 log10(peak² / MSE)` in dB over all channels; `None` for equal images.
    pub psnr: Option<f64>,
    /// The peak used for `psnr`.
    pub psnr_peak: f64,
}

/// Errors of `image` against `reference`, which has the same size; `peak` is the signal of PSNR.
pub fn errors(image: &Pixels, reference: &Pixels, peak: f64) -> Errors {
    let n = image.rgb.len().max(1) as f64;
    let s = sum(image, reference, |x, r| {
        let mut out = [0.0; 5];
        for c in 0..3 {
            let (x, r) = (f64::from(x[c]), f64::from(r[c]));
            let d = x - r;
            out[c] = d * d;
            out[3] += d * d / (r * r + RELMSE_EPSILON);
            out[4] += d.abs() / (r.abs() + MAPE_EPSILON);
        }
        out
    });
    let mse = (s[0] + s[1] + s[2]) / (3.0 * n);
    Errors {
        rmse: [(s[0] / n).sqrt(), (s[1] / n).sqrt(), (s[2] / n).sqrt()],
        rmse_all: mse.sqrt(),
        relmse: s[3] / (3.0 * n),
        relmse_trimmed: trimmed_relmse(image, reference),
        mape: s[4] / (3.0 * n),
        psnr: (mse > 0.0).then(|| 10.0 * (peak * peak / mse).log10()),
        psnr_peak: peak,
    }
}

/// `rmse_all` and `relmse` of [`Errors`], in a fraction of the time of all.
pub fn main_errors(image: &Pixels, reference: &Pixels) -> [f64; 2] {
    let n = image.rgb.len().max(1) as f64;
    let s = sum(image, reference, |x, r| {
        let mut out = [0.0; 4];
        for c in 0..3 {
            let (x, r) = (f64::from(x[c]), f64::from(r[c]));
            let square = (x - r) * (x - r);
            out[c] = square;
            out[3] += square / (r * r + RELMSE_EPSILON);
        }
        out
    });
    [((s[0] + s[1] + s[2]) / (3.0 * n)).sqrt(), s[3] / (3.0 * n)]
}

fn trimmed_relmse(image: &Pixels, reference: &Pixels) -> f64 {
    // f64: the square of an f32 may overflow f32.
    let mut values: Vec<f64> = image
        .rgb
        .par_iter()
        .zip(&reference.rgb)
        .map(|(x, r)| {
            let mut v = 0.0;
            for c in 0..3 {
                let (x, r) = (f64::from(x[c]), f64::from(r[c]));
                v += (x - r) * (x - r) / (r * r + RELMSE_EPSILON);
            }
            v / 3.0
        })
        .collect();
    let dropped = (values.len() as f64 * TRIM) as usize;
    let kept = values.len() - dropped;
    if kept == 0 {
        return 0.0;
    }
    values.select_nth_unstable_by(kept - 1, f64::total_cmp);
    let partial: Vec<f64> = values[..kept].par_chunks(super::CHUNK).map(|chunk| chunk.iter().sum()).collect();
    partial.iter().sum::<f64>() / kept as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn definitions() {
        let r = Pixels::from_fn(40, 50, |_, _| [0.0, 1.0, 2.0]);
        let i = Pixels::from_fn(40, 50, |_, _| [0.1, 1.0, 2.4]);
        let e = errors(&i, &r, 1.0);
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-6 * b.abs().max(1.0), "{a} {b}");
        assert_eq!(main_errors(&i, &r), [e.rmse_all, e.relmse]);
        close(e.rmse[0], 0.1);
        close(e.rmse[1], 0.0);
        close(e.rmse[2], 0.4);
        close(e.rmse_all, (0.17f64 / 3.0).sqrt());
        close(e.relmse, (0.01 / 0.01 + 0.16 / 4.01) / 3.0);
        close(e.relmse_trimmed, e.relmse);
        close(e.mape, (0.1 / 0.01 + 0.4 / 2.01) / 3.0);
        close(e.psnr.unwrap(), -10.0 * (0.17f64 / 3.0).log10());
    }

    #[test]
    fn trimming_drops_a_firefly_in_a_thousand_pixels() {
        let r = Pixels::from_fn(100, 10, |_, _| [1.0; 3]);
        let mut i = Pixels::from_fn(100, 10, |_, _| [1.1; 3]);
        i.rgb[17] = [1e6; 3];
        let e = errors(&i, &r, 1.0);
        assert!(e.relmse > 1e8);
        assert!((e.relmse_trimmed - 0.01 / 1.01).abs() < 1e-7, "{}", e.relmse_trimmed);
        i.rgb.fill([1e38; 3]);
        assert!(errors(&i, &r, 1.0).relmse_trimmed > 9e75, "its square is beyond single precision");
    }

    #[test]
    fn equal_images_have_no_error_and_no_psnr() {
        let r = Pixels::from_fn(9, 9, |x, y| [x as f32, y as f32, 1.0]);
        let e = errors(&r, &r, 1.0);
        assert_eq!((e.rmse_all, e.relmse, e.mape, e.psnr), (0.0, 0.0, 0.0, None));
    }

    #[test]
    fn the_number_of_threads_changes_nothing() {
        let r = Pixels::from_fn(301, 307, |x, y| [(x * y % 97) as f32 * 0.1, x as f32, 0.3]);
        let i = Pixels::from_fn(301, 307, |x, y| [(x * y % 89) as f32 * 0.1, y as f32, 0.7]);
        let on = |n| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
            pool.install(|| errors(&i, &r, 1.0))
        };
        assert_eq!(on(1), on(4));
    }
}
