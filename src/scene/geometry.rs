//! Primitives and their BVHs: one level for the world, one per shape group that is instanced.

use std::marker::PhantomData;
use std::ops::Range;

use crate::accel::{Bvh, Visitor};
use crate::math::simd::{Wide, widest_bundle, widest_wide};
use crate::math::{Bounds, Ray, Vec3};
use crate::shape::Analytic;
use crate::shape::triangle::{Block, Bundle, Corners, Nearest, Shear, WIDTH};

/// A triangle, or the number of something else, as the builder lists them.
#[derive(Clone, Copy, Debug)]
pub struct Primitive {
    v: [[f32; 3]; 3],
    pub shape: u32,
    /// Triangle of the shape's mesh; with [`ANALYTIC`] or [`INSTANCE`] set, an index into those lists.
    tag: u32,
}

const ANALYTIC: u32 = 1 << 31;
const INSTANCE: u32 = 1 << 30;
const INDEX: u32 = INSTANCE - 1;

/// What a primitive is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Triangle(u32),
    Analytic(u32),
    Instance(u32),
}

fn kind(tag: u32) -> Kind {
    if tag & (ANALYTIC | INSTANCE) == 0 {
        Kind::Triangle(tag)
    } else if tag & ANALYTIC != 0 {
        Kind::Analytic(tag & INDEX)
    } else {
        Kind::Instance(tag & INDEX)
    }
}

impl Primitive {
    pub fn triangle(v: [[f32; 3]; 3], shape: u32, index: u32) -> Self {
        debug_assert!(index <= INDEX);
        Self { v, shape, tag: index }
    }

    pub fn analytic(shape: u32, index: u32) -> Self {
        Self { v: [[0.0; 3]; 3], shape, tag: index | ANALYTIC }
    }

    pub fn instance(index: u32) -> Self {
        Self { v: [[0.0; 3]; 3], shape: u32::MAX, tag: index | INSTANCE }
    }

    pub fn corners(&self) -> &[[f32; 3]; 3] {
        &self.v
    }

    pub fn corners_mut(&mut self) -> &mut [[f32; 3]; 3] {
        &mut self.v
    }

    pub fn kind(&self) -> Kind {
        kind(self.tag)
    }

    /// With the lists that its number is an index into.
    pub fn bounds(&self, analytic: &[Analytic], instance_bounds: &[Bounds]) -> Bounds {
        match self.kind() {
            Kind::Triangle(_) => Bounds::of(self.v.map(Vec3::from)),
            Kind::Analytic(i) => analytic[i as usize].bounds(),
            Kind::Instance(i) => instance_bounds[i as usize],
        }
    }
}

/// Most triangles of one mesh, and most meshes or instances of one scene.
pub const MAX_INDEX: usize = INDEX as usize;

/// The primitives of a leaf: up to eight triangles, or up to eight other things.
#[derive(Clone, Copy, Debug)]
struct Packet {
    triangles: Block,
    shape: [u32; WIDTH],
    tag: [u32; WIDTH],
    /// Lanes in use when these are no triangles, else 0.
    others: u32,
}

/// A triangle as shading wants it.
#[derive(Clone, Copy, Debug)]
pub struct Face {
    corners: Corners,
    /// Unit normal by the winding.
    pub normal: Vec3,
    /// Largest coordinate of a corner.
    pub magnitude: f32,
}

impl Face {
    #[inline(always)]
    fn new(block: &Block, lane: usize) -> Self {
        let [a, b, c] = [block.corner(0, lane), block.corner(1, lane), block.corner(2, lane)];
        Self {
            corners: [a, b, c].map(|v| v.extend(0.0).to_array()),
            normal: (b - a).cross(c - a).normalize_or(Vec3::Z),
            magnitude: a.abs().max(b.abs()).max(c.abs()).max_element(),
        }
    }

    #[inline(always)]
    pub fn corners(&self) -> [Vec3; 3] {
        self.corners.map(|v| Vec3::from_vec4(v.into()))
    }
}

/// Affine map in f32 with its inverse.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    pub columns: [Vec3; 4],
    pub inverse: [Vec3; 4],
}

fn affine(m: &[Vec3; 4], v: Vec3, w: f32) -> Vec3 {
    m[0] * v.x + m[1] * v.y + m[2] * v.z + m[3] * w
}

impl Placement {
    pub fn point(&self, p: Vec3) -> Vec3 {
        affine(&self.columns, p, 1.0)
    }

