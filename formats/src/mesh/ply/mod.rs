//! Stanford PLY: ASCII and binary of both byte orders. Polygons become fans; elements and
//! properties other than those of a mesh and its attributes are skipped.

mod header;
mod source;

use header::{Element, Encoding, Property, header};
use source::Source;

use super::attributes::{Columns, FACE, FOUR, VERTEX, WHOLE};
use super::{Mesh, MeshError, MeshOptions, check_indices, finish};

/// Reads a PLY file: vertices with `x y z`, optionally `nx ny nz` and one of `u v`, `s t` or
/// `texture_u texture_v`; faces with a list `vertex_index` or `vertex_indices`.
///
/// # Errors
/// When header or data are malformed, an index points nowhere, or the file has triangle strips.
pub fn read_ply(bytes: &[u8], options: &MeshOptions) -> Result<Mesh, MeshError> {
    let header = header(bytes)?;
    let mut source = Source {
        bytes: &bytes[header.length..],
        position: 0,
        start: header.length,
        line: header.lines + 1,
        encoding: header.encoding,
    };
    let mut mesh = Mesh::default();
    for element in &header.elements {
        source.check_claim(element)?;
        match element.name.as_str() {
            "vertex" => read_vertices(&mut source, element, &mut mesh)?,
            "face" => read_faces(&mut source, element, &mut mesh)?,
            "tristrips" if element.count > 0 => {
                return Err(MeshError::Unsupported("a PLY file with triangle strips".into()));
            }
            _ => skip(&mut source, element)?,
        }
    }
    check_indices(&mesh)?;
    Ok(finish(mesh, options))
}

/// Attributes of a PLY file that [`read_ply`] leaves out because they do not have one or three components, with
/// their number of components.
pub fn skipped_attributes(bytes: &[u8]) -> Result<Vec<(String, usize)>, MeshError> {
    let mut skipped = Vec::new();
    for element in &header(bytes)?.elements {
        match element.name.as_str() {
            "vertex" => skipped.extend(vertex_columns(element, &targets(element)?).skipped),
            "face" => skipped.extend(face_columns(element).skipped),
            _ => {}
        }
    }
    Ok(skipped)
}

/// Where the values of a vertex go.
#[derive(Clone, Copy)]
enum Target {
    Position(usize),
    Normal(usize),
    Uv(usize),
    Nothing,
}

/// Names of texture coordinates, the most common first.
const UV_NAMES: [[&str; 2]; 4] =
    [["u", "v"], ["s", "t"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]];

fn targets(element: &Element) -> Result<Vec<Target>, MeshError> {
    let has = |name: &str| element.properties.iter().any(|p| p.list.is_none() && p.name == name);
    let all = |names: &[&str]| names.iter().all(|name| has(name));
    if !all(&["x", "y", "z"]) {
        return Err(MeshError::Invalid("the PLY vertices lack x, y or z".into()));
    }
    let normals = all(&["nx", "ny", "nz"]);
    let uv_names = UV_NAMES.iter().find(|names| all(*names));
    let find = |names: &[&str], name: &str| names.iter().position(|known| *known == name);
    let target = |property: &Property| {
        let name = property.name.as_str();
        if property.list.is_some() {
            Target::Nothing
        } else if let Some(axis) = find(&["x", "y", "z"], name) {
            Target::Position(axis)
        } else if let (true, Some(axis)) = (normals, find(&["nx", "ny", "nz"], name)) {
            Target::Normal(axis)
        } else if let Some(axis) = uv_names.and_then(|names| find(names, name)) {
            Target::Uv(axis)
        } else {
            Target::Nothing
        }
    };
    Ok(element.properties.iter().map(target).collect())
}

fn vertex_columns(element: &Element, targets: &[Target]) -> Columns {
    let free = element.properties.iter().zip(targets).map(|(p, target)| {
        (p.list.is_none() && matches!(target, Target::Nothing)).then_some(p.name.as_str())
    });
    noted(Columns::new(VERTEX, free), element)
}

