//! How often light paths start at which lamp, and from which numbers.

use rayon::prelude::*;

use crate::math::Vec2;
use crate::sampling::{AXES, Bins, Discrete, Found, Grown};

/// What a lamp makes emission of: the place (two numbers) and the direction (two more) in [0, 1)⁴.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// Number of the lamp.
    pub lamp: usize,
    /// Place, then direction.
    pub at: [f32; AXES],
    /// Density of this choice over that of a choice by power and even numbers.
    pub density: f32,
}

impl Start {
    /// The numbers for the place.
    pub fn place(&self) -> Vec2 {
        Vec2::new(self.at[0], self.at[1])
    }

    /// The numbers for the direction.
    pub fn direction(&self) -> Vec2 {
        Vec2::new(self.at[2], self.at[3])
    }
}

/// A traced light path of lamp `lamp`.
#[derive(Clone, Copy, Debug)]
pub struct PathFound {
    /// Number of the lamp.
    pub lamp: usize,
    /// What it brought. Its weight is relative to a choice by power and even numbers.
    pub found: Found,
}

/// A learned density over the starts of light paths. A share of it follows power and even numbers, so that what pilots
/// missed is not lost, and no path carries more than 1/share times what it carries without.
#[derive(Clone, Debug)]
pub struct Starts {
    lamps: Discrete,
    /// By lamp; `None` where numbers are even.
    bins: Vec<Option<Bins>>,
}

impl Starts {
    /// From traced paths, for lamps that are otherwise chosen by `power`; the share `even` follows power and even
    /// numbers. `None` if no path brought anything.
    pub fn learn(power: &Discrete, paths: &[PathFound], even: f64) -> Option<Self> {
        let mut of: Vec<Vec<Found>> = vec![Vec::new(); power.len()];
        for path in paths {
            of[path.lamp].push(path.found);
        }
        let grown: Vec<Option<Grown>> = of
            .into_par_iter()
            .map(|found| found.iter().any(|f| f.value > 0.0).then(|| Grown::new(&found)))
            .collect();
        let by_power = |i: usize| f64::from(power.probability(i));
        let mass = |i: usize| grown[i].as_ref().map_or(0.0, Grown::mass) * by_power(i).sqrt();
        let masses: Vec<f64> = (0..power.len()).map(mass).collect();
        let total: f64 = masses.iter().sum();
        if !(total > 0.0 && total.is_finite()) {
            return None;
        }
        let learned = |i: usize| (1.0 - even) * masses[i] / total;
        let lamps = Discrete::new((0..power.len()).map(|i| learned(i) + even * by_power(i)));
        let close = |(i, grown): (usize, Option<Grown>)| {
            let own = even * by_power(i);
            grown.map(|grown| grown.close(own / (own + learned(i))))
        };
        let bins = grown.into_iter().enumerate().map(close).collect();
        Some(Self { lamps, bins })
    }

    /// By lamp, how many times as many paths it gets as by `power`.
    pub fn times(&self, power: &Discrete) -> Vec<(usize, f32)> {
        let times = |i: usize| self.lamps.probability(i) / power.probability(i);
        (0..power.len()).filter(|&i| power.probability(i) > 0.0).map(|i| (i, times(i))).collect()
    }

    /// The start that uniform numbers select.
    #[inline]
    pub fn sample(&self, power: &Discrete, pick: f32, place: Vec2, direction: Vec2) -> Start {
        let (lamp, _) = self.lamps.sample(pick);
        let u = [place.x, place.y, direction.x, direction.y];
        let (at, density) = self.bins[lamp].as_ref().map_or((u, 1.0), |bins| bins.sample(u));
        Start { lamp, at, density: density * self.lamps.probability(lamp) / power.probability(lamp) }
    }

    /// [`Start::density`] of a lamp and numbers.
    pub fn density(&self, power: &Discrete, lamp: usize, at: [f32; AXES]) -> f32 {
        let inner = self.bins[lamp].as_ref().map_or(1.0, |bins| bins.density(at));
        inner * self.lamps.probability(lamp) / power.probability(lamp)
    }
}
