//! Radiance from photon density (Jensen 1996): L = Σ f(wi, wo)·Φ·k(d/r)/r². No cosine: the density of
//! photons on the surface already contains it.

use std::f32::consts::FRAC_1_PI;

use super::boundary::Boundary;
use super::scan;
use super::store::{PhotonMap, Query};
use crate::bsdf::{Range, Transport};
use crate::film::{Layer, Radiance};
use crate::math::kernel::{Kernel, KernelKind, with_kernel};
use crate::math::{Color, decode_direction};
use crate::scene::PhotonSide;
use crate::settings::Lookup;
use crate::transport::{Smallness, Vertex};

/// How one map is read.
#[derive(Clone, Copy, Debug)]
pub struct Estimator {
    /// Weight of a photon by its distance.
    pub kernel: KernelKind,
    /// Of the disc that is searched, in scene units.
    pub radius: f32,
    /// Most photons of one estimate: beyond it the nearest count, in their own smaller disc. At least 2.
    pub cap: usize,
    /// The lobes that photons are for.
    pub lobes: Range,
}

/// The k-th nearest photon bounds the disc and is not counted itself, so fewer than two show nothing.
const LEAST: usize = 2;

impl Estimator {
    /// Reads all photons within `radius`, or with [`Lookup::Nearest`] the `neighbours` nearest of them, and never
    /// more than `cap` (`u32::MAX` for no cap). Fewer than two neighbours count as two.
    pub fn new(kernel: KernelKind, radius: f32, lookup: Lookup, neighbours: u32, cap: u32) -> Self {
        let nearest = if lookup == Lookup::Nearest { neighbours as usize } else { usize::MAX };
        let cap = nearest.min(if cap == u32::MAX { usize::MAX } else { cap as usize }).max(LEAST);
        Self { kernel, radius, cap, lobes: Range::ALL }
    }
}

/// Where a camera path gathers, and what of the photons there counts.
#[derive(Clone, Copy, Debug)]
pub struct GatherPoint<'a> {
    /// The surface, and the direction that light is wanted along.
    pub vertex: &'a Vertex<'a>,
    /// The side whose photons tell of the light that is sent back.
    pub side: PhotonSide,
    /// Of the camera path.
    pub throughput: Color,
    /// Segments of the longest light path that counts.
    pub max_photon_depth: u32,
}

/// Scratch and counters of one thread.
#[derive(Debug, Default)]
pub struct Gather {
    found: Vec<(f32, u32)>,
    hint: f32,
    /// Estimates made.
    pub lookups: u64,
    /// Photons found by them.
    pub photons: u64,
}

impl Estimator {
    /// Adds to `out` the radiance that the photons of `map` send back from a gather point along the camera
    /// path, times its throughput. `boundary` corrects the density near edges.
    pub fn estimate(
        &self,
        map: &PhotonMap,
        at: &GatherPoint<'_>,
        mut boundary: Option<Boundary<'_>>,
        gather: &mut Gather,
        out: &mut Radiance,
    ) {
        if map.is_empty() {
            return;
        }
        gather.lookups += 1;
        let (vertex, s, n) = (at.vertex, at.vertex.surface, at.side.n);
        let q = Query { p: s.p, n, lift: s.lift, radius: self.radius };
        // Where photons of both sides lie together, each has to be asked for its side.
        let lambertian = vertex.closure.lambertian(vertex.wi).filter(|_| !at.side.both);
        let all_depths = at.max_photon_depth >= u32::from(map.deepest);
        let mut edge = None;
        if let (Some(albedo), Some(class), true, usize::MAX) =
            (lambertian, map.uniform_class, all_depths, self.cap)
        {
            let (sum, count) = with_kernel!(self.kernel, K => {
                let (sum, count) = scan::accumulate::<K>(map, &q);
                (sum * normalisation::<K>(q.radius * q.radius), count)
            });
            if count == 0 {
                return;
            }
            let found = boundary.as_mut().map(|b| b.correction(&q, q.radius, self.kernel));
            if !found.is_some_and(|e| e.obstructed) {
                gather.photons += u64::from(count);
                let factor = found.map_or(1.0, |e| e.factor);
                out.add(class.layer(), at.throughput * albedo * sum * (FRAC_1_PI * factor));
                return;
            }
            edge = found;
        }
        let r2 = gather.find(map, &q, self.cap);
        gather.photons += gather.found.len() as u64;
        if gather.found.is_empty() {
            return;
        }
        let mut factor = 1.0;
        if let Some(b) = &mut boundary {
            let radius = r2.sqrt();
            let edge = edge.unwrap_or_else(|| b.correction(&q, radius, self.kernel));
            factor = edge.factor;
            if edge.obstructed {
                gather.found.retain(|&(_, i)| b.sees(&q, radius, map.place(i)));
            }
        }
        with_kernel!(self.kernel, K => {
            let scale = normalisation::<K>(r2) * factor;
            for &(d2, i) in &gather.found {
                let weight = K::shape(d2 / r2) * scale;
                self.add_photon(map, i as usize, at, lambertian, weight, out);
            }
        });
    }

