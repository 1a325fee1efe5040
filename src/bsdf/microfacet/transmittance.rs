//! How much light a rough dielectric surface lets through, tabulated.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use rayon::prelude::*;

use super::alpha_table::{AlphaTable, cosine_entry};
use super::{Distribution, Microfacet, Shadowing, VisibleNormals, reflect, refract};
use crate::bsdf::fresnel;
use crate::math::{Vec3, gauss_legendre};

/// Entries over cosθ from 0 to 1.
const ENTRIES: usize = 64;

/// For one α, or for a row of them.
#[derive(Clone, Debug)]
pub struct Transmittance {
    rows: AlphaTable<Row>,
}

/// Distribution, bits of α (none: any α) and of the relative index.
type Key = (Distribution, Shadowing, Option<u32>, u32);

/// A table has 256 bytes, or 6 kB for all α.
const MOST_MADE: usize = 1024;

static MADE: Mutex<VecDeque<(Key, Arc<Transmittance>)>> = Mutex::new(VecDeque::new());

#[derive(Clone, Debug)]
struct Row {
    /// For light from outside: what passes unshadowed, less than 1 − reflectance.
    external: [f32; ENTRIES],
    /// Reflectance for diffuse light from inside.
    internal: f32,
}

impl Transmittance {
    /// For one roughness, as exactly as Mitsuba's `roughplastic` makes its table.
    pub fn new(kind: Distribution, shadowing: Shadowing, alpha: f32, eta: f32) -> Self {
        // The discontinuity of total reflection is what takes so many. Beckmann's slopes end sooner than
        // the long tails of the others: half as many already agree with twice as many to 5e-5.
        let inner_nodes = if kind == Distribution::Beckmann { 64 } else { 128 };
        Self {
            rows: AlphaTable::new([row(Microfacet::new(kind, shadowing, alpha, alpha), eta, inner_nodes)]),
        }
    }

    /// For every roughness up to 1: interpolated between 24 of them.
    pub fn all(kind: Distribution, shadowing: Shadowing, eta: f32) -> Self {
        let n = 24;
        // Denser where surfaces are smooth: there the table changes fastest.
        let alpha = |i: usize| ((i as f32 + 0.25) / (n as f32 - 0.75)).powi(2);
        let microfacet = |i| Microfacet::new(kind, shadowing, alpha(i), alpha(i));
        Self { rows: AlphaTable::new((0..n).map(|i| row(microfacet(i), eta, 24))) }
    }

    /// That of one α or, without, of all. Scenes have it many times, and each takes milliseconds: those made last are
    /// kept for the whole program.
    pub fn shared(kind: Distribution, shadowing: Shadowing, alpha: Option<f32>, eta: f32) -> Arc<Self> {
        let key = (kind, shadowing, alpha.map(f32::to_bits), eta.to_bits());
        let made = || MADE.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, known)) = made().iter().find(|(of, _)| *of == key) {
            return known.clone();
        }
        let table = Arc::new(match alpha {
            Some(alpha) => Self::new(kind, shadowing, alpha, eta),
            None => Self::all(kind, shadowing, eta),
        });
        let mut made = made();
        if made.len() == MOST_MADE {
            made.pop_front();
        }
        made.push_back((key, table.clone()));
        table
    }

    /// Into the surface at cosθ from outside.
    pub fn external(&self, alpha: f32, cos: f32) -> f32 {
        let (i, x) = cosine_entry(cos, ENTRIES);
        self.rows.at(alpha, |r| r.external[i] + (r.external[i + 1] - r.external[i]) * x)
    }

    /// Share of diffuse light inside that is reflected back.
    pub fn internal(&self, alpha: f32) -> f32 {
        self.rows.at(alpha, |r| r.internal)
    }
}

fn row(microfacet: Microfacet, eta: f32, inner_nodes: usize) -> (f32, Row) {
    let cos = |i: usize| (i as f32 / (ENTRIES - 1) as f32).max(1e-6);
    let outer = VisibleNormals::new(&microfacet, &gauss_legendre(32));
    let inner = VisibleNormals::new(&microfacet, &gauss_legendre(inner_nodes));
    let external = std::array::from_fn(|i| scattered(&microfacet, cos(i), eta, &outer, Side::Through) as f32);
    let back = |i: usize| f64::from(cos(i)) * scattered(&microfacet, cos(i), 1.0 / eta, &inner, Side::Back);
    // Added in order, so that the sum does not depend on the threads.
    let shares: Vec<f64> = (0..ENTRIES).into_par_iter().map(back).collect();
    let sum: f64 = shares.iter().sum();
    let mean = match microfacet.shadowing {
        // Mitsuba's table, which counts the ends of the integral in full.
        Shadowing::Separable => sum / ENTRIES as f64,
        // At grazing angles the share is 0.
        Shadowing::HeightCorrelated => (sum - 0.5 * shares[ENTRIES - 1]) / (ENTRIES - 1) as f64,
    };
    (microfacet.au, Row { external, internal: (2.0 * mean) as f32 })
}

/// Which of the two shares.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    /// Reflected.
    Back,
    /// Transmitted.
    Through,
}

/// Reflected or transmitted share: ∫ F·G/G1(wi) or ∫ (1 − F)·G/G1(wi) over visible normals.
fn scattered(microfacet: &Microfacet, cos: f32, eta: f32, normals: &VisibleNormals<'_>, side: Side) -> f64 {
    let wi = Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
    let mut sum = 0.0;
    normals.each(wi, |m, weight| {
        let f = fresnel::dielectric(wi.dot(m), eta);
        let (share, wo) = match side {
            Side::Back => (f.reflectance, reflect(wi, m)),
            Side::Through => (1.0 - f.reflectance, refract(wi, m, f.cos_t, f.eta)),
        };
        if share <= 0.0 || (wo.z > 0.0) != (side == Side::Back) || wo.z == 0.0 {
            return;
        }
        let passes = match microfacet.kind {
            Distribution::Phong => {
                microfacet.g(wi, wo, m) * wi.dot(m).abs() / (wi.z * m.z).max(f32::MIN_POSITIVE)
            }
            Distribution::Beckmann | Distribution::Ggx => match microfacet.shadowing {
                Shadowing::Separable => microfacet.g1(wo, m),
                Shadowing::HeightCorrelated => microfacet.g(wi, wo, m) / microfacet.g1(wi, m),
            },
        };
        sum += f64::from(share * passes) * weight;
    });
    sum.min(1.0)
}
