use std::f64::consts::{PI, TAU};

use super::{PhaseSample, Scatter};
use crate::math::{Frame, Vec2, Vec3, gauss_legendre};
use crate::medium::Volume;
use crate::sampling::warp;

/// Mirrors as small as dust on rough fibres (Zhao, Jakob, Marschner, Bala 2011): the density of their normals falls as a
/// Gaussian of the cosine to the fibre.
#[derive(Clone, Debug)]
pub struct Microflake {
    /// Direction of the fibres; where it is 0, or without it, there are no flakes.
    orientation: Option<Volume>,
    deviation: f32,
    /// Density of normals across the fibre, per steradian.
    peak: f32,
    /// The [`Scatter::area`] by the angle to the fibre: see [`Microflake::node`].
    areas: Box<[f32]>,
    /// Half axis along the fibre of the ellipsoid, of radius 1 across it, whose visible normals are samples.
    flatness: f32,
}

/// Values of the area; straight lines between them are right to 1e-4.
const NODES: usize = 257;

/// The narrowest Gaussian: single precision does not tell cosines of less apart.
const NARROWEST: f64 = 1e-4;

impl Microflake {
    /// From the standard deviation of the cosine, above 0, and the direction of the fibres.
    pub fn new(deviation: f64, orientation: Option<Volume>) -> Self {
        let deviation = deviation.max(NARROWEST);
        let rule = gauss_legendre(64);
        let gaussian = |c: f64| (-0.5 * (c / deviation).powi(2)).exp();
        // Farther out nothing is left.
        let far = (9.0 * deviation).min(1.0);
        let between = |a: f64, b: f64, f: &dyn Fn(f64) -> f64| -> f64 {
            (b - a) * rule.iter().map(|(x, w)| w * f(a + (b - a) * x)).sum::<f64>()
        };
        let peak = 1.0 / (2.0 * TAU * between(0.0, far, &gaussian));
        let area = |sin: f64| {
            let cos = (1.0 - sin * sin).max(0.0).sqrt();
            // ∫|m·w| around the fibre, for normals m of cosine c to it.
            let around = |c: f64| {
                let (a, b) = (c * cos, (1.0 - c * c).max(0.0).sqrt() * sin);
                let whole =
                    if a >= b { TAU * a } else { 4.0 * ((b * b - a * a).sqrt() + a * (a / b).asin()) };
                whole * gaussian(c)
            };
            let kink = sin.min(far);
            4.0 * peak * (between(0.0, kink, &around) + between(kink, far, &around))
        };
        let areas = (0..NODES).map(|i| area(Self::node(i, deviation)) as f32).collect();
        let flatness = flattest(deviation, peak) as f32;
        Self { orientation, deviation: deviation as f32, peak: peak as f32, areas, flatness }
    }

    /// Sine of the angle to the fibre for a value of the table: fine where it is about the deviation and below.
    fn node(i: usize, deviation: f64) -> f64 {
        let x = i as f64 / (NODES - 1) as f64;
        (deviation * (x * (1.0 / deviation).asinh()).sinh()).min(1.0)
    }

    fn fibre(&self, p: Vec3) -> Option<Vec3> {
        self.orientation.as_ref()?.vector(p).try_normalize()
    }

    fn area_at(&self, cos: f32) -> f32 {
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let x = (sin / self.deviation).asinh() / (1.0 / self.deviation).asinh() * (NODES - 1) as f32;
        let i = (x as usize).min(NODES - 2);
        let t = (x - i as f32).min(1.0);
        self.areas[i] * (1.0 - t) + self.areas[i + 1] * t
    }

    /// Of normals, by their cosine to the fibre.
    fn distribution(&self, c: f32) -> f32 {
        self.peak * (-0.5 * (c / self.deviation).powi(2)).exp()
    }

    fn value(&self, fibre: Vec3, wi: Vec3, m: Vec3) -> f32 {
        // 2·D·|wi·m|, of both sides of the flakes, over 4·|wi·m| and the projected area; `area_at` is twice that.
        self.distribution(m.dot(fibre)) / self.area_at(wi.dot(fibre))
    }

    fn density(&self, fibre: Vec3, wi: Vec3, m: Vec3) -> f32 {
        let (c, s) = (m.dot(fibre), self.flatness);
        let cos = wi.dot(fibre);
        let projected = (1.0 - (1.0 - s * s) * cos * cos).max(0.0).sqrt();
        0.25 * ellipsoid(c, s) / projected
    }
}

/// Density of the normals of an ellipsoid, whose integral is 4 for a ball; see [`Microflake`]'s `flatness`.
fn ellipsoid(c: f32, s: f32) -> f32 {
    let x = c / s;
    let den = 1.0 - c * c + x * x;
    1.0 / (std::f32::consts::PI * s * den * den)
}

/// The half axis with the least maximum of the weight D/D', for directions across the fibre.
fn flattest(deviation: f64, peak: f64) -> f64 {
    let worst = |s: f64| {
        let ratio = |i: u32| {
            let c = (f64::from(i) / 64.0).powi(2);
            let den = 1.0 - c * c + (c / s).powi(2);
            peak * (-0.5 * (c / deviation).powi(2)).exp() * PI * s * den * den
        };
        (0..=64).map(ratio).fold(0.0, f64::max)
    };
    let widths = (1..=64).map(|i| (deviation * f64::from(i) / 16.0).min(1.0));
    widths.min_by(|a, b| worst(*a).total_cmp(&worst(*b))).unwrap_or(1.0)
}

