//! Watertight ray–triangle test (Woop, Benthin, Wald 2013): neighbours that share an edge compute the
//! same edge function up to its sign, so no ray slips between them.

use super::Lines;
use crate::math::simd::Wide;
use crate::math::{Ray, Vec3};

/// Per-ray constants: the axis permutation and shear that turn the ray into +Z.
#[derive(Clone, Copy, Debug)]
pub struct Shear {
    k: [usize; 3],
    s: [f32; 3],
    /// Origin along the permuted axes.
    o: [f32; 3],
}

/// The axes across a ray along each axis, forward and backward: the winding of a triangle, and with it the sign of the
/// edge functions, then means the same for every ray.
const ACROSS: [[[usize; 2]; 3]; 2] = [[[1, 2], [2, 0], [0, 1]], [[2, 1], [0, 2], [1, 0]]];

impl Shear {
    /// For a ray of any length.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let d = ray.d.to_array();
        let a = ray.d.abs();
        // No branch: which axis it is cannot be predicted.
        let along_x = (a.x > a.y) & (a.x > a.z);
        let along_y = (a.x <= a.y) & (a.y > a.z);
        let kz = 2 - 2 * usize::from(along_x) - usize::from(along_y);
        let [kx, ky] = ACROSS[usize::from(d[kz] < 0.0)][kz];
        let inv = 1.0 / d[kz];
        let o = ray.o.to_array();
        Self { k: [kx, ky, kz], s: [d[kx] * inv, d[ky] * inv, inv], o: [o[kx], o[ky], o[kz]] }
    }

    /// Whether any lane is hit with `0 < t < tmax`.
    #[inline(always)]
    pub fn occluded<W: Wide>(&self, b: &Block, tmax: f32, isa: W::Isa) -> bool {
        W::bits(self.test(b, W::splat(isa, tmax)).hit) != 0
    }

    #[inline(always)]
    fn test<W: Wide>(&self, b: &Block, tmax: W) -> Lanes<W, W::Mask> {
        let isa = tmax.isa();
        let o = [W::splat(isa, self.o[0]), W::splat(isa, self.o[1]), W::splat(isa, self.o[2])];
        let s = [W::splat(isa, self.s[0]), W::splat(isa, self.s[1]), W::splat(isa, self.s[2])];
        // No closure: it would not be compiled for the wider instructions.
        let corners = [self.sheared(&b.v[0], o, s), self.sheared(&b.v[1], o, s), self.sheared(&b.v[2], o, s)];
        test_sheared(&corners, s[2], tmax)
    }

    /// Vertices relative to the ray, which becomes +Z.
    #[inline(always)]
    fn sheared<W: Wide>(&self, v: &[[f32; WIDTH]; 3], o: [W; 3], s: [W; 3]) -> [W; 3] {
        let [kx, ky, kz] = self.k;
        // SAFETY: `k` is a permutation of 0, 1, 2. Nine checks would cost a quarter of the whole test.
        let (x, y, z) = unsafe { (v.get_unchecked(kx), v.get_unchecked(ky), v.get_unchecked(kz)) };
        let isa = o[0].isa();
        shear([W::load(isa, x), W::load(isa, y), W::load(isa, z)], o, s)
    }
}

/// A point with permuted axes, relative to a ray that becomes +Z.
#[inline(always)]
fn shear<const N: usize, W: Wide<N>>(p: [W; 3], o: [W; 3], s: [W; 3]) -> [W; 3] {
    let z = p[2] - o[2];
    [p[0] - o[0] - s[0] * z, p[1] - o[1] - s[1] * z, z]
}

/// The test proper, on sheared corners.
#[inline(always)]
fn test_sheared<const N: usize, W: Wide<N>>(corners: &[[W; 3]; 3], sz: W, tmax: W) -> Lanes<W, W::Mask> {
    let [[x0, y0, z0], [x1, y1, z1], [x2, y2, z2]] = *corners;
    let e = [x2 * y1 - y2 * x1, x0 * y2 - y0 * x2, x1 * y0 - y1 * x0];
    let z = [z0, z1, z2];
    // The product may also underflow to zero; what follows is right for any triangle.
    let isa = tmax.isa();
    if W::bits((e[0] * e[1] * e[2]).equal(W::splat(isa, 0.0))) != 0 {
        let (x, y) = ([x0.array(), x1.array(), x2.array()], [y0.array(), y1.array(), y2.array()]);
        let mut exact = [e[0].array(), e[1].array(), e[2].array()];
        on_edges(&x, &y, &mut exact);
        let exact = [W::load(isa, &exact[0]), W::load(isa, &exact[1]), W::load(isa, &exact[2])];
        return decide(exact, z, sz, tmax);
    }
    decide(e, z, sz, tmax)
}

