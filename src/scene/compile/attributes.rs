//! Mesh attributes for the textures that read them.

use caustica_formats::ir;
use caustica_formats::mesh::Mesh;

use super::Compiler;
use crate::texture::{Texture, Values};

impl Compiler<'_> {
    /// Hands the attributes of `mesh` to the textures of the material of shape `index`.
    pub(super) fn attach_attributes(
        &mut self,
        material: u32,
        mesh: Option<&Mesh>,
        index: u32,
        at: ir::Origin,
    ) {
        for i in self.textures.so_far().attributes_in(&self.materials.params(material)) {
            let Some(Texture::MeshAttribute(texture)) = self.textures.at(i) else { continue };
            let found = mesh.and_then(|m| {
                let attribute = m.attributes.iter().find(|a| a.name == texture.name)?;
                let corners = if attribute.is_per_face() { Vec::new() } else { m.triangles.clone() };
                Some((Values { corners, values: attribute.values.clone() }, attribute.note))
            });
            match found {
                Some((values, note)) => {
                    texture.give(index, values);
                    if let Some(note) = note {
                        let text = format!("the attribute `{}` of this mesh: {note}", texture.name);
                        self.warn(text, at);
                    }
                }
                None => {
                    let name = texture.name.clone();
                    self.error(format!("this shape has no attribute `{name}`, which its texture shows"), at);
                }
            }
        }
    }
}

/// The mesh with unshared corners and pbrt's default uv on every triangle.
pub fn with_default_uvs(mesh: &Mesh) -> Mesh {
    let corners = || mesh.triangles.iter().flatten().map(|&i| i as usize);
    Mesh {
        positions: corners().map(|i| mesh.positions[i]).collect(),
        normals: corners().filter_map(|i| mesh.normals.get(i).copied()).collect(),
        uvs: mesh.triangles.iter().flat_map(|_| [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]).collect(),
        triangles: (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        computed_normals: false,
        attributes: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_triangle_has_half_of_the_square() {
        let mesh = Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let own = with_default_uvs(&mesh);
        assert_eq!(own.positions[own.triangles[1][1] as usize], [1.0, 1.0, 0.0]);
        assert_eq!(own.triangles[1].map(|i| own.uvs[i as usize]), [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]);
        assert!(own.normals.is_empty());
    }
}
