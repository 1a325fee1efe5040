use std::f32::consts::{FRAC_1_PI, PI};
use std::sync::Arc;

use super::{Bxdf, Lobes, Nature, Parameters, Point, Range, Scatter, Transport};
use crate::math::{Color, Vec2, Vec3};
use crate::sampling::warp;
use crate::spectrum::rgb;
use crate::texture::Param;

/// A tabulated BSDF: a Fourier series of the azimuth for each pair of cosines, and splines between them (pbrt-v3's
/// `fourier`).
#[derive(Clone, Debug)]
pub struct FourierModel(pub Arc<FourierTable>);

impl Parameters for FourierModel {
    fn at(&self, _: &Point<'_>) -> Bxdf {
        Fourier(self.0.clone()).into()
    }

    fn params(&self) -> Vec<Param> {
        Vec::new()
    }

    fn nature(&self) -> Nature {
        Nature { smooth: Some([self.0.roughness; 2]), transmits: self.0.transmits, ..Nature::default() }
    }
}

/// What all points of a surface of [`FourierModel`] share.
#[derive(Debug)]
pub struct FourierTable {
    /// Index of refraction behind the normal over that before it.
    eta: f32,
    roughness: f32,
    channels: usize,
    mu: Vec<f32>,
    series: Vec<(u32, u32)>,
    coefficients: Vec<f32>,
    transmits: bool,
    sampling: Sampling,
}

/// For each cosine of the viewer a distribution of cells: between two cosines of light, and of the azimuth.
#[derive(Debug, Default)]
struct Sampling {
    /// Of the azimuth, from 0 to π.
    bins: usize,
    /// Sums of the probabilities of cells, one row a viewer.
    rows: Vec<f32>,
    /// What a viewer sees of even light.
    albedo: Vec<f32>,
}

/// Probability of any direction, so that none is left out by the coarseness of the cells.
const ANYWHERE: f32 = 0.05;

/// Cells of all viewers together, about.
const CELLS: usize = 4 << 20;

/// Σ a·cos(kφ).
fn sum(a: &[f32], cos_phi: f64) -> f64 {
    let (mut value, mut before, mut now) = (0.0, cos_phi, 1.0);
    for a in a {
        value += f64::from(*a) * now;
        (before, now) = (now, 2.0 * cos_phi * now - before);
    }
    value
}

impl FourierTable {
    /// The parts of a file: index, roughness (0: not known), channels (1: luminance; 3: luminance, red, blue), ascending
    /// cosines, for each outgoing and then incident one where its coefficients begin and how many each channel has, and
    /// the coefficients.
    pub fn new(
        [eta, roughness]: [f32; 2],
        channels: usize,
        mu: Vec<f32>,
        series: Vec<(u32, u32)>,
        coefficients: Vec<f32>,
    ) -> Self {
        let n = mu.len();
        let crosses = |at: usize| mu[at / n] * mu[at % n] > 0.0;
        let transmits = series.iter().enumerate().any(|(at, (_, length))| *length > 0 && crosses(at));
        let roughness = if roughness > 0.0 { roughness } else { Range::DIFFUSE };
        let sampling = Sampling::default();
        let mut table = Self { eta, roughness, channels, mu, series, coefficients, transmits, sampling };
        table.sampling = table.distributions();
        table
    }

    /// Coefficients of one channel between two nodes.
    fn channel(&self, o: usize, i: usize, channel: usize) -> &[f32] {
        let (first, length) = self.series[o * self.mu.len() + i];
        let first = first as usize + channel * length as usize;
        &self.coefficients[first..first + length as usize]
    }

    fn distributions(&self) -> Sampling {
        let n = self.mu.len();
        let bins = (CELLS / (n * n)).clamp(4, 32);
        let (mut rows, mut albedo) = (Vec::with_capacity(n * (n - 1) * bins), Vec::with_capacity(n));
        let cosines: Vec<f64> =
            (0..=bins).map(|b| (std::f64::consts::PI * b as f64 / bins as f64).cos()).collect();
        for o in 0..n {
            let values: Vec<Vec<f64>> = (0..n)
                .map(|i| cosines.iter().map(|cos| sum(self.channel(o, i, 0), *cos).max(0.0)).collect())
                .collect();
            let begin = rows.len();
            let mut total = 0.0;
            for k in 0..n - 1 {
                let area = f64::from(self.mu[k + 1] - self.mu[k]) * std::f64::consts::PI / bins as f64;
                for b in 0..bins {
                    let corners = values[k][b] + values[k][b + 1] + values[k + 1][b] + values[k + 1][b + 1];
                    total += 0.25 * corners * area;
                    rows.push(total as f32);
                }
            }
            // Both halves of the azimuth.
            albedo.push((2.0 * total) as f32);
            let row = &mut rows[begin..];
            if total > 0.0 {
                row.iter_mut().for_each(|sum| *sum /= total as f32);
            } else {
                let count = row.len() as f32;
                row.iter_mut().enumerate().for_each(|(at, sum)| *sum = (at + 1) as f32 / count);
            }
            if let Some(last) = row.last_mut() {
                *last = 1.0;
            }
        }
        Sampling { bins, rows, albedo }
    }

