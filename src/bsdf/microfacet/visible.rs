//! Quadrature over the normals that are visible from a direction.

use super::{Distribution, Microfacet, beckmann_slope_x, beckmann_slope_y, ggx_slope};
use crate::math::{Vec2, Vec3};
use crate::sampling::warp;

/// Nodes of a quadrature over the visible normals of an isotropic surface: all pairs of numbers of a rule in one
/// dimension, mapped as [`Microfacet::sample`] does, as far as that does not depend on the direction.
pub struct VisibleNormals<'a> {
    microfacet: &'a Microfacet,
    nodes: Nodes,
}

/// Each with its weight.
enum Nodes {
    /// Each number decides about one coordinate of the slope: the first number, and the second coordinate.
    Beckmann([Vec<(f32, f64)>; 2]),
    /// Points of the unit disk.
    Ggx(Vec<(Vec2, f64)>),
    /// Normals: all are visible.
    Phong(Vec<(Vec3, f64)>),
}

impl<'a> VisibleNormals<'a> {
    /// `rule` lists pairs of place and weight, symmetric about ½.
    pub fn new(microfacet: &'a Microfacet, rule: &[(f64, f64)]) -> Self {
        let pairs = |first: &[(f64, f64)]| -> Vec<(Vec2, f64)> {
            let at = |&(x, wx): &(f64, f64)| {
                rule.iter().map(move |&(y, wy)| (Vec2::new(x as f32, y as f32), wx * wy))
            };
            first.iter().flat_map(at).collect()
        };
        // Of two normals that mirror each other only one is listed, with the weight of both.
        let last = rule.len() - 1;
        let doubled = |i: usize| if i == last - i { 1.0 } else { 2.0 };
        let half: Vec<(f64, f64)> =
            rule[..=last / 2].iter().enumerate().map(|(i, &(x, w))| (x, w * doubled(i))).collect();
        let nodes = match microfacet.kind {
            Distribution::Beckmann => Nodes::Beckmann([
                rule.iter().map(|&(x, w)| (x as f32, w)).collect(),
                half.iter().map(|&(y, w)| (beckmann_slope_y(y as f32), w)).collect(),
            ]),
            // The first number mirrored is the slope mirrored.
            Distribution::Ggx => {
                Nodes::Ggx(pairs(&half).into_iter().map(|(u, w)| (warp::disk(u), w)).collect())
            }
            Distribution::Phong => {
                Nodes::Phong(pairs(rule).into_iter().map(|(u, w)| (microfacet.sample_phong(u), w)).collect())
            }
        };
        Self { microfacet, nodes }
    }

    /// Calls `each` with the normals that are visible from `wi`, which has no y, and their weights.
    pub fn each(&self, wi: Vec3, mut each: impl FnMut(Vec3, f64)) {
        let Microfacet { au, av, .. } = *self.microfacet;
        let normal = |slope: Vec2| Vec3::new(-slope.x * au, -slope.y * av, 1.0).normalize_or(Vec3::Z);
        let cos = self.microfacet.stretched(wi).z;
        match &self.nodes {
            Nodes::Beckmann([xs, ys]) => {
                for &(x, wx) in xs {
                    let x = beckmann_slope_x(cos, x);
                    for &(y, wy) in ys {
                        each(normal(Vec2::new(x, y)), wx * wy);
                    }
                }
            }
            Nodes::Ggx(points) => {
                for &(p, weight) in points {
                    each(normal(ggx_slope(cos, p)), weight);
                }
            }
            Nodes::Phong(normals) => {
                for &(m, weight) in normals {
                    each(m, weight);
                }
            }
        }
    }
}
