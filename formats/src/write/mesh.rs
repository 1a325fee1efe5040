//! Meshes that have to be generated: converted from other formats, inline in the scene, or tessellated.

use std::f64::consts::TAU;
use std::path::Path;
use std::rc::Rc;

use super::facing::Facing;
use super::source::sound;
use super::{Output, WriteError};
use crate::ir::{InlineMesh, MeshFile, MeshFormat, Origin, PartialQuadric, Shape, ShapeKind, Transform};
use crate::mesh::{Mesh, builtin, write_ply};

impl Output<'_> {
    /// The mesh as it is rendered; its normals are absent when it is flat.
    pub fn mesh(&self, file: &MeshFile) -> Result<Rc<Mesh>, WriteError> {
        Ok(self.files.mesh(file)?.mesh.clone())
    }

    /// Whether the mesh has no normals that its author gave.
    pub fn faces_by_winding(&self, file: &MeshFile) -> Result<bool, WriteError> {
        let mesh = self.mesh(file)?;
        Ok(mesh.computed_normals || mesh.normals.is_empty())
    }

    /// Whether a shape that is a mesh has any surface.
    pub fn has_area(&self, shape: &Shape) -> Result<bool, WriteError> {
        let any =
            |mesh: &Mesh| mesh.triangles.iter().any(|t| cross(mesh, *t).iter().any(|v| v.abs() > 1e-30));
        Ok(match &shape.kind {
            ShapeKind::Mesh(file) => any(&*self.mesh(file)?),
            ShapeKind::Inline(mesh) => {
                let (positions, triangles) = (mesh.positions.clone(), mesh.triangles.clone());
                any(&Mesh { positions, triangles, ..Mesh::default() })
            }
            _ => true,
        })
    }

    /// A PLY file of the mesh as it is rendered, facing so; `origin` is that of its shape.
    pub fn make_ply(
        &mut self,
        file: &MeshFile,
        facing: Facing,
        origin: Origin,
    ) -> Result<String, WriteError> {
        let key = format!("mesh {facing:?} {file:?}");
        let mut stem = stem(&file.path);
        if let MeshFormat::Serialized { index } | MeshFormat::ObjPart { index } = file.format {
            stem = format!("{stem}-{index:03}");
        }
        self.make(&key, "meshes", &stem, "ply", |output| {
            let loaded = output.files.mesh(file)?;
            for (name, size) in &loaded.skipped {
                let what = format!("the attribute `{name}` of a mesh, {size} numbers each");
                output.lose(origin, what, "a mesh without it");
            }
            Ok(write_ply(&facing.of(with_sound_normals(Mesh::clone(&loaded.mesh)))))
        })
    }

    pub fn make_inline_ply(
        &mut self,
        mesh: &InlineMesh,
        facing: Facing,
        name: &str,
    ) -> Result<String, WriteError> {
        // A mesh written into the scene is met once; its address tells it from others.
        let key = format!("inline {facing:?} {:p}", std::ptr::from_ref(mesh));
        self.make(&key, "meshes", name, "ply", |_| {
            Ok(write_ply(&facing.of(with_sound_normals(Mesh {
                positions: mesh.positions.clone(),
                normals: mesh.normals.clone(),
                uvs: mesh.uvs.clone(),
                triangles: mesh.triangles.clone(),
                computed_normals: false,
                attributes: Vec::new(),
            }))))
        })
    }

    pub fn make_cube_ply(&mut self, facing: Facing, name: &str) -> Result<String, WriteError> {
        let key = format!("cube {facing:?}");
        self.make(&key, "meshes", name, "ply", |_| Ok(write_ply(&facing.of(builtin::cube()))))
    }

    pub fn make_quadric_ply(
        &mut self,
        quadric: &PartialQuadric,
        facing: Facing,
        name: &str,
    ) -> Result<String, WriteError> {
        let key = format!("quadric {facing:?} {quadric:?}");
        self.make(&key, "meshes", name, "ply", |_| Ok(write_ply(&facing.of(tessellate(quadric)))))
    }

    /// A sphere with Mitsuba's uv, whose v runs down from +Z.
    pub fn make_sphere_ply(
        &mut self,
        center: [f64; 3],
        radius: f64,
        facing: Facing,
        name: &str,
    ) -> Result<String, WriteError> {
        self.make(&format!("sphere {facing:?} {center:?} {radius}"), "meshes", name, "ply", |_| {
            let quadric = PartialQuadric::Sphere { radius, z_min: -radius, z_max: radius, phi_max: 360.0 };
            let mut mesh = tessellate(&quadric);
            for p in &mut mesh.positions {
                *p = std::array::from_fn(|i| (f64::from(p[i]) + center[i]) as f32);
            }
            mesh.uvs.iter_mut().for_each(|uv| uv[1] = 1.0 - uv[1]);
            Ok(write_ply(&facing.of(mesh)))
        })
    }

    pub fn make_cylinder_ply(
        &mut self,
        p0: [f64; 3],
        p1: [f64; 3],
        radius: f64,
        facing: Facing,
        name: &str,
    ) -> Result<String, WriteError> {
        self.make(&format!("cylinder {facing:?} {p0:?} {p1:?} {radius}"), "meshes", name, "ply", |_| {
            let axis: [f64; 3] = std::array::from_fn(|i| p1[i] - p0[i]);
            let length = axis.iter().map(|v| v * v).sum::<f64>().sqrt();
            let place = Transform::translate(p0).after(&about(axis.map(|v| v / length)));
            let quadric = PartialQuadric::Cylinder { radius, z_min: 0.0, z_max: length, phi_max: 360.0 };
            let mut mesh = tessellate(&quadric);
            for p in &mut mesh.positions {
                *p = place.point(p.map(f64::from)).map(|v| v as f32);
            }
            for n in &mut mesh.normals {
                *n = place.vector(n.map(f64::from)).map(|v| v as f32);
            }
            Ok(write_ply(&facing.of(mesh)))
        })
    }

    /// A unit disk with Mitsuba's uv: the distance from the middle, and the angle.
    pub fn make_disk_ply(&mut self, name: &str) -> Result<String, WriteError> {
        self.make("polar disk", "meshes", name, "ply", |_| Ok(write_ply(&polar_disk())))
    }

    /// Whether all faces of a PLY file are triangles and all normals directions, so that every reader takes them alike.
    pub fn is_triangle_ply(&self, file: &MeshFile) -> Result<bool, WriteError> {
        Ok(self.files.mesh(file)?.plain)
    }
}

