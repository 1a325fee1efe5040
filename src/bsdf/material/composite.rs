//! A nest of models at a point, as a flat list of weighted lobes.

use super::tilt::Tilt;
use crate::bsdf::{
    Bxdf, DeltaLobe, Deltas, Event, Lobe, Lobes, Range, Sample, SmoothSample, Transport, adjoint_correction,
};
use crate::math::{Color, Frame, Vec2, Vec3};

/// A model in its place: on which side of what it lies, and how much of it there is.
#[derive(Clone, Debug)]
pub(in crate::bsdf) struct Component {
    /// Share of the surface.
    pub weight: f32,
    /// Seen from below through a two-sided wrapper: z is negated on the way in and out.
    pub mirrored: bool,
    /// Of a bump or normal map.
    pub tilt: Option<Tilt>,
    /// The same for a wrapper inside the tilt.
    pub mirrored_inside: bool,
    /// The model at the point.
    pub bxdf: Bxdf,
}

fn side(w: Vec3, mirrored: bool) -> Vec3 {
    if mirrored { Vec3::new(w.x, w.y, -w.z) } else { w }
}

/// A frame in which a component may scatter light.
#[derive(Clone, Copy)]
struct Pose {
    frame: Option<Frame>,
    flipped: bool,
    /// With which it is drawn.
    probability: f32,
}

impl Component {
    fn pose(&self, flipped: bool, probability: f32) -> Pose {
        Pose { frame: self.tilt.map(|t| t.frame(flipped)), flipped, probability }
    }

    /// The pose that `viewer` sees.
    fn seen(&self, viewer: Vec3) -> Pose {
        self.pose(self.tilt.is_some_and(|t| t.flipped(side(viewer, self.mirrored))), 1.0)
    }

    /// All poses in which what comes along `wi` may be scattered. `wi` is the viewer of radiance; that of
    /// light is the direction still to be drawn, and who sees a mirrored normal there sees that pose.
    fn poses(&self, wi: Vec3, mode: Transport) -> impl Iterator<Item = Pose> {
        let flip = match (mode, &self.tilt) {
            (Transport::Importance, Some(tilt)) => tilt.flip_probability(),
            _ => 0.0,
        };
        let (first, second) = if flip > 0.0 {
            (self.pose(false, 1.0 - flip), Some(self.pose(true, flip)))
        } else {
            (self.seen(wi), None)
        };
        std::iter::once(first).chain(second)
    }

    /// One of [`Self::poses`], drawn by `u` in proportion to `share`, which is asked only where there are two.
    fn draw_pose(
        &self,
        wi: Vec3,
        mode: Transport,
        u: &mut f32,
        share: impl Fn(&Pose) -> f32,
    ) -> Option<Pose> {
        let mut poses = self.poses(wi, mode);
        let (first, second) = (poses.next()?, poses.next());
        let Some(second) = second else { return Some(first) };
        let shares = [&first, &second].map(share);
        let sum = shares[0] + shares[1];
        let chosen = pick(u, shares.into_iter().map(|s| s / sum))?;
        Some(if chosen == 0 { first } else { second })
    }

    fn local(&self, pose: &Pose, w: Vec3) -> Vec3 {
        let w = side(w, self.mirrored);
        side(pose.frame.map_or(w, |f| f.to_local(w)), self.mirrored_inside)
    }

    fn outer(&self, pose: &Pose, w: Vec3) -> Vec3 {
        let w = side(w, self.mirrored_inside);
        side(pose.frame.map_or(w, |f| f.to_world(w)), self.mirrored)
    }

    fn eval(&self, wi: Vec3, wo: Vec3, mode: Transport, range: Range) -> Color {
        let (viewer, light) = match mode {
            Transport::Radiance => (wi, wo),
            Transport::Importance => (wo, wi),
        };
        let pose = self.seen(viewer);
        let (Some(tilt), Some(frame)) = (&self.tilt, pose.frame) else {
            return self.bxdf.eval(self.local(&pose, wi), self.local(&pose, wo), mode, range);
        };
        let light = side(light, self.mirrored);
        let (flat, cos) = (light.z, frame.n.dot(light));
        if cos * flat <= 0.0 {
            return Color::ZERO;
        }
        let f = self.bxdf.eval(self.local(&pose, wi), self.local(&pose, wo), mode, range);
        // The cosine belongs to the tilted facet; that of the surface is applied by who asks.
        f * (cos / flat * tilt.shadow(light))
    }

