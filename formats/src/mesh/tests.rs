mod obj_files;

use super::*;

const PLAIN: MeshOptions = MeshOptions {
    face_normals: false,
    authored_normals: false,
    flip_tex_coords: false,
    max_smooth_angle: None,
};
const FLAT: MeshOptions = MeshOptions { face_normals: true, ..PLAIN };

fn message(result: Result<Mesh, MeshError>) -> String {
    result.expect_err("a malformed file").to_string()
}

fn obj(text: &str) -> Mesh {
    read_obj(text.as_bytes(), &PLAIN).expect("valid")
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn empty_meshes_are_valid() {
    assert_eq!(obj(""), Mesh::default());
    let mesh = obj(&format!("{SQUARE}f 1 2\nl 1 2\n"));
    assert_eq!(mesh, Mesh::default());
}

#[test]
fn normals_are_weighted_by_angle() {
    // A corner of a cube: three faces, one of them two triangles, must weigh the same.
    let mesh = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 0\nf 1 5 2\nf 1 3 5\nf 1 4 3\nf 1 2 4\n");
    let expected = -1.0 / 3.0_f32.sqrt();
    assert!(mesh.normals[0].iter().all(|c| (c - expected).abs() < 1e-6), "{:?}", mesh.normals[0]);
}

#[test]
fn unusable_normals_are_computed() {
    let text = format!("{SQUARE}vn nan 0 1\nvn 0 0 0\nvn 1 0 0\nf 1//1 2//2 3//3\n");
    assert_eq!(obj(&text).normals, [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]);
    let flat = read_obj(text.as_bytes(), &FLAT).expect("valid");
    assert!(flat.normals.is_empty());
}

#[test]
fn degenerate_triangles_stay() {
    let mesh = obj("v 0 0 0\nv 1 0 0\nf 1 2 2\nf 1 1 1\n");
    assert_eq!(mesh.triangles.len(), 2);
    assert!(mesh.normals.iter().all(|n| *n == [0.0, 0.0, 1.0]));
}

#[test]
fn creases_split_at_the_angle() {
    // Two squares that share an edge at a right angle, and a third that continues the first.
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 0 1\nv 1 1 1\nv -1 0 0\nv -1 1 0\n\
                f 1 2 3 4\nf 2 5 6 3\nf 7 1 4 8\n";
    let crease = |degrees| {
        let options = MeshOptions { max_smooth_angle: Some(degrees), ..PLAIN };
        read_obj(text.as_bytes(), &options).expect("valid")
    };
    let sharp = crease(80.0);
    assert_eq!(sharp.positions.len(), 10, "two vertices of the shared edge are doubled");
    assert!(sharp.normals.iter().all(|n| n.iter().filter(|c| **c == 0.0).count() == 2));
    let smooth = crease(100.0);
    assert_eq!(smooth.positions.len(), 8);
    assert_eq!(smooth.triangles.len(), 6);
}

#[test]
fn creases_ignore_uv_seams() {
    let text = format!("{SQUARE}vt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 1/2 3/2 4/2\n");
    let options = MeshOptions { max_smooth_angle: Some(10.0), ..PLAIN };
    let mesh = read_obj(text.as_bytes(), &options).expect("valid");
    assert_eq!((mesh.positions.len(), mesh.uvs.len()), (6, 6));
    assert_eq!(mesh.normals, [[0.0, 0.0, 1.0]; 6]);
}

fn sample() -> Mesh {
    obj(&format!("{SQUARE}v 0.5 0.5 1\nvt 0 0\nvt 1 0.5\nf 1/1 2/2 3/1 4/2\nf 1/1 2/2 5/2\nf 3/1 4/2 5/1\n"))
}

#[test]
fn ply_round_trip() {
    let mesh = Mesh { computed_normals: false, ..sample() };
    assert_eq!(read_ply(&write_ply(&mesh), &PLAIN).expect("own output"), mesh);
    let vertices = mesh.positions.iter().map(|p| p.map(|x| x + 0.25)).collect();
    let faces = (0..mesh.triangles.len()).map(|i| [i as f32; 3]).collect();
    let attributes = vec![
        Attribute { name: "vertex_color".to_owned(), values: vertices, note: None },
        Attribute { name: "face_heat".to_owned(), values: faces, note: None },
    ];
    let full = Mesh { attributes, ..mesh.clone() };
    assert_eq!(read_ply(&write_ply(&full), &PLAIN).expect("own output"), full);
    let bare = Mesh { normals: Vec::new(), uvs: Vec::new(), ..mesh };
    assert_eq!(read_ply(&write_ply(&bare), &FLAT).expect("own output"), bare);
}

const ASCII: &str = "ply\r\nformat ascii 1.0\r\ncomment x\nelement vertex 4\nproperty double x\n\
    property float y\nproperty float32 z\nproperty uchar red\nproperty float s\nproperty float t\n\
    element extra 1\nproperty list uchar float weights\nelement face 2\nproperty int flags\n\
    property list uchar uint vertex_indices\nend_header\n\
    0 0 0 255 0 0\n1 0 0 255 1 0\n1 1 0 255 1 1\n0 1 0 255 0 1\n2 0.5 0.5\n7 4 0 1 2 3\n8 3 0 1 2\n";

#[test]
fn ply_ascii_skips_the_unknown() {
    let mesh = read_ply(ASCII.as_bytes(), &PLAIN).expect("valid");
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
    assert_eq!(mesh.positions[2], [1.0, 1.0, 0.0]);
    assert_eq!(mesh.uvs[3], [0.0, 1.0]);
    assert_eq!(mesh.normals, [[0.0, 0.0, 1.0]; 4]);
}

fn big_endian() -> Vec<u8> {
    let mut bytes = b"ply\nformat binary_big_endian 1.0\nelement face 1\n\
        property list ushort short vertex_index\nelement vertex 3\nproperty float x\n\
        property float y\nproperty float z\nproperty float nx\nproperty float ny\n\
        property float nz\nend_header\n"
        .to_vec();
    for index in [3_i16, 0, 1, 2] {
        bytes.extend(index.to_be_bytes());
    }
    for position in [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
        for value in position.into_iter().chain([0.0, 3.0, 4.0]) {
            bytes.extend(value.to_be_bytes());
        }
    }
    bytes
}

#[test]
fn ply_big_endian_faces_first() {
    let mesh = read_ply(&big_endian(), &PLAIN).expect("valid");
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    assert_eq!(mesh.positions[1], [1.0, 0.0, 0.0]);
    assert_eq!(mesh.normals, [[0.0, 0.6, 0.8]; 3]);
}

#[test]
fn ply_errors_name_the_place() {
    let read = |from: &str, to: &str| message(read_ply(ASCII.replace(from, to).as_bytes(), &PLAIN));
    assert_eq!(read("\n1 1 0", "\n1 inf 0"), "vertex 2 (line 19) has a coordinate that is not finite");
    assert_eq!(read("3 0 1 2", "3 0 1 9"), "triangle 2 refers to vertex 9, but the mesh has 4 vertices");
    assert_eq!(read("3 0 1 2", "3 0 1 -1"), "line 23: -1 cannot be a vertex index");
    assert_eq!(read("\n1 1 0", "\n1 one 0"), "line 19: expected a number, found \"one\"");
    assert_eq!(
        read("vertex 4", "vertex 400000000000"),
        "the file is too short for 400000000000 elements \"vertex\""
    );
    assert_eq!(read("float y", "float q"), "the PLY vertices lack x, y or z");
    assert_eq!(read("float y", "half y"), "line 6: unknown type \"half\"");
    assert_eq!(read("ply\r", "obj\r"), "line 1: a PLY file starts with the word ply");
    assert_eq!(read("end_header", "comment"), "line 17: \"0 0 0 255 0 0\" does not belong in a PLY header");
    assert_eq!(message(read_ply(b"ply\ncomment", &PLAIN)), "the PLY header has no end");
}

/// A container with the meshes given as (flags, content after the counts, vertices, triangles).
fn container(version: u16, meshes: &[(u32, Vec<u8>, u64, u64)]) -> Vec<u8> {
    use std::io::Write;
    let mut bytes = Vec::new();
    let mut offsets = Vec::new();
    for (flags, content, vertices, triangles) in meshes {
        offsets.push(bytes.len());
        bytes.extend(0x041c_u16.to_le_bytes());
        bytes.extend(version.to_le_bytes());
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
        let mut body = flags.to_le_bytes().to_vec();
        if version >= 4 {
            body.extend(b"a name\0");
        }
        body.extend(vertices.to_le_bytes());
        body.extend(triangles.to_le_bytes());
        body.extend(content);
        encoder.write_all(&body).expect("in memory");
        bytes.extend(encoder.finish().expect("in memory"));
    }
    for offset in offsets {
        match version {
            3 => bytes.extend((offset as u32).to_le_bytes()),
            _ => bytes.extend((offset as u64).to_le_bytes()),
        }
    }
    bytes.extend((meshes.len() as u32).to_le_bytes());
    bytes
}

fn triangle_content(double: bool, uvs: bool) -> Vec<u8> {
    let mut values = vec![0.0_f64, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    if uvs {
        values.extend([0.0, 0.0, 1.0, 0.0, 0.0, 0.25]);
    }
    let float = |v: f64| {
        if double { v.to_le_bytes().to_vec() } else { (v as f32).to_le_bytes().to_vec() }
    };
    let indices = [0_u32, 1, 2].into_iter().flat_map(|i| i.to_le_bytes());
    values.into_iter().flat_map(float).chain(indices).collect()
}

fn two_meshes(version: u16) -> Vec<u8> {
    container(
        version,
        &[(0x1000, triangle_content(false, false), 3, 1), (0x2002, triangle_content(true, true), 3, 1)],
    )
}

#[test]
fn serialized_versions_and_precisions() {
    for version in [3, 4] {
        let bytes = two_meshes(version);
        assert_eq!(serialized_count(&bytes).expect("a table"), 2);
        let first = read_serialized(&bytes, 0, &PLAIN).expect("valid");
        let second = read_serialized(&bytes, 1, &PLAIN).expect("valid");
        assert_eq!(first.positions, second.positions);
        assert_eq!(first.triangles, [[0, 1, 2]]);
        assert_eq!(second.uvs[2], [0.0, 0.25]);
        assert_eq!(first.normals, [[0.0, 0.0, 1.0]; 3]);
        assert_eq!(
            message(read_serialized(&bytes, 2, &PLAIN)),
            "the file has 2 meshes; there is none with index 2"
        );
    }
}

#[test]
fn serialized_flat_flag() {
    let bytes = container(4, &[(0x1010, triangle_content(false, false), 3, 1)]);
    assert!(read_serialized(&bytes, 0, &PLAIN).expect("valid").normals.is_empty());
}

#[test]
fn serialized_lies() {
    let content = triangle_content(false, false);
    for (vertices, triangles) in [(3, 2), (300, 1), (1 << 31, 1), (u64::MAX, 0), (0, 1 << 31), (2, 1)] {
        let bytes = container(4, &[(0x1000, content.clone(), vertices, triangles)]);
        assert!(read_serialized(&bytes, 0, &PLAIN).is_err(), "{vertices} {triangles}");
    }
    assert!(read_serialized(b"", 0, &PLAIN).is_err());
    let version5 = container(5, &[(0x1000, content, 3, 1)]);
    assert!(matches!(read_serialized(&version5, 0, &PLAIN), Err(MeshError::Unsupported(_))));
}

#[test]
fn hostile_files_do_not_panic() {
    let binary = write_ply(&sample());
    let obj_text = format!("{SQUARE}vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1 4//1\nf -1 -2 -3\n");
    let crease = MeshOptions { max_smooth_angle: Some(30.0), ..PLAIN };
    let read_all = |format: MeshFormat, bytes: &[u8]| {
        for options in [PLAIN, crease] {
            if let Ok(mesh) = read(format, bytes, &options) {
                check(&mesh);
            }
        }
    };
    let serialized = MeshFormat::Serialized { index: 1 };
    let files: [(MeshFormat, Vec<u8>); 6] = [
        (MeshFormat::Obj, obj_text.into_bytes()),
        (MeshFormat::Ply, ASCII.as_bytes().to_vec()),
        (MeshFormat::Ply, binary),
        (MeshFormat::Ply, big_endian()),
        (serialized, two_meshes(3)),
        (serialized, two_meshes(4)),
    ];
    for (format, bytes) in files {
        for end in 0..bytes.len() {
            read_all(format, &bytes[..end]);
        }
        let mut state = 7_u64;
        let mut random = move |below: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % below
        };
        for _ in 0..5000 {
            let mut copy = bytes.clone();
            for _ in 0..=random(4) {
                let at = random(copy.len());
                copy[at] = random(256) as u8;
            }
            read_all(format, &copy);
        }
    }
}

fn check(mesh: &Mesh) {
    let count = mesh.positions.len();
    assert!(mesh.triangles.iter().flatten().all(|&index| (index as usize) < count));
    assert!(mesh.positions.iter().flatten().all(|c| c.is_finite()));
    assert!(mesh.normals.is_empty() || mesh.normals.len() == count);
    assert!(mesh.uvs.is_empty() || mesh.uvs.len() == count);
    for normal in &mesh.normals {
        let length = normal.iter().map(|c| c * c).sum::<f32>().sqrt();
        assert!((length - 1.0).abs() < 1e-4, "{normal:?}");
    }
}

proptest::proptest! {
    #[test]
    fn arbitrary_text_does_not_panic(text in "([vf](t|n)?( -?[0-9/.e]{1,6}){0,5}\n){0,12}") {
        if let Ok(mesh) = read_obj(text.as_bytes(), &PLAIN) {
            check(&mesh);
        }
    }
}

/// Mitsuba 3.9.1 shows uchar 255 as 255 times as bright, with a warning, and no colour of four numbers.
#[test]
fn colours_that_mitsuba_warns_of_have_a_note() {
    let note = |properties: &str, values: &str| {
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n{properties}end_header\n0 0 0 {values}\n"
        );
        let mesh = read_ply(text.as_bytes(), &PLAIN).expect("valid");
        (mesh.attributes[0].values[0], mesh.attributes[0].note.unwrap_or_default())
    };
    let (value, said) = note("property uchar red\nproperty uchar green\nproperty uchar blue\n", "255 128 0");
    assert_eq!(value, [255.0, 128.0, 0.0]);
    assert!(said.starts_with("the file has whole numbers"), "{said}");
    let (value, said) =
        note("property float r\nproperty float g\nproperty float b\nproperty float a\n", "1 .5 0 1");
    assert_eq!(value, [1.0, 0.5, 0.0]);
    assert!(said.starts_with("the file has an alpha"), "{said}");
    assert_eq!(note("property float r\nproperty float g\nproperty float b\n", "1 .5 0").1, "");
}
