//! Watertight ray–triangle test (Woop, Benthin, Wald 2013): neighbours that share an edge compute the
//! same edge function up to its sign, so no ray slips between them.

use crate::math::{Ray, Vec3};

/// Per-ray constants: the axis permutation and shear that turn the ray into +Z.
#[derive(Clone, Copy, Debug)]
pub struct Shear {
    k: [usize; 3],
    s: [f32; 3],
    o: [f32; 3],
}

impl Shear {
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let d = ray.d.to_array();
        let a = ray.d.abs();
        let kz = if a.x > a.y {
            if a.x > a.z { 0 } else { 2 }
        } else if a.y > a.z {
            1
        } else {
            2
        };
        let (mut kx, mut ky) = ((kz + 1) % 3, (kz + 2) % 3);
        // Keeps the winding, so that the sign of the edge functions means the same for every ray.
        if d[kz] < 0.0 {
            std::mem::swap(&mut kx, &mut ky);
        }
        let inv = 1.0 / d[kz];
        Self { k: [kx, ky, kz], s: [d[kx] * inv, d[ky] * inv, inv], o: ray.o.to_array() }
    }

    /// Nearest hit with `0 < t < tmax` among the lanes: lane, distance and barycentric weights of the
    /// second and third vertex.
    #[inline(always)]
    pub fn intersect(&self, b: &Block, tmax: f32) -> Option<(usize, f32, f32, f32)> {
        let h = self.test(b, tmax);
        if h.mask == 0 {
            return None;
        }
        let mut best = h.mask.trailing_zeros() as usize;
        for l in best + 1..WIDTH {
            if h.mask >> l & 1 == 1 && h.t[l] < h.t[best] {
                best = l;
            }
        }
        Some((best, h.t[best], h.b1[best], h.b2[best]))
    }

    /// Whether any lane is hit with `0 < t < tmax`.
    #[inline(always)]
    pub fn occluded(&self, b: &Block, tmax: f32) -> bool {
        self.test(b, tmax).mask != 0
    }

    /// Plain loops over lanes, which the compiler turns into SIMD.
    #[inline(always)]
    fn test(&self, b: &Block, tmax: f32) -> Lanes {
        let [kx, ky, kz] = self.k;
        let [sx, sy, sz] = self.s;
        let (ox, oy, oz) = (self.o[kx], self.o[ky], self.o[kz]);
        let mut x = [[0.0f32; WIDTH]; 3];
        let mut y = [[0.0f32; WIDTH]; 3];
        let mut z = [[0.0f32; WIDTH]; 3];
        for v in 0..3 {
            let (px, py, pz) = (&b.v[v][kx], &b.v[v][ky], &b.v[v][kz]);
            for l in 0..WIDTH {
                z[v][l] = pz[l] - oz;
                x[v][l] = px[l] - ox - sx * z[v][l];
                y[v][l] = py[l] - oy - sy * z[v][l];
            }
        }
        let mut e = [[0.0f32; WIDTH]; 3];
        for l in 0..WIDTH {
            e[0][l] = x[2][l] * y[1][l] - y[2][l] * x[1][l];
            e[1][l] = x[0][l] * y[2][l] - y[0][l] * x[2][l];
            e[2][l] = x[1][l] * y[0][l] - y[1][l] * x[0][l];
        }
        let mut lanes = decide(&e, &z, sz, tmax);
        if lanes.mask >> WIDTH != 0 {
            on_edges(&x, &y, &mut e);
            lanes = decide(&e, &z, sz, tmax);
            lanes.mask &= (1 << WIDTH) - 1;
        }
        lanes
    }
}

/// Edge functions → hits: bit l of the mask for a hit of lane l, bit l + WIDTH where one is zero.
#[inline(always)]
fn decide(e: &[[f32; WIDTH]; 3], z: &[[f32; WIDTH]; 3], sz: f32, tmax: f32) -> Lanes {
    let mut out = Lanes { mask: 0, t: [0.0; WIDTH], b1: [0.0; WIDTH], b2: [0.0; WIDTH] };
    let mut bits = [0u32; WIDTH];
    for l in 0..WIDTH {
        let (e0, e1, e2) = (e[0][l], e[1][l], e[2][l]);
        let negative = (e0 < 0.0) | (e1 < 0.0) | (e2 < 0.0);
        let positive = (e0 > 0.0) | (e1 > 0.0) | (e2 > 0.0);
        let zero = (e0 == 0.0) | (e1 == 0.0) | (e2 == 0.0);
        let inv = 1.0 / (e0 + e1 + e2);
        let t = (e0 * z[0][l] + e1 * z[1][l] + e2 * z[2][l]) * sz * inv;
        // Empty lanes hold NaN and flat triangles give NaN or infinity: `t` then fails both comparisons.
        let hit = !(negative & positive) & (t > 0.0) & (t < tmax);
        (out.t[l], out.b1[l], out.b2[l]) = (t, e1 * inv, e2 * inv);
        bits[l] = if hit { BITS[l] } else { 0 } | if zero { BITS[l] << WIDTH } else { 0 };
    }
    out.mask = bits.iter().fold(0, |m, b| m | b);
    out
}

/// Constants rather than shifts: the compiler then masks and folds whole vectors.
const BITS: [u32; WIDTH] = [1, 2, 4, 8, 16, 32, 64, 128];

/// An edge function is zero in f32: decide in f64, where the products are exact.
#[cold]
fn on_edges(x: &[[f32; WIDTH]; 3], y: &[[f32; WIDTH]; 3], e: &mut [[f32; WIDTH]; 3]) {
    for l in 0..WIDTH {
        let cross = |p: usize, q: usize| {
            (f64::from(x[p][l]) * f64::from(y[q][l]) - f64::from(y[p][l]) * f64::from(x[q][l])) as f32
        };
        if e[0][l] == 0.0 || e[1][l] == 0.0 || e[2][l] == 0.0 {
            (e[0][l], e[1][l], e[2][l]) = (cross(2, 1), cross(0, 2), cross(1, 0));
        }
    }
}

/// Triangles tested together.
pub const WIDTH: usize = 8;

/// Corners of up to [`WIDTH`] triangles, by vertex, axis and lane. Empty lanes are NaN.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub struct Block {
    v: [[[f32; WIDTH]; 3]; 3],
}

impl Block {
    pub const EMPTY: Self = Self { v: [[[f32::NAN; WIDTH]; 3]; 3] };

    pub fn set(&mut self, lane: usize, corners: &[[f32; 3]; 3]) {
        for (vertex, corner) in self.v.iter_mut().zip(corners) {
            for (axis, &c) in vertex.iter_mut().zip(corner) {
                axis[lane] = c;
            }
        }
    }

    pub fn corners(&self, lane: usize) -> [[f32; 3]; 3] {
        self.v.map(|vertex| vertex.map(|axis| axis[lane]))
    }
}

struct Lanes {
    mask: u32,
    t: [f32; WIDTH],
    b1: [f32; WIDTH],
    b2: [f32; WIDTH],
}

/// Un-normalised geometric normal, length twice the area.
#[inline]
pub fn cross_product(v: &[[f32; 3]; 3]) -> Vec3 {
    let p0 = Vec3::from(v[0]);
    (Vec3::from(v[1]) - p0).cross(Vec3::from(v[2]) - p0)
}
