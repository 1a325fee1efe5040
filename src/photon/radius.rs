//! Search radii: the first from the measured density of photons, the later by a fixed schedule.

use super::store::{PhotonMap, Query};
use super::stored::Stored;
use crate::emitter::SceneSphere;
use crate::math::Vec3;

/// A place where the density is measured.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// In the world.
    pub p: Vec3,
    /// Unit normal of the side.
    pub n: Vec3,
    /// Rounding of positions there.
    pub lift: f32,
    /// Size of a pixel there, 0 where unknown.
    pub footprint: f32,
}

/// Photons that a lookup of the first pass should find: with fewer the error grows fast, with more
/// slowly (measured: 2.4 are four times worse, 100 slightly).
pub const FOR_SIGHT: usize = 25;

/// The same for a map of `stored` caustic photons. Variance goes with 1/(n·r²) and the square of bias with r⁴, so that the
/// radius of least error goes with n^(−1/6) (Silverman 1986) and the photons in it with n^(2/3): [`FOR_SIGHT`] at
/// 2000 photons.
pub fn for_caustics(stored: usize) -> usize {
    let times = (stored as f32 / 2000.0).powf(2.0 / 3.0);
    ((FOR_SIGHT as f32 * times) as usize).clamp(8, 200)
}

/// The same for irradiance that is read at the second rough surface: its blur is hardly seen, its noise is, since all
/// camera paths of a pass share it (measured on four rooms: with 25 an error twice as large, with 300 no smaller).
pub const FOR_GATHERING: usize = 100;

/// Most places that are measured.
pub const PLACES: usize = 1024;

/// Largest first radius, in pixels: a wider blur hides what is seen, whatever the density, and where
/// light falls off towards a corner a wide disc is too bright for long (with 16 pixels 1.1 % of a whole
/// picture of an indirectly lit room after 600 passes, with 8 less than half of it after 150).
const MOST_PIXELS: f32 = 8.0;

/// No radius falls below this: a smaller square, or its inverse, leaves the range of f32.
pub const LEAST: f32 = 1e-18;

/// Radius within which a `share` of the places find `wanted` photons or more. The search goes up to
/// a tenth of `scene_radius`, that of the bounding sphere; larger radii are extrapolated from the photons within it.
pub fn measured(photons: &Stored, places: &[Place], wanted: usize, share: f32, scene_radius: f32) -> f32 {
    let most = largest(scene_radius);
    // As wide a disc holds an n-th as many of every n-th photon.
    let step = (photons.len() / MEASURED).clamp(1, (wanted / FEWEST).max(1));
    let wanted = wanted / step;
    let map = PhotonMap::build_for_nearest(photons.every(step), wanted, most);
    let mut found = Vec::new();
    let mut hint = 0.0;
    let mut distances: Vec<f32> = places
        .iter()
        .map(|at| {
            map.nearest(
                &Query { p: at.p, n: at.n, lift: at.lift, radius: most },
                wanted,
                &mut hint,
                &mut found,
            );
            if found.len() < wanted {
                // Half a photon where there is none.
                most * (wanted as f32 / (found.len() as f32).max(0.5)).sqrt()
            } else {
                found.iter().map(|f| f.0).fold(0.0, f32::max).sqrt()
            }
        })
        .collect();
    quantile(&mut distances, share).unwrap_or(most).max(LEAST.min(most))
}

/// No first radius is larger.
fn largest(scene_radius: f32) -> f32 {
    0.1 * scene_radius
}

/// Median size of a pixel at the places where the camera gathers; 0 when it gathers nowhere.
pub fn pixel(places: &[Place]) -> f32 {
    let mut footprints: Vec<f32> = places.iter().map(|p| p.footprint).collect();
    quantile(&mut footprints, 0.5).unwrap_or(0.0)
}

/// A sphere around three quarters of the places; its radius is 0 without any.
pub fn around(places: &[Place]) -> SceneSphere {
    let middle = |axis: usize| {
        let mut along: Vec<f32> = places.iter().map(|at| at.p[axis]).collect();
        quantile(&mut along, 0.5).unwrap_or(0.0)
    };
    let center = Vec3::new(middle(0), middle(1), middle(2));
    let mut distances: Vec<f32> = places.iter().map(|at| at.p.distance(center)).collect();
    SceneSphere { center, radius: quantile(&mut distances, 0.75).unwrap_or(0.0) }
}

/// The radius between half a pixel and [`MOST_PIXELS`], and no larger than a tenth of the scene.
pub fn clamped(radius: f32, pixel: f32, scene_radius: f32) -> f32 {
    let radius = radius.min(largest(scene_radius));
    if pixel > 0.0 { radius.clamp(0.5 * pixel, MOST_PIXELS * pixel) } else { radius }
}

/// Factor on the number of light paths that lets a lookup find its photons within [`MOST_PIXELS`], since density
/// grows with that number. Bounded, because a pass should stay short.
pub fn more_paths(radius: f32, pixel: f32) -> f32 {
    const MOST: f32 = 16.0;
    if pixel > 0.0 { (radius / (MOST_PIXELS * pixel)).powi(2).clamp(1.0, MOST) } else { 1.0 }
}

/// Photons that tell the density well enough, and fewest that a disc should hold of them.
const MEASURED: usize = 1 << 20;
const FEWEST: usize = 6;

/// The value that so large a share of others is below, of two middle ones the upper; `None` of none.
pub fn quantile(values: &mut [f32], share: f32) -> Option<f32> {
    if values.is_empty() {
        return None;
    }
    let at = (values.len() as f32 * share) as usize;
    Some(*values.select_nth_unstable_by(at.min(values.len() - 1), f32::total_cmp).1)
}

/// The photons themselves as places: density matters where they lie.
pub fn photon_places(photons: &Stored) -> Vec<Place> {
    let step = photons.len().div_ceil(PLACES).max(1);
    let place = |i: usize| {
        let photon = photons.photon(i);
        let lift = photon.p.abs().max_element() * crate::math::LIFT;
        Place { p: photon.p, n: photon.n, lift, footprint: 0.0 }
    };
    (0..photons.len()).step_by(step).map(place).collect()
}

/// r² of pass `pass` over r² of pass 0: ∏ᵢ₌₁ (i + α)/(i + 1) (Knaus and Zwicker 2011).
pub fn shrinkage(pass: u32, alpha: f64) -> f64 {
    (1..=pass).map(|i| (f64::from(i) + alpha) / (f64::from(i) + 1.0)).product()
}

/// Mean over passes of r² of pass 0 over r² of the pass: by how much the variance of a photon grows as radii shrink.
pub fn growth(passes: u32, alpha: f64) -> f64 {
    (0..passes).map(|pass| 1.0 / shrinkage(pass, alpha)).sum::<f64>() / f64::from(passes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The product telescopes to Γ(n+1+α)/(Γ(1+α)·Γ(n+2)), which falls as n^(α−1).
    #[test]
    fn radius_shrinks_with_the_power_that_makes_it_consistent() {
        let ratio = shrinkage(8000, 0.7) / shrinkage(1000, 0.7);
        assert!((ratio / 8f64.powf(-0.3) - 1.0).abs() < 1e-3);
        assert_eq!(shrinkage(0, 0.5), 1.0);
    }
}
