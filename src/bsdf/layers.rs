//! A nest of models at a point, as a flat list of weighted lobes.

use super::event::{DeltaLobe, Deltas, Event, Range, Sample, SmoothSample, Transport};
use super::tilt::Tilt;
use super::{Bxdf, Lobe, Lobes};
use crate::math::{Color, Frame, Vec2, Vec3};

/// A model in its place: on which side of what it lies, and how much of it there is.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub weight: f32,
    /// Seen from below through a two-sided wrapper: z is negated on the way in and out.
    pub mirrored: bool,
    pub tilt: Option<Tilt>,
    /// The same for a wrapper inside the tilt.
    pub mirrored_inside: bool,
    pub bxdf: Bxdf,
}

fn side(w: Vec3, mirrored: bool) -> Vec3 {
    if mirrored { Vec3::new(w.x, w.y, -w.z) } else { w }
}

impl Entry {
    fn frame(&self, viewer: Vec3) -> Option<Frame> {
        self.tilt.map(|t| t.frame(side(viewer, self.mirrored)))
    }

    fn local(&self, frame: Option<Frame>, w: Vec3) -> Vec3 {
        let w = side(w, self.mirrored);
        side(frame.map_or(w, |f| f.to_local(w)), self.mirrored_inside)
    }

    fn outer(&self, frame: Option<Frame>, w: Vec3) -> Vec3 {
        let w = side(w, self.mirrored_inside);
        side(frame.map_or(w, |f| f.to_world(w)), self.mirrored)
    }

    fn eval(&self, wi: Vec3, wo: Vec3, mode: Transport, range: Range) -> Color {
        let Some(tilt) = &self.tilt else {
            return self.bxdf.eval(self.local(None, wi), self.local(None, wo), mode, range);
        };
        let (viewer, light) = match mode {
            Transport::Radiance => (wi, wo),
            Transport::Importance => (wo, wi),
        };
        let frame = self.frame(viewer);
        let light = side(light, self.mirrored);
        let flat = light.z;
        let cos = frame.map_or(flat, |f| f.n.dot(light));
        if cos * flat <= 0.0 {
            return Color::ZERO;
        }
        let f = self.bxdf.eval(self.local(frame, wi), self.local(frame, wo), mode, range);
        // The cosine belongs to the tilted facet; that of the surface is applied by who asks.
        f * (cos / flat * tilt.shadow(light))
    }

    fn pdf(&self, wi: Vec3, wo: Vec3, range: Range) -> f32 {
        let frame = self.frame(wi);
        self.bxdf.pdf(self.local(frame, wi), self.local(frame, wo), range)
    }

    fn lobes(&self, wi: Vec3) -> Lobes {
        self.bxdf.lobes(self.local(self.frame(wi), wi))
    }

    fn deltas(&self, wi: Vec3, mode: Transport) -> Deltas {
        let frame = self.frame(wi);
        let found = self.bxdf.deltas(self.local(frame, wi), mode);
        if self.tilt.is_none() && !self.mirrored && !self.mirrored_inside {
            return found;
        }
        let mut deltas = Deltas::default();
        for lobe in found.iter() {
            let wo = self.outer(frame, lobe.wo);
            let mut weight = lobe.weight;
            if let Some(tilt) = &self.tilt {
                let inner = side(lobe.wo, self.mirrored_inside);
                let same = inner.z * side(wo, self.mirrored).z > 0.0;
                let light = if mode == Transport::Radiance { wo } else { wi };
                weight *= if same { tilt.shadow(side(light, self.mirrored)) } else { 0.0 };
            }
            deltas.push(DeltaLobe { wo, weight, ..*lobe });
        }
        deltas
    }

    fn smooth_probability(&self, wi: Vec3) -> f32 {
        (1.0 - self.deltas(wi, Transport::Importance).probability()).max(0.0)
    }
}

/// See the module.
#[derive(Clone, Debug, Default)]
pub(super) struct Layers {
    pub entries: Vec<Entry>,
    /// What goes straight through.
    pub through: f32,
}