    /// The interval of a cosine, and the place in it from 0 to 1; `None` outside of the table.
    fn interval(&self, mu: f32) -> Option<(usize, f32)> {
        let n = self.mu.len();
        if !(self.mu[0]..=self.mu[n - 1]).contains(&mu) {
            return None;
        }
        let at = self.mu.partition_point(|node| *node <= mu).clamp(1, n - 1) - 1;
        Some((at, (mu - self.mu[at]) / (self.mu[at + 1] - self.mu[at])))
    }

    /// Weights of the nodes around a cosine, of a Catmull-Rom spline: the first node may be before the table, the last
    /// one behind it, both with the weight 0.
    fn spline(&self, mu: f32) -> Option<[(usize, f32); 4]> {
        let (at, t) = self.interval(mu)?;
        let (t2, t3) = (t * t, t * t * t);
        let width = self.mu[at + 1] - self.mu[at];
        let mut w = [0.0, 2.0 * t3 - 3.0 * t2 + 1.0, -2.0 * t3 + 3.0 * t2, 0.0];
        let (first, last) = (t3 - 2.0 * t2 + t, t3 - t2);
        if at > 0 {
            let slope = first * width / (self.mu[at + 1] - self.mu[at - 1]);
            w[0] -= slope;
            w[2] += slope;
        } else {
            w[1] -= first;
            w[2] += first;
        }
        if at + 2 < self.mu.len() {
            let slope = last * width / (self.mu[at + 2] - self.mu[at]);
            w[1] -= slope;
            w[3] += slope;
        } else {
            w[1] -= last;
            w[2] += last;
        }
        Some([
            (at.saturating_sub(1), w[0]),
            (at, w[1]),
            (at + 1, w[2]),
            ((at + 2).min(self.mu.len() - 1), w[3]),
        ])
    }

    /// f for radiance towards `viewer`.
    fn f(&self, viewer: Vec3, light: Vec3) -> Color {
        let (mu_o, mu_i) = (viewer.z, -light.z);
        let (Some(outgoing), Some(incident)) = (self.spline(mu_o), self.spline(mu_i)) else {
            return Color::ZERO;
        };
        if mu_i == 0.0 {
            return Color::ZERO;
        }
        let cos_phi = f64::from(cos_azimuth(viewer, light));
        let mut values = [0.0; 3];
        for (o, weight_o) in outgoing {
            for (i, weight_i) in incident {
                let weight = weight_o * weight_i;
                if weight != 0.0 {
                    for (channel, value) in values.iter_mut().enumerate().take(self.channels) {
                        *value += f64::from(weight) * sum(self.channel(o, i, channel), cos_phi);
                    }
                }
            }
        }
        let mut scale = f64::from(1.0 / mu_i.abs());
        if mu_i * mu_o > 0.0 {
            let eta = f64::from(if mu_i > 0.0 { 1.0 / self.eta } else { self.eta });
            scale *= eta * eta;
        }
        let [y, r, b] = [values[0].max(0.0), values[1], values[2]];
        if self.channels == 1 {
            return Color::splat((y * scale) as f32);
        }
        let g = 1.39829 * y - 0.100913 * b - 0.297375 * r;
        rgb([r, g, b].map(|c| (c * scale).max(0.0) as f32))
    }

    /// Nodes around the cosine of a viewer, with their linear weights.
    fn viewers(&self, mu: f32) -> [(usize, f32); 2] {
        let inside = mu.clamp(self.mu[0], self.mu[self.mu.len() - 1]);
        let (at, t) = self.interval(inside).unwrap_or((0, 0.0));
        [(at, 1.0 - t), (at + 1, t)]
    }