/// With the normal of the faces around a vertex where the mesh has none: pbrt shows such a triangle flat.
fn with_sound_normals(mut mesh: Mesh) -> Mesh {
    if mesh.normals.iter().all(|n| sound(*n)) {
        return mesh;
    }
    let mut around = vec![[0f32; 3]; mesh.normals.len()];
    for triangle in &mesh.triangles {
        let normal = cross(&mesh, *triangle).map(|v| v as f32);
        for &vertex in triangle {
            let sum = &mut around[vertex as usize];
            *sum = std::array::from_fn(|i| sum[i] + normal[i]);
        }
    }
    for (normal, around) in mesh.normals.iter_mut().zip(around) {
        if !sound(*normal) {
            let length = around.iter().map(|v| v * v).sum::<f32>().sqrt();
            *normal = if sound(around) { around.map(|v| v / length) } else { [0.0, 0.0, 1.0] };
        }
    }
    mesh
}

/// Twice the area of a triangle, along its normal.
pub(super) fn cross(mesh: &Mesh, triangle: [u32; 3]) -> [f64; 3] {
    let [a, b, c] = triangle.map(|i| mesh.positions[i as usize].map(f64::from));
    let (e, f) = ([0, 1, 2].map(|i| b[i] - a[i]), [0, 1, 2].map(|i| c[i] - a[i]));
    [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]]
}