/// Rays that are tested against one triangle after the other: where there is no tree, that saves
/// finding the best of several lanes. A triangle gives each ray the same bits as [`Shear`] does.
#[derive(Clone, Copy, Debug)]
pub struct Bundle<const N: usize, W: Wide<N>> {
    k: [W::Index; 3],
    o: [W; 3],
    s: [W; 3],
    t: W,
    b1: W,
    b2: W,
    /// Triangle numbers, as bits.
    triangle: W,
}

/// Corners with a lane to spare, as [`Bundle`] reads them.
pub type Corners = [[f32; 4]; 3];

impl<const N: usize, W: Wide<N>> Bundle<N, W> {
    /// Nothing met yet. It is what [`Shear::new`] does, without a branch.
    #[inline(always)]
    pub fn new(rays: &Lines<N, W>) -> Self {
        let Lines { o, d, tmax, .. } = *rays;
        let isa = tmax.isa();
        let zero = W::splat(isa, 0.0);
        let a = [d[0].max(zero - d[0]), d[1].max(zero - d[1]), d[2].max(zero - d[2])];
        let along_x = W::and(a[1].less(a[0]), a[2].less(a[0]));
        let along_y = W::and_not(a[1].less(a[0]), a[2].less(a[1]));
        // The axis along the ray, the next one, and the one after it.
        let z = Self::choose(along_x, along_y, d);
        let backward = z.less(zero);
        let [x, y] = Self::turned(backward, along_x, along_y, d);
        let inv = W::splat(isa, 1.0) / z;
        let [ox, oy] = Self::turned(backward, along_x, along_y, o);
        let number = |i: u32| W::splat(isa, f32::from_bits(i));
        let axes = [number(0), number(1), number(2)];
        let [kx, ky] = Self::turned(backward, along_x, along_y, axes);
        let kz = Self::choose(along_x, along_y, axes);
        Self {
            k: [kx.as_index(), ky.as_index(), kz.as_index()],
            o: [ox, oy, Self::choose(along_x, along_y, o)],
            s: [x * inv, y * inv, inv],
            t: tmax,
            b1: zero,
            b2: zero,
            triangle: W::splat(isa, f32::from_bits(u32::MAX)),
        }
    }

    /// `v[0]` where the ray runs along x, `v[1]` where along y, else `v[2]`.
    #[inline(always)]
    fn choose(along_x: W::Mask, along_y: W::Mask, v: [W; 3]) -> W {
        v[0].select(along_x, v[1].select(along_y, v[2]))
    }

    /// The two axes across the ray, in the order that keeps the winding.
    #[inline(always)]
    fn turned(backward: W::Mask, along_x: W::Mask, along_y: W::Mask, v: [W; 3]) -> [W; 2] {
        let x = Self::choose(along_x, along_y, [v[1], v[2], v[0]]);
        let y = Self::choose(along_x, along_y, [v[2], v[0], v[1]]);
        [y.select(backward, x), x.select(backward, y)]
    }

    #[inline(always)]
    fn test(&self, corners: &Corners) -> Lanes<W, W::Mask> {
        let corners = [self.corner(&corners[0]), self.corner(&corners[1]), self.corner(&corners[2])];
        test_sheared(&corners, self.s[2], self.t)
    }

    #[inline(always)]
    fn corner(&self, corner: &[f32; 4]) -> [W; 3] {
        let [x, y, z] = self.k;
        shear([W::pick(corner, x), W::pick(corner, y), W::pick(corner, z)], self.o, self.s)
    }

    /// Shortens the rays that meet triangle number `index`.
    #[inline(always)]
    pub fn add(&mut self, corners: &Corners, index: u32) {
        let h = self.test(corners);
        self.t = h.t.select(h.hit, self.t);
        self.b1 = h.b1.select(h.hit, self.b1);
        self.b2 = h.b2.select(h.hit, self.b2);
        self.triangle = W::splat(self.t.isa(), f32::from_bits(index)).select(h.hit, self.triangle);
    }

    /// The rays, as bits, that meet the triangle.
    #[inline(always)]
    pub fn blocked(&self, corners: &Corners) -> u32 {
        W::bits(self.test(corners).hit)
    }

    /// For each ray: triangle (`u32::MAX` for none), distance, weights of the second and third corner.
    #[inline(always)]
    pub fn found(&self) -> ([u32; N], [[f32; N]; 3]) {
        (self.triangle.array().map(f32::to_bits), [self.t.array(), self.b1.array(), self.b2.array()])
    }
}

