use std::f32::consts::TAU;

use super::{PhaseSample, Scatter, around};
use crate::math::{Vec2, Vec3};

/// A phase function by its values at cosines evenly spaced from −1 (back) to 1 (straight on), straight lines between.
#[derive(Clone, Debug)]
pub struct Tabulated {
    /// Density of the cosine at the nodes.
    values: Vec<f32>,
    /// Of the cosine at the nodes, from 0 to 1.
    cdf: Vec<f32>,
}

impl Tabulated {
    /// From values in any unit. `None` if there are fewer than two, one is negative or not finite, or all are 0.
    pub fn new(values: &[f64]) -> Option<Self> {
        let good = values.iter().all(|v| *v >= 0.0 && v.is_finite());
        if values.len() < 2 || !good {
            return None;
        }
        let step = 2.0 / (values.len() - 1) as f64;
        let mut cdf = vec![0.0];
        let mut sum = 0.0;
        for pair in values.windows(2) {
            sum += 0.5 * step * (pair[0] + pair[1]);
            cdf.push(sum);
        }
        (sum > 0.0 && sum.is_finite()).then(|| Self {
            values: values.iter().map(|v| (v / sum) as f32).collect(),
            cdf: cdf.iter().map(|c| (c / sum) as f32).collect(),
        })
    }

    /// Width of an interval.
    fn step(&self) -> f32 {
        2.0 / (self.values.len() - 1) as f32
    }

    fn density(&self, cos: f32) -> f32 {
        let x = ((cos + 1.0) / self.step()).max(0.0);
        let i = (x as usize).min(self.values.len() - 2);
        let t = (x - i as f32).min(1.0);
        self.values[i] + (self.values[i + 1] - self.values[i]) * t
    }

    fn invert(&self, u: f32) -> f32 {
        let above = self.cdf.partition_point(|c| *c <= u).clamp(1, self.values.len() - 1);
        let i = above - 1;
        let (a, b) = (self.values[i], self.values[above]);
        // Area a·t + (b − a)·t²/2 up to the place t of the interval, in the form that holds for a = b too.
        let area = ((u - self.cdf[i]) / self.step()).max(0.0);
        let root = (a * a + 2.0 * (b - a) * area).max(0.0).sqrt();
        let t = if a + root > 0.0 { (2.0 * area / (a + root)).min(1.0) } else { 0.0 };
        -1.0 + (i as f32 + t) * self.step()
    }
}

impl Scatter for Tabulated {
    #[inline(always)]
    fn eval(&self, _: Vec3, wi: Vec3, wo: Vec3) -> f32 {
        self.density(-wi.dot(wo)) / TAU
    }

    #[inline(always)]
    fn sample(&self, _: Vec3, wi: Vec3, _: f32, u: Vec2) -> Option<PhaseSample> {
        let cos = self.invert(u.x);
        let pdf = self.density(cos) / TAU;
        let wo = around(-wi, (1.0 - cos).clamp(0.0, 2.0), u.y);
        (pdf > 0.0).then_some(PhaseSample { wo, weight: 1.0, pdf })
    }

    fn describe(&self) -> String {
        "tabulated phase function".to_owned()
    }
}
