//! Which way a written mesh faces.

use crate::mesh::Mesh;

/// What is reversed in a mesh when it is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Facing {
    /// The normals.
    pub normals: bool,
    /// The winding.
    pub faces: bool,
    /// Each triangle has corners of its own, with the texture coordinates that it shows where the mesh has none:
    /// they follow the order of the corners, which a reversed winding changes.
    pub keeps_uvs: bool,
}

impl Facing {
    /// As it is.
    pub const FRONT: Self = Self { normals: false, faces: false, keeps_uvs: false };

    /// As it is, or the other way around.
    pub fn new(reversed: bool) -> Self {
        Self { normals: reversed, faces: reversed, keeps_uvs: false }
    }

    pub(super) fn of(self, mut mesh: Mesh) -> Mesh {
        if self.keeps_uvs && mesh.uvs.is_empty() {
            mesh = apart(&mesh);
        }
        if self.normals {
            mesh.normals.as_flattened_mut().iter_mut().for_each(|v| *v = -*v);
        }
        if self.faces {
            mesh.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
        mesh
    }
}

/// The triangles with corners of their own, whose texture coordinates are the barycentric ones.
fn apart(mesh: &Mesh) -> Mesh {
    let corners = || mesh.triangles.as_flattened().iter().map(|&corner| corner as usize);
    Mesh {
        positions: corners().map(|corner| mesh.positions[corner]).collect(),
        normals: corners().filter_map(|corner| mesh.normals.get(corner).copied()).collect(),
        uvs: mesh.triangles.iter().flat_map(|_| [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]).collect(),
        triangles: (0..mesh.triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        computed_normals: mesh.computed_normals,
        attributes: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::builtin;

    #[test]
    fn a_reversed_mesh_faces_the_other_way_and_shows_its_texture_as_before() {
        let rectangle =
            Mesh { uvs: Vec::new(), normals: vec![[0.0, 0.0, 1.0]; 4], ..builtin::rectangle(false) };
        let back = Facing { keeps_uvs: true, ..Facing::new(true) }.of(rectangle.clone());
        assert!(back.normals.iter().all(|n| *n == [0.0, 0.0, -1.0]));
        for (front, back_corners) in rectangle.triangles.iter().zip(&back.triangles) {
            let [a, b, c] = front.map(|i| rectangle.positions[i as usize]);
            assert_eq!(back_corners.map(|i| back.positions[i as usize]), [a, c, b]);
            // The weights of the second and third corner.
            assert_eq!(back_corners.map(|i| back.uvs[i as usize]), [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]]);
        }
        assert_eq!(Facing::FRONT.of(rectangle.clone()), rectangle);
    }
}