impl Layers {
    fn total(&self) -> f32 {
        self.entries.iter().map(|e| e.weight).sum()
    }

    pub fn eval(&self, wi: Vec3, wo: Vec3, mode: Transport, range: Range) -> Color {
        self.entries.iter().map(|e| e.eval(wi, wo, mode, range) * e.weight).sum()
    }

    /// Density of `wo` under [`Layers::sample`].
    pub fn pdf(&self, wi: Vec3, wo: Vec3, range: Range) -> f32 {
        self.pdf_solid(wi, wo, range) * (1.0 - self.through)
    }

    fn pdf_solid(&self, wi: Vec3, wo: Vec3, range: Range) -> f32 {
        let of = |e: &Entry| {
            let pdf = e.pdf(wi, wo, range);
            if pdf > 0.0 { e.weight * pdf * e.smooth_probability(wi) } else { 0.0 }
        };
        match &self.entries[..] {
            [] => 0.0,
            [one] => of(one) / one.weight,
            all => all.iter().map(of).sum::<f32>() / self.total(),
        }
    }

    pub fn has_smooth(&self, wi: Vec3, range: Range) -> bool {
        let inside = |p: &Lobe| p.probability > 0.0 && range.contains(p.roughness);
        self.entries.iter().any(|e| e.lobes(wi).iter().any(inside))
    }

    /// Every smooth lobe with its entry, its number there, and its probability among all events but
    /// passing through.
    pub fn smooth_lobes(&self, wi: Vec3) -> impl Iterator<Item = (usize, usize, Lobe)> {
        let total = self.total();
        self.entries.iter().enumerate().flat_map(move |(i, e)| {
            let share = e.weight / total * e.smooth_probability(wi);
            let lobes = e.lobes(wi).into_iter().enumerate().filter(|(_, l)| l.probability > 0.0);
            lobes.map(move |(k, l)| (i, k, Lobe { probability: l.probability * share, ..l }))
        })
    }

    /// A direction from a lobe of [`Layers::smooth_lobes`].
    pub fn draw(&self, entry: usize, lobe: usize, wi: Vec3, u_lobe: f32, u: Vec2) -> Option<(Vec3, f32)> {
        draw(&self.entries[entry], lobe, wi, u_lobe, u)
    }

    pub fn albedo(&self, wi: Vec3, range: Range) -> Color {
        self.entries.iter().map(|e| e.bxdf.albedo(e.local(e.frame(wi), wi), range) * e.weight).sum()
    }

    /// Specular directions; weights and probabilities are those of an opaque surface.
    pub fn deltas(&self, wi: Vec3, mode: Transport) -> Deltas {
        if let [one] = &self.entries[..]
            && one.weight == 1.0
        {
            return one.deltas(wi, mode);
        }
        let (total, solid) = (self.total(), 1.0 - self.through);
        let mut deltas = Deltas::default();
        for entry in &self.entries {
            for lobe in entry.deltas(wi, mode).iter() {
                deltas.push(DeltaLobe {
                    weight: lobe.weight * (entry.weight / solid),
                    probability: lobe.probability * (entry.weight / total),
                    ..*lobe
                });
            }
        }
        deltas
    }

