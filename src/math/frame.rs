use super::Vec3;

/// Right-handed orthonormal basis; `s`, `t` and `n` are the local X, Y and Z axes in world space.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// First tangent.
    pub s: Vec3,
    /// Second tangent.
    pub t: Vec3,
    /// Normal.
    pub n: Vec3,
}

impl Frame {
    /// A frame around the unit vector `n`, by the branchless construction of Duff et al. 2017
    /// ("Building an Orthonormal Basis, Revisited", JCGT).
    #[inline(always)]
    pub fn from_normal(n: Vec3) -> Self {
        let sign = 1.0f32.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        Self {
            s: Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
            t: Vec3::new(b, sign + n.y * n.y * a, -n.y),
            n,
        }
    }

    /// World to local coordinates.
    #[inline(always)]
    pub fn to_local(self, v: Vec3) -> Vec3 {
        Vec3::new(self.s.dot(v), self.t.dot(v), self.n.dot(v))
    }

    /// Local to world coordinates.
    #[inline(always)]
    pub fn to_world(self, v: Vec3) -> Vec3 {
        self.s * v.x + self.t * v.y + self.n * v.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_orthonormal_even_at_the_poles() {
        for n in [Vec3::Z, -Vec3::Z, Vec3::X, Vec3::new(1e-4, -1e-4, -1.0).normalize()] {
            let f = Frame::from_normal(n);
            let v = f.to_local(f.to_world(Vec3::new(0.3, -0.4, 0.5)));
            assert!((v - Vec3::new(0.3, -0.4, 0.5)).length() < 1e-6);
            assert!((f.s.cross(f.t) - n).length() < 1e-6);
        }
    }
}
