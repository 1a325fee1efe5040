use super::sum;
use crate::pixels::Pixels;
use serde::Serialize;

/// Difference of the means of two images: the error that remains when noise averages out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bias {
    /// Mean of the image per channel (R, G, B).
    pub image_mean: [f64; 3],
    /// Mean of the reference per channel.
    pub reference_mean: [f64; 3],
    /// `image_mean − reference_mean`.
    pub absolute: [f64; 3],
    /// `absolute / |reference_mean|`; the same as `absolute` where the reference's mean is 0.
    pub relative: [f64; 3],
    /// Mean of `absolute` over the channels.
    pub absolute_all: f64,
    /// `absolute_all` over the mean of all channels of the reference.
    pub relative_all: f64,
}

impl Bias {
    /// Largest magnitude of the relative bias over the channels.
    pub fn worst(&self) -> f64 {
        self.relative.iter().fold(0.0, |m, v| m.max(v.abs()))
    }
}

/// Bias of `image` against `reference`; both have the same size.
pub fn bias(image: &Pixels, reference: &Pixels) -> Bias {
    let n = image.rgb.len().max(1) as f64;
    let s = sum(image, reference, |x, r| [x[0], x[1], x[2], r[0], r[1], r[2]].map(f64::from));
    let image_mean = [s[0] / n, s[1] / n, s[2] / n];
    let reference_mean = [s[3] / n, s[4] / n, s[5] / n];
    let absolute: [f64; 3] = std::array::from_fn(|c| image_mean[c] - reference_mean[c]);
    let absolute_all = absolute.iter().sum::<f64>() / 3.0;
    Bias {
        image_mean,
        reference_mean,
        absolute,
        relative: std::array::from_fn(|c| relative(absolute[c], reference_mean[c])),
        absolute_all,
        relative_all: relative(absolute_all, reference_mean.iter().sum::<f64>() / 3.0),
    }
}

fn relative(difference: f64, mean: f64) -> f64 {
    if mean == 0.0 { difference } else { difference / mean.abs() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_and_their_difference() {
        let r = Pixels::from_fn(300, 200, |x, _| [x as f32, 2.0, 0.0]);
        let i = Pixels::from_fn(300, 200, |x, _| [x as f32 * 1.5, 1.0, 0.0]);
        let b = bias(&i, &r);
        assert_eq!(b.reference_mean, [149.5, 2.0, 0.0]);
        assert_eq!(b.absolute, [74.75, -1.0, 0.0]);
        assert_eq!(b.relative, [0.5, -0.5, 0.0]);
        assert_eq!(b.worst(), 0.5);
    }
}
