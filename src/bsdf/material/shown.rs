//! What pictures of a material show: the reflectance and the normal that denoisers ask for.

use std::f32::consts::PI;

use super::{Material, Node, flat};
use crate::bsdf::{Point, Range, Transport};
use crate::math::{Color, Vec3};

impl Node {
    /// Diffuse reflectance as Mitsuba tells it: the parameter of that meaning where a model has one, elsewhere π
    /// times the BSDF for light along the normal. Opacity does not count.
    fn reflectance(&self, point: &Point<'_>, wi: Vec3) -> Color {
        match self {
            Self::Null => Color::ZERO,
            Self::Model(m) => match m.reflectance() {
                Some(param) => point.color(param),
                None => flat(self, point, wi).eval(wi, Vec3::Z, Transport::Radiance, Range::ALL) * PI,
            },
            Self::TwoSided(sides) if wi.z >= 0.0 => sides[0].reflectance(point, wi),
            Self::TwoSided(sides) => sides[1].reflectance(point, Vec3::new(wi.x, wi.y, -wi.z)),
            Self::Mask(_, nested) | Self::Tilted(_, nested) => nested.reflectance(point, wi),
            Self::Blend(weight, nested) => {
                let second = point.scalar(*weight).clamp(0.0, 1.0);
                let [a, b] = [&nested[0], &nested[1]].map(|node| node.reflectance(point, wi));
                a * (1.0 - second) + b * second
            }
            Self::Mixture(nested) => {
                nested.iter().map(|(share, node)| node.reflectance(point, wi) * *share).sum()
            }
        }
    }

    /// The first bent normal on the way inwards, in the shading frame.
    fn bent_normal(&self, point: &Point<'_>, wi: Vec3, inside: bool) -> Option<Vec3> {
        match self {
            Self::Tilted(perturbation, _) => {
                let tilt = perturbation.at(point);
                Some(tilt.frame(tilt.flipped(wi)).n)
            }
            Self::Mask(_, nested) if inside => nested.bent_normal(point, wi, inside),
            Self::TwoSided(sides) if inside && wi.z >= 0.0 => sides[0].bent_normal(point, wi, inside),
            Self::TwoSided(sides) if inside => {
                let below = |w: Vec3| Vec3::new(w.x, w.y, -w.z);
                sides[1].bent_normal(point, below(wi), inside).map(below)
            }
            _ => None,
        }
    }
}

impl Material {
    /// Diffuse reflectance at a point, as Mitsuba's BSDFs tell it, seen from the local direction `wi`.
    pub fn reflectance(&self, point: &Point<'_>, wi: Vec3) -> Color {
        self.root.reflectance(point, wi)
    }

    /// The normal that a bump or normal map makes at a point, in the shading frame; `None` where there is none. Mitsuba
    /// looks for it at the outermost part only; `inside` also looks below masks and two-sided wrappers.
    pub fn bent_normal(&self, point: &Point<'_>, wi: Vec3, inside: bool) -> Option<Vec3> {
        self.root.bent_normal(point, wi, inside)
    }
}
