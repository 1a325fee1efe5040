use std::fmt::Write as _;
use std::io::Write as _;

use caustica_formats::ir::MeshFormat;
use caustica_formats::mesh::{MeshOptions, read, serialized_count};
use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};
use proptest::collection::vec;
use proptest::prelude::*;

/// What a file is to say.
#[derive(Clone, Debug)]
struct Said {
    positions: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    triangles: Vec<[u32; 3]>,
}

/// Coordinates of every magnitude a file may hold, zero and negative zero included.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        8 => -1e3f32..1e3,
        1 => (-30i32..30, -1f32..1.0).prop_map(|(e, m)| m * 10f32.powi(e)),
        1 => Just(0.0f32),
        1 => Just(-0.0f32),
    ]
}

fn said() -> impl Strategy<Value = Said> {
    (1usize..40, any::<bool>()).prop_flat_map(|(count, textured)| {
        let index = 0..count as u32;
        let positions = vec([number(), number(), number()], count);
        let uvs = vec([number(), number()], if textured { count } else { 0 });
        let triangles = vec([index.clone(), index.clone(), index], 0..60);
        (positions, uvs, triangles).prop_map(|(positions, uvs, triangles)| Said { positions, uvs, triangles })
    })
}

/// Reads without normals, of which each format has its own rules.
fn check(format: MeshFormat, bytes: &[u8], said: &Said) {
    let options = MeshOptions { face_normals: true, ..MeshOptions::default() };
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(bytes).unwrap();
    for bytes in [bytes, &packed.finish().unwrap()] {
        let mesh = read(format, bytes, &options).unwrap();
        assert_eq!(mesh.positions, said.positions);
        assert_eq!(mesh.uvs, said.uvs);
        assert_eq!(mesh.triangles, said.triangles);
        assert!(mesh.normals.is_empty());
    }
}

fn ply(said: &Said, format: &str, float: &str, index: &str, endings: &str) -> Vec<u8> {
    let mut lines =
        vec!["ply".to_owned(), format!("format {format} 1.0"), "comment of no meaning".to_owned()];
    lines.push(format!("element vertex {}", said.positions.len()));
    lines.extend(["x", "y", "z"].map(|name| format!("property {float} {name}")));
    if !said.uvs.is_empty() {
        lines.extend(["u", "v"].map(|name| format!("property {float} {name}")));
    }
    lines.push(format!("element face {}", said.triangles.len()));
    lines.push(format!("property list uchar {index} vertex_indices"));
    lines.push("end_header".to_owned());
    let mut bytes: Vec<u8> = lines.iter().flat_map(|line| format!("{line}{endings}").into_bytes()).collect();
    let big = format.contains("big");
    let scalar = |out: &mut Vec<u8>, value: f64, kind: &str| match (kind, big) {
        ("float", false) => out.extend((value as f32).to_le_bytes()),
        ("float", true) => out.extend((value as f32).to_be_bytes()),
        ("double", false) => out.extend(value.to_le_bytes()),
        ("double", true) => out.extend(value.to_be_bytes()),
        ("ushort", false) => out.extend((value as u16).to_le_bytes()),
        ("ushort", true) => out.extend((value as u16).to_be_bytes()),
        (_, false) => out.extend((value as i32).to_le_bytes()),
        (_, true) => out.extend((value as i32).to_be_bytes()),
    };
    let rows = said.positions.iter().enumerate();
    let vertices = rows.map(|(i, p)| p.iter().chain(said.uvs.get(i).into_iter().flatten()).copied());
    if format == "ascii" {
        let mut text = String::new();
        for vertex in vertices {
            let numbers: Vec<String> = vertex.map(|v| v.to_string()).collect();
            write!(text, "{}{endings}", numbers.join(" ")).unwrap();
        }
        said.triangles.iter().for_each(|[a, b, c]| write!(text, "3 {a} {b}\t{c}{endings}").unwrap());
        bytes.extend(text.into_bytes());
    } else {
        vertices.flatten().for_each(|v| scalar(&mut bytes, f64::from(v), float));
        for triangle in &said.triangles {
            bytes.push(3);
            triangle.iter().for_each(|i| scalar(&mut bytes, f64::from(*i), index));
        }
    }
    bytes
}

