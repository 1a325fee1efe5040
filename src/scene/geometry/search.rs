//! Rays against the geometry: the nearest hit, or any.

use std::ops::Range;

use super::primitive::{Kind, kind};
use super::{Geometry, Hit, Level, NO_INSTANCE};
use crate::accel::Visitor;
use crate::math::Ray;
use crate::math::simd::{Wide, widest_bundle, widest_wide};
use crate::shape::triangle::{Bundle, Nearest, Shear, WIDTH};

impl Geometry {
    /// Nearest hit in (0, tmax).
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        widest_wide!(Geometry::closest_any; geometry: &Geometry = self, ray: &Ray = ray => Option<Hit>)
    }

    #[inline(always)]
    fn closest_any<W: Wide>(&self, ray: &Ray, isa: W::Isa) -> Option<Hit> {
        let mut best = None;
        self.closest_in::<W>(&self.world, ray, NO_INSTANCE, &mut best, isa);
        best
    }

    #[inline(always)]
    fn closest_in<W: Wide>(
        &self,
        level: &Level,
        ray: &Ray,
        instance: u32,
        best: &mut Option<Hit>,
        isa: W::Isa,
    ) {
        let shear = Shear::new(ray);
        let mut visitor = Closest::<W> { geometry: self, level, ray, shear, instance, best, isa };
        level.bvh.walk::<W, true>(ray, &mut visitor, isa);
    }

    #[inline(never)]
    fn closest_other(
        &self,
        level: &Level,
        element: usize,
        ray: &Ray,
        tmax: &mut f32,
        instance: u32,
        best: &mut Option<Hit>,
    ) {
        let p = &level.packets[element];
        for lane in 0..p.others {
            let found = match kind(p.tag[lane as usize]) {
                Kind::Analytic(i) => level.analytic[i as usize].intersect(ray, *tmax).map(|t| Hit {
                    t,
                    b1: 0.0,
                    b2: 0.0,
                    packet: element as u32,
                    lane,
                    instance,
                }),
                Kind::Instance(i) => {
                    let placed = &self.instances[i as usize];
                    let local = placed.placement.inverse_ray(ray, *tmax);
                    self.closest_in_group(placed.group, &local, i)
                }
                Kind::Triangle(_) => None,
            };
            if let Some(hit) = found {
                *tmax = hit.t;
                *best = Some(hit);
            }
        }
    }

    fn closest_in_group(&self, group: u32, ray: &Ray, instance: u32) -> Option<Hit> {
        widest_wide!(Geometry::closest_in_group_any;
            geometry: &Geometry = self, group: u32 = group, ray: &Ray = ray, instance: u32 = instance
            => Option<Hit>)
    }

    #[inline(always)]
    fn closest_in_group_any<W: Wide>(
        &self,
        group: u32,
        ray: &Ray,
        instance: u32,
        isa: W::Isa,
    ) -> Option<Hit> {
        let mut best = None;
        self.closest_in::<W>(&self.groups[group as usize], ray, instance, &mut best, isa);
        best
    }

    /// [`Geometry::closest`] of `rays[i]` into `hits[i]` for all `i` of `which`.
    pub fn closest_each(&self, rays: &[Ray], which: &[usize], hits: &mut [Option<Hit>]) {
        if self.world.flat.is_empty() {
            which.iter().for_each(|&i| hits[i] = self.closest(&rays[i]));
            return;
        }
        widest_bundle!(Geometry::closest_flat; geometry: &Geometry = self, rays: &[Ray] = rays,
            which: &[usize] = which, hits: &mut [Option<Hit>] = hits => ())
    }

    #[inline(always)]
    fn closest_flat<const N: usize, W: Wide<N>>(
        &self,
        rays: &[Ray],
        which: &[usize],
        hits: &mut [Option<Hit>],
        isa: W::Isa,
    ) {
        for some in which.chunks(N) {
            let mut bundle =
                Bundle::<N, W>::new(std::array::from_fn(|l| &rays[some[l.min(some.len() - 1)]]), isa);
            for (face, i) in self.world.flat.iter().zip(0..) {
                bundle.add(&face.corners, i);
            }
            let (triangle, [t, b1, b2]) = bundle.found();
            for (l, &i) in some.iter().enumerate() {
                hits[i] = (triangle[l] != u32::MAX).then(|| Hit {
                    t: t[l],
                    b1: b1[l],
                    b2: b2[l],
                    packet: triangle[l] / WIDTH as u32,
                    lane: triangle[l] % WIDTH as u32,
                    instance: NO_INSTANCE,
                });
            }
        }
    }

    /// [`Geometry::occluded`] of each ray.
    pub fn occluded_each(&self, rays: &[Ray], occluded: &mut Vec<bool>) {
        occluded.clear();
        if self.world.flat.is_empty() {
            occluded.extend(rays.iter().map(|ray| self.occluded(ray)));
            return;
        }
        widest_bundle!(Geometry::occluded_flat; geometry: &Geometry = self, rays: &[Ray] = rays,
            occluded: &mut Vec<bool> = occluded => ())
    }

    #[inline(always)]
    fn occluded_flat<const N: usize, W: Wide<N>>(&self, rays: &[Ray], occluded: &mut Vec<bool>, isa: W::Isa) {
        for some in rays.chunks(N) {
            let bundle = Bundle::<N, W>::new(std::array::from_fn(|l| &some[l.min(some.len() - 1)]), isa);
            let mut blocked = 0;
            for face in &self.world.flat {
                blocked |= bundle.blocked(&face.corners);
            }
            for l in 0..some.len() {
                occluded.push(blocked >> l & 1 == 1);
            }
        }
    }

    /// Whether anything lies in (0, tmax).
    pub fn occluded(&self, ray: &Ray) -> bool {
        widest_wide!(Geometry::occluded_any; geometry: &Geometry = self, ray: &Ray = ray => bool)
    }

    #[inline(always)]
    fn occluded_any<W: Wide>(&self, ray: &Ray, isa: W::Isa) -> bool {
        self.occluded_in::<W>(&self.world, ray, isa)
    }

    fn occluded_in_group(&self, group: u32, ray: &Ray) -> bool {
        widest_wide!(Geometry::occluded_in_group_any;
            geometry: &Geometry = self, group: u32 = group, ray: &Ray = ray => bool)
    }

    #[inline(always)]
    fn occluded_in_group_any<W: Wide>(&self, group: u32, ray: &Ray, isa: W::Isa) -> bool {
        self.occluded_in::<W>(&self.groups[group as usize], ray, isa)
    }

    #[inline(always)]
    fn occluded_in<W: Wide>(&self, level: &Level, ray: &Ray, isa: W::Isa) -> bool {
        let mut visitor = Any::<W> { geometry: self, level, ray, shear: Shear::new(ray), found: false, isa };
        level.bvh.walk::<W, false>(ray, &mut visitor, isa);
        visitor.found
    }

    #[inline(never)]
    fn occluded_by_other(&self, level: &Level, element: usize, ray: &Ray) -> bool {
        let p = &level.packets[element];
        (0..p.others as usize).any(|lane| match kind(p.tag[lane]) {
            Kind::Analytic(i) => level.analytic[i as usize].intersect(ray, ray.tmax).is_some(),
            Kind::Instance(i) => {
                let placed = &self.instances[i as usize];
                self.occluded_in_group(placed.group, &placed.placement.inverse_ray(ray, ray.tmax))
            }
            Kind::Triangle(_) => false,
        })
    }
}

