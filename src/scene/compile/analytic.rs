//! Shapes that are intersected by their equations, placed in the world.

use caustica_formats::ir::{ShapeKind, Transform};

use crate::math::{Frame, Vec3};
use crate::shape::{Analytic, Cylinder, Disk, Sphere};

/// A whole sphere, cylinder or disk in object space, as [`ShapeKind`] has them.
pub enum Quadric {
    Sphere { center: [f64; 3], radius: f64 },
    Cylinder { p0: [f64; 3], p1: [f64; 3], radius: f64 },
    Disk,
}

pub fn is_quadric(kind: &ShapeKind) -> bool {
    matches!(kind, ShapeKind::Sphere { .. } | ShapeKind::Cylinder { .. })
}

fn columns(m: &Transform) -> [[f64; 3]; 3] {
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|a| m.vector(a))
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn vec3(v: [f64; 3]) -> Vec3 {
    Vec3::new(v[0] as f32, v[1] as f32, v[2] as f32)
}

/// The axes of a cylinder, whose angle counts from axes that turn with the object.
fn about(m: &Transform, p0: [f64; 3], p1: [f64; 3], axis: Vec3) -> Frame {
    let object = Frame::from_normal(vec3(std::array::from_fn(|i| p1[i] - p0[i])).normalize_or_zero());
    let turned = |v: Vec3| vec3(m.vector(v.to_array().map(f64::from))).normalize_or_zero();
    let (s, t) = (turned(object.s), turned(object.t));
    if s == Vec3::ZERO || t == Vec3::ZERO { Frame::from_normal(axis) } else { Frame { s, t, n: axis } }
}

/// The shape under `m`, which must be a similarity for spheres and cylinders. `None` when nothing of
/// it is left. Mirroring turns the normals of spheres and cylinders inwards, as in Mitsuba 3.9.
pub fn place(quadric: &Quadric, m: &Transform, flip: bool) -> Option<Analytic> {
    let axes = columns(m);
    let scale = dot(axes[0], axes[0]).sqrt();
    let inward = flip != (m.determinant3() < 0.0);
    let unit = axes.map(|a| vec3(a.map(|x| x / scale)));
    match quadric {
        Quadric::Sphere { center, radius } => {
            let radius = radius.abs() * scale;
            let to_object = Frame { s: unit[0], t: unit[1], n: unit[2] };
            (radius as f32 > 0.0 && (radius as f32).is_finite()).then(|| {
                Analytic::Sphere(Sphere { center: m.point(*center).into(), radius, to_object, inward })
            })
        }
        Quadric::Cylinder { p0, p1, radius } => {
            let (a, b) = (m.point(*p0), m.point(*p1));
            let d = vec3([b[0] - a[0], b[1] - a[1], b[2] - a[2]]);
            let length = d.length();
            let radius = (radius.abs() * scale) as f32;
            (radius > 0.0 && length > 0.0 && length.is_finite()).then(|| {
                Analytic::Cylinder(Cylinder {
                    p0: vec3(a),
                    axis: about(m, *p0, *p1, d / length),
                    length,
                    radius,
                    inward,
                })
            })
        }
        Quadric::Disk => {
            let (u, v) = (vec3(axes[0]), vec3(axes[1]));
            // The image of +Z as a normal lies on the side that the transformed Z axis points to.
            let n = u.cross(v).normalize_or_zero();
            let n = if n.dot(vec3(axes[2])) < 0.0 { -n } else { n };
            (n != Vec3::ZERO)
                .then(|| Analytic::Disk(Disk::new(m.point([0.0; 3]).into(), u, v, if flip { -n } else { n })))
        }
    }
}