/// Says of each attribute what its properties are.
fn noted(mut columns: Columns, element: &Element) -> Columns {
    let alpha = element.properties.iter().any(|p| matches!(p.name.as_str(), "a" | "alpha"));
    for (property, place) in element.properties.iter().zip(&columns.places) {
        let Some((attribute, _)) = *place else { continue };
        let is_color = matches!(property.name.as_str(), "r" | "g" | "b" | "red" | "green" | "blue");
        if is_color && alpha {
            columns.notes[attribute] = Some(FOUR);
        } else if !matches!(property.scalar, header::Scalar::F32 | header::Scalar::F64) {
            columns.notes[attribute] = Some(WHOLE);
        }
    }
    columns
}

fn face_columns(element: &Element) -> Columns {
    let free = element.properties.iter().map(|p| p.list.is_none().then_some(p.name.as_str()));
    noted(Columns::new(FACE, free), element)
}

fn read_vertices(source: &mut Source<'_>, element: &Element, mesh: &mut Mesh) -> Result<(), MeshError> {
    let targets = targets(element)?;
    let any = |wanted: fn(&Target) -> bool| targets.iter().any(wanted);
    let has_normals = any(|target| matches!(target, Target::Normal(_)));
    let has_uvs = any(|target| matches!(target, Target::Uv(_)));
    let columns = vertex_columns(element, &targets);
    let (mut lists, mut row) = (columns.lists(), columns.row());
    mesh.positions.reserve(element.count);
    for vertex in 0..element.count {
        let (mut position, mut normal, mut uv) = ([0.0; 3], [0.0; 3], [0.0; 2]);
        let mut line = 0;
        for ((property, target), place) in element.properties.iter().zip(&targets).zip(&columns.places) {
            if property.list.is_some() {
                source.skip_property(property)?;
                continue;
            }
            let value = source.number(property.scalar)? as f32;
            match *target {
                Target::Position(axis) => position[axis] = value,
                Target::Normal(axis) => normal[axis] = value,
                Target::Uv(axis) => uv[axis] = value,
                Target::Nothing => {
                    if let Some((attribute, component)) = *place {
                        row[attribute][component] = value;
                    }
                }
            }
            line = source.line;
        }
        if position.iter().any(|c: &f32| !c.is_finite()) {
            let place = match source.encoding {
                Encoding::Ascii => format!(" (line {line})"),
                _ => String::new(),
            };
            return Err(MeshError::Invalid(format!(
                "vertex {vertex}{place} has a coordinate that is not finite"
            )));
        }
        mesh.positions.push(position);
        if has_normals {
            mesh.normals.push(normal);
        }
        if has_uvs {
            mesh.uvs.push(uv);
        }
        columns.push(&mut lists, &row);
    }
    mesh.attributes.append(&mut lists);
    Ok(())
}

fn read_faces(source: &mut Source<'_>, element: &Element, mesh: &mut Mesh) -> Result<(), MeshError> {
    let is_indices = |property: &Property| {
        property.list.is_some() && matches!(property.name.as_str(), "vertex_index" | "vertex_indices")
    };
    if element.count > 0 && !element.properties.iter().any(is_indices) {
        return Err(MeshError::Invalid("the PLY faces lack a list of vertex_indices".into()));
    }
    let columns = face_columns(element);
    let (mut lists, mut row) = (columns.lists(), columns.row());
    let mut corners = Vec::new();
    mesh.triangles.reserve(element.count);
    for _ in 0..element.count {
        let before = mesh.triangles.len();
        for (property, place) in element.properties.iter().zip(&columns.places) {
            if let Some((attribute, component)) = *place {
                row[attribute][component] = source.number(property.scalar)? as f32;
                continue;
            }
            let Some(count) = property.list.filter(|_| is_indices(property)) else {
                source.skip_property(property)?;
                continue;
            };
            let length = source.list_length(count, property.scalar)?;
            corners.clear();
            for _ in 0..length {
                corners.push(source.index(property.scalar)?);
            }
            for pair in corners.windows(2).skip(1) {
                mesh.triangles.push([corners[0], pair[0], pair[1]]);
            }
        }
        // All triangles of a polygon have its values.
        for _ in before..mesh.triangles.len() {
            columns.push(&mut lists, &row);
        }
    }
    mesh.attributes.append(&mut lists);
    Ok(())
}

fn skip(source: &mut Source<'_>, element: &Element) -> Result<(), MeshError> {
    if element.properties.is_empty() {
        return Ok(());
    }
    for _ in 0..element.count {
        for property in &element.properties {
            source.skip_property(property)?;
        }
    }
    Ok(())
}