    fn row(&self, viewer: usize) -> &[f32] {
        let length = (self.mu.len() - 1) * self.sampling.bins;
        &self.sampling.rows[viewer * length..][..length]
    }
}

/// Cosine of the azimuth between a direction and the other one turned around.
fn cos_azimuth(viewer: Vec3, light: Vec3) -> f32 {
    let lengths = (viewer.x * viewer.x + viewer.y * viewer.y) * (light.x * light.x + light.y * light.y);
    if lengths == 0.0 {
        return 1.0;
    }
    (-(viewer.x * light.x + viewer.y * light.y) / lengths.sqrt()).clamp(-1.0, 1.0)
}

/// [`super::FourierModel`] at a point.
#[derive(Clone, Debug)]
pub struct Fourier(Arc<FourierTable>);

impl Scatter for Fourier {
    fn lobes(&self, _: Vec3) -> Lobes {
        Lobes::one(self.0.roughness)
    }

    /// Photons are scattered as cameras see it, whatever the table says of both ends.
    fn eval(&self, wi: Vec3, wo: Vec3, mode: Transport, range: Range) -> Color {
        if !range.contains(self.0.roughness) {
            return Color::ZERO;
        }
        match mode {
            Transport::Radiance => self.0.f(wi, wo),
            Transport::Importance => self.0.f(wo, wi),
        }
    }

    fn pdf(&self, wi: Vec3, wo: Vec3, range: Range) -> f32 {
        if !range.contains(self.0.roughness) {
            return 0.0;
        }
        let (table, anywhere) = (&self.0, ANYWHERE * 0.25 * FRAC_1_PI);
        let Some((k, _)) = table.interval(-wo.z) else { return anywhere };
        let bins = table.sampling.bins;
        let phi = cos_azimuth(wi, wo).acos();
        let bin = ((phi * FRAC_1_PI * bins as f32) as usize).min(bins - 1);
        let cell = k * bins + bin;
        let area = (table.mu[k + 1] - table.mu[k]) * PI / bins as f32;
        let of = |(viewer, weight): (usize, f32)| {
            let row = table.row(viewer);
            weight * (row[cell] - if cell > 0 { row[cell - 1] } else { 0.0 })
        };
        let probability: f32 = table.viewers(wi.z).into_iter().map(of).sum();
        // Of two mirrored azimuths one.
        anywhere + (1.0 - ANYWHERE) * probability / (2.0 * area)
    }

    fn draw(&self, _: usize, wi: Vec3, u_lobe: f32, u: Vec2) -> Option<(Vec3, f32)> {
        let table = &self.0;
        let wo = if u_lobe < ANYWHERE {
            warp::sphere(u)
        } else {
            let [(first, share), (second, _)] = table.viewers(wi.z);
            let viewer = if (u_lobe - ANYWHERE) / (1.0 - ANYWHERE) < share { first } else { second };
            let (row, bins) = (table.row(viewer), table.sampling.bins);
            let cell = row.partition_point(|sum| *sum <= u.x).min(row.len() - 1);
            let before = if cell > 0 { row[cell - 1] } else { 0.0 };
            let t = ((u.x - before) / (row[cell] - before)).clamp(0.0, 1.0);
            let (k, bin) = (cell / bins, cell % bins);
            let mu = table.mu[k] + t * (table.mu[k + 1] - table.mu[k]);
            let (v, sign) = if u.y < 0.5 { (2.0 * u.y, 1.0) } else { (2.0 * u.y - 1.0, -1.0) };
            let phi = sign * (bin as f32 + v) / bins as f32 * PI + wi.y.atan2(wi.x);
            let sin = (1.0 - mu * mu).max(0.0).sqrt();
            Vec3::new(-sin * phi.cos(), -sin * phi.sin(), -mu)
        };
        let eta = match wi.z * wo.z < 0.0 {
            true if wi.z > 0.0 => table.eta,
            true => 1.0 / table.eta,
            false => 1.0,
        };
        wo.is_finite().then_some((wo, eta))
    }

    fn albedo(&self, wi: Vec3, range: Range) -> Color {
        if !range.contains(self.0.roughness) {
            return Color::ZERO;
        }
        let of = |(viewer, weight): (usize, f32)| weight * self.0.sampling.albedo[viewer];
        Color::splat(self.0.viewers(wi.z).into_iter().map(of).sum::<f32>().min(1.0))
    }
}
