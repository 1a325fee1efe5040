//! Light paths in scenes without media.

use super::Photon;
use super::job::{Part, TraceJob};
use crate::bsdf::{Event, Range, Transport, adjoint_correction};
use crate::film::Rejected;
use crate::math::{Color, Ray, Vec3};
use crate::sampling::Sampler;
use crate::scene::{LightStart, Scene};
use crate::transport::roulette::Length;
use crate::transport::{Owner, PathClass, Smallness, Vertex, roulette};

/// Follows a path from its start. Returns the first surface point; `None` if it misses the scene.
#[inline]
pub(super) fn follow(
    scene: &Scene,
    job: &TraceJob,
    start: &LightStart,
    sampler: &mut Sampler,
    out: &mut Part,
) -> Option<Vec3> {
    let emission = &start.emission;
    let mut flux = emission.flux / job.paths as f32;
    let mut ray = Ray::new(emission.o, emission.d);
    let mut class = PathClass::FROM_LAMP;
    let mut depth = 1u32;
    let mut first = None;
    let mut smallness = Smallness::default();
    // By a specular or glossy surface, since the last rough one.
    let mut bent = false;
    loop {
        out.rays += 1;
        let Some(hit) = scene.geometry.closest(&ray) else { return first };
        let surface = scene.surface(&ray, &hit);
        first.get_or_insert(surface.p);
        let vertex = Vertex::new(scene, &surface, -ray.d);
        let kept = job.all || class.owner(job.next_event, job.caustic_map) == job.owner;
        if kept && holds_photons(scene, job, &vertex) {
            let focused = job.focused && bent && class == PathClass::Indirect;
            let class = if job.all { PathClass::Indirect } else { class };
            let n = scene.photon_side(&surface, vertex.back).n;
            let found = photon(&vertex, n, (flux, class, depth), smallness, &mut out.rejected);
            if focused { &mut out.apart } else { &mut out.photons }.extend(found);
        }
        let glint = job.glints && class == PathClass::Caustic && smallness.enough();
        if glint && vertex.closure.has_smooth(vertex.wi, Range::glossy(job.glossy)) {
            let n = scene.glint_side(&surface, vertex.back).n;
            out.apart.extend(photon(&vertex, n, (flux, class, depth), smallness, &mut out.rejected));
        }
        // A photon at the next surface needs two more segments: there, if the way is not straight on for nothing, and from
        // there to the camera.
        if depth.saturating_add(1 + scene.passage) > job.max_depth {
            return first;
        }
        let Some((d, next, event)) = scatter(scene, job, &vertex, flux, sampler) else { return first };
        let further = if event == Event::Null { scene.passage } else { 1 };
        if depth.saturating_add(1 + further) > job.max_depth {
            return first;
        }
        let length = Length { segments: depth, most: job.max_depth };
        let survival = roulette::light_survival(flux, next, length);
        flux = if survival < 1.0 {
            let Some(survivor) = roulette::survivor(next, survival, sampler) else { return first };
            survivor
        } else {
            next
        };
        if job.glints && class == PathClass::Direct && event != Event::Null {
            smallness = Smallness::of(scene.pdf_direct_start(surface.p, -ray.d, start));
        }
        if event != Event::Null {
            bent = event != Event::Smooth;
        }
        class = class.after_light_event(event);
        depth += further;
        ray = surface.leave(d);
    }
}

/// Whether there are lobes that photons are for.
#[inline(always)]
pub(super) fn holds_photons(scene: &Scene, job: &TraceJob, vertex: &Vertex<'_>) -> bool {
    let rough = Range::rough(job.glossy);
    vertex.closure.has_smooth(vertex.wi, rough) || scene.material(vertex.surface).may_have(rough)
}

/// The direction (world) in which light goes on, its flux there, and what it went through.
#[inline(always)]
pub(super) fn scatter(
    scene: &Scene,
    job: &TraceJob,
    vertex: &Vertex<'_>,
    flux: Color,
    sampler: &mut Sampler,
) -> Option<(Vec3, Color, Event)> {
    let (u_lobe, u) = (sampler.next_1d(), sampler.next_2d());
    let sample = vertex.closure.sample(vertex.wi, u_lobe, u, Transport::Importance, job.glossy)?;
    // The caustic map holds nothing of what a rough surface scattered.
    if sample.event == Event::Smooth && job.owner == Owner::CausticMap {
        return None;
    }
    let d = vertex.surface.frame.to_world(sample.wo);
    let event = sample.event_where(scene.panes_pass);
    Some((d, flux * sample.weight * adjoint(vertex, d, sample.wo.z, event), event))
}

/// [`adjoint_correction`] of light that goes on along `wo`. Straight through, nothing is scattered.
fn adjoint(vertex: &Vertex<'_>, wo: Vec3, wo_ns: f32, event: Event) -> f32 {
    let s = vertex.surface;
    if event == Event::Null || s.ng == s.frame.n {
        return 1.0;
    }
    adjoint_correction([vertex.wi.z, wo_ns], [vertex.back.dot(s.ng), wo.dot(s.ng)])
}

/// A photon where it arrives; `None` where it is not finite.
pub(super) fn photon(
    vertex: &Vertex<'_>,
    n: Vec3,
    (flux, class, depth): (Color, PathClass, u32),
    smallness: Smallness,
    rejected: &mut Rejected,
) -> Option<Photon> {
    let (s, wi) = (vertex.surface, vertex.back);
    // Density is counted per geometric area, but irradiance is wanted on the shading plane.
    let flux = flux * adjoint_correction([vertex.wi.z, 1.0], [wi.dot(s.ng), 1.0]);
    if !s.p.is_finite() {
        rejected.photon_place += 1;
        return None;
    }
    if !flux.is_finite() {
        rejected.photon_flux += 1;
        return None;
    }
    Some(Photon { p: s.p, flux, wi, n, class, depth: depth.min(255) as u8, smallness })
}