/// Edge functions → hits.
#[inline(always)]
fn decide<const N: usize, W: Wide<N>>(e: [W; 3], z: [W; 3], sz: W, tmax: W) -> Lanes<W, W::Mask> {
    let isa = tmax.isa();
    let zero = W::splat(isa, 0.0);
    let negative = e[0].min(e[1]).min(e[2]).less(zero);
    let positive = zero.less(e[0].max(e[1]).max(e[2]));
    let inv = W::splat(isa, 1.0) / (e[0] + e[1] + e[2]);
    let t = (e[0] * z[0] + e[1] * z[1] + e[2] * z[2]) * sz * inv;
    // Empty lanes hold NaN and flat triangles give NaN or infinity: `t` then fails both comparisons.
    let between = W::and(zero.less(t), t.less(tmax));
    let hit = W::and_not(W::and(negative, positive), between);
    Lanes { hit, t, b1: e[1] * inv, b2: e[2] * inv }
}

/// An edge function is zero in f32: decide in f64, where the products are exact.
#[cold]
fn on_edges<const N: usize>(x: &[[f32; N]; 3], y: &[[f32; N]; 3], e: &mut [[f32; N]; 3]) {
    for l in 0..N {
        let cross = |p: usize, q: usize| {
            (f64::from(x[p][l]) * f64::from(y[q][l]) - f64::from(y[p][l]) * f64::from(x[q][l])) as f32
        };
        if e[0][l] == 0.0 || e[1][l] == 0.0 || e[2][l] == 0.0 {
            (e[0][l], e[1][l], e[2][l]) = (cross(2, 1), cross(0, 2), cross(1, 0));
        }
    }
}

/// Triangles tested together.
pub use crate::math::simd::WIDTH;

/// Corners of up to [`WIDTH`] triangles, by vertex, axis and lane. Empty lanes are NaN.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub struct Block {
    v: [[[f32; WIDTH]; 3]; 3],
}

impl Block {
    /// No triangle in any lane.
    pub const EMPTY: Self = Self { v: [[[f32::NAN; WIDTH]; 3]; 3] };

    /// Puts a triangle into a lane.
    pub fn set(&mut self, lane: usize, corners: &[[f32; 3]; 3]) {
        for (vertex, corner) in self.v.iter_mut().zip(corners) {
            for (axis, &c) in vertex.iter_mut().zip(corner) {
                axis[lane] = c;
            }
        }
    }

    /// A vertex of the triangle in a lane.
    #[inline(always)]
    pub fn corner(&self, vertex: usize, lane: usize) -> Vec3 {
        let v = &self.v[vertex];
        Vec3::new(v[0][lane], v[1][lane], v[2][lane])
    }
}

/// What each triangle of a block says.
struct Lanes<W, Mask> {
    hit: Mask,
    t: W,
    b1: W,
    b2: W,
}

/// Nearest hits so far, one for each lane of the blocks that were tried: the loop over blocks then has
/// no branch that depends on what is hit.
#[derive(Clone, Copy, Debug)]
pub struct Nearest<W> {
    t: W,
    b1: W,
    b2: W,
    /// Block numbers, as bits.
    block: W,
}

impl<W: Wide> Nearest<W> {
    /// Nothing below `tmax` yet.
    #[inline(always)]
    pub fn new(tmax: f32, isa: W::Isa) -> Self {
        let zero = W::splat(isa, 0.0);
        Self { t: W::splat(isa, tmax), b1: zero, b2: zero, block: zero }
    }

    /// Tries the triangles of block number `index`.
    #[inline(always)]
    pub fn add(&mut self, shear: &Shear, b: &Block, index: u32) {
        let h = shear.test(b, self.t);
        self.t = h.t.select(h.hit, self.t);
        self.b1 = h.b1.select(h.hit, self.b1);
        self.b2 = h.b2.select(h.hit, self.b2);
        self.block = W::splat(self.t.isa(), f32::from_bits(index)).select(h.hit, self.block);
    }

    /// The nearest of all below the `tmax` it began with: block, lane, distance, and barycentric weights
    /// of the second and third vertex.
    #[inline(always)]
    pub fn best(&self, tmax: f32) -> Option<(u32, usize, f32, f32, f32)> {
        let isa = self.t.isa();
        let found = W::bits(self.t.less(W::splat(isa, tmax)));
        if found == 0 {
            return None;
        }
        let t = self.t.array();
        let nearest = min(min(min(t[0], t[1]), min(t[2], t[3])), min(min(t[4], t[5]), min(t[6], t[7])));
        let lane = W::bits(self.t.equal(W::splat(isa, nearest))).trailing_zeros() as usize % WIDTH;
        Some((
            self.block.array()[lane].to_bits(),
            lane,
            nearest,
            self.b1.array()[lane],
            self.b2.array()[lane],
        ))
    }
}

#[inline(always)]
fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Un-normalised geometric normal, length twice the area.
#[inline]
pub fn cross_product(v: &[[f32; 3]; 3]) -> Vec3 {
    let p0 = Vec3::from(v[0]);
    (Vec3::from(v[1]) - p0).cross(Vec3::from(v[2]) - p0)
}
