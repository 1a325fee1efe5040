//! Round trips of light between a smooth coat and a rough metal below it.

use crate::bsdf::fresnel;
use crate::bsdf::microfacet::{AlphaTable, Microfacet, Roughness, VisibleNormals, cosine_entry, reflect};
use crate::math::{Color, Vec3, gauss_legendre};

/// Entries over cosθ from 0 to 1.
const ENTRIES: usize = 32;

/// Round trips that are followed: as many meetings with the metal as pbrt's default walk has, less the first.
const TRIPS: usize = 4;

/// What leaves the coat after each round trip, over what leaves it after none, for a metal that absorbs nothing: half of
/// it by the cosine inside under which light comes, half by that under which it goes. For one roughness or for a row of
/// them.
#[derive(Clone, Debug)]
pub struct RoundTrips(AlphaTable<Trips>);

/// By the entry of the cosine, and by trip.
type Trips = [[f32; TRIPS]; ENTRIES];

/// Roughnesses of a texture that are told apart.
const ALPHAS: usize = 16;

impl RoundTrips {
    /// `eta` is the coat's index over that outside, `thickness` its optical thickness straight through.
    pub fn new(metal: &Roughness, eta: f32, thickness: f32) -> Self {
        let row = |alpha: f32| {
            let metal = Microfacet::new(metal.kind, metal.shadowing, alpha, alpha);
            (metal.au, trips(&metal, eta, thickness))
        };
        Self(match metal.isotropic() {
            Some(alpha) => AlphaTable::new([row(alpha)]),
            None => AlphaTable::new((0..ALPHAS).map(|i| row((i as f32 + 0.5) / (ALPHAS as f32 - 0.5)))),
        })
    }

    /// Sum over all trips for a metal of reflectance `base`, of one of the two ends: 1 without any.
    pub fn sum(&self, alpha: f32, cos: f32, base: Color) -> Color {
        let (i, x) = cosine_entry(cos, ENTRIES);
        // Horner's rule, longest trip first.
        (0..TRIPS).rev().fold(Color::ZERO, |sum, k| {
            let trip = self.0.at(alpha, |t| t[i][k] + (t[i + 1][k] - t[i][k]) * x);
            (sum + Color::splat(trip)) * base
        }) + Color::ONE
    }
}

fn cosine(i: usize) -> f32 {
    (i as f32 / (ENTRIES - 1) as f32).max(1e-2)
}

/// Follows light between the entries: each meeting with the metal spreads it over them.
fn trips(metal: &Microfacet, eta: f32, thickness: f32) -> Trips {
    let normals = VisibleNormals::new(metal, &gauss_legendre(32));
    let spread: Table = std::array::from_fn(|i| reflected(metal, &normals, cosine(i)));
    let back: [f64; ENTRIES] =
        std::array::from_fn(|i| f64::from(fresnel::dielectric(cosine(i), 1.0 / eta).reflectance));
    let absorbed: [f64; ENTRIES] = std::array::from_fn(|i| (-2.0 * f64::from(thickness / cosine(i))).exp());
    let out: Table = spread.map(|row| std::array::from_fn(|j| row[j] * (1.0 - back[j])));
    let mut light = spread;
    let mut factors = [[0.0; TRIPS]; ENTRIES];
    for k in 0..TRIPS {
        light = light.map(|row| {
            let mut next = [0.0; ENTRIES];
            for j in 0..ENTRIES {
                let returned = row[j] * back[j] * absorbed[j];
                next.iter_mut().zip(&spread[j]).for_each(|(n, s)| *n += returned * s);
            }
            next
        });
        let leaves = light.map(|row| row.iter().zip(&back).map(|(l, b)| l * (1.0 - b)).sum());
        let solved = symmetric(&out, &leaves);
        factors.iter_mut().zip(solved).for_each(|(f, s)| f[k] = s as f32);
    }
    factors
}

type Table = [[f64; ENTRIES]; ENTRIES];

/// h with Σⱼ outᵢⱼ·½(hᵢ + hⱼ) = leavesᵢ: light that leaves directly, times the mean of h at both its ends, which keeps the
/// reflection reciprocal, is what leaves in all. By Gauss and Seidel's method.
fn symmetric(out: &Table, leaves: &[f64; ENTRIES]) -> [f64; ENTRIES] {
    let mut h = [0.0; ENTRIES];
    for _ in 0..64 {
        for i in 0..ENTRIES {
            let sum: f64 = out[i].iter().sum();
            let others: f64 = (0..ENTRIES).filter(|&j| j != i).map(|j| out[i][j] * h[j]).sum();
            if sum > 1e-6 {
                h[i] = ((2.0 * leaves[i] - others) / (sum + out[i][i])).max(0.0);
            }
        }
    }
    h
}

/// Where light that meets the metal under `cos` goes, shared among the entries; what its own bumps catch is lost.
fn reflected(metal: &Microfacet, normals: &VisibleNormals<'_>, cos: f32) -> [f64; ENTRIES] {
    let wi = Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
    let mut entries = [0.0; ENTRIES];
    normals.each(wi, |m, weight| {
        let wo = reflect(wi, m);
        if wo.z > 0.0 {
            let share = weight * f64::from(metal.g(wi, wo, m) / metal.g1(wi, m));
            let x = f64::from(wo.z.min(1.0)) * (ENTRIES - 1) as f64;
            let i = (x as usize).min(ENTRIES - 2);
            entries[i] += share * (1.0 - (x - i as f64));
            entries[i + 1] += share * (x - i as f64);
        }
    });
    entries
}
