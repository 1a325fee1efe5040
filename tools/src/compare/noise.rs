//! The noise of the difference of two pictures, from what is known of either.

use super::variance::{Variance, VarianceKind};
use crate::metrics::{Noise, Space};

/// Least variance of one sample, as in Mitsuba's render tests: none that is measured is below it for good.
const FLOOR: f64 = 1e-4;

/// Samples of a mean whose number is not known, for the least variance only.
const MANY: f64 = 1e6;

/// What is known of the noise of one picture.
#[derive(Debug, Default)]
pub struct Known {
    pub variance: Option<Variance>,
    /// Samples of each pixel.
    pub samples: Option<f64>,
}

/// The noise of a difference.
#[derive(Debug)]
pub struct Difference {
    pub noise: Noise,
    /// Nothing is known of the noise of the image.
    pub image_is_exact: bool,
    /// Where the variances are from.
    pub note: String,
}

/// Variance of the means of a picture's pixels: that of a source, scaled.
struct OfMeans<'a> {
    source: &'a Variance,
    scale: f64,
    least: f64,
    /// The source is the other picture.
    borrowed: bool,
}

/// Variance of the difference of two pictures: the sum of the variances of their pixels' means. Without a variance
/// of its own, a picture is taken to be by the same renderer as the other one, so that the sample counts tell its
/// noise. `None` if neither noise is known.
pub fn of_difference(image: &Known, reference: &Known) -> Option<Difference> {
    let sides = [of_means(image, reference), of_means(reference, image)];
    let image_is_exact = sides[0].is_none();
    let known: Vec<&OfMeans<'_>> = sides.iter().flatten().collect();
    let space = common(known.iter().map(|side| side.source.space))?;
    let pixels = known.iter().map(|side| side.source.values.len()).min()?;
    let at = |i: usize| {
        let each = known.iter().map(|side| side.at(i, space));
        each.fold([0.0; 3], |sum, v| std::array::from_fn(|c| sum[c] + v[c]))
    };
    let noise = Noise { space, variance: (0..pixels).map(at).collect() };
    let names = ["image", "reference"];
    let from = names.iter().zip(&sides).map(|(name, side)| match side {
        Some(side) if side.borrowed => format!("of the {name} by its sample count"),
        Some(side) => format!("of the {name} from {}", side.source.from),
        None => format!("of the {name} taken as 0"),
    });
    let what = match space {
        Space::Rgb => "RGB",
        Space::Xyz => "XYZ",
        Space::Luminance => "luminance",
    };
    let note = format!("z-test of {what}: variance {}", from.collect::<Vec<_>>().join(", "));
    Some(Difference { noise, image_is_exact, note })
}

fn of_means<'a>(own: &'a Known, other: &'a Known) -> Option<OfMeans<'a>> {
    let least = FLOOR / own.samples.unwrap_or(MANY);
    let scaled = |source, scale, borrowed| OfMeans { source, scale, least, borrowed };
    if let Some(source) = &own.variance {
        return match source.kind {
            VarianceKind::OfMean => Some(scaled(source, 1.0, false)),
            VarianceKind::OfSample => {
                let n = own.samples? - source.lost;
                (n > 0.0).then(|| scaled(source, 1.0 / n, false))
            }
        };
    }
    let source = other.variance.as_ref()?;
    let scale = match source.kind {
        VarianceKind::OfMean => other.samples? / own.samples?,
        VarianceKind::OfSample => 1.0 / own.samples?,
    };
    Some(scaled(source, scale, true))
}

/// The space of all sources, or luminance.
fn common(mut spaces: impl Iterator<Item = Space>) -> Option<Space> {
    let first = spaces.next()?;
    Some(if spaces.all(|space| space == first) { first } else { Space::Luminance })
}

impl OfMeans<'_> {
    fn at(&self, pixel: usize, space: Space) -> [f64; 3] {
        let v = self.source.values[pixel].map(|v| (v * self.scale).max(self.least));
        match (self.source.space, space) {
            (Space::Xyz, Space::Luminance) => [v[1]; 3],
            // How the channels vary together is not known; no luminance varies more than if they do so fully.
            (Space::Rgb, Space::Luminance) => {
                let [r, g, b] = v.map(f64::sqrt);
                [(0.2126 * r + 0.7152 * g + 0.0722 * b).powi(2); 3]
            }
            _ => v,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn known(variance: Option<(f64, Space, VarianceKind)>, samples: Option<f64>) -> Known {
        let variance = variance.map(|(v, space, kind)| Variance {
            values: vec![[v; 3]],
            space,
            kind,
            lost: 0.0,
            from: "file".to_owned(),
        });
        Known { variance, samples }
    }

    /// Variance of the difference, and whether the image is taken as exact.
    fn variance(image: &Known, reference: &Known) -> Option<(f64, bool)> {
        let found = of_difference(image, reference)?;
        Some((found.noise.variance[0][0], found.image_is_exact))
    }

    #[test]
    fn either_picture_or_both_know_their_noise() {
        use Space::{Luminance, Rgb};
        use VarianceKind::{OfMean, OfSample};
        let nothing = known(None, None);
        let mean = |v| known(Some((v, Rgb, OfMean)), None);
        assert_eq!(variance(&nothing, &nothing), None);
        assert_eq!(variance(&mean(0.25), &mean(0.5)), Some((0.75, false)));
        assert_eq!(variance(&mean(0.25), &nothing), Some((0.25, false)));
        assert_eq!(variance(&nothing, &mean(0.5)), Some((0.5, true)));
        // A reference of 4 samples has a quarter of the variance of a sample, an image of 8 an eighth.
        let reference = known(Some((2.0, Rgb, OfSample)), Some(4.0));
        assert_eq!(variance(&known(None, Some(8.0)), &reference), Some((0.75, false)));
        assert_eq!(variance(&nothing, &reference), Some((0.5, true)));
        let image = known(Some((0.5, Luminance, OfMean)), Some(4.0));
        assert_eq!(variance(&image, &known(None, Some(16.0))), Some((0.625, false)));
        assert_eq!(variance(&image, &mean(0.25)).unwrap().1, false);
        // A sample's variance without a count says nothing.
        assert_eq!(variance(&known(Some((2.0, Rgb, OfSample)), None), &nothing), None);
    }

    #[test]
    fn spaces_meet_in_luminance() {
        let both = |space| {
            let image = known(Some((0.5, Space::Luminance, VarianceKind::OfMean)), None);
            of_difference(&image, &known(Some((0.25, space, VarianceKind::OfMean)), None)).unwrap().noise
        };
        for space in [Space::Rgb, Space::Xyz, Space::Luminance] {
            let noise = both(space);
            assert_eq!(noise.space, Space::Luminance);
            assert!((noise.variance[0][2] - 0.75).abs() < 1e-12, "{space:?}");
        }
    }
}
