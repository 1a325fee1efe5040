//! Which lamp lights a point most: the choice of next event estimation.
//!
//! Of few lamps, a sample of each is compared (`integrator::direct`); where that is not done, the choice is the same
//! everywhere. Of many lamps, most are far away, so the scene is divided into cells, each with a distribution of its
//! own: by the irradiance that a lamp would bring to the cell were nothing in its way (power over squared distance),
//! mixed with the choice of the whole scene, because things are in the way.

use crate::emitter::{Emitter, SceneSphere};
use crate::math::{Vec2, Vec3};
use crate::sampling::Discrete;

/// Of the choice among few lamps, the share that is even where some are hidden.
const DOUBT: f32 = 0.2;

/// Lamps of which a larger share of the light arrives count as seen everywhere.
const SEEN: f32 = 0.95;

/// Entries of all cells together.
const ENTRIES: usize = 1 << 20;

/// Most cells along an axis.
const MOST: usize = 16;

/// Share of the scene's choice in that of each cell.
const EVEN: f64 = 0.2;

/// Probabilities of lamps for direct light.
#[derive(Debug)]
pub struct LampChoice {
    whole: Discrete,
    cells: Option<Cells>,
    few: bool,
    arriving: [f32; LampChoice::FEW],
    even: f32,
}

/// Distributions on a grid over the sphere around the scene.
#[derive(Debug)]
struct Cells {
    low: Vec3,
    /// Cells in a unit of length.
    scale: f32,
    side: usize,
    lamps: usize,
    /// By cell, the sum of the probabilities up to each lamp; single precision because there are many.
    sums: Vec<f32>,
}

impl LampChoice {
    /// Up to so many lamps are compared, and chosen alike everywhere else.
    pub const FEW: usize = 8;

    /// For lamps of so much power each. `whole` is the choice where place does not matter.
    pub fn new(whole: Discrete, emitters: &[Emitter], power: &[f64], sphere: &SceneSphere) -> Self {
        let side = ((ENTRIES / emitters.len().max(1)) as f64).cbrt() as usize;
        let many = emitters.len() > Self::FEW && side > 1 && sphere.radius > 0.0 && sphere.radius.is_finite();
        let cells = many.then(|| Cells::new(&whole, emitters, power, sphere, side.min(MOST)));
        Self {
            whole,
            cells,
            few: (2..=Self::FEW).contains(&emitters.len()),
            arriving: [1.0; Self::FEW],
            even: 0.0,
        }
    }

    /// There are several lamps, so few that a sample of each can be looked at.
    #[inline]
    pub fn few(&self) -> bool {
        self.few
    }

    /// Of the light that each of a few lamps would bring where the camera looks were nothing in its way, the shares that
    /// arrive.
    pub fn set_arriving(&mut self, shares: [f32; Self::FEW]) {
        self.arriving = shares;
        let hidden = shares.iter().any(|share| *share < SEEN);
        self.even = if hidden { DOUBT } else { 0.0 };
    }

    /// See [`LampChoice::set_arriving`]; 1 for all where nobody has looked.
    #[inline]
    pub fn arriving(&self, lamp: usize) -> f32 {
        self.arriving[lamp]
    }

    /// Share of the choice among a few lamps that makes no difference between them, since a lamp may be hidden in one place
    /// and not in another; 0 where all are seen.
    #[inline]
    pub fn even(&self) -> f32 {
        self.even
    }

    /// What multiple importance sampling counts of a lamp's own density at `p`: the probability of the lamp; all of it
    /// where few lamps are compared, since each of them is sampled then.
    #[inline]
    pub fn counted(&self, p: Vec3, lamp: usize) -> f32 {
        if self.few { 1.0 } else { self.probability(p, lamp) }
    }

    /// The lamp that `u` in [0, 1) selects at `p`.
    #[inline]
    pub fn sample(&self, p: Vec3, u: f32) -> usize {
        match &self.cells {
            None => self.whole.sample(u).0,
            Some(cells) => {
                let sums = cells.at(p);
                sums.partition_point(|&sum| sum <= u).min(sums.len() - 1)
            }
        }
    }

    /// The same for a point that is not known yet.
    #[inline]
    pub fn sample_anywhere(&self, u: f32) -> usize {
        self.whole.sample(u).0
    }

    /// Probability of a lamp at `p`.
    #[inline]
    pub fn probability(&self, p: Vec3, lamp: usize) -> f32 {
        match &self.cells {
            None => self.whole.probability(lamp),
            Some(cells) => {
                let sums = cells.at(p);
                sums[lamp] - if lamp > 0 { sums[lamp - 1] } else { 0.0 }
            }
        }
    }
}

impl Cells {
    fn new(whole: &Discrete, emitters: &[Emitter], power: &[f64], sphere: &SceneSphere, side: usize) -> Self {
        let size = 2.0 * sphere.radius / side as f32;
        let low = sphere.center - Vec3::splat(sphere.radius);
        let lamps: Vec<_> =
            emitters.iter().zip(power).map(|(e, power)| Lamp::new(e, *power, sphere)).collect();
        let mut sums = Vec::with_capacity(side.pow(3) * lamps.len());
        for cell in 0..side.pow(3) {
            let at = [cell % side, cell / side % side, cell / (side * side)].map(|i| i as f32 + 0.5);
            let centre = low + Vec3::from(at) * size;
            // Nearer than a cell is wide, what is nearest depends on the place within the cell.
            let weights: Vec<f64> = lamps.iter().map(|lamp| lamp.irradiance(centre, size)).collect();
            let total: f64 = weights.iter().sum();
            let mut sum = 0.0;
            sums.extend(weights.iter().enumerate().map(|(i, weight)| {
                let near = if total > 0.0 { weight / total } else { f64::from(whole.probability(i)) };
                sum += EVEN * f64::from(whole.probability(i)) + (1.0 - EVEN) * near;
                sum as f32
            }));
            // The last lamp takes what rounding leaves.
            let last = sums.len() - 1;
            sums[last] = 1.0;
        }
        Self { low, scale: 1.0 / size, side, lamps: lamps.len(), sums }
    }

    /// The sums of the cell around `p`, or of the nearest cell.
    #[inline]
    fn at(&self, p: Vec3) -> &[f32] {
        let at = (p - self.low) * self.scale;
        // The casts saturate, and make 0 of NaN.
        let [x, y, z] = at.to_array().map(|v| (v as usize).min(self.side - 1));
        let cell = (z * self.side + y) * self.side + x;
        &self.sums[cell * self.lamps..(cell + 1) * self.lamps]
    }
}

/// What of a lamp matters for the choice.
struct Lamp {
    power: f64,
    /// `None` where it is infinitely far.
    place: Option<Vec3>,
    area: f32,
    /// Of the disk that the scene shows to light from infinity.
    disk: f32,
}

impl Lamp {
    fn new(emitter: &Emitter, power: f64, sphere: &SceneSphere) -> Self {
        let place = emitter.place(Vec2::splat(0.5)).filter(|p| p.is_finite());
        Self { power, place, area: emitter.visible_area(), disk: sphere.disk() }
    }

    /// Irradiance at `p`, about; of what is nearer than `least` as if it were there.
    fn irradiance(&self, p: Vec3, least: f32) -> f64 {
        let Some(place) = self.place else { return self.power / f64::from(self.disk) };
        let square = place.distance_squared(p).max(least * least).max(self.area);
        self.power / (4.0 * std::f64::consts::PI * f64::from(square))
    }
}