    pub fn vector(&self, v: Vec3) -> Vec3 {
        affine(&self.columns, v, 0.0)
    }

    /// Normals go by the inverse transpose.
    pub fn normal(&self, n: Vec3) -> Vec3 {
        Vec3::new(self.inverse[0].dot(n), self.inverse[1].dot(n), self.inverse[2].dot(n)).normalize_or_zero()
    }

    pub fn inverse_point(&self, p: Vec3) -> Vec3 {
        affine(&self.inverse, p, 1.0)
    }

    pub fn inverse_vector(&self, v: Vec3) -> Vec3 {
        affine(&self.inverse, v, 0.0)
    }

    /// t is the same on both sides because the direction is not normalised.
    fn inverse_ray(&self, ray: &Ray, tmax: f32) -> Ray {
        Ray { o: self.inverse_point(ray.o), d: self.inverse_vector(ray.d), tmax }
    }
}

/// A group placed in the world.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    pub group: u32,
    pub placement: Placement,
}

/// One level: packets of primitives and the tree over them.
#[derive(Debug)]
pub struct Level {
    packets: Vec<Packet>,
    /// All triangles in the order of the packets, when there is no tree and nothing else.
    flat: Vec<Face>,
    pub primitives: usize,
    pub analytic: Vec<Analytic>,
    bvh: Bvh,
    pub bounds: Bounds,
}

impl Level {
    pub fn new(primitives: &[Primitive], analytic: Vec<Analytic>, instance_bounds: &[Bounds]) -> Self {
        let boxes: Vec<Bounds> = primitives.iter().map(|p| p.bounds(&analytic, instance_bounds)).collect();
        let mut bounds = Bounds::EMPTY;
        boxes.iter().for_each(|b| bounds.union(b));
        let (bvh, packets) = Bvh::build(&boxes, |items, packets: &mut Vec<Packet>| {
            let flat = |&&i: &&u32| matches!(kind(primitives[i as usize].tag), Kind::Triangle(_));
            let (triangles, others): (Vec<&u32>, Vec<&u32>) = items.iter().partition(flat);
            for (list, are_triangles) in [(triangles, true), (others, false)] {
                packets.extend(list.chunks(WIDTH).map(|lanes| packet(primitives, lanes, are_triangles)));
            }
        });
        let flat = if bvh.is_flat() && packets.iter().all(|p| p.others == 0) {
            (0..primitives.len()).map(|i| Face::new(&packets[i / WIDTH].triangles, i % WIDTH)).collect()
        } else {
            Vec::new()
        };
        Self { packets, flat, primitives: primitives.len(), analytic, bvh, bounds }
    }

    pub fn bytes(&self) -> usize {
        self.bvh.bytes() + size_of_val(self.packets.as_slice())
    }

    /// What a hit in this level met.
    #[inline(always)]
    pub fn kind(&self, hit: &Hit) -> Kind {
        kind(self.packets[hit.packet as usize].tag[hit.lane as usize])
    }

    /// Shape of the primitive that was hit.
    #[inline(always)]
    pub fn shape(&self, hit: &Hit) -> u32 {
        self.packets[hit.packet as usize].shape[hit.lane as usize]
    }

    /// The triangle that was hit.
    #[inline(always)]
    pub fn face(&self, hit: &Hit) -> Face {
        let (packet, lane) = (hit.packet as usize, hit.lane as usize % WIDTH);
        // Large scenes would wait longer for a stored face than it takes to make it from what the search
        // for the hit has just read.
        match self.flat.get(packet * WIDTH + lane) {
            Some(face) => *face,
            None => Face::new(&self.packets[packet].triangles, lane),
        }
    }
}

fn packet(primitives: &[Primitive], lanes: &[&u32], are_triangles: bool) -> Packet {
    let mut packet = Packet { triangles: Block::EMPTY, shape: [u32::MAX; WIDTH], tag: [0; WIDTH], others: 0 };
    for (lane, &&i) in lanes.iter().enumerate() {
        let p = &primitives[i as usize];
        (packet.shape[lane], packet.tag[lane]) = (p.shape, p.tag);
        if are_triangles {
            packet.triangles.set(lane, &p.v);
        } else {
            packet.others += 1;
        }
    }
    packet
}

/// Where a ray met a primitive.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    pub t: f32,
    /// Barycentric weights of the second and third corner (triangles).
    pub b1: f32,
    pub b2: f32,
    /// Packet of the level, and the lane in it.
    packet: u32,
    lane: u32,
    /// Instance the primitive was reached through; [`NO_INSTANCE`] for the world itself.
    pub instance: u32,
}

