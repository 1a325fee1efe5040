//! Mitsuba's `.serialized` container, versions 3 and 4: zlib streams, one per mesh, and a table of
//! their offsets at the end. Little endian.

use std::io::Read;

use flate2::read::ZlibDecoder;

use super::{Mesh, MeshError, MeshOptions, check_indices, finish};

/// The first two bytes of every mesh.
pub(super) const MAGIC: u16 = 0x041c;

const HAS_NORMALS: u32 = 0x0001;
const HAS_UVS: u32 = 0x0002;
const HAS_COLORS: u32 = 0x0008;
const FACE_NORMALS: u32 = 0x0010;
const DOUBLE: u32 = 0x2000;

/// Deflate never expands further than this.
const MAX_RATIO: u64 = 1032;

/// Reads mesh number `index` of the file.
///
/// # Errors
/// When the file is malformed or has no such mesh.
pub fn read_serialized(bytes: &[u8], index: u32, options: &MeshOptions) -> Result<Mesh, MeshError> {
    let start = offset(bytes, index)?;
    let body = bytes.get(start..).unwrap_or(&[]);
    let version = version(body, start)?;
    let packed = &body[4..];
    let mut stream = Stream { decoder: ZlibDecoder::new(packed), offset: start };

    let flags = u32::from_le_bytes(stream.array()?);
    if version >= 4 {
        stream.skip_name()?;
    }
    let vertices = u64::from_le_bytes(stream.array()?);
    let triangles = u64::from_le_bytes(stream.array()?);
    if vertices > u64::from(u32::MAX) || triangles > u64::from(u32::MAX) {
        return Err(MeshError::Unsupported(format!(
            "a serialized mesh of {vertices} vertices and {triangles} triangles"
        )));
    }
    let (vertices, triangles) = (vertices as usize, triangles as usize);
    let present = |flag: u32, components: u64| if flags & flag != 0 { components } else { 0 };
    let per_vertex = 3 + present(HAS_NORMALS, 3) + present(HAS_UVS, 2) + present(HAS_COLORS, 3);
    let float_size = if flags & DOUBLE != 0 { 8 } else { 4 };
    let needed = vertices as u64 * per_vertex * float_size + triangles as u64 * 12;
    if needed > packed.len() as u64 * MAX_RATIO {
        return Err(invalid(start, format!("cannot hold {vertices} vertices and {triangles} triangles")));
    }

    let wide = float_size == 8;
    let positions = stream.floats::<3>(vertices, wide)?;
    if let Some(vertex) = positions.iter().position(|p| p.iter().any(|c| !c.is_finite())) {
        return Err(MeshError::Invalid(format!("vertex {vertex} has a coordinate that is not finite")));
    }
    let normals = if flags & HAS_NORMALS != 0 { stream.floats(vertices, wide)? } else { Vec::new() };
    let uvs = if flags & HAS_UVS != 0 { stream.floats(vertices, wide)? } else { Vec::new() };
    if flags & HAS_COLORS != 0 {
        stream.floats::<3>(vertices, wide)?;
    }
    let indices = stream.bytes(triangles * 12)?;
    let triangles = indices
        .chunks_exact(12)
        .map(|t| std::array::from_fn(|i| u32::from_le_bytes(word(&t[i * 4..]))))
        .collect();
    let mesh = Mesh { positions, normals, uvs, triangles, ..Mesh::default() };
    check_indices(&mesh)?;
    let face_normals = options.face_normals || flags & FACE_NORMALS != 0;
    Ok(finish(mesh, &MeshOptions { face_normals, ..*options }))
}

/// Number of meshes in the file.
///
/// # Errors
/// When the table at the end of the file is malformed.
pub fn serialized_count(bytes: &[u8]) -> Result<u32, MeshError> {
    table(bytes).map(|table| (table.entries.len() / table.width) as u32)
}

struct Table<'a> {
    entries: &'a [u8],
    /// Bytes per entry: 4 in version 3, 8 in version 4.
    width: usize,
}

