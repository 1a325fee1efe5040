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
    #[inline]
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

    /// Distance and barycentric weights of the second and third vertex, for `0 < t < tmax`.
    #[inline]
    pub fn intersect(&self, v: &[[f32; 3]; 3], tmax: f32) -> Option<(f32, f32, f32)> {
        let [kx, ky, kz] = self.k;
        let [sx, sy, sz] = self.s;
        let local = |p: &[f32; 3]| {
            let z = p[kz] - self.o[kz];
            (p[kx] - self.o[kx] - sx * z, p[ky] - self.o[ky] - sy * z, z)
        };
        let (a, b, c) = (local(&v[0]), local(&v[1]), local(&v[2]));
        let mut e0 = c.0 * b.1 - c.1 * b.0;
        let mut e1 = a.0 * c.1 - a.1 * c.0;
        let mut e2 = b.0 * a.1 - b.1 * a.0;
        // On an edge in f32: decide in f64, where these products are exact.
        if e0 == 0.0 || e1 == 0.0 || e2 == 0.0 {
            let cross = |p: (f32, f32, f32), q: (f32, f32, f32)| {
                (f64::from(p.0) * f64::from(q.1) - f64::from(p.1) * f64::from(q.0)) as f32
            };
            e0 = cross(c, b);
            e1 = cross(a, c);
            e2 = cross(b, a);
        }
        if (e0 < 0.0 || e1 < 0.0 || e2 < 0.0) && (e0 > 0.0 || e1 > 0.0 || e2 > 0.0) {
            return None;
        }
        let det = e0 + e1 + e2;
        if det == 0.0 {
            return None;
        }
        let inv = 1.0 / det;
        let t = (e0 * a.2 + e1 * b.2 + e2 * c.2) * sz * inv;
        (t > 0.0 && t < tmax).then_some((t, e1 * inv, e2 * inv))
    }
}

/// Un-normalised geometric normal, length twice the area.
#[inline]
pub fn cross_product(v: &[[f32; 3]; 3]) -> Vec3 {
    let p0 = Vec3::from(v[0]);
    (Vec3::from(v[1]) - p0).cross(Vec3::from(v[2]) - p0)
}