fn serialized(said: &Said, version: u16, wide: bool) -> Vec<u8> {
    let mut body = ZlibEncoder::new(Vec::new(), Compression::default());
    let uvs: u32 = if said.uvs.is_empty() { 0 } else { 0x0002 };
    let flags = uvs | if wide { 0x2000 } else { 0x1000 };
    body.write_all(&flags.to_le_bytes()).unwrap();
    if version == 4 {
        body.write_all(b"name\0").unwrap();
    }
    for count in [said.positions.len(), said.triangles.len()] {
        body.write_all(&(count as u64).to_le_bytes()).unwrap();
    }
    for value in said.positions.iter().flatten().chain(said.uvs.iter().flatten()) {
        if wide {
            body.write_all(&f64::from(*value).to_le_bytes()).unwrap();
        } else {
            body.write_all(&value.to_le_bytes()).unwrap();
        }
    }
    for index in said.triangles.iter().flatten() {
        body.write_all(&index.to_le_bytes()).unwrap();
    }
    [0x041c_u16.to_le_bytes().to_vec(), version.to_le_bytes().to_vec(), body.finish().unwrap()].concat()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn obj_files_read_to_what_they_say(said in said(), negative in any::<bool>(), crlf in any::<bool>()) {
        // A vertex of the mesh is a pair of place and uv as the faces name them: here each its own.
        let end = if crlf { "\r\n" } else { "\n" };
        let mut text = format!("# a comment{end}o thing{end}");
        said.positions.iter().for_each(|[x, y, z]| write!(text, "v {x} {y} {z}{end}").unwrap());
        said.uvs.iter().for_each(|[u, v]| write!(text, "vt {u} {v}{end}").unwrap());
        let count = said.positions.len() as i64;
        let name = |i: u32| {
            let i = if negative { i64::from(i) - count } else { i64::from(i) + 1 };
            if said.uvs.is_empty() { i.to_string() } else { format!("{i}/{i}") }
        };
        said.triangles.iter().for_each(|t| write!(text, "f {} {}  {}{end}", name(t[0]), name(t[1]), name(t[2])).unwrap());
        let options = MeshOptions { face_normals: true, ..MeshOptions::default() };
        let mesh = read(MeshFormat::Obj, text.as_bytes(), &options).unwrap();
        prop_assert_eq!(mesh.triangles.len(), said.triangles.len());
        for (found, said_triangle) in mesh.triangles.iter().zip(&said.triangles) {
            for (i, j) in found.iter().zip(said_triangle) {
                prop_assert_eq!(mesh.positions[*i as usize], said.positions[*j as usize]);
                if !said.uvs.is_empty() {
                    prop_assert_eq!(mesh.uvs[*i as usize], said.uvs[*j as usize]);
                }
            }
        }
    }

    #[test]
    fn ply_files_read_to_what_they_say(
        said in said(),
        format in prop::sample::select(vec!["ascii", "binary_little_endian", "binary_big_endian"]),
        float in prop::sample::select(vec!["float", "double"]),
        index in prop::sample::select(vec!["int", "uint", "ushort"]),
        endings in prop::sample::select(vec!["\n", "\r\n"]),
    ) {
        check(MeshFormat::Ply, &ply(&said, format, float, index, endings), &said);
    }

    #[test]
    fn serialized_files_read_to_what_they_say(
        all in vec(said(), 1..4),
        version in 3u16..=4,
        wide in any::<bool>(),
    ) {
        let mut bytes = Vec::new();
        let mut offsets = Vec::new();
        for said in &all {
            offsets.push(bytes.len());
            bytes.extend(serialized(said, version, wide));
        }
        for offset in offsets {
            // Version 3 has offsets of four bytes.
            bytes.extend(&(offset as u64).to_le_bytes()[..if version == 3 { 4 } else { 8 }]);
        }
        bytes.extend((all.len() as u32).to_le_bytes());
        prop_assert_eq!(serialized_count(&bytes).unwrap() as usize, all.len());
        for (index, said) in (0..).zip(&all) {
            check(MeshFormat::Serialized { index }, &bytes, said);
        }
    }
}

/// Whatever was to be read, a pointer or a page in its place is named for what it is.
#[test]
fn files_that_are_something_else_are_named() {
    use caustica_formats::image;
    use caustica_formats::mesh::MeshOptions;
    use caustica_formats::spectrum::parse_spd;

    let pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n";
    let page = b"\r\n<!doctype HTML>\n<title>404</title>\n";
    let names = [
        (&pointer[..], "it is a Git LFS pointer: fetch the file with `git lfs pull`"),
        (page, "it is an HTML page, probably of a failed download"),
    ];
    for (bytes, name) in names {
        use caustica_formats::ir::MeshFormat::{Obj, ObjPart, Ply, Serialized};
        for format in [Obj, ObjPart { index: 0 }, Ply, Serialized { index: 1 }] {
            let said = read(format, bytes, &MeshOptions::default()).expect_err("no mesh").to_string();
            assert_eq!(said, name, "{format:?}");
        }
        assert_eq!(image::read(bytes).expect_err("no picture").to_string(), name);
        assert_eq!(parse_spd(bytes).expect_err("no spectrum").to_string(), name);
    }
    let ply = b"ply\nformat ascii 1.0\nend_header\n";
    let said = read(MeshFormat::Obj, ply, &MeshOptions::default()).expect_err("no OBJ");
    assert_eq!(said.to_string(), "it is a PLY file, which shape `ply` reads");
    let link = image::read(b"../textures/wood.jpg").expect_err("no picture").to_string();
    assert_eq!(link, "it is a text that begins with \"../textures/wood.jpg\"");
}
