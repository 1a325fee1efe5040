//! Groups boxes by magnitude, so that their surface areas neither overflow nor vanish in `f32`.

use std::collections::{HashMap, HashSet};

use obvhs::aabb::Aabb;

use crate::math::{Bounds, Vec3};

/// A band whose largest coordinate is below this is scaled up.
const NEAREST: f32 = 1e-6;

/// The largest coordinates of all bands but the last.
const FARTHEST: [f32; 2] = [1e12, 1e25];

/// Number of boxes sampled to find out whether some are equal.
const SAMPLED: usize = 1024;

/// Finite boxes whose areas the builder can compare in `f32`. Areas that overflow, or underflow to 0, are all
/// equal, and the builder merges boxes of equal area one pair at a time, which gives a tree as deep as there
/// are boxes.
pub struct Band {
    /// Indices of the boxes in the caller's list.
    items: Vec<u32>,
    /// Positions in `items` grouped by equal boxes; `None` if all boxes are taken to differ.
    groups: Option<Vec<Vec<u32>>>,
    /// Power of two by which the boxes are multiplied; 1 for scenes of ordinary size.
    pub scale: f32,
    /// Scaled boxes, one per group if there are groups, else one per item.
    pub boxes: Vec<Aabb>,
}

impl Band {
    /// Sorts boxes into bands; empty bands are left out.
    pub fn all(boxes: &[Bounds]) -> Vec<Self> {
        let mut bands: [Vec<u32>; 3] = Default::default();
        for (i, b) in (0_u32..).zip(boxes).filter(|(_, b)| b.min.is_finite() && b.max.is_finite()) {
            bands[FARTHEST.iter().filter(|&&f| b.magnitude() > f).count()].push(i);
        }
        bands.into_iter().filter(|b| !b.is_empty()).map(|items| Self::new(items, boxes)).collect()
    }

    fn new(items: Vec<u32>, boxes: &[Bounds]) -> Self {
        let far = items.iter().map(|&i| boxes[i as usize].magnitude()).fold(0.0, f32::max);
        let scale = if far == 0.0 || (NEAREST..=FARTHEST[0]).contains(&far) {
            1.0
        } else {
            (FARTHEST[0].log2() - far.log2()).floor().min(126.0).exp2()
        };
        let mut boxes: Vec<Aabb> = items.iter().map(|&i| padded(&boxes[i as usize], scale)).collect();
        let groups = equal(&boxes);
        if let Some(groups) = &groups {
            boxes = groups.iter().map(|g| boxes[g[0] as usize]).collect();
        }
        Self { items, groups, scale, boxes }
    }

    /// The caller's indices for these indices into `self.boxes`.
    pub fn members(&self, boxes: &[u32]) -> Vec<u32> {
        let item = |&i: &u32| self.items[i as usize];
        match &self.groups {
            Some(groups) => boxes.iter().flat_map(|&g| &groups[g as usize]).map(item).collect(),
            None => boxes.iter().map(item).collect(),
        }
    }
}

/// The scaled box, grown by a few ulp so that rounding cannot lose a ray that the primitive test accepts, and by
/// the smallest normal number where scaling may have lost digits.
fn padded(b: &Bounds, scale: f32) -> Aabb {
    let lost = if scale == 1.0 { 0.0 } else { f32::MIN_POSITIVE };
    let pad = Vec3::splat(b.magnitude() * scale * 4.0 * f32::EPSILON + lost);
    Aabb { min: b.min * scale - pad, max: b.max * scale + pad }
}

/// Groups equal boxes, by index; `None` if no two of a sample are equal.
fn equal(boxes: &[Aabb]) -> Option<Vec<Vec<u32>>> {
    let key = |b: &Aabb| [b.min, b.max].map(|v| v.to_array().map(f32::to_bits));
    let mut seen = HashSet::new();
    if boxes.iter().step_by((boxes.len() / SAMPLED).max(1)).all(|b| seen.insert(key(b))) {
        return None;
    }
    let mut known = HashMap::new();
    let mut groups: Vec<Vec<u32>> = Vec::new();
    for (i, b) in (0_u32..).zip(boxes) {
        let group = *known.entry(key(b)).or_insert(groups.len());
        if group == groups.len() {
            groups.push(Vec::new());
        }
        groups[group].push(i);
    }
    Some(groups)
}