    /// Density of `wo` with the probability of a smooth lobe, times `weight`.
    fn pdf(&self, wi: Vec3, wo: Vec3, mode: Transport, range: Range, weight: f32) -> f32 {
        let of = |pose: Pose| {
            let inside = self.local(&pose, wi);
            let pdf = self.bxdf.pdf(inside, self.local(&pose, wo), range);
            if pdf > 0.0 { weight * pdf * self.smooth_in(&pose, wi) * pose.probability } else { 0.0 }
        };
        self.poses(wi, mode).map(of).sum()
    }

    /// [`Self::eval`] times `weight`, and [`Self::pdf`].
    fn eval_pdf(&self, wi: Vec3, wo: Vec3, mode: Transport, range: Range) -> (Color, f32) {
        if self.tilt.is_some() {
            let f = self.eval(wi, wo, mode, range) * self.weight;
            return (f, self.pdf(wi, wo, mode, range, self.weight));
        }
        let pose = self.pose(false, 1.0);
        let (f, pdf) = self.bxdf.eval_pdf(self.local(&pose, wi), self.local(&pose, wo), mode, range);
        (f * self.weight, if pdf > 0.0 { self.weight * pdf * self.smooth_in(&pose, wi) } else { 0.0 })
    }

    /// The smooth lobes as seen from `wi`.
    fn lobes(&self, wi: Vec3) -> Lobes {
        self.bxdf.lobes(self.local(&self.seen(wi), wi))
    }

    fn deltas(&self, wi: Vec3, mode: Transport) -> Deltas {
        if self.tilt.is_none() && !self.mirrored && !self.mirrored_inside {
            return self.bxdf.deltas(wi, mode);
        }
        let mut deltas = Deltas::default();
        for pose in self.poses(wi, mode) {
            for lobe in self.bxdf.deltas(self.local(&pose, wi), mode).iter() {
                let wo = self.outer(&pose, lobe.wo);
                let weight = lobe.weight * self.delta_factor(&pose, wi, wo, mode);
                let probability = lobe.probability * pose.probability;
                deltas.push(DeltaLobe { wo, weight, probability, ..*lobe });
            }
        }
        deltas
    }

    /// What a tilt makes of specular light. As for smooth lobes, the cosine of light belongs to the tilted
    /// facet, and that of light that is traced to the surface (Veach 1997, eq. 5.19).
    fn delta_factor(&self, pose: &Pose, wi: Vec3, wo: Vec3, mode: Transport) -> f32 {
        let (Some(tilt), Some(frame)) = (&self.tilt, pose.frame) else { return 1.0 };
        let (wi, wo) = (side(wi, self.mirrored), side(wo, self.mirrored));
        let (wi_tilted, wo_tilted) = (frame.n.dot(wi), frame.n.dot(wo));
        if wo_tilted * wo.z <= 0.0 {
            return 0.0;
        }
        match mode {
            Transport::Radiance => tilt.shadow(wo),
            Transport::Importance if tilt.flipped(wo) != pose.flipped || wi_tilted * wi.z <= 0.0 => 0.0,
            Transport::Importance => {
                adjoint_correction([wi_tilted, wo_tilted], [wi.z, wo.z]) * tilt.shadow(wi)
            }
        }
    }

    /// Probability of a smooth lobe in a pose.
    fn smooth_in(&self, pose: &Pose, wi: Vec3) -> f32 {
        (1.0 - self.bxdf.deltas(self.local(pose, wi), Transport::Importance).probability()).max(0.0)
    }

    fn smooth_probability(&self, wi: Vec3, mode: Transport) -> f32 {
        self.poses(wi, mode).map(|pose| self.smooth_in(&pose, wi) * pose.probability).sum()
    }

