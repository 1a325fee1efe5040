use std::f32::consts::PI;

use super::{PhaseSample, Scatter};
use crate::math::{Frame, Vec2, Vec3};
use crate::medium::{Matrices, Symmetric};
use crate::sampling::warp;

/// Mirrors as small as dust, whose normals have the distribution SGGX (Heitz et al. 2015).
#[derive(Clone, Debug)]
pub struct Sggx {
    matrices: Matrices,
    largest: f32,
}

impl Sggx {
    /// From the matrix S at each place.
    pub fn new(matrices: Matrices) -> Self {
        let largest = matrices.largest_trace().max(0.0).sqrt();
        Self { matrices, largest }
    }
}

/// wᵀ·S·w.
fn form(s: &Symmetric, w: Vec3) -> f32 {
    s.times(w).dot(w)
}

/// Density of normals, per steradian and unit of area.
fn distribution(s: &Symmetric, m: Vec3) -> f32 {
    let det = s.determinant().max(0.0);
    let den = form(&s.adjugate(), m);
    if den > 0.0 { det * det.sqrt() / (PI * den * den) } else { 0.0 }
}

fn projected(s: &Symmetric, w: Vec3) -> f32 {
    form(s, w).max(0.0).sqrt()
}

impl Scatter for Sggx {
    #[inline(always)]
    fn eval(&self, p: Vec3, wi: Vec3, wo: Vec3) -> f32 {
        let s = self.matrices.at(p);
        let Some(m) = (wi + wo).try_normalize() else { return 0.0 };
        let area = projected(&s, wi);
        if area > 0.0 { 0.25 * distribution(&s, m) / area } else { 0.0 }
    }

    #[inline(always)]
    fn sample(&self, p: Vec3, wi: Vec3, _: f32, u: Vec2) -> Option<PhaseSample> {
        let s = self.matrices.at(p);
        let frame = Frame::from_normal(wi);
        // S in a frame along wi: of its square root only three columns are needed (supplement of the article).
        let [a, b, c] = [frame.s, frame.t, frame.n].map(|v| s.times(v));
        let (kk, kj, ki) = (a.dot(frame.s), a.dot(frame.t), a.dot(frame.n));
        let (jj, ji, ii) = (b.dot(frame.t), b.dot(frame.n), c.dot(frame.n));
        let det = (kk * jj * ii + 2.0 * kj * ki * ji - kk * ji * ji - jj * ki * ki - ii * kj * kj).max(0.0);
        let (root, minor) = (ii.max(0.0).sqrt(), (jj * ii - ji * ji).max(0.0).sqrt());
        let across = Vec3::new(det.sqrt() / minor, 0.0, 0.0);
        let along = Vec3::new((kj * ii - ki * ji) / (minor * root), minor / root, 0.0);
        let facing = Vec3::new(ki, ji, ii) / root;
        let v = warp::cosine_hemisphere(u);
        let m = (across * v.x + along * v.y + facing * v.z).try_normalize()?;
        let m = frame.to_world(m);
        let wo = (m * (2.0 * m.dot(wi)) - wi).try_normalize()?;
        let pdf = self.eval(p, wi, wo);
        (pdf > 0.0 && pdf.is_finite()).then_some(PhaseSample { wo, weight: 1.0, pdf })
    }

    #[inline(always)]
    fn area(&self, p: Vec3, w: Vec3) -> f32 {
        projected(&self.matrices.at(p), w)
    }

    fn largest_area(&self) -> f32 {
        self.largest
    }

    fn has_area(&self) -> bool {
        true
    }

    fn describe(&self) -> String {
        "SGGX phase function".to_owned()
    }
}
