//! Meshes and pictures of a scene as arrays, and arrays as files in memory.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use caustica_formats::files::Files;
use caustica_formats::image::{self, ExrLayer, ExrOptions};
use caustica_formats::ir::{InlineMesh, MeshFile, MeshFormat, TextureEncoding};
use caustica_formats::mesh::{self, Mesh, MeshOptions};
use caustica_formats::picture::linear_rgb;

use super::array::{Array, NumberKind, ValueError};

/// The vertices and triangles of a mesh file, as they are rendered before the shape is placed.
pub fn read_mesh(files: &dyn Files, file: &MeshFile, key: &str) -> Result<Mesh, ValueError> {
    let options = MeshOptions {
        face_normals: file.face_normals,
        authored_normals: file.authored_normals,
        flip_tex_coords: file.flip_tex_coords,
        max_smooth_angle: file.max_smooth_angle,
    };
    let problem = |e: &dyn std::fmt::Display| {
        ValueError::invalid(key, format!("cannot read mesh `{}`: {e}", file.path.display()))
    };
    let bytes = files.read(&file.path).map_err(|e| problem(&e))?;
    mesh::read(file.format, &bytes, &options).map_err(|e| problem(&e))
}

/// A mesh file that stands for `mesh`, which was read from `file`, at another path.
pub fn mesh_file(mut mesh: Mesh, file: &MeshFile, path: PathBuf) -> (MeshFile, Vec<u8>) {
    if mesh.computed_normals {
        // They are computed anew when it is read.
        mesh.normals.clear();
    }
    let made = MeshFile {
        path,
        format: MeshFormat::Ply,
        flip_tex_coords: false,
        max_smooth_angle: None,
        ..file.clone()
    };
    (made, mesh::write_ply(&mesh))
}

/// The vertices and triangles of a mesh of the scene file.
pub fn of_inline(mesh: &InlineMesh) -> Mesh {
    Mesh {
        positions: mesh.positions.clone(),
        normals: mesh.normals.clone(),
        uvs: mesh.uvs.clone(),
        triangles: mesh.triangles.clone(),
        ..Mesh::default()
    }
}

/// The other way around.
pub fn into_inline(mesh: Mesh, old: &InlineMesh) -> Arc<InlineMesh> {
    let made_from = old.made_from.clone();
    let Mesh { positions, normals, uvs, triangles, .. } = mesh;
    Arc::new(InlineMesh { positions, normals, uvs, triangles, made_from })
}

/// One of the arrays of a mesh, by its part of the key.
pub fn mesh_array(mesh: &Mesh, part: &str) -> Array {
    match part {
        ".vertex_positions" => Array::rows(&mesh.positions),
        ".vertex_normals" => Array::rows(&mesh.normals),
        ".vertex_texcoords" => Array::rows(&mesh.uvs),
        _ => Array {
            shape: vec![mesh.triangles.len(), 3],
            data: mesh.triangles.as_flattened().iter().map(|v| f64::from(*v)).collect(),
            kind: NumberKind::Index,
        },
    }
}

/// Changes one of the arrays. `recompute`: the normals follow the positions.
pub fn set_mesh_array(
    mesh: &mut Mesh,
    part: &str,
    key: &str,
    array: &Array,
    recompute: bool,
) -> Result<(), ValueError> {
    let count = mesh.positions.len();
    let wrong =
        |columns: usize| ValueError::shape(key, format!("an array of shape ({count}, {columns})"), array);
    let rows = || array.as_rows::<3>().filter(|rows| rows.len() == count).ok_or_else(|| wrong(3));
    // Of no vertex: without normals a mesh is flat, and it need not have texture coordinates.
    let none = array.data.is_empty() && array.shape.first() == Some(&0);
    let single = |row: &[f64; 3]| row.map(|v| v as f32);
    match part {
        ".vertex_positions" => {
            mesh.positions = rows()?.iter().map(single).collect();
            if recompute {
                mesh.normals.clear();
            }
        }
        ".vertex_normals" if none => (mesh.normals, mesh.computed_normals) = (Vec::new(), false),
        ".vertex_texcoords" if none => mesh.uvs = Vec::new(),
        ".vertex_normals" => {
            mesh.normals = rows()?.iter().map(single).collect();
            mesh.computed_normals = false;
        }
        ".vertex_texcoords" => {
            let rows = array.as_rows::<2>().filter(|rows| rows.len() == count).ok_or_else(|| wrong(2))?;
            mesh.uvs = rows.iter().map(|row| row.map(|v| v as f32)).collect();
        }
        _ => {
            let words = "an array of shape (m, 3)";
            let rows = array.as_rows::<3>().ok_or_else(|| ValueError::shape(key, words, array))?;
            let good = |v: f64| v.fract() == 0.0 && v >= 0.0 && v < count as f64;
            if !rows.as_flattened().iter().all(|v| good(*v)) {
                let what = format!("a corner is no whole number below {count}, the number of vertices");
                return Err(ValueError::invalid(key, what));
            }
            mesh.triangles = rows.iter().map(|row| row.map(|v| v as u32)).collect();
        }
    }
    Ok(())
}

/// A picture as it is shown: `scale` times its linear colours, or one minus that.
pub fn picture_array(
    files: &dyn Files,
    path: &Path,
    encoding: TextureEncoding,
    channel: Option<char>,
    (scale, invert): (f64, bool),
    key: &str,
) -> Result<Array, ValueError> {
    let problem = |e: &dyn std::fmt::Display| {
        ValueError::invalid(key, format!("cannot read picture `{}`: {e}", path.display()))
    };
    let bytes = files.read(path).map_err(|e| problem(&e))?;
    let image = image::read(&bytes).map_err(|e| problem(&e))?;
    let shown = |v: f64| if invert { (1.0 - v * scale).max(0.0) } else { v * scale };
    let data = linear_rgb(&image, encoding, channel).into_iter().flat_map(|rgb| rgb.map(shown)).collect();
    Ok(Array { shape: vec![image.height, image.width, 3], data, kind: NumberKind::Single })
}

/// An EXR with the numbers of an array of shape (h, w), (h, w, 1) or (h, w, 3).
pub fn encode_picture(key: &str, array: &Array) -> Result<Vec<u8>, ValueError> {
    let channels: &[&str] = match array.shape[..] {
        [_, _] | [_, _, 1] => &["Y"],
        [_, _, 3] => &["R", "G", "B"],
        _ => return Err(ValueError::shape(key, "a picture of shape (h, w) or (h, w, 3)", array)),
    };
    let data: Vec<f32> = array.data.iter().map(|v| *v as f32).collect();
    let layer = ExrLayer { name: "", channels, data: &data };
    image::encode_exr(array.shape[1], array.shape[0], &[layer], &[], ExrOptions::default())
        .map_err(|e| ValueError::invalid(key, e))
}