    /// Kept out of the loops that mostly meet diffuse surfaces.
    #[inline(never)]
    pub fn sample(&self, wi: Vec3, mut u_lobe: f32, u: Vec2, mode: Transport, glossy: f32) -> Option<Sample> {
        if u_lobe < self.through {
            return Some(Sample { wo: -wi, weight: Color::ONE, pdf: 0.0, eta: 1.0, event: Event::Null });
        }
        let solid = 1.0 - self.through;
        u_lobe = (u_lobe - self.through) / solid;
        let total = self.total();
        let chosen = pick(&mut u_lobe, self.entries.iter().map(|e| e.weight / total))?;
        let entry = &self.entries[chosen];
        for lobe in entry.deltas(wi, mode).iter() {
            if u_lobe < lobe.probability {
                // Probability of the entry against its share: 1 unless a mixture absorbs.
                let weight = lobe.weight * (total / (solid * lobe.probability));
                return Some(Sample { wo: lobe.wo, weight, pdf: 0.0, eta: lobe.eta, event: Event::Delta });
            }
            u_lobe -= lobe.probability;
        }
        u_lobe /= entry.smooth_probability(wi);
        let lobes = entry.lobes(wi);
        let lobe = pick(&mut u_lobe, lobes.iter().map(|l| l.probability))?;
        let (range, event) = if lobes[lobe].roughness < glossy {
            (Range::glossy(glossy), Event::Glossy)
        } else {
            (Range::rough(glossy), Event::Smooth)
        };
        let (wo, eta) = draw(entry, lobe, wi, u_lobe, u)?;
        let pdf = self.pdf(wi, wo, range);
        let weight = finite(self.eval(wi, wo, mode, range) * (wo.z.abs() / pdf), pdf)?;
        Some(Sample { wo, weight, pdf, eta, event })
    }

    /// Draws a direction from the smooth lobes of `range` alone; the weight is theirs.
    pub fn sample_smooth(
        &self,
        wi: Vec3,
        mut u_lobe: f32,
        u: Vec2,
        mode: Transport,
        range: Range,
    ) -> Option<SmoothSample> {
        let share = |e: &Entry| {
            let lobes = e.lobes(wi);
            let inside: f32 =
                lobes.iter().filter(|l| range.contains(l.roughness)).map(|l| l.probability).sum();
            if inside > 0.0 { e.weight * inside * e.smooth_probability(wi) } else { 0.0 }
        };
        let all: f32 = self.entries.iter().map(share).sum();
        if all <= 0.0 {
            return None;
        }
        let chosen = pick(&mut u_lobe, self.entries.iter().map(|e| share(e) / all))?;
        let entry = &self.entries[chosen];
        let lobes = entry.lobes(wi);
        let probability = |l: &Lobe| if range.contains(l.roughness) { l.probability } else { 0.0 };
        let inside: f32 = lobes.iter().map(probability).sum();
        let lobe = pick(&mut u_lobe, lobes.iter().map(|l| probability(l) / inside))?;
        let (wo, eta) = draw(entry, lobe, wi, u_lobe, u)?;
        let pdf = self.pdf_solid(wi, wo, range) * (self.total() / all);
        let weight = finite(self.eval(wi, wo, mode, range) * (wo.z.abs() / pdf), pdf)?;
        Some(SmoothSample { wo, weight, pdf, eta })
    }
}

fn draw(entry: &Entry, lobe: usize, wi: Vec3, u_lobe: f32, u: Vec2) -> Option<(Vec3, f32)> {
    let frame = entry.frame(wi);
    let (wo, eta) = entry.bxdf.draw(lobe, entry.local(frame, wi), u_lobe.clamp(0.0, ONE_MINUS), u)?;
    Some((entry.outer(frame, wo), eta))
}

/// The largest float below 1.
const ONE_MINUS: f32 = 1.0 - f32::EPSILON / 2.0;

/// Grazing directions of nearly smooth surfaces may leave the range of f32: such a path ends.
fn finite(weight: Color, pdf: f32) -> Option<Color> {
    (pdf > 0.0 && pdf.is_finite() && weight.is_finite()).then_some(weight)
}

/// Index drawn by `u`, which is stretched to be used again. Rounding goes to the last possible one.
pub(super) fn pick(u: &mut f32, probabilities: impl Iterator<Item = f32>) -> Option<usize> {
    let mut last = None;
    for (i, p) in probabilities.enumerate().filter(|&(_, p)| p > 0.0) {
        if *u < p {
            *u /= p;
            return Some(i);
        }
        *u -= p;
        last = Some(i);
    }
    *u = ONE_MINUS;
    last
}
