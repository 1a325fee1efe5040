//! Values that are no finite numbers: counted by where they came from, and kept out of film and maps.

use serde::Serialize;

use super::layer::Layer;

/// Camera samples of one layer that were left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct RejectedLayer {
    /// Samples in which the layer was NaN.
    pub nan: u64,
    /// Samples in which the layer was infinite, or too large for the sum.
    pub infinite: u64,
}

/// What was left out, by cause.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Rejected {
    /// Of the emission layer.
    pub emission: RejectedLayer,
    /// Of the direct layer.
    pub direct: RejectedLayer,
    /// Of the caustic layer.
    pub caustic: RejectedLayer,
    /// Of the indirect layer.
    pub indirect: RejectedLayer,
    /// Of the medium layer.
    pub medium: RejectedLayer,
    /// Photons whose flux is no finite number.
    pub photon_flux: u64,
    /// Photons that landed nowhere finite.
    pub photon_place: u64,
}

impl Rejected {
    /// Counts a camera sample of which `layer` is NaN, or else infinite.
    pub fn sample(&mut self, layer: Layer, nan: bool) {
        let layer = match layer {
            Layer::Emission => &mut self.emission,
            Layer::Direct => &mut self.direct,
            Layer::Caustic => &mut self.caustic,
            Layer::Indirect => &mut self.indirect,
            Layer::Medium => &mut self.medium,
        };
        *(if nan { &mut layer.nan } else { &mut layer.infinite }) += 1;
    }

    /// Adds the counts of another part.
    pub fn add(&mut self, other: &Self) {
        for ((_, sum), (_, more)) in self.counts_mut().into_iter().zip(other.causes()) {
            *sum += more;
        }
    }

    /// Every cause with its count.
    pub fn causes(&self) -> [(&'static str, u64); 12] {
        let mut copy = *self;
        copy.counts_mut().map(|(name, count)| (name, *count))
    }

    /// All of them.
    pub fn total(&self) -> u64 {
        self.causes().iter().map(|(_, count)| count).sum()
    }

    fn counts_mut(&mut self) -> [(&'static str, &mut u64); 12] {
        [
            ("samples with emission that is NaN", &mut self.emission.nan),
            ("samples with infinite emission", &mut self.emission.infinite),
            ("samples with direct light that is NaN", &mut self.direct.nan),
            ("samples with infinite direct light", &mut self.direct.infinite),
            ("samples with a caustic that is NaN", &mut self.caustic.nan),
            ("samples with an infinite caustic", &mut self.caustic.infinite),
            ("samples with indirect light that is NaN", &mut self.indirect.nan),
            ("samples with infinite indirect light", &mut self.indirect.infinite),
            ("samples with light from a medium that is NaN", &mut self.medium.nan),
            ("samples with infinite light from a medium", &mut self.medium.infinite),
            ("photons whose flux is not finite", &mut self.photon_flux),
            ("photons at a place that is not finite", &mut self.photon_place),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::LAYERS;

    #[test]
    fn every_cause_is_counted_by_itself() {
        let mut all = Rejected { photon_flux: 11, photon_place: 12, ..Rejected::default() };
        for (i, (layer, _)) in LAYERS.into_iter().enumerate() {
            (0..=2 * i).for_each(|_| all.sample(layer, true));
            (0..=2 * i + 1).for_each(|_| all.sample(layer, false));
        }
        assert_eq!(all.causes().map(|(_, n)| n), [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]);
        let one = all;
        all.add(&one);
        assert_eq!(all.total(), 156);
    }
}
