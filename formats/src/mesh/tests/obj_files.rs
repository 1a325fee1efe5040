//! Faces, vertices and errors of OBJ files.

use super::*;

#[test]
fn fans_and_shares_vertices() {
    let mesh = obj(&format!("# square\no a\n{SQUARE}usemtl x\ns off\nf 1 2 3 4\n"));
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh.positions.len(), 4);
    assert_eq!(mesh.normals, [[0.0, 0.0, 1.0]; 4]);
    assert!(mesh.uvs.is_empty());
}

#[test]
fn vertices_are_distinct_triples() {
    let text = format!(
        "{SQUARE}vt 0 0\nvt .25 .75 0\nvn 0 0 2\nf 1/1/1 2/1/1 3/2/1\nf 1/1/1 3/2/1 4/1\nf 1/2/1 2/1/1 3/2/1"
    );
    let mesh = obj(&text);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [4, 1, 2]]);
    assert_eq!(mesh.uvs[2], [0.25, 0.75]);
    assert_eq!(mesh.normals[3], [0.0, 0.0, 1.0], "the missing normal is computed");
    let flipped = MeshOptions { flip_tex_coords: true, ..PLAIN };
    let mesh = read_obj(text.as_bytes(), &flipped).expect("valid");
    assert_eq!(mesh.uvs[2], [0.25, 0.25]);
}

#[test]
fn many_triples_at_one_position() {
    let mut text = SQUARE.to_owned();
    for i in 0..100 {
        text.push_str(&format!("vt {i} 0\n"));
    }
    for _ in 0..2 {
        for i in 1..=100 {
            text.push_str(&format!("f 1/{i} 2/1 3/1\n"));
        }
    }
    let mesh = obj(&text);
    assert_eq!(mesh.positions.len(), 102);
    assert_eq!(mesh.triangles[..100], mesh.triangles[100..]);
}

#[test]
fn relative_forward_and_continued() {
    let relative = obj(&format!("{SQUARE}f -4 -3 \\\r\n  -2\r\n"));
    assert_eq!(relative.triangles, [[0, 1, 2]]);
    assert_eq!(relative.positions[1], [1.0, 0.0, 0.0]);
    let forward = obj(&format!("f 1 2 3\n{SQUARE}"));
    assert_eq!(forward.triangles, [[0, 1, 2]]);
}

#[test]
fn partial_uvs_are_zero() {
    let mesh = obj(&format!("{SQUARE}vt 1 1\nf 1/1 2/1 3/1\nf 1 3 4\n"));
    assert_eq!(mesh.uvs, [[1.0; 2], [1.0; 2], [1.0; 2], [0.0; 2], [0.0; 2], [0.0; 2]]);
    let unused = obj(&format!("{SQUARE}vt 1 1\nf 1 2 3\n"));
    assert!(unused.uvs.is_empty());
}

#[test]
fn errors_name_the_line() {
    let read = |text: &str| message(read_obj(text.as_bytes(), &PLAIN));
    let not_finite = "vertex 3 (line 4) has a coordinate that is not finite";
    assert_eq!(read("v 0 0 0\n\nv 1 0 0\nv 1 nan 0\n"), not_finite);
    assert_eq!(read("v 0 0 0\n\nv 1 0 0\nv 1 1e99 0\n"), not_finite);
    assert_eq!(
        read(&format!("{SQUARE}f 1 2 5\n")),
        "the face on line 5 refers to vertex 5, but 4 are defined"
    );
    assert_eq!(
        read(&format!("{SQUARE}f 1 2 -5\n")),
        "the face on line 5 refers to vertex -5, but 4 are defined"
    );
    assert_eq!(
        read(&format!("{SQUARE}f 1/2 2/1 3/1\n")),
        "the face on line 5 refers to texture coordinate 2, but 0 are defined"
    );
    assert_eq!(
        read(&format!("{SQUARE}f 0 1 2\n")),
        "the face on line 5 refers to vertex 0, but 4 are defined"
    );
    assert_eq!(read("v 0 x 0\n"), "line 1: expected a number, found \"x\"");
    assert_eq!(read("v 0 1\n"), "line 1: expected 3 numbers, found 2");
    assert_eq!(read(&format!("{SQUARE}f 1 2 a/b\n")), "line 5: expected a corner like 1/2/3, found \"a/b\"");
}
