//! Shapes → world-space primitives, instances and area emitters.

mod contact;
mod extent;
mod split;

use std::collections::{HashMap, HashSet};
use std::path::PathBuf;

use caustica_formats::files::Files;
use caustica_formats::ir::{self, ShapeKind, Transform};
use caustica_formats::mesh::{self, Mesh, MeshOptions};
use rayon::prelude::*;

use caustica_formats::mesh::builtin;

use super::attributes::with_default_uvs;
use super::{Compiler, analytic, partial};
use crate::emitter::{Emitter, MeshTriangle, SceneSphere, Surface};
use crate::math::{Bounds, LIFT, Vec2, Vec3};
use crate::scene::ShapeRecord;
use crate::scene::geometry::{Geometry, Instance, Level, MAX_INDEX, Placement, Primitive};
use crate::shape::{Analytic, triangle};
use extent::origin;

/// What the shapes of a scene become.
pub struct Shapes {
    pub geometry: Geometry,
    pub records: Vec<ShapeRecord>,
    /// Area emitters, in shape order.
    pub emitters: Vec<Emitter>,
    pub sphere: SceneSphere,
    /// The author's coordinates of our (0, 0, 0).
    pub origin: [f64; 3],
}

/// A mesh file with the options it is read with.
type MeshKey = (PathBuf, ir::MeshFormat, bool, bool, bool, Option<u64>);

fn mesh_key(m: &ir::MeshFile) -> MeshKey {
    let angle = m.max_smooth_angle.map(f64::to_bits);
    (m.path.clone(), m.format, m.face_normals, m.authored_normals, m.flip_tex_coords, angle)
}

type Meshes = HashMap<(PathBuf, String), Option<Mesh>>;

fn cache_key(m: &ir::MeshFile) -> (PathBuf, String) {
    let (path, ..) = mesh_key(m);
    (path, format!("{:?}", mesh_key(m)))
}

/// The materials of all shapes, so that what they want to read is known before anything is.
pub fn build_materials(b: &mut Compiler<'_>) {
    for shape in every_shape(b.ir) {
        b.material(shape.bsdf, shape.emission.is_some());
    }
}

pub fn build(b: &mut Compiler<'_>, loaded: LoadedMeshes<'_>, camera: Option<[f64; 3]>) -> Shapes {
    let meshes = loaded.checked(b);
    let origin = origin(b, &meshes, camera);
    b.origin = origin;
    let mut level = LevelParts::default();
    let mut records = Vec::new();
    let mut emitters = Vec::new();
    let mut groups = Vec::new();
    let mut opaque = Vec::new();
    for (_, group) in b.ir.groups.iter() {
        let mut g = LevelParts::default();
        let first = records.len();
        for shape in &group.shapes {
            if let Some(e) = &shape.emission {
                b.error("a shape inside a shapegroup cannot emit light", e.origin);
            }
            if matches!(shape.kind, ShapeKind::Instance { .. }) {
                b.error("an instance cannot stand inside a shapegroup", shape.origin);
                continue;
            }
            add_shape(b, &meshes, shape, &shape.to_world, &mut g, &mut records, None);
        }
        groups.push(Level::new(&g.primitives, g.analytic, &[]));
        opaque.push(!records[first..].iter().any(|r| b.transmits(r.material)));
    }
    let to_ours = Transform::translate(origin.map(|x| -x));
    let mut instances = Vec::new();
    let mut instance_bounds = Vec::new();
    let mut placed = HashSet::new();
    let ir = b.ir;
    let mut authors = vec![ir.origin; records.len()];
    for shape in &ir.shapes {
        let to_world = to_ours.after(&shape.to_world);
        let group = match &shape.kind {
            ShapeKind::Instance { group } => group.index() as u32,
            // A stretched quadric is the plain one seen through an instance.
            // A sphere that shines becomes a mesh instead, because instances cannot.
            kind if analytic::is_quadric(kind)
                && !analytic::is_similarity(&shape.to_world)
                && !(shape.emission.is_some() && matches!(kind, ShapeKind::Sphere { .. })) =>
            {
                if let Some(e) = &shape.emission {
                    b.error("a cylinder that is not scaled evenly cannot emit light", e.origin);
                }
                let mut g = LevelParts::default();
                add_shape(b, &meshes, shape, &Transform::IDENTITY, &mut g, &mut records, None);
                groups.push(Level::new(&g.primitives, g.analytic, &[]));
                groups.len() as u32 - 1
            }
            _ => {
                add_shape(b, &meshes, shape, &to_world, &mut level, &mut records, Some(&mut emitters));
                authors.resize(records.len(), shape.origin);
                continue;
            }
        };
        let Some(placement) = placement(&to_world) else {
            b.error("the to_world of this shape is singular", shape.origin);
            continue;
        };
        let bounds = transform_bounds(&placement, &groups[group as usize].bounds);
        let place = placement.columns.map(|c| c.to_array().map(f32::to_bits));
        // Of an opaque group, the same once more is never seen, and every ray would have to try it.
        let again = !placed.insert((group, place)) && opaque.get(group as usize) == Some(&true);
        if bounds.is_empty() || again {
            continue;
        }
        level.primitives.push(Primitive::instance(instances.len() as u32));
        instances.push(Instance { group, placement });
        instance_bounds.push(bounds);
    }
    for (shape, gap) in contact::draw_back(&mut level, &records, |r| b.transmits(r.material)) {
        let what = format!("faces of this shape coincide with another's; they are drawn back by {gap:.1e}");
        b.warn(what, authors[shape as usize]);
    }
    let world = Level::new(&level.primitives, level.analytic, &instance_bounds);
    let bounds = world.bounds;
    let finite = bounds.min.is_finite() && bounds.max.is_finite();
    if !finite && !bounds.is_empty() {
        b.error("the shapes reach farther than 32-bit floats can tell", b.ir.origin);
    }
    let sphere = if bounds.is_empty() {
        SceneSphere { center: Vec3::ZERO, radius: 1.0 }
    } else {
        // A little larger than the corners need, so that light from infinity starts outside everything.
        SceneSphere { center: bounds.center(), radius: bounds.radius() * 1.001 }
    };
    Shapes { geometry: Geometry { world, groups, instances }, records, emitters, sphere, origin }
}

