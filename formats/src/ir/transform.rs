//! Affine and projective transforms in f64, row-major, acting on column vectors.

use serde::{Deserialize, Serialize};

/// `p' = M p`. Authoring-level: nothing is rounded to f32 before the scene is compiled.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Transform(pub [[f64; 4]; 4]);

impl Default for Transform {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Transform {
    /// Leaves everything where it is.
    pub const IDENTITY: Self =
        Self([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]);

    /// Moves by `t`.
    pub fn translate(t: [f64; 3]) -> Self {
        let mut m = Self::IDENTITY;
        for (row, offset) in m.0.iter_mut().zip(t) {
            row[3] = offset;
        }
        m
    }

    /// Scales each axis by its factor.
    pub fn scale(s: [f64; 3]) -> Self {
        let mut m = Self::IDENTITY;
        for (i, factor) in s.into_iter().enumerate() {
            m.0[i][i] = factor;
        }
        m
    }

    /// Right-handed rotation by `degrees` about `axis` (any length but zero).
    pub fn rotate(axis: [f64; 3], degrees: f64) -> Option<Self> {
        Some(Self::rodrigues(normalize(axis)?, degrees))
    }

    /// Rodrigues' formula with the axis as it is: a rotation by `degrees` about a unit vector, and sheared and scaled
    /// for any other one. Mitsuba 2 and 3 read `<rotate>` so.
    pub fn rodrigues([x, y, z]: [f64; 3], degrees: f64) -> Self {
        let (s, c) = degrees.to_radians().sin_cos();
        let t = 1.0 - c;
        Self([
            [t * x * x + c, t * x * y - s * z, t * x * z + s * y, 0.0],
            [t * x * y + s * z, t * y * y + c, t * y * z - s * x, 0.0],
            [t * x * z - s * y, t * y * z + s * x, t * z * z + c, 0.0],
            [0.0, 0.0, 0.0, 1.0],
        ])
    }

    /// Mitsuba's camera frame: +Z towards the target, +Y up, +X to the left of the picture.
    /// `None` when target equals origin or `up` is parallel to the view direction.
    pub fn look_at(origin: [f64; 3], target: [f64; 3], up: [f64; 3]) -> Option<Self> {
        let dir = normalize([target[0] - origin[0], target[1] - origin[1], target[2] - origin[2]])?;
        let left = normalize(cross(normalize(up)?, dir))?;
        let new_up = cross(dir, left);
        let mut m = Self::IDENTITY;
        for i in 0..3 {
            m.0[i] = [left[i], new_up[i], dir[i], origin[i]];
        }
        Some(m)
    }

    /// `self` applied after `first`: the matrix product `self · first`.
    pub fn after(&self, first: &Self) -> Self {
        let mut m = [[0.0; 4]; 4];
        for (i, row) in m.iter_mut().enumerate() {
            for (j, cell) in row.iter_mut().enumerate() {
                *cell = (0..4).map(|k| self.0[i][k] * first.0[k][j]).sum();
            }
        }
        Self(m)
    }

    /// Where a point goes, divided by its w.
    pub fn point(&self, p: [f64; 3]) -> [f64; 3] {
        let h = |r: usize| self.0[r][0] * p[0] + self.0[r][1] * p[1] + self.0[r][2] * p[2] + self.0[r][3];
        let w = h(3);
        [h(0) / w, h(1) / w, h(2) / w]
    }

    /// Where a direction goes; no translation, no normalisation.
    pub fn vector(&self, v: [f64; 3]) -> [f64; 3] {
        let h = |r: usize| self.0[r][0] * v[0] + self.0[r][1] * v[1] + self.0[r][2] * v[2];
        [h(0), h(1), h(2)]
    }

    /// Determinant of the linear part; negative when the transform mirrors.
    pub fn determinant3(&self) -> f64 {
        let m = &self.0;
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    }

    /// Whether it keeps angles, to the 1e-4 that matrices printed with six digits have.
    pub fn is_similarity(&self) -> bool {
        let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| self.vector(axis));
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let s = dot(x, x);
        let same = |a: f64, b: f64| (a - b).abs() <= 1e-4 * s;
        same(dot(y, y), s)
            && same(dot(z, z), s)
            && same(dot(x, y), 0.0)
            && same(dot(x, z), 0.0)
            && same(dot(y, z), 0.0)
    }

    /// Inverse by Gauss-Jordan elimination with pivoting; `None` when singular.
    pub fn inverse(&self) -> Option<Self> {
        let mut a = self.0;
        let mut inv = Self::IDENTITY.0;
        for col in 0..4 {
            let pivot = (col..4).max_by(|&i, &j| a[i][col].abs().total_cmp(&a[j][col].abs()))?;
            if !a[pivot][col].is_normal() {
                return None;
            }
            a.swap(col, pivot);
            inv.swap(col, pivot);
            let d = a[col][col];
            for j in 0..4 {
                a[col][j] /= d;
                inv[col][j] /= d;
            }
            for i in 0..4 {
                let f = a[i][col];
                if i != col && f != 0.0 {
                    for j in 0..4 {
                        a[i][j] -= f * a[col][j];
                        inv[i][j] -= f * inv[col][j];
                    }
                }
            }
        }
        Some(Self(inv))
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn normalize(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    (length.is_normal()).then(|| v.map(|x| x / length))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn look_at_puts_world_x_on_the_right_when_looking_down_minus_z() {
        let m = Transform::look_at([0.0, 0.0, 5.0], [0.0; 3], [0.0, 1.0, 0.0]).unwrap();
        assert_eq!(m.vector([1.0, 0.0, 0.0]), [-1.0, 0.0, 0.0]);
        assert_eq!(m.point([0.0, 0.0, 5.0]), [0.0; 3]);
        assert!(Transform::look_at([0.0; 3], [0.0, 1.0, 0.0], [0.0, 2.0, 0.0]).is_none());
    }

    #[test]
    fn inverse_undoes_and_singular_has_none() {
        let m = Transform::translate([1.0, 2.0, 3.0])
            .after(&Transform::rotate([1.0, 1.0, 0.0], 33.0).unwrap())
            .after(&Transform::scale([2.0, -3.0, 0.5]));
        let id = m.inverse().unwrap().after(&m);
        for i in 0..4 {
            for j in 0..4 {
                assert!((id.0[i][j] - f64::from(u8::from(i == j))).abs() < 1e-14);
            }
        }
        assert!(m.determinant3() < 0.0);
        assert!(Transform::scale([1.0, 0.0, 1.0]).inverse().is_none());
    }
}
