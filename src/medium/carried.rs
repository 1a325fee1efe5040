//! What a path carries through media whose lanes differ.

use crate::math::{Color, LANES};

/// Weights of a path whose density differs from lane to lane.
///
/// A flight through a medium is drawn for one lane, chosen anew each time with probability `share`/3. The density of
/// the whole path is then the mean of the densities p of the lanes: the balance heuristic over lanes (Wilkie et al.
/// 2014; Miller, Georgiev and Jarosz 2019 for null collisions). Each lane's weight is f over that mean, and `share` is
/// p over it. Where all lanes are extinguished alike, nothing of this changes anything.
#[derive(Clone, Copy, Debug)]
pub struct Carried {
    /// Throughput or flux.
    pub weight: Color,
    /// Density of the path for each lane, over their mean.
    pub share: Color,
    /// Probability with which the path came as far as it did since this was set to 1: of passing, not of directions.
    pub reach: f32,
}

/// What happens to light on a straight way, and with what probability (for events at one place: density) a path that
/// is drawn for one lane takes that way. Factors common to both are left out.
#[derive(Clone, Copy, Debug)]
pub struct Passage {
    /// What is left of the light.
    pub left: Color,
    /// Density for each lane.
    pub density: Color,
}

impl Passage {
    /// Through nothing.
    pub const FREE: Self = Self { left: Color::ONE, density: Color::ONE };

    /// One after the other.
    #[must_use]
    #[inline(always)]
    pub fn then(self, next: Self) -> Self {
        Self { left: self.left * next.left, density: self.density * next.density }
    }
}

/// The mean of the lanes.
#[inline(always)]
pub(crate) fn mean(color: Color) -> f32 {
    color.sum_of_lanes() / LANES as f32
}

impl Carried {
    /// Before any medium.
    pub fn new(weight: Color) -> Self {
        Self { weight, share: Color::ONE, reach: 1.0 }
    }

    /// The lane that a flight is drawn for, by a uniform number.
    #[inline(always)]
    pub fn lane(&self, u: f32) -> usize {
        let [a, b, _] = self.share.lanes();
        let x = u * self.share.sum_of_lanes();
        usize::from(x >= a) + usize::from(x >= a + b)
    }

    /// Probability of the way for a path as this one.
    #[inline(always)]
    pub fn probability(&self, density: Color) -> f32 {
        mean(self.share * density)
    }

    /// The path takes the way. One that cannot be taken leaves nothing.
    #[inline(always)]
    pub fn take(&mut self, way: Passage) {
        let m = self.probability(way.density);
        if m > 0.0 && m.is_finite() {
            self.weight = self.weight * way.left / m;
            self.share = self.share * way.density / m;
            self.reach *= m;
        } else {
            self.weight = Color::ZERO;
        }
    }

    /// Whether there is light left to carry.
    #[inline(always)]
    pub fn alive(&self) -> bool {
        self.weight.max_element() > 0.0
    }
}