pub const NO_INSTANCE: u32 = u32::MAX;

/// Everything rays can meet.
#[derive(Debug)]
pub struct Geometry {
    pub world: Level,
    pub groups: Vec<Level>,
    pub instances: Vec<Instance>,
}

impl Geometry {
    /// Level that holds the primitive of `hit`.
    pub fn level(&self, instance: u32) -> &Level {
        match self.instances.get(instance as usize) {
            Some(i) => &self.groups[i.group as usize],
            None => &self.world,
        }
    }

    /// Nearest hit in (0, tmax).
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        widest_wide!(Geometry::closest_any; geometry: &Geometry = self, ray: &Ray = ray => Option<Hit>)
    }

    #[inline(always)]
    fn closest_any<W: Wide>(&self, ray: &Ray) -> Option<Hit> {
        let mut best = None;
        self.closest_in::<W>(&self.world, ray, NO_INSTANCE, &mut best);
        best
    }

    #[inline(always)]
    fn closest_in<W: Wide>(&self, level: &Level, ray: &Ray, instance: u32, best: &mut Option<Hit>) {
        let mut visitor = Closest {
            geometry: self,
            level,
            ray,
            shear: Shear::new(ray),
            instance,
            best,
            wide: PhantomData::<W>,
        };
        level.bvh.walk::<W, true>(ray, &mut visitor);
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
    fn closest_in_group_any<W: Wide>(&self, group: u32, ray: &Ray, instance: u32) -> Option<Hit> {
        let mut best = None;
        self.closest_in::<W>(&self.groups[group as usize], ray, instance, &mut best);
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
    ) {
        for some in which.chunks(N) {
            let mut bundle = Bundle::<N, W>::new(std::array::from_fn(|l| &rays[some[l.min(some.len() - 1)]]));
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
    fn occluded_flat<const N: usize, W: Wide<N>>(&self, rays: &[Ray], occluded: &mut Vec<bool>) {
        for some in rays.chunks(N) {
            let bundle = Bundle::<N, W>::new(std::array::from_fn(|l| &some[l.min(some.len() - 1)]));
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
    fn occluded_any<W: Wide>(&self, ray: &Ray) -> bool {
        self.occluded_in::<W>(&self.world, ray)
    }

    fn occluded_in_group(&self, group: u32, ray: &Ray) -> bool {
        widest_wide!(Geometry::occluded_in_group_any;
            geometry: &Geometry = self, group: u32 = group, ray: &Ray = ray => bool)
    }

    #[inline(always)]
    fn occluded_in_group_any<W: Wide>(&self, group: u32, ray: &Ray) -> bool {
        self.occluded_in::<W>(&self.groups[group as usize], ray)
    }

    #[inline(always)]
    fn occluded_in<W: Wide>(&self, level: &Level, ray: &Ray) -> bool {
        let mut visitor =
            Any { geometry: self, level, ray, shear: Shear::new(ray), found: false, wide: PhantomData::<W> };
        level.bvh.walk::<W, false>(ray, &mut visitor);
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

    pub fn bytes(&self) -> usize {
        self.world.bytes() + self.groups.iter().map(Level::bytes).sum::<usize>()
    }
}

/// Looks for the nearest hit.
struct Closest<'a, W> {
    geometry: &'a Geometry,
    level: &'a Level,
    ray: &'a Ray,
    shear: Shear,
    instance: u32,
    best: &'a mut Option<Hit>,
    wide: PhantomData<W>,
}

impl<W: Wide> Visitor for Closest<'_, W> {
    #[inline(always)]
    fn test(&mut self, elements: Range<usize>, tmax: &mut f32) -> bool {
        let mut nearest = Nearest::<W>::new(*tmax);
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
struct Any<'a, W> {
    geometry: &'a Geometry,
    level: &'a Level,
    ray: &'a Ray,
    shear: Shear,
    found: bool,
    wide: PhantomData<W>,
}

impl<W: Wide> Visitor for Any<'_, W> {
    #[inline(always)]
    fn test(&mut self, elements: Range<usize>, tmax: &mut f32) -> bool {
        for (p, i) in self.level.packets[elements.clone()].iter().zip(elements) {
            self.found = if p.others > 0 {
                self.geometry.occluded_by_other(self.level, i, self.ray)
            } else {
                self.shear.occluded::<W>(&p.triangles, *tmax)
            };
            if self.found {
                return true;
            }
        }
        false
    }
}