/// The axes that Mitsuba's cylinders have about a unit vector (Duff et al. 2017).
pub(crate) fn about([x, y, z]: [f64; 3]) -> Transform {
    let sign = 1f64.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    Transform([
        [1.0 + sign * x * x * a, b, x, 0.0],
        [sign * b, sign + y * y * a, y, 0.0],
        [-sign * x, -y, z, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    ])
}

pub(crate) fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// Steps around a whole circle: the chord is 0.03 % of the radius inside it.
const STEPS: usize = 128;

/// From the middle of a disk to its rim, where u and v are bilinear in each ring.
const RINGS: usize = 16;

fn polar_disk() -> Mesh {
    let mut mesh = Mesh::default();
    for column in 0..=STEPS {
        let v = column as f64 / STEPS as f64;
        let (sin, cos) = (TAU * v).sin_cos();
        for ring in 0..=RINGS {
            let r = ring as f64 / RINGS as f64;
            mesh.positions.push([r * cos, r * sin, 0.0].map(|x| x as f32));
            mesh.uvs.push([r as f32, v as f32]);
        }
    }
    let rows = RINGS + 1;
    for column in 0..STEPS {
        for ring in 0..RINGS {
            let at = |c: usize, r: usize| ((column + c) * rows + ring + r) as u32;
            let (a, b, c, d) = (at(0, 0), at(0, 1), at(1, 1), at(1, 0));
            mesh.triangles.push([a, b, c]);
            if ring > 0 {
                mesh.triangles.push([a, c, d]);
            }
        }
    }
    mesh
}

/// uv as pbrt has it: u = φ/phi_max; v from `z_min` to `z_max`, or from the rim to the middle.
pub(crate) fn tessellate(quadric: &PartialQuadric) -> Mesh {
    // (radius, z, normal's radial part, normal's z, v) of a point of the profile.
    let profile: Vec<[f64; 5]> = match *quadric {
        PartialQuadric::Sphere { radius, z_min, z_max, .. } => {
            let angle = |z: f64| (z / radius).clamp(-1.0, 1.0).acos();
            let (from, to) = (angle(z_min), angle(z_max));
            (0..=STEPS / 2)
                .map(|i| {
                    let v = i as f64 / (STEPS / 2) as f64;
                    let (s, c) = (from + (to - from) * v).sin_cos();
                    [radius * s, radius * c, s, c, v]
                })
                .collect()
        }
        PartialQuadric::Disk { height, radius, inner_radius, .. } => {
            vec![[radius, height, 0.0, 1.0, 0.0], [inner_radius, height, 0.0, 1.0, 1.0]]
        }
        PartialQuadric::Cylinder { radius, z_min, z_max, .. } => {
            vec![[radius, z_min, 1.0, 0.0, 0.0], [radius, z_max, 1.0, 0.0, 1.0]]
        }
    };
    let (PartialQuadric::Sphere { phi_max, .. }
    | PartialQuadric::Disk { phi_max, .. }
    | PartialQuadric::Cylinder { phi_max, .. }) = *quadric;
    let turns = (phi_max / 360.0).clamp(0.0, 1.0);
    let columns = ((STEPS as f64 * turns).ceil() as usize).max(3);
    let mut mesh = Mesh::default();
    for column in 0..=columns {
        let u = column as f64 / columns as f64;
        let (sin, cos) = (TAU * turns * u).sin_cos();
        for [r, z, nr, nz, v] in &profile {
            mesh.positions.push([r * cos, r * sin, *z].map(|x| x as f32));
            mesh.normals.push([nr * cos, nr * sin, *nz].map(|x| x as f32));
            mesh.uvs.push([u as f32, *v as f32]);
        }
    }
    let rows = profile.len();
    for column in 0..columns {
        for row in 0..rows - 1 {
            let at = |c: usize, r: usize| ((column + c) * rows + row + r) as u32;
            let (a, b, c, d) = (at(0, 0), at(1, 0), at(1, 1), at(0, 1));
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Flux of the position through the surface is three times the volume it encloses with the
    /// origin; its sign says on which side the front is.
    fn volume(mesh: &Mesh) -> f64 {
        let p = |i: u32| mesh.positions[i as usize].map(f64::from);
        let det = |[a, b, c]: [[f64; 3]; 3]| {
            a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
                + a[2] * (b[0] * c[1] - b[1] * c[0])
        };
        mesh.triangles.iter().map(|t| det(t.map(p)) / 6.0).sum()
    }

    #[test]
    fn fronts_face_outwards_and_volumes_are_those_of_the_quadrics() {
        let sphere = PartialQuadric::Sphere { radius: 2.0, z_min: -2.0, z_max: 2.0, phi_max: 360.0 };
        // A chord spans 1/64 turn: the polyhedron lacks about 2·(π/64)² = 0.5 % of the volume.
        let whole = 4.0 / 3.0 * std::f64::consts::PI * 8.0;
        let found = volume(&tessellate(&sphere));
        assert!((found / whole - 1.0).abs() < 0.01 && found > 0.0, "{found} against {whole}");
        let tube = PartialQuadric::Cylinder { radius: 1.0, z_min: 0.0, z_max: 3.0, phi_max: 360.0 };
        // The mantle alone gives two thirds of π·r²·h.
        let found = volume(&tessellate(&tube));
        assert!((found / TAU - 1.0).abs() < 0.01, "{found}");
        let disk = PartialQuadric::Disk { height: 1.5, radius: 1.0, inner_radius: 0.0, phi_max: 360.0 };
        // A cone of height 1.5 below it, the front upwards.
        let found = volume(&tessellate(&disk));
        assert!((found / (TAU / 4.0) - 1.0).abs() < 0.01, "{found}");
    }
}
