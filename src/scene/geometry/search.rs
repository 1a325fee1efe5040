//! Rays against the geometry: the nearest hit, or any.

use std::ops::Range;

use super::level::{Other, Small};
use super::primitive::{Kind, kind};
use super::{Geometry, Hit, Level, NO_INSTANCE};
use crate::accel::Visitor;
use crate::math::Ray;
use crate::math::simd::{Wide, widest_bundle, widest_wide};
use crate::shape::triangle::{Bundle, Nearest, Shear, WIDTH};
use crate::shape::{Analytic, Lines};

impl Geometry {
    /// Nearest hit in (0, tmax).
    #[inline]
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        let mut best = None;
        self.find_closest(ray, &mut best);
        best
    }

    /// Puts the nearest hit into `best`, which holds none: it is not copied after it was written.
    fn find_closest(&self, ray: &Ray, best: &mut Option<Hit>) {
        widest_wide!(Geometry::closest_any;
            geometry: &Geometry = self, ray: &Ray = ray, best: &mut Option<Hit> = best => ())
    }

    #[inline(always)]
    fn closest_any<W: Wide>(&self, ray: &Ray, best: &mut Option<Hit>, isa: W::Isa) {
        self.closest_in::<W>(&self.world, ray, NO_INSTANCE, best, isa);
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
        let Some(small) = &self.world.small else {
            for &i in which {
                hits[i] = None;
                self.find_closest(&rays[i], &mut hits[i]);
            }
            return;
        };
        widest_bundle!(Geometry::closest_small; geometry: &Geometry = self, small: &Small = small, rays: &[Ray] = rays,
            which: &[usize] = which, hits: &mut [Option<Hit>] = hits => ())
    }

    #[inline(always)]
    fn closest_small<const N: usize, W: Wide<N>>(
        &self,
        small: &Small,
        rays: &[Ray],
        which: &[usize],
        hits: &mut [Option<Hit>],
        isa: W::Isa,
    ) {
        for some in which.chunks(N) {
            let together: [&Ray; N] = std::array::from_fn(|l| &rays[some[l.min(some.len() - 1)]]);
            let lines = Lines::<N, W>::new(together, isa);
            let mut bundle = Bundle::new(&lines);
            for (face, i) in small.faces.iter().zip(0..) {
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
            for other in &small.others {
                let shape = &self.world.analytic[other.analytic as usize];
                let mut may = lines_near(&lines, shape, some.len());
                while may != 0 {
                    let i = some[may.trailing_zeros() as usize];
                    may &= may - 1;
                    let before = hits[i].as_ref().map_or(rays[i].tmax, |hit| hit.t);
                    if let Some(t) = shape.intersect(&rays[i], before) {
                        let Other { packet, lane, .. } = *other;
                        hits[i] = Some(Hit { t, b1: 0.0, b2: 0.0, packet, lane, instance: NO_INSTANCE });
                    }
                }
            }
        }
    }

    /// [`Geometry::occluded`] of each ray.
    pub fn occluded_each(&self, rays: &[Ray], occluded: &mut Vec<bool>) {
        occluded.clear();
        let Some(small) = &self.world.small else {
            occluded.extend(rays.iter().map(|ray| self.occluded(ray)));
            return;
        };
        widest_bundle!(Geometry::occluded_small; geometry: &Geometry = self, small: &Small = small, rays: &[Ray] = rays,
            occluded: &mut Vec<bool> = occluded => ())
    }

    #[inline(always)]
    fn occluded_small<const N: usize, W: Wide<N>>(
        &self,
        small: &Small,
        rays: &[Ray],
        occluded: &mut Vec<bool>,
        isa: W::Isa,
    ) {
        for some in rays.chunks(N) {
            let together: [&Ray; N] = std::array::from_fn(|l| &some[l.min(some.len() - 1)]);
            let lines = Lines::<N, W>::new(together, isa);
            let bundle = Bundle::new(&lines);
            let mut blocked = 0;
            for face in &small.faces {
                blocked |= bundle.blocked(&face.corners);
            }
            for other in &small.others {
                let shape = &self.world.analytic[other.analytic as usize];
                let mut may = lines_near(&lines, shape, some.len()) & !blocked;
                while may != 0 {
                    let l = may.trailing_zeros();
                    may &= may - 1;
                    let ray = &some[l as usize];
                    blocked |= u32::from(shape.intersect(ray, ray.tmax).is_some()) << l;
                }
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

/// Which of the first `count` rays may meet the shape.
#[inline(always)]
fn lines_near<const N: usize, W: Wide<N>>(lines: &Lines<N, W>, shape: &Analytic, count: usize) -> u32 {
    let all = u32::MAX >> (u32::BITS as usize - count);
    match shape {
        Analytic::Sphere(sphere) => lines.near(sphere) & all,
        Analytic::Disk(_) | Analytic::Cylinder(_) => all,
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
