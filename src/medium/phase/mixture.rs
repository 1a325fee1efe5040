use super::{Phase, PhaseSample, Scatter};
use crate::math::{Vec2, Vec3};
use crate::medium::Volume;
use crate::sampling::Discrete;

/// Several phase functions with fixed weights. What their sum lacks of 1 is absorbed.
#[derive(Clone, Debug)]
pub struct Mixture {
    parts: Vec<Phase>,
    weights: Discrete,
    sum: f32,
}

impl Mixture {
    /// From parts with weights, which are divided by their sum if it is above 1. `None` without a part of positive
    /// weight.
    pub fn new(parts: Vec<(f32, Phase)>) -> Option<Self> {
        let weights = Discrete::new(parts.iter().map(|(w, _)| f64::from(w.max(0.0))));
        let total = weights.total();
        (total > 0.0 && total.is_finite()).then(|| Self {
            parts: parts.into_iter().map(|(_, phase)| phase).collect(),
            weights,
            sum: total.min(1.0) as f32,
        })
    }

    fn mean(&self, of: impl Fn(&Phase) -> f32) -> f32 {
        self.parts.iter().enumerate().map(|(i, part)| self.weights.probability(i) * of(part)).sum()
    }
}

impl Scatter for Mixture {
    #[inline(always)]
    fn eval(&self, p: Vec3, wi: Vec3, wo: Vec3) -> f32 {
        self.sum * self.mean(|part| part.eval(p, wi, wo))
    }

    #[inline(always)]
    fn pdf(&self, p: Vec3, wi: Vec3, wo: Vec3) -> f32 {
        self.mean(|part| part.pdf(p, wi, wo))
    }

    #[inline(always)]
    fn sample(&self, p: Vec3, wi: Vec3, pick: f32, u: Vec2) -> Option<PhaseSample> {
        let (i, rest) = self.weights.sample(pick);
        let wo = self.parts[i].sample(p, wi, rest, u)?.wo;
        let pdf = self.pdf(p, wi, wo);
        (pdf > 0.0).then(|| PhaseSample { wo, weight: self.eval(p, wi, wo) / pdf, pdf })
    }

    #[inline(always)]
    fn area(&self, p: Vec3, w: Vec3) -> f32 {
        self.mean(|part| part.area(p, w))
    }

    fn largest_area(&self) -> f32 {
        self.mean(Phase::largest_area)
    }

    fn has_area(&self) -> bool {
        self.parts.iter().any(Phase::has_area)
    }

    fn describe(&self) -> String {
        format!("mixture of {} phase functions", self.parts.len())
    }
}

/// Two phase functions; a volume says how much of the second.
#[derive(Clone, Debug)]
pub struct Blend {
    /// Share of the second, in its first lane; clamped to 0 … 1.
    pub weight: Volume,
    /// Where the weight is 0, and where it is 1.
    pub parts: [Phase; 2],
}

impl Blend {
    fn sum(&self, p: Vec3, of: impl Fn(&Phase) -> f32) -> f32 {
        let w = self.second(p);
        (1.0 - w) * of(&self.parts[0]) + w * of(&self.parts[1])
    }

    fn second(&self, p: Vec3) -> f32 {
        self.weight.color(p).lanes()[0].clamp(0.0, 1.0)
    }
}

impl Scatter for Blend {
    #[inline(always)]
    fn eval(&self, p: Vec3, wi: Vec3, wo: Vec3) -> f32 {
        self.sum(p, |part| part.eval(p, wi, wo))
    }

    #[inline(always)]
    fn pdf(&self, p: Vec3, wi: Vec3, wo: Vec3) -> f32 {
        self.sum(p, |part| part.pdf(p, wi, wo))
    }

    #[inline(always)]
    fn sample(&self, p: Vec3, wi: Vec3, pick: f32, u: Vec2) -> Option<PhaseSample> {
        let w = self.second(p);
        let (part, rest) = if pick < w { (1, pick / w) } else { (0, (pick - w) / (1.0 - w)) };
        let wo = self.parts[part].sample(p, wi, rest.min(1.0 - f32::EPSILON), u)?.wo;
        let pdf = self.pdf(p, wi, wo);
        (pdf > 0.0).then(|| PhaseSample { wo, weight: self.eval(p, wi, wo) / pdf, pdf })
    }

    #[inline(always)]
    fn area(&self, p: Vec3, w: Vec3) -> f32 {
        self.sum(p, |part| part.area(p, w))
    }

    fn largest_area(&self) -> f32 {
        self.parts[0].largest_area().max(self.parts[1].largest_area())
    }

    fn has_area(&self) -> bool {
        self.parts.iter().any(Phase::has_area)
    }

    fn describe(&self) -> String {
        "blend of two phase functions".to_owned()
    }
}