fn table(bytes: &[u8]) -> Result<Table<'_>, MeshError> {
    let width = if version(bytes, 0)? >= 4 { 8 } else { 4 };
    let (rest, count) =
        bytes.split_last_chunk::<4>().ok_or_else(|| invalid(bytes.len(), "ends before its table".into()))?;
    let count = u32::from_le_bytes(*count) as usize;
    let entries = count
        .checked_mul(width)
        .and_then(|size| rest.len().checked_sub(size))
        .map(|start| &rest[start..])
        .ok_or_else(|| invalid(rest.len(), format!("is too short for a table of {count} meshes")))?;
    Ok(Table { entries, width })
}

/// Where mesh `index` starts. The first one starts the file, whatever the table says; so files
/// without a table are readable.
fn offset(bytes: &[u8], index: u32) -> Result<usize, MeshError> {
    if index == 0 {
        return Ok(0);
    }
    let table = table(bytes)?;
    let entry = table.entries.chunks_exact(table.width).nth(index as usize).ok_or_else(|| {
        MeshError::Invalid(format!(
            "the file has {} meshes; there is none with index {index}",
            table.entries.len() / table.width
        ))
    })?;
    let mut wide = [0; 8];
    wide[..table.width].copy_from_slice(entry);
    let offset = u64::from_le_bytes(wide);
    usize::try_from(offset)
        .ok()
        .filter(|&offset| offset < bytes.len())
        .ok_or_else(|| MeshError::Invalid(format!("mesh {index} starts beyond the file, at {offset}")))
}

/// Version of the mesh that starts `body`.
fn version(body: &[u8], offset: usize) -> Result<u16, MeshError> {
    let [m0, m1, v0, v1] = *body.first_chunk::<4>().ok_or_else(|| invalid(offset, "is cut off".into()))?;
    if u16::from_le_bytes([m0, m1]) != MAGIC {
        return Err(invalid(offset, "does not start like a serialized mesh".into()));
    }
    match u16::from_le_bytes([v0, v1]) {
        version @ 3..=4 => Ok(version),
        version => Err(MeshError::Unsupported(format!("version {version} of serialized meshes"))),
    }
}

fn invalid(offset: usize, what: String) -> MeshError {
    MeshError::Invalid(format!("the data at byte {offset} {what}"))
}

fn word<const N: usize>(bytes: &[u8]) -> [u8; N] {
    std::array::from_fn(|i| bytes[i])
}

/// The inflated content of one mesh.
struct Stream<'a> {
    decoder: ZlibDecoder<&'a [u8]>,
    /// Of the mesh in the file, for messages.
    offset: usize,
}

impl Stream<'_> {
    fn array<const N: usize>(&mut self) -> Result<[u8; N], MeshError> {
        let mut bytes = [0; N];
        self.decoder
            .read_exact(&mut bytes)
            .map_err(|error| invalid(self.offset, format!("does not unpack: {error}")))?;
        Ok(bytes)
    }

    /// The buffer grows with the data that is there, not with the size that the header claims.
    fn bytes(&mut self, count: usize) -> Result<Vec<u8>, MeshError> {
        let mut bytes = Vec::with_capacity(count.min(1 << 20));
        let read = self.decoder.by_ref().take(count as u64).read_to_end(&mut bytes);
        match read {
            Ok(length) if length == count => Ok(bytes),
            Ok(length) => Err(invalid(
                self.offset,
                format!("ends early: {length} of {count} bytes of a vertex or index array"),
            )),
            Err(error) => Err(invalid(self.offset, format!("does not unpack: {error}"))),
        }
    }

    fn floats<const N: usize>(&mut self, count: usize, wide: bool) -> Result<Vec<[f32; N]>, MeshError> {
        let size = if wide { 8 } else { 4 };
        let bytes = self.bytes(count * N * size)?;
        let float = |bytes: &[u8]| {
            if wide { f64::from_le_bytes(word(bytes)) as f32 } else { f32::from_le_bytes(word(bytes)) }
        };
        let element = |bytes: &[u8]| std::array::from_fn(|i| float(&bytes[i * size..]));
        Ok(bytes.chunks_exact(N * size).map(element).collect())
    }

    fn skip_name(&mut self) -> Result<(), MeshError> {
        const LONGEST: usize = 1 << 16;
        for _ in 0..LONGEST {
            if self.array::<1>()? == [0] {
                return Ok(());
            }
        }
        Err(invalid(self.offset, "has an unterminated name".into()))
    }
}
