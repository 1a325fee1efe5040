//! Triangle meshes: files read once, and the triangles that a shape stands for.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::path::PathBuf;

use caustica_formats::files::Files;
use caustica_formats::ir::{self, ShapeKind, Transform};
use caustica_formats::mesh::{self, Mesh, MeshOptions, builtin};
use rayon::prelude::*;

use super::super::analytic::Quadric;
use super::super::{Compiler, partial};
use super::{LevelParts, every_shape};
use crate::math::Vec3;
use crate::scene::ShapeRecord;
use crate::scene::geometry::Primitive;
use crate::shape::triangle;

/// A mesh file with the options it is read with.
type MeshKey = (PathBuf, ir::MeshFormat, bool, bool, bool, Option<u64>);

fn mesh_key(m: &ir::MeshFile) -> MeshKey {
    let angle = m.max_smooth_angle.map(f64::to_bits);
    (m.path.clone(), m.format, m.face_normals, m.authored_normals, m.flip_tex_coords, angle)
}

/// By path and by the options it is read with; `None` where the file is broken.
pub type Meshes = HashMap<(PathBuf, String), Option<Mesh>>;

/// Where the mesh of a file is found among [`Meshes`].
pub fn cache_key(m: &ir::MeshFile) -> (PathBuf, String) {
    let (path, ..) = mesh_key(m);
    (path, format!("{:?}", mesh_key(m)))
}

/// Every mesh file of a scene with the first shape that uses it, and what reading it gave.
pub struct LoadedMeshes<'a>(Vec<(&'a ir::MeshFile, ir::Origin, Result<Mesh, String>)>);

/// Reads every mesh file once, in parallel.
pub fn load_meshes<'a>(ir: &'a ir::Scene, files: &dyn Files) -> LoadedMeshes<'a> {
    let mut wanted: Vec<(&ir::MeshFile, ir::Origin)> = Vec::new();
    let mut seen = HashSet::new();
    for shape in every_shape(ir) {
        if let ShapeKind::Mesh(m) = &shape.kind
            && seen.insert(cache_key(m))
        {
            wanted.push((m, shape.origin));
        }
    }
    let load = |(m, origin): (&'a ir::MeshFile, ir::Origin)| {
        let options = MeshOptions {
            face_normals: m.face_normals,
            authored_normals: m.authored_normals,
            flip_tex_coords: m.flip_tex_coords,
            max_smooth_angle: m.max_smooth_angle,
        };
        let read = || {
            let bytes = files.read(&m.path).map_err(|e| e.to_string())?;
            mesh::read(m.format, &bytes, &options).map_err(|e| e.to_string())
        };
        (m, origin, read())
    };
    LoadedMeshes(wanted.into_par_iter().map(load).collect())
}

impl LoadedMeshes<'_> {
    /// Problems are reported at the first shape that uses the file.
    pub fn checked(self, b: &mut Compiler<'_>) -> Meshes {
        let mut meshes = Meshes::new();
        for (m, origin, result) in self.0 {
            let mesh = match result {
                Ok(mesh) => {
                    if mesh.triangles.is_empty() {
                        b.warn(format!("mesh `{}` has no triangles", m.path.display()), origin);
                    }
                    Some(mesh)
                }
                Err(e) => {
                    b.error(format!("cannot read mesh `{}`: {e}", m.path.display()), origin);
                    None
                }
            };
            meshes.insert(cache_key(m), mesh);
        }
        meshes
    }
}

/// What a shape is made of.
pub enum Form<'a> {
    /// In object space.
    Triangles(Cow<'a, Mesh>),
    /// A model of its own, in object space.
    Quadric(Quadric),
}

/// What a shape becomes when it is placed by `to_level`; `None` after a problem, which is reported here
/// unless it was when the mesh was read.
pub fn form<'a>(
    b: &mut Compiler<'_>,
    meshes: &'a Meshes,
    shape: &ir::Shape,
    to_level: &Transform,
) -> Option<Form<'a>> {
    form_of_kind(meshes, &shape.kind, to_level).unwrap_or_else(|problem| {
        b.error(problem, shape.origin);
        None
    })
}

/// As [`form`], with the problem as text. `None` for a mesh that could not be read, and for an instance, which
/// has no surface of its own.
pub fn form_of_kind<'a>(
    meshes: &'a Meshes,
    kind: &ShapeKind,
    to_level: &Transform,
) -> Result<Option<Form<'a>>, &'static str> {
    let mirrored = || to_level.determinant3() < 0.0;
    let mesh = match *kind {
        ShapeKind::Mesh(ref file) => {
            let mesh = meshes.get(&cache_key(file)).and_then(Option::as_ref);
            return Ok(mesh.map(|m| Form::Triangles(Cow::Borrowed(m))));
        }
        ShapeKind::Inline(ref mesh) => Mesh {
            positions: mesh.positions.clone(),
            normals: mesh.normals.clone(),
            uvs: mesh.uvs.clone(),
            triangles: mesh.triangles.clone(),
            computed_normals: false,
            attributes: Vec::new(),
        },
        ShapeKind::Sphere { center, radius } => {
            if to_level.is_similarity() {
                return Ok(Some(Form::Quadric(Quadric::Sphere { center, radius })));
            }
            partial::sphere(center, radius, mirrored()).ok_or("the sphere has no radius")?
        }
        ShapeKind::Cylinder { p0, p1, radius } => {
            return Ok(Some(Form::Quadric(Quadric::Cylinder { p0, p1, radius })));
        }
        ShapeKind::Disk => return Ok(Some(Form::Quadric(Quadric::Disk))),
        ShapeKind::Partial(ref quadric) => {
            partial::mesh(quadric, mirrored()).ok_or("nothing is left of this shape: its cuts meet")?
        }
        ShapeKind::Rectangle => builtin::rectangle(mirrored()),
        ShapeKind::Cube => builtin::cube(),
        ShapeKind::Instance { .. } => return Ok(None),
    };
    Ok(Some(Form::Triangles(Cow::Owned(mesh))))
}