    /// Probability of the smooth lobes of `range` in a pose, times `weight`.
    fn share_in(&self, pose: &Pose, wi: Vec3, range: Range, weight: f32) -> f32 {
        let lobes = self.bxdf.lobes(self.local(pose, wi));
        let inside: f32 = lobes.iter().filter(|l| range.contains(l.roughness)).map(|l| l.probability).sum();
        if inside > 0.0 { weight * inside * self.smooth_in(pose, wi) * pose.probability } else { 0.0 }
    }

    /// A direction from a lobe in a pose.
    fn draw(&self, pose: &Pose, lobe: usize, wi: Vec3, u_lobe: f32, u: Vec2) -> Option<(Vec3, f32)> {
        let (wo, eta) = self.bxdf.draw(lobe, self.local(pose, wi), u_lobe.clamp(0.0, ONE_MINUS), u)?;
        Some((self.outer(pose, wo), eta))
    }
}

/// See the module.
#[derive(Clone, Debug, Default)]
pub(in crate::bsdf) struct Composite {
    /// Models by weight, all of which light of this side meets.
    pub components: Vec<Component>,
    /// What goes straight through.
    pub through: f32,
}

impl Composite {
    fn total(&self) -> f32 {
        self.components.iter().map(|e| e.weight).sum()
    }

    /// f of the smooth lobes in `range`, in 1/sr, without the cosine.
    pub fn eval(&self, wi: Vec3, wo: Vec3, mode: Transport, range: Range) -> Color {
        self.components.iter().map(|e| e.eval(wi, wo, mode, range) * e.weight).sum()
    }

    /// Density of `wo` under [`Composite::sample`].
    pub fn pdf(&self, wi: Vec3, wo: Vec3, mode: Transport, range: Range) -> f32 {
        self.pdf_solid(wi, wo, mode, range) * (1.0 - self.through)
    }

    fn pdf_solid(&self, wi: Vec3, wo: Vec3, mode: Transport, range: Range) -> f32 {
        let of = |e: &Component| e.pdf(wi, wo, mode, range, e.weight);
        match &self.components[..] {
            [] => 0.0,
            [one] => of(one) / one.weight,
            all => all.iter().map(of).sum::<f32>() / self.total(),
        }
    }

    /// [`Composite::eval`] and [`Composite::pdf`].
    pub fn eval_pdf(&self, wi: Vec3, wo: Vec3, mode: Transport, range: Range) -> (Color, f32) {
        let (f, pdf) = self.eval_pdf_solid(wi, wo, mode, range);
        (f, pdf * (1.0 - self.through))
    }

    fn eval_pdf_solid(&self, wi: Vec3, wo: Vec3, mode: Transport, range: Range) -> (Color, f32) {
        let (mut f, mut pdf) = (Color::ZERO, 0.0);
        for component in &self.components {
            let one = component.eval_pdf(wi, wo, mode, range);
            (f, pdf) = (f + one.0, pdf + one.1);
        }
        (f, if pdf > 0.0 { pdf / self.total() } else { 0.0 })
    }

    /// Whether smooth lobes in `range` can be chosen by light along `wi`.
    pub fn has_smooth(&self, wi: Vec3, range: Range) -> bool {
        let inside = |p: &Lobe| p.probability > 0.0 && range.contains(p.roughness);
        self.components.iter().any(|e| e.lobes(wi).iter().any(inside))
    }

    /// Every smooth lobe with its component, its number there, and its probability among all events but
    /// passing through. For layers whose normals are the same for all viewers.
    pub fn smooth_lobes(&self, wi: Vec3) -> impl Iterator<Item = (usize, usize, Lobe)> {
        let total = self.total();
        self.components.iter().enumerate().flat_map(move |(i, e)| {
            let share = e.weight / total * e.smooth_probability(wi, Transport::Radiance);
            let lobes = e.lobes(wi).into_iter().enumerate().filter(|(_, l)| l.probability > 0.0);
            lobes.map(move |(k, l)| (i, k, Lobe { probability: l.probability * share, ..l }))
        })
    }