impl Scatter for Microflake {
    #[inline(always)]
    fn eval(&self, p: Vec3, wi: Vec3, wo: Vec3) -> f32 {
        let (Some(fibre), Some(m)) = (self.fibre(p), (wi + wo).try_normalize()) else { return 0.0 };
        self.value(fibre, wi, m)
    }

    #[inline(always)]
    fn pdf(&self, p: Vec3, wi: Vec3, wo: Vec3) -> f32 {
        let (Some(fibre), Some(m)) = (self.fibre(p), (wi + wo).try_normalize()) else { return 0.0 };
        self.density(fibre, wi, m)
    }

    #[inline(always)]
    fn sample(&self, p: Vec3, wi: Vec3, _: f32, u: Vec2) -> Option<PhaseSample> {
        let fibre = self.fibre(p)?;
        // The square root of the matrix of the ellipsoid takes the view to that of a ball, and normals back.
        let flattened = |v: Vec3| v + fibre * ((self.flatness - 1.0) * v.dot(fibre));
        let axis = flattened(wi).try_normalize()?;
        let n = Frame::from_normal(axis).to_world(warp::cosine_hemisphere(u));
        let m = flattened(n).try_normalize()?;
        let wo = (m * (2.0 * m.dot(wi)) - wi).try_normalize()?;
        let pdf = self.density(fibre, wi, m);
        let weight = self.value(fibre, wi, m) / pdf;
        (pdf > 0.0 && pdf.is_finite() && weight > 0.0).then_some(PhaseSample { wo, weight, pdf })
    }

    #[inline(always)]
    fn area(&self, p: Vec3, w: Vec3) -> f32 {
        self.fibre(p).map_or(0.0, |fibre| self.area_at(w.dot(fibre)))
    }

    fn largest_area(&self) -> f32 {
        self.areas.iter().copied().fold(0.0, f32::max)
    }

    fn has_area(&self) -> bool {
        true
    }

    fn describe(&self) -> String {
        "microflakes".to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Color;

    fn flakes(deviation: f64) -> Microflake {
        Microflake::new(deviation, Some(Volume::Constant(Color::from_lanes([0.0, 0.0, 3.0]))))
    }

    /// Very narrow, all normals are across the fibre: the mean of |m·w| is 2/π·sin θ. Very wide, they are everywhere, and
    /// area and values are those of an even medium. The table adds 1e-4.
    #[test]
    fn the_area_of_flakes_has_its_limits() {
        for degrees in [1.0f32, 20.0, 45.0, 70.0, 90.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let w = Vec3::new(sin, 0.0, cos);
            let narrow = flakes(1e-4).area(Vec3::ZERO, w);
            let exact = 4.0 / std::f32::consts::PI * sin;
            assert!((narrow / exact - 1.0).abs() < 1e-3, "{degrees}: {narrow} of {exact}");
            let wide = flakes(100.0);
            assert!((wide.area(Vec3::ZERO, w) - 1.0).abs() < 1e-3, "{degrees}");
            let value = wide.eval(Vec3::ZERO, w, Vec3::X);
            assert!((value * 4.0 * std::f32::consts::PI - 1.0).abs() < 1e-3, "{degrees}: {value}");
        }
        assert_eq!(Microflake::new(0.2, None).area(Vec3::ZERO, Vec3::X), 0.0);
    }

    /// The area is ∫D·|m·w| over the sphere of normals, here by the midpoint rule.
    #[test]
    fn the_area_of_flakes_is_their_projection() {
        for deviation in [0.03, 0.2, 0.7, 2.0] {
            let phase = flakes(deviation);
            for degrees in [0.0f32, 1.0, 10.0, 60.0, 90.0] {
                let (sin, cos) = degrees.to_radians().sin_cos();
                let w = Vec3::new(sin, 0.0, cos);
                let (rows, columns) = (4000, 400);
                let mut sum = 0.0;
                for i in 0..rows {
                    let c = (i as f32 + 0.5) / rows as f32 * 2.0 - 1.0;
                    let r = (1.0 - c * c).sqrt();
                    for j in 0..columns {
                        let phi = (j as f32 + 0.5) / columns as f32 * std::f32::consts::TAU;
                        let m = Vec3::new(r * phi.cos(), r * phi.sin(), c);
                        sum += f64::from(phase.distribution(c) * m.dot(w).abs());
                    }
                }
                let exact = 2.0 * sum * 2.0 * TAU / f64::from(rows * columns);
                let found = f64::from(phase.area(Vec3::ZERO, w));
                assert!((found / exact - 1.0).abs() < 1e-3, "{deviation} {degrees}: {found} of {exact}");
            }
        }
    }

    /// Samples are of nearly equal weight for every roughness and view, so that no path shines out.
    #[test]
    fn samples_of_flakes_weigh_about_the_same() {
        let mut rng = crate::sampling::CounterRng::new(15, 0);
        for deviation in [1e-3, 0.05, 0.3, 1.0, 5.0] {
            let phase = flakes(deviation);
            let (mut sum, n) = (0.0, 20_000);
            for _ in 0..n {
                let wi = warp::sphere(rng.next_2d().into());
                let Some(s) = phase.sample(Vec3::ZERO, wi, 0.0, rng.next_2d().into()) else { continue };
                assert!(s.weight < 2.0 && s.wo.is_finite(), "{deviation}: {s:?}");
                sum += f64::from(s.weight);
            }
            // The variance of a weight is below 0.15.
            assert!((sum / f64::from(n) - 1.0).abs() < 0.0125, "{deviation}: {}", sum / f64::from(n));
        }
    }
}