/// Looks for the nearest hit.
struct Closest<'a, W: Wide> {
    geometry: &'a Geometry,
    level: &'a Level,
    ray: &'a Ray,
    shear: Shear,
    instance: u32,
    best: &'a mut Option<Hit>,
    isa: W::Isa,
}

impl<W: Wide> Visitor for Closest<'_, W> {
    #[inline(always)]
    fn test(&mut self, elements: Range<usize>, tmax: &mut f32) -> bool {
        let mut nearest = Nearest::<W>::new(*tmax, self.isa);
        let mut i = elements.start as u32;
        for p in &self.level.packets[elements.clone()] {
            if p.others > 0 {
                // Triangles come first in a leaf.
                break;
            }
            nearest.add(&self.shear, &p.triangles, i);
            i += 1;
        }
        let others = i as usize;
        if let Some((packet, lane, t, b1, b2)) = nearest.best(*tmax) {
            *tmax = t;
            *self.best = Some(Hit { t, b1, b2, packet, lane: lane as u32, instance: self.instance });
        }
        for i in others..elements.end {
            self.geometry.closest_other(self.level, i, self.ray, tmax, self.instance, self.best);
        }
        false
    }
}

/// Looks for any hit.
struct Any<'a, W: Wide> {
    geometry: &'a Geometry,
    level: &'a Level,
    ray: &'a Ray,
    shear: Shear,
    found: bool,
    isa: W::Isa,
}

impl<W: Wide> Visitor for Any<'_, W> {
    #[inline(always)]
    fn test(&mut self, elements: Range<usize>, tmax: &mut f32) -> bool {
        for (p, i) in self.level.packets[elements.clone()].iter().zip(elements) {
            self.found = if p.others > 0 {
                self.geometry.occluded_by_other(self.level, i, self.ray)
            } else {
                self.shear.occluded::<W>(&p.triangles, *tmax, self.isa)
            };
            if self.found {
                return true;
            }
        }
        false
    }
}