    /// A direction from a lobe of [`Composite::smooth_lobes`].
    pub fn draw(&self, component: usize, lobe: usize, wi: Vec3, u_lobe: f32, u: Vec2) -> Option<(Vec3, f32)> {
        let component = &self.components[component];
        component.draw(&component.seen(wi), lobe, wi, u_lobe, u)
    }

    /// Share of what arrives along `wi` that the smooth lobes in `range` scatter.
    pub fn albedo(&self, wi: Vec3, range: Range) -> Color {
        self.components.iter().map(|e| e.bxdf.albedo(e.local(&e.seen(wi), wi), range) * e.weight).sum()
    }

    /// Specular directions; weights and probabilities are those of an opaque surface.
    pub fn deltas(&self, wi: Vec3, mode: Transport) -> Deltas {
        if let [one] = &self.components[..]
            && one.weight == 1.0
        {
            return one.deltas(wi, mode);
        }
        let (total, solid) = (self.total(), 1.0 - self.through);
        let mut deltas = Deltas::default();
        for component in &self.components {
            for lobe in component.deltas(wi, mode).iter() {
                deltas.push(DeltaLobe {
                    weight: lobe.weight * (component.weight / solid),
                    probability: lobe.probability * (component.weight / total),
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
            return Some(Sample::through(-wi));
        }
        let solid = 1.0 - self.through;
        u_lobe = (u_lobe - self.through) / solid;
        let total = self.total();
        let chosen = pick(&mut u_lobe, self.components.iter().map(|e| e.weight / total))?;
        let component = &self.components[chosen];
        for lobe in component.deltas(wi, mode).iter() {
            if u_lobe < lobe.probability {
                // Probability of the component against its share: 1 unless a mixture absorbs.
                let weight = lobe.weight * (total / (solid * lobe.probability));
                let DeltaLobe { wo, eta, straight, .. } = *lobe;
                return Some(Sample { wo, weight, pdf: 0.0, eta, event: Event::Delta, straight });
            }
            u_lobe -= lobe.probability;
        }
        u_lobe /= component.smooth_probability(wi, mode);
        let share = |pose: &Pose| component.smooth_in(pose, wi) * pose.probability;
        let pose = component.draw_pose(wi, mode, &mut u_lobe, share)?;
        let lobes = component.bxdf.lobes(component.local(&pose, wi));
        let lobe = pick(&mut u_lobe, lobes.iter().map(|l| l.probability))?;
        let (range, event) = if lobes[lobe].roughness < glossy {
            (Range::glossy(glossy), Event::Glossy)
        } else {
            (Range::rough(glossy), Event::Smooth)
        };
        let (wo, eta) = component.draw(&pose, lobe, wi, u_lobe, u)?;
        let (f, pdf) = self.eval_pdf(wi, wo, mode, range);
        let weight = finite(f * (wo.z.abs() / pdf), pdf)?;
        Some(Sample { wo, weight, pdf, eta, event, straight: false })
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
        let share = |e: &Component| -> f32 {
            e.poses(wi, mode).map(|pose| e.share_in(&pose, wi, range, e.weight)).sum()
        };
        let all: f32 = self.components.iter().map(share).sum();
        if all <= 0.0 {
            return None;
        }
        let chosen = pick(&mut u_lobe, self.components.iter().map(|e| share(e) / all))?;
        let component = &self.components[chosen];
        let of_pose = |pose: &Pose| component.share_in(pose, wi, range, component.weight);
        let pose = component.draw_pose(wi, mode, &mut u_lobe, of_pose)?;
        let lobes = component.bxdf.lobes(component.local(&pose, wi));
        let probability = |l: &Lobe| if range.contains(l.roughness) { l.probability } else { 0.0 };
        let inside: f32 = lobes.iter().map(probability).sum();
        let lobe = pick(&mut u_lobe, lobes.iter().map(|l| probability(l) / inside))?;
        let (wo, eta) = component.draw(&pose, lobe, wi, u_lobe, u)?;
        let (f, pdf) = self.eval_pdf_solid(wi, wo, mode, range);
        let pdf = pdf * (self.total() / all);
        let weight = finite(f * (wo.z.abs() / pdf), pdf)?;
        Some(SmoothSample { wo, weight, pdf, eta })
    }
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