/// Whether the author's normals or winding decide which side of the mesh is the front (pbrt).
pub fn is_authored(kind: &ShapeKind) -> bool {
    match kind {
        ShapeKind::Mesh(file) => file.authored_normals,
        ShapeKind::Inline(_) => true,
        _ => false,
    }
}

/// The mesh rewound so that in the world its triangles face where the author's normals point, or without
/// normals where the winding in object space does (a mirroring transform reverses the winding).
pub fn oriented_by_author(mesh: &Mesh, mirrored: bool) -> Mesh {
    let mut mesh = mesh.clone();
    for t in &mut mesh.triangles {
        let [a, b, c] = t.map(|i| Vec3::from(mesh.positions[i as usize]));
        let normals = t.iter().filter_map(|&i| mesh.normals.get(i as usize));
        let normal: Vec3 = normals.map(|&n| Vec3::from(n)).sum();
        let against = (b - a).cross(c - a).dot(normal) < 0.0;
        if against != mirrored {
            t.swap(1, 2);
        }
    }
    mesh
}

/// Appends the triangles of a mesh, placed by `to_level`, to the primitives of a level, and what shading needs of
/// them to `record`.
pub fn add_mesh(
    mesh: &Mesh,
    to_level: &Transform,
    index: u32,
    uvs_matter: bool,
    level: &mut LevelParts,
    record: &mut ShapeRecord,
) {
    // In f64 and rounded once, so that meshes which share an edge in the file share it here.
    let positions: Vec<[f32; 3]> = mesh
        .positions
        .par_iter()
        .with_min_len(4096)
        .map(|p| to_level.point(p.map(f64::from)).map(|x| x as f32))
        .collect();
    level.primitives.extend(
        mesh.triangles
            .iter()
            .enumerate()
            .map(|(i, t)| Primitive::triangle(t.map(|v| positions[v as usize]), index, i as u32)),
    );
    if !mesh.normals.is_empty()
        && let Some(inverse) = to_level.inverse()
    {
        let side = if mesh.computed_normals && to_level.determinant3() < 0.0 { -1.0 } else { 1.0 };
        record.normals = mesh
            .normals
            .par_iter()
            .with_min_len(4096)
            .map(|n| {
                let n = n.map(f64::from);
                let m = &inverse.0;
                let t: [f64; 3] = std::array::from_fn(|i| m[0][i] * n[0] + m[1][i] * n[1] + m[2][i] * n[2]);
                let length = side * t.iter().map(|x| x * x).sum::<f64>().sqrt();
                if length != 0.0 { t.map(|x| (x / length) as f32) } else { [0.0; 3] }
            })
            .collect();
    }
    if are_flat(&record.normals, &mesh.triangles, &positions) {
        record.normals = Vec::new();
    }
    if uvs_matter {
        record.uvs.clone_from(&mesh.uvs);
    }
    if !record.normals.is_empty() || !record.uvs.is_empty() {
        record.triangles.clone_from(&mesh.triangles);
    }
}

/// Whether every vertex normal equals its face normal up to rounding, so that normals need not be stored.
fn are_flat(normals: &[[f32; 3]], triangles: &[[u32; 3]], positions: &[[f32; 3]]) -> bool {
    /// Radians; no picture shows a smaller error.
    const NOTHING: f32 = 1e-5;
    let corner = |of: &[[f32; 3]], i: u32| Vec3::from(of[i as usize]);
    !normals.is_empty()
        && triangles.iter().all(|t| {
            let face = triangle::cross_product(&t.map(|i| positions[i as usize])).normalize_or_zero();
            t.iter().all(|&i| (corner(normals, i) - face).length_squared() < NOTHING * NOTHING)
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Clockwise seen from +Z with normals along +Z; without them the winding itself counts.
    #[test]
    fn triangles_face_where_the_author_says() {
        let plain = Mesh {
            positions: vec![[0.0; 3], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let with_normals = Mesh { normals: vec![[0.0, 0.0, 1.0]; 3], ..plain.clone() };
        for (mesh, mirrored, expected) in [
            (&plain, false, [0, 1, 2]),
            (&plain, true, [0, 2, 1]),
            (&with_normals, false, [0, 2, 1]),
            (&with_normals, true, [0, 1, 2]),
        ] {
            assert_eq!(oriented_by_author(mesh, mirrored).triangles, [expected]);
        }
    }
}
