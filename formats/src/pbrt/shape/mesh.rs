//! Vertices and indices written into the scene.

use super::super::directive::ParamType;
use super::super::params::Params;
use super::{NORMAL, UV};
use crate::ir::InlineMesh;

/// Faces of a fixed number of corners over shared vertices.
pub(super) struct Cage {
    pub positions: Vec<[f32; 3]>,
    pub normals: Vec<[f32; 3]>,
    pub uvs: Vec<[f32; 2]>,
    pub indices: Vec<u32>,
}

pub(super) fn triangles(p: &mut Params) -> Option<InlineMesh> {
    // Tangents and ptex faces are not used.
    p.ignore(&["S", "faceIndices"]);
    let cage = cage(p, 3)?;
    let triangles = cage.indices.as_chunks::<3>().0.to_vec();
    Some(InlineMesh {
        positions: cage.positions,
        normals: cage.normals,
        uvs: cage.uvs,
        triangles,
        made_from: None,
    })
}

/// `P`, `indices`, `N` and `uv`. Without indices, one face.
pub(super) fn cage(p: &mut Params, corners: usize) -> Option<Cage> {
    let indices = p.integer_list("indices");
    let positions = positions(p);
    let normals = per_vertex(p, "N", NORMAL, positions.as_ref().map(Vec::len));
    let uvs = per_vertex(p, "uv", UV, positions.as_ref().map(Vec::len));
    let positions = positions?;
    let indices = match indices {
        Some(indices) => checked(p, &indices, positions.len(), corners)?,
        None if p.has("indices") => return None,
        None if positions.len() == corners => (0..corners as u32).collect(),
        None => {
            let text = format!("{} needs the parameter \"integer indices\"", p.what());
            p.complain("P", text);
            return None;
        }
    };
    Some(Cage { positions, normals, uvs, indices })
}

pub(super) fn required_indices(p: &mut Params) -> Option<Vec<i32>> {
    if !p.has("indices") {
        let text = format!("{} needs the parameter \"integer indices\"", p.what());
        p.complain("indices", text);
    }
    p.integer_list("indices")
}

pub(super) fn positions(p: &mut Params) -> Option<Vec<[f32; 3]>> {
    if !p.has("P") {
        let text = format!("{} needs the parameter \"point3 P\"", p.what());
        p.complain("P", text);
    }
    p.points("P", ParamType::Point3)
}

/// One item per vertex; dropped with a warning when the count differs, as in pbrt.
fn per_vertex<const N: usize>(
    p: &mut Params,
    name: &'static str,
    kind: ParamType,
    vertices: Option<usize>,
) -> Vec<[f32; N]> {
    let items = p.points::<N>(name, kind).unwrap_or_default();
    match vertices {
        Some(count) if !items.is_empty() && items.len() != count => {
            let text = format!("`{name}` has {} items for {count} vertices and is dropped", items.len());
            p.warn(name, text);
            Vec::new()
        }
        _ => items,
    }
}

/// Indices that exist, whole faces of them.
pub(super) fn checked(p: &mut Params, indices: &[i32], vertices: usize, corners: usize) -> Option<Vec<u32>> {
    let bad = indices.iter().position(|&i| usize::try_from(i).map_or(true, |i| i >= vertices));
    if let Some(at) = bad {
        let text = format!("index {} refers to vertex {}, but there are {vertices}", at, indices[at]);
        p.complain("indices", text);
        return None;
    }
    let whole = indices.len() / corners * corners;
    if whole != indices.len() {
        let text =
            format!("{} indices are not a multiple of {corners}; the last ones are dropped", indices.len());
        p.warn("indices", text);
    }
    Some(indices[..whole].iter().map(|i| i.cast_unsigned()).collect())
}