fn every_shape(ir: &ir::Scene) -> impl Iterator<Item = &ir::Shape> {
    ir.shapes.iter().chain(ir.groups.iter().flat_map(|(_, g)| g.shapes.iter()))
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
    fn checked(self, b: &mut Compiler<'_>) -> Meshes {
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

#[derive(Default)]
struct LevelParts {
    primitives: Vec<Primitive>,
    analytic: Vec<Analytic>,
}

/// Adds a shape that is not an instance, placed by `to_level`.
fn add_shape(
    b: &mut Compiler<'_>,
    meshes: &Meshes,
    shape: &ir::Shape,
    to_level: &Transform,
    level: &mut LevelParts,
    records: &mut Vec<ShapeRecord>,
    emitters: Option<&mut Vec<Emitter>>,
) {
    if to_level.inverse().is_none() {
        b.error("the to_world of this shape is singular", shape.origin);
        return;
    }
    let index = records.len() as u32;
    let material = b.material(shape.bsdf, shape.emission.is_some());
    let mut record = ShapeRecord {
        material,
        emitter: None,
        flip: shape.flip_normals,
        oriented: b.oriented(material),
        triangles: Vec::new(),
        normals: Vec::new(),
        uvs: Vec::new(),
    };
    let built;
    let mesh = match &shape.kind {
        ShapeKind::Mesh(file) => match meshes.get(&cache_key(file)) {
            Some(Some(mesh)) => Some(mesh),
            _ => return,
        },
        ShapeKind::Inline(mesh) => {
            built = Mesh {
                positions: mesh.positions.clone(),
                normals: mesh.normals.clone(),
                uvs: mesh.uvs.clone(),
                triangles: mesh.triangles.clone(),
                attributes: Vec::new(),
            };
            Some(&built)
        }
        ShapeKind::Sphere { center, radius } if !analytic::is_similarity(to_level) => {
            let Some(mesh) = partial::sphere(*center, *radius, to_level.determinant3() < 0.0) else {
                b.error("the sphere has no radius", shape.origin);
                return;
            };
            built = mesh;
            Some(&built)
        }
        ShapeKind::Partial(quadric) => {
            let Some(mesh) = partial::mesh(quadric, to_level.determinant3() < 0.0) else {
                b.error("nothing is left of this shape: its cuts meet", shape.origin);
                return;
            };
            built = mesh;
            Some(&built)
        }
        ShapeKind::Rectangle => {
            built = builtin::rectangle(to_level.determinant3() < 0.0);
            Some(&built)
        }
        ShapeKind::Cube => {
            built = builtin::cube();
            Some(&built)
        }
        _ => None,
    };
    let shines = shape.emission.as_ref().is_some_and(|e| matches!(e.radiance, ir::ColorInput::Texture(_)));
    // Pieces of a triangle have other uv than it when nobody gave any.
    let own_uvs = |m: &Mesh| !m.uvs.is_empty() || !(shines || b.varies(material));
    // The camera is near the origin of the world, not of instances.
    let pieces = mesh.filter(|m| emitters.is_some() && own_uvs(m)).and_then(|m| split::split(m, to_level));
    let mesh = pieces.as_ref().or(mesh);
    b.attach_attributes(material, mesh, index, shape.origin);
    let surface = match mesh {
        Some(mesh) => {
            if mesh.triangles.len() > MAX_INDEX {
                b.error(format!("a mesh of {} triangles is too large", mesh.triangles.len()), shape.origin);
                return;
            }
            let first = level.primitives.len();
            let oriented;
            let mesh = if is_authored(&shape.kind) {
                let mirrored = to_level.determinant3() < 0.0;
                oriented = if mesh.uvs.is_empty() && (shines || b.varies(material)) {
                    oriented_by_author(&with_default_uvs(mesh), mirrored)
                } else {
                    oriented_by_author(mesh, mirrored)
                };
                &oriented
            } else {
                mesh
            };
            let uvs_matter = shines || record.oriented || b.varies(material);
            add_mesh(mesh, to_level, index, uvs_matter, level, &mut record);
            if shape.emission.is_some() { Some(lamp_mesh(&level.primitives[first..], &record)) } else { None }
        }
        None => {
            let Some(quadric) = analytic::place(&shape.kind, to_level, shape.flip_normals) else {
                b.error("the shape's radius, length or axes are degenerate", shape.origin);
                return;
            };
            record.flip = false;
            level.primitives.push(Primitive::analytic(index, level.analytic.len() as u32));
            level.analytic.push(quadric.clone());
            Some(Surface::Analytic(quadric))
        }
    };
    if let (Some(emission), Some(surface), Some(emitters)) = (&shape.emission, surface, emitters) {
        let extent = match &surface {
            Surface::Mesh { triangles, .. } => triangles
                .iter()
                .flat_map(|t| t.v)
                .map(|v| Vec3::from(v).abs().max_element())
                .fold(0.0, f32::max),
            Surface::Analytic(a) => a.bounds().magnitude(),
        };
        if surface.area() > 0.0 {
            let lamp = b.lamp(emission, surface, extent * LIFT);
            record.emitter = lamp.is_some().then_some(emitters.len() as u32);
            emitters.extend(lamp);
        } else {
            b.warn("a lamp without area gives no light", shape.origin);
        }
    }
    records.push(record);
}

/// Whether a mesh follows pbrt's rule about its side.
fn is_authored(kind: &ShapeKind) -> bool {
    match kind {
        ShapeKind::Mesh(file) => file.authored_normals,
        ShapeKind::Inline(_) => true,
        _ => false,
    }
}

/// The mesh with its triangles so wound that they face, in the world, where the author's normals point,
/// or else where the winding in object space does: a mirroring transform turns triangles around.
fn oriented_by_author(mesh: &Mesh, mirrored: bool) -> Mesh {
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

fn add_mesh(
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
        record.normals = mesh
            .normals
            .par_iter()
            .with_min_len(4096)
            .map(|n| {
                let n = n.map(f64::from);
                let m = &inverse.0;
                let t: [f64; 3] = std::array::from_fn(|i| m[0][i] * n[0] + m[1][i] * n[1] + m[2][i] * n[2]);
                let length = t.iter().map(|x| x * x).sum::<f64>().sqrt();
                if length > 0.0 { t.map(|x| (x / length) as f32) } else { [0.0; 3] }
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

/// Whether all normals are those of the faces they stand on, but for rounding: nobody needs them then.
fn are_flat(normals: &[[f32; 3]], triangles: &[[u32; 3]], positions: &[[f32; 3]]) -> bool {
    /// No picture shows a normal that is off by so many radians.
    const NOTHING: f32 = 1e-5;
    let corner = |of: &[[f32; 3]], i: u32| Vec3::from(of[i as usize]);
    !normals.is_empty()
        && triangles.iter().all(|t| {
            let face = triangle::cross_product(&t.map(|i| positions[i as usize])).normalize_or_zero();
            t.iter().all(|&i| (corner(normals, i) - face).length_squared() < NOTHING * NOTHING)
        })
}

/// The lamp's triangles with the normal of the side that shines: the side of the shading normals.
fn lamp_mesh(primitives: &[Primitive], record: &ShapeRecord) -> Surface {
    let flip = if record.flip { -1.0 } else { 1.0 };
    let triangles = primitives.iter().enumerate().map(|(i, p)| {
        let geometric = triangle::cross_product(p.corners()).normalize_or_zero() * flip;
        let corner = |k: usize| record.triangles.get(i).map(|t| t[k] as usize);
        let shading: Vec3 = (0..3)
            .filter_map(|k| corner(k).and_then(|v| record.normals.get(v)))
            .map(|&n| Vec3::from(n) * flip)
            .sum();
        let uv = std::array::from_fn(|k| match corner(k).and_then(|v| record.uvs.get(v)) {
            Some(&uv) => Vec2::from(uv),
            None => [Vec2::ZERO, Vec2::X, Vec2::Y][k],
        });
        let normal = if shading.dot(geometric) < 0.0 { -geometric } else { geometric };
        MeshTriangle { v: *p.corners(), uv, normal }
    });
    Surface::mesh(triangles.collect())
}

fn placement(m: &Transform) -> Option<Placement> {
    let columns = |m: &Transform| {
        std::array::from_fn(|c| Vec3::new(m.0[0][c] as f32, m.0[1][c] as f32, m.0[2][c] as f32))
    };
    Some(Placement { columns: columns(m), inverse: columns(&m.inverse()?) })
}

fn transform_bounds(m: &Placement, b: &Bounds) -> Bounds {
    let mut out = Bounds::EMPTY;
    if !b.is_empty() {
        for i in 0..8 {
            let pick = |bit: usize, lo: f32, hi: f32| if i >> bit & 1 == 0 { lo } else { hi };
            out.add(m.point(Vec3::new(
                pick(0, b.min.x, b.max.x),
                pick(1, b.min.y, b.max.y),
                pick(2, b.min.z, b.max.z),
            )));
        }
    }
    out
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
