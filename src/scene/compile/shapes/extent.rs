//! How far the author's scene reaches, before anything is placed.

use caustica_formats::ir::{PartialQuadric, ShapeKind, Transform};

use super::super::Compiler;
use super::super::analytic::Quadric;
use super::meshes::{Form, Meshes, cache_key, form_of_kind};

/// The point of the scene's bounds that is nearest to `camera`, or their middle without one, in the
/// author's coordinates and f64: single precision is finest there.
pub fn origin(b: &Compiler<'_>, meshes: &Meshes, camera: Option<[f64; 3]>) -> [f64; 3] {
    let mut min = [f64::INFINITY; 3];
    let mut max = [f64::NEG_INFINITY; 3];
    let mut add = |p: [f64; 3]| {
        for i in 0..3 {
            min[i] = min[i].min(p[i]);
            max[i] = max[i].max(p[i]);
        }
    };
    for shape in &b.ir.shapes {
        let m = &shape.to_world;
        match &shape.kind {
            ShapeKind::Mesh(file) => {
                if let Some(Some(mesh)) = meshes.get(&cache_key(file)) {
                    mesh.positions.iter().for_each(|p| add(m.point(p.map(f64::from))));
                }
            }
            ShapeKind::Instance { group } => {
                for inner in &b.ir.groups[*group].shapes {
                    let both = m.after(&inner.to_world);
                    corners(&inner.kind, meshes).into_iter().for_each(|p| add(both.point(p)));
                }
            }
            kind => corners(kind, meshes).into_iter().for_each(|p| add(m.point(p))),
        }
    }
    std::array::from_fn(|i| {
        let middle = 0.5 * (min[i] + max[i]);
        let near = camera.map_or(middle, |c| c[i].max(min[i]).min(max[i]));
        if near.is_finite() && middle.is_finite() { near } else { 0.0 }
    })
}

/// Points whose hull contains the shape, in object space.
fn corners(kind: &ShapeKind, meshes: &Meshes) -> Vec<[f64; 3]> {
    let around = |lo: [f64; 3], hi: [f64; 3]| {
        (0..8).map(|i| std::array::from_fn(|a| if i >> a & 1 == 0 { lo[a] } else { hi[a] })).collect()
    };
    let vertices = |positions: &[[f32; 3]]| positions.iter().map(|p| p.map(f64::from)).collect();
    let form = match kind {
        // Without a copy of its other lists.
        ShapeKind::Inline(mesh) => return vertices(&mesh.positions),
        // The true surface reaches beyond its facets.
        ShapeKind::Partial(quadric) => {
            let (radius, low, high) = match *quadric {
                PartialQuadric::Sphere { radius, z_min, z_max, .. }
                | PartialQuadric::Cylinder { radius, z_min, z_max, .. } => (radius, z_min, z_max),
                PartialQuadric::Disk { height, radius, .. } => (radius, height, height),
            };
            return around([-radius, -radius, low], [radius, radius, high]);
        }
        kind => form_of_kind(meshes, kind, &Transform::IDENTITY),
    };
    match form {
        Ok(Some(Form::Triangles(mesh))) => vertices(&mesh.positions),
        Ok(Some(Form::Quadric(Quadric::Sphere { center, radius }))) => {
            around(center.map(|c| c - radius.abs()), center.map(|c| c + radius.abs()))
        }
        Ok(Some(Form::Quadric(Quadric::Cylinder { p0, p1, radius }))) => around(
            std::array::from_fn(|i| p0[i].min(p1[i]) - radius.abs()),
            std::array::from_fn(|i| p0[i].max(p1[i]) + radius.abs()),
        ),
        Ok(Some(Form::Quadric(Quadric::Disk))) => around([-1.0, -1.0, 0.0], [1.0, 1.0, 0.0]),
        Ok(None) | Err(_) => Vec::new(),
    }
}
