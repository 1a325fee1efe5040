//! Small files that stand for meshes and pictures which a scene names and which are missing.

use std::io::{self, Write};
use std::path::Path;

use caustica_formats::files::{Disk, Files};
use caustica_formats::image::{ExrLayer, ExrOptions, encode_exr, encode_hdr, encode_pfm, encode_png};
use caustica_formats::mesh::{Mesh, write_ply};
use flate2::Compression;
use flate2::write::ZlibEncoder;

/// The disk, with a stand-in for each mesh or picture that is not there.
#[derive(Debug)]
pub struct StandIns;

impl Files for StandIns {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        if let Ok(bytes) = Disk.read(path)
            && !bytes.starts_with(b"version https://git-lfs")
        {
            return Ok(bytes);
        }
        made(path).ok_or_else(|| io::ErrorKind::NotFound.into())
    }

    fn is_file(&self, path: &Path) -> bool {
        Disk.is_file(path) || made(path).is_some()
    }

    fn names(&self, folder: &Path) -> Vec<String> {
        Disk.names(folder)
    }
}

/// The side of a picture: square, as pbrt's environments are.
const SIDE: usize = 8;

/// Numbers from 0.1 to 0.9, three for each pixel, that no turn or mirror leaves alone.
fn pixels() -> Vec<f32> {
    let value = |i: usize| 0.1 + 0.8 * ((i * i + 3 * i) % 97) as f32 / 96.0;
    (0..SIDE * SIDE * 3).map(value).collect()
}

fn made(path: &Path) -> Option<Vec<u8>> {
    let name = path.file_name()?.to_str()?.to_ascii_lowercase();
    let data = pixels();
    let bytes: Vec<u8> = data.iter().map(|v| (v * 255.0) as u8).collect();
    match name.rsplit_once('.')?.1 {
        "exr" => {
            let layer = ExrLayer { name: "", channels: &["R", "G", "B"], data: &data };
            encode_exr(SIDE, SIDE, &[layer], &[], ExrOptions::default()).ok()
        }
        "hdr" | "rgbe" => encode_hdr(SIDE, SIDE, &data).ok(),
        "pfm" => encode_pfm(SIDE, SIDE, &data).ok(),
        // Readers go by the first bytes.
        "png" | "jpg" | "jpeg" | "tga" | "bmp" => encode_png(SIDE, SIDE, &bytes).ok(),
        "ply" => Some(write_ply(&tent())),
        "gz" if name.ends_with(".ply.gz") => Some(write_ply(&tent())),
        "obj" => Some(obj(&tent()).into_bytes()),
        "serialized" => serialized(&tent()).ok(),
        _ => None,
    }
}

/// Two triangles that meet at an edge, with normals and uv.
fn tent() -> Mesh {
    Mesh {
        positions: vec![[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 0.5, 1.0], [-1.0, 0.0, 1.0]],
        normals: vec![[0.0, 1.0, 0.0]; 4],
        uvs: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        triangles: vec![[0, 2, 1], [0, 3, 2]],
        computed_normals: false,
        attributes: Vec::new(),
    }
}

fn obj(mesh: &Mesh) -> String {
    let mut text = String::new();
    for [x, y, z] in &mesh.positions {
        text.push_str(&format!("v {x} {y} {z}\n"));
    }
    for [u, v] in &mesh.uvs {
        text.push_str(&format!("vt {u} {v}\n"));
    }
    for [x, y, z] in &mesh.normals {
        text.push_str(&format!("vn {x} {y} {z}\n"));
    }
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|i| i + 1);
        text.push_str(&format!("f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}\n"));
    }
    text
}

/// Meshes that a `.serialized` file offers; all are the same.
const MESHES: usize = 4096;

fn serialized(mesh: &Mesh) -> io::Result<Vec<u8>> {
    const HEAD: [u8; 4] = [0x1c, 0x04, 0x04, 0x00];
    const NORMALS_AND_UV_IN_SINGLE_PRECISION: u32 = 0x1003;
    let mut body = ZlibEncoder::new(Vec::new(), Compression::default());
    body.write_all(&NORMALS_AND_UV_IN_SINGLE_PRECISION.to_le_bytes())?;
    body.write_all(b"mesh\0")?;
    body.write_all(&(mesh.positions.len() as u64).to_le_bytes())?;
    body.write_all(&(mesh.triangles.len() as u64).to_le_bytes())?;
    let (points, normals) = (mesh.positions.as_flattened(), mesh.normals.as_flattened());
    for v in points.iter().chain(normals).chain(mesh.uvs.as_flattened()) {
        body.write_all(&v.to_le_bytes())?;
    }
    for index in mesh.triangles.as_flattened() {
        body.write_all(&index.to_le_bytes())?;
    }
    let mut bytes = HEAD.to_vec();
    bytes.extend(body.finish()?);
    bytes.extend([0; 8 * MESHES]);
    bytes.extend((MESHES as u32).to_le_bytes());
    Ok(bytes)
}
