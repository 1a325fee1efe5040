//! The exposures of HDR-FLIP, and tonemapping.

use crate::pixels::{Pixels, luminance};
use serde::{Deserialize, Serialize};

/// Tonemapping curves `(c0 x² + c1 x + c2) / (c3 x² + c4 x + c5)` (2021, §3.1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Tonemapper {
    /// Narkowicz's fit of ACES, with its pre-exposure of 0.6 cancelled.
    #[default]
    Aces,
    /// The curve of the game Uncharted 2, by Hable.
    Hable,
    /// x / (1 + x) on luminance.
    Reinhard,
}

impl Tonemapper {
    pub(super) fn coefficients(self) -> [f32; 6] {
        match self {
            Self::Aces => [0.36 * 2.51, 0.6 * 0.03, 0.0, 0.36 * 2.43, 0.6 * 0.59, 0.14],
            Self::Hable => [0.231683, 0.013791, 0.0, 0.18, 0.3, 0.018],
            Self::Reinhard => [0.0, 1.0, 0.0, 0.0, 1.0, 1.0],
        }
    }

    /// The largest `x` that the curve maps to `y`.
    fn inverse(self, y: f64) -> f64 {
        let c = self.coefficients().map(f64::from);
        let (a, b, d) = (c[0] - y * c[3], c[1] - y * c[4], c[2] - y * c[5]);
        if a == 0.0 {
            return -d / b;
        }
        let root = (b * b - 4.0 * a * d).max(0.0).sqrt();
        f64::max((-b + root) / (2.0 * a), (-b - root) / (2.0 * a))
    }

    /// Exposed linear radiance to display values in [0, 1].
    #[cfg(test)]
    fn apply(self, rgb: [f32; 3]) -> [f32; 3] {
        match self {
            Self::Reinhard => reinhard(rgb),
            Self::Aces | Self::Hable => rational(&self.coefficients(), rgb),
        }
    }
}

/// A tonemapping curve per channel.
#[inline(always)]
pub fn rational(c: &[f32; 6], [r, g, b]: [f32; 3]) -> [f32; 3] {
    let curve = |x: f32| {
        let y = (c[0] * x * x + c[1] * x + c[2]) / (c[3] * x * x + c[4] * x + c[5]);
        y.clamp(0.0, 1.0)
    };
    [curve(r), curve(g), curve(b)]
}

/// Reinhard's curve, which scales a colour by its luminance.
#[inline(always)]
pub fn reinhard(rgb: [f32; 3]) -> [f32; 3] {
    let scale = 1.0 / (1.0 + luminance(rgb));
    let [r, g, b] = rgb;
    [(r * scale).clamp(0.0, 1.0), (g * scale).clamp(0.0, 1.0), (b * scale).clamp(0.0, 1.0)]
}

/// Evenly spaced exposures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Exposures {
    /// The first, in stops.
    pub start: f64,
    /// The last, in stops.
    pub stop: f64,
    /// How many.
    pub count: usize,
}

impl Exposures {
    /// The range of the 2021 paper, §3.2: from the exposure at which the reference's largest luminance is
    /// tonemapped to 0.85, to the one at which its median is, in steps of about one stop. A black reference
    /// has the single exposure 0.
    pub fn automatic(reference: &Pixels, tonemapper: Tonemapper) -> Self {
        let mut values: Vec<f32> = reference.rgb.iter().map(|p| luminance(p.map(|v| v.max(0.0)))).collect();
        let max = values.iter().copied().fold(0.0, f32::max);
        if max <= 0.0 {
            return Self { start: 0.0, stop: 0.0, count: 1 };
        }
        let middle = values.len() / 2;
        let (_, &mut median, _) = values.select_nth_unstable_by(middle, f32::total_cmp);
        let white = tonemapper.inverse(0.85);
        let start = (white / f64::from(max)).log2();
        // The median of a picture that is mostly black is 0.
        let stop = (white / f64::from(median.max(f32::EPSILON))).log2().max(start);
        Self { start, stop, count: ((stop - start).ceil() as usize).max(2) }
    }

    /// The exposures in stops, first to last.
    pub fn values(&self) -> impl Iterator<Item = f64> + '_ {
        let step = (self.stop - self.start) / (self.count.max(2) - 1) as f64;
        (0..self.count).map(move |i| self.start + step * i as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_invert() {
        for t in [Tonemapper::Aces, Tonemapper::Hable, Tonemapper::Reinhard] {
            let x = t.inverse(0.85) as f32;
            let y = t.apply([x; 3]);
            assert!((y[0] - 0.85).abs() < 1e-5, "{t:?} {x} {y:?}");
        }
    }

    #[test]
    fn range_of_a_picture() {
        let p = Pixels::from_fn(4, 2, |x, y| [(1 << (x + 4 * y)) as f32; 3]);
        let e = Exposures::automatic(&p, Tonemapper::Aces);
        // Brightest 128, median (the upper of two) 16: three stops apart.
        assert!((e.stop - e.start - 3.0).abs() < 1e-5 && e.count <= 4, "{e:?}");
        assert_eq!(e.values().count(), e.count);
        let black = Pixels::from_fn(4, 2, |_, _| [0.0; 3]);
        assert_eq!(Exposures::automatic(&black, Tonemapper::Aces).values().collect::<Vec<_>>(), [0.0]);
    }
}
