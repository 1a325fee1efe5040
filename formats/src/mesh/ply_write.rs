//! Meshes as PLY files.

use super::Mesh;
use super::attributes::{Attribute, FACE, VERTEX};

/// A binary little-endian PLY file with everything `mesh` has.
pub fn write_ply(mesh: &Mesh) -> Vec<u8> {
    let columns = |prefix: &str| -> Vec<Column<'_>> {
        mesh.attributes.iter().filter_map(|attribute| Column::new(attribute, prefix)).collect()
    };
    let (per_vertex, per_face) = (columns(VERTEX), columns(FACE));
    let mut properties: Vec<String> = ["x", "y", "z"].map(str::to_owned).to_vec();
    if !mesh.normals.is_empty() {
        properties.extend(["nx", "ny", "nz"].map(str::to_owned));
    }
    if !mesh.uvs.is_empty() {
        properties.extend(["u", "v"].map(str::to_owned));
    }
    properties.extend(per_vertex.iter().flat_map(Column::properties));
    let mut header =
        format!("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", mesh.positions.len());
    let declare = |header: &mut String, names: &[String]| {
        names.iter().for_each(|name| header.push_str(&format!("property float {name}\n")));
    };
    declare(&mut header, &properties);
    let faces = mesh.triangles.len();
    header.push_str(&format!("element face {faces}\nproperty list uchar int vertex_indices\n"));
    let properties: Vec<String> = per_face.iter().flat_map(Column::properties).collect();
    declare(&mut header, &properties);
    header.push_str("end_header\n");
    let mut bytes = header.into_bytes();
    for (vertex, position) in mesh.positions.iter().enumerate() {
        let normal = mesh.normals.get(vertex).into_iter().flatten();
        let uv = mesh.uvs.get(vertex).into_iter().flatten();
        let others = per_vertex.iter().flat_map(|column| column.values(vertex));
        for value in position.iter().chain(normal).chain(uv).chain(others) {
            bytes.extend(value.to_le_bytes());
        }
    }
    for (face, triangle) in mesh.triangles.iter().enumerate() {
        bytes.push(3);
        bytes.extend(triangle.iter().flat_map(|index| index.to_le_bytes()));
        for value in per_face.iter().flat_map(|column| column.values(face)) {
            bytes.extend(value.to_le_bytes());
        }
    }
    bytes
}

/// An attribute as properties of its element.
struct Column<'a> {
    attribute: &'a Attribute,
    /// Without `vertex_` or `face_`.
    stem: &'a str,
    /// One property for a number that is repeated, else three.
    size: usize,
}

impl<'a> Column<'a> {
    fn new(attribute: &'a Attribute, prefix: &str) -> Option<Self> {
        let stem = attribute.name.strip_prefix(prefix)?;
        let single = attribute.values.iter().all(|[a, b, c]| a == b && b == c);
        Some(Self { attribute, stem, size: if single { 1 } else { 3 } })
    }

    fn properties(&self) -> impl Iterator<Item = String> {
        (0..self.size).map(|i| format!("{}_{i}", self.stem))
    }

    fn values(&self, index: usize) -> &'a [f32] {
        self.attribute.values.get(index).map_or(&[0.0; 3][..self.size], |value| &value[..self.size])
    }
}