    /// [`Estimator::estimate`] for a map of glints, of which those count that belong to photons.
    pub fn glints(
        &self,
        map: &PhotonMap,
        at: &GatherPoint<'_>,
        mut boundary: Option<Boundary<'_>>,
        gather: &mut Gather,
        out: &mut Radiance,
    ) {
        if map.is_empty() {
            return;
        }
        gather.lookups += 1;
        let Vertex { surface: s, wi, ref closure, .. } = *at.vertex;
        let q = Query { p: s.p, n: at.side.n, lift: s.lift, radius: self.radius };
        let r2 = gather.find(map, &q, self.cap);
        gather.photons += gather.found.len() as u64;
        let mut sum = Color::ZERO;
        with_kernel!(self.kernel, K => {
            for &(d2, i) in &gather.found {
                let i = i as usize;
                let wo = s.frame.to_local(decode_direction(map.direction[i]));
                let f = closure.eval(wi, wo, Transport::Radiance, self.lobes);
                if f.max_element() <= 0.0 || u32::from(map.depth[i]) > at.max_photon_depth {
                    continue;
                }
                let pdf = closure.pdf(wi, wo, Transport::Radiance, self.lobes);
                if map.smallness(i) >= Smallness::least(pdf) {
                    let flux = map.flux_of(i);
                    sum += f * flux * K::shape(d2 / r2);
                }
            }
            sum *= normalisation::<K>(r2);
        });
        if sum.max_element() > 0.0 {
            let edge = boundary.as_mut().map(|b| b.correction(&q, r2.sqrt(), self.kernel));
            out.add(Layer::Emission, at.throughput * sum * edge.map_or(1.0, |e| e.factor));
        }
    }

    /// Irradiance of all photons of `map` around a place.
    pub(super) fn irradiance(
        &self,
        map: &PhotonMap,
        q: &Query,
        mut boundary: Option<Boundary<'_>>,
        gather: &mut Gather,
    ) -> Color {
        let edge = boundary.as_mut().map(|b| b.correction(q, q.radius, self.kernel));
        let factor = edge.map_or(1.0, |e| e.factor);
        with_kernel!(self.kernel, K => {
            let scale = normalisation::<K>(q.radius * q.radius) * factor;
            let Some(b) = boundary.as_mut().filter(|_| edge.is_some_and(|e| e.obstructed)) else {
                return scan::accumulate::<K>(map, q).0 * scale;
            };
            let r2 = gather.find(map, q, usize::MAX);
            let mut sum = Color::ZERO;
            for &(d2, i) in &gather.found {
                if b.sees(q, q.radius, map.place(i)) {
                    let i = i as usize;
                    let flux = map.flux_of(i);
                    sum += flux * K::shape(d2 / r2);
                }
            }
            sum * scale
        })
    }

    /// Adds what one photon sends along the camera path; `lambertian` is the albedo of a surface that asks
    /// for no direction.
    #[inline(always)]
    fn add_photon(
        &self,
        map: &PhotonMap,
        i: usize,
        at: &GatherPoint<'_>,
        lambertian: Option<Color>,
        weight: f32,
        out: &mut Radiance,
    ) {
        if u32::from(map.depth[i]) > at.max_photon_depth {
            return;
        }
        let f = match lambertian {
            Some(albedo) => albedo * FRAC_1_PI,
            None => {
                let Vertex { surface, wi, ref closure, .. } = *at.vertex;
                let wo = surface.frame.to_local(decode_direction(map.direction[i]));
                closure.eval(wi, wo, Transport::Radiance, self.lobes)
            }
        };
        let flux = map.flux_of(i);
        out.add(map.class(i).layer(), at.throughput * f * flux * weight);
    }
}

impl Gather {
    /// The nearest photon of the disc.
    pub(super) fn nearest(&mut self, map: &PhotonMap, q: &Query) -> Option<usize> {
        self.lookups += 1;
        // How near the nearest one was to the query before says nothing. About three photons share a cell: with this share
        // of its size, one query in seven finds none, and few cells are looked at.
        let mut radius = 0.45 / map.inverse_cell;
        map.nearest(q, 1, &mut radius, &mut self.found);
        self.found.first().map(|&(_, i)| i as usize)
    }

    /// Fills `found` and returns the squared radius it stands for. With more than `cap` photons in the
    /// disc, the distance of the cap-th is the radius and that photon itself is left out: k − 1 photons
    /// in the disc through the k-th is the unbiased density of a uniform pattern.
    fn find(&mut self, map: &PhotonMap, q: &Query, cap: usize) -> f32 {
        if cap == usize::MAX {
            self.found.clear();
            let found = &mut self.found;
            map.within(q, &mut |i, d2| found.push((d2, i)));
            return q.radius * q.radius;
        }
        map.nearest(q, cap, &mut self.hint, &mut self.found);
        if self.found.len() < cap {
            return q.radius * q.radius;
        }
        let last =
            self.found.iter().enumerate().max_by(|a, b| a.1.0.total_cmp(&b.1.0).then(a.1.1.cmp(&b.1.1)));
        let Some((at, &(d2, _))) = last else { return q.radius * q.radius };
        if d2 <= q.lift * q.lift {
            // All of them in one point: their own distance is rounding; spread them over the lift.
            return (q.lift * q.lift).max(f32::MIN_POSITIVE);
        }
        self.found.swap_remove(at);
        d2
    }
}

/// 1/(mass·r²): makes the profile a density per area.
fn normalisation<K: Kernel>(r2: f32) -> f32 {
    (1.0 / (K::mass() * f64::from(r2))) as f32
}
