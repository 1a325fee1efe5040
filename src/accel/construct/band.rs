//! Boxes of magnitudes that one tree can compare.

use std::collections::{HashMap, HashSet};

use obvhs::aabb::Aabb;

use crate::math::{Bounds, Vec3};

/// A farthest corner nearer than this has boxes scaled.
const NEAREST: f32 = 1e-6;

/// Farthest corners of all bands but the last.
const FARTHEST: [f32; 2] = [1e12, 1e25];

/// Boxes of which so many are looked at for equal ones.
const LOOKED_AT: usize = 1024;

/// Finite boxes whose magnitudes are close enough for the areas that the builder compares in `f32`: areas that
/// overflow or are 0 are equal, and no tree can part equal ones. It pairs neighbours that prefer each other
/// two at a time, and makes a chain as deep as they are many.
pub struct Band {
    /// Indices of the boxes.
    items: Vec<u32>,
    /// Groups of `items` with equal boxes, unless all are taken to differ.
    groups: Option<Vec<Vec<u32>>>,
    /// What boxes are multiplied by, a power of two. Usual scenes stay as they are.
    pub scale: f32,
    /// One for every group, else for every item.
    pub boxes: Vec<Aabb>,
}

impl Band {
    /// All bands in which there are boxes.
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

    /// Indices of what has these of the band's boxes.
    pub fn members(&self, boxes: &[u32]) -> Vec<u32> {
        let item = |&i: &u32| self.items[i as usize];
        match &self.groups {
            Some(groups) => boxes.iter().flat_map(|&g| &groups[g as usize]).map(item).collect(),
            None => boxes.iter().map(item).collect(),
        }
    }
}

/// A box larger by a few units in the last place, so that rounding cannot lose a ray that the primitive test
/// accepts, times the scale (which may lose digits of what is nearly 0).
fn padded(b: &Bounds, scale: f32) -> Aabb {
    let lost = if scale == 1.0 { 0.0 } else { f32::MIN_POSITIVE };
    let pad = Vec3::splat(b.magnitude() * scale * 4.0 * f32::EPSILON + lost);
    Aabb { min: b.min * scale - pad, max: b.max * scale + pad }
}

/// All boxes in groups of equal ones, when many are equal.
fn equal(boxes: &[Aabb]) -> Option<Vec<Vec<u32>>> {
    let key = |b: &Aabb| [b.min, b.max].map(|v| v.to_array().map(f32::to_bits));
    let mut seen = HashSet::new();
    if boxes.iter().step_by((boxes.len() / LOOKED_AT).max(1)).all(|b| seen.insert(key(b))) {
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
