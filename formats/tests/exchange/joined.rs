//! Meshes with equal materials, which Mitsuba joins unless `flip_normals` keeps them apart: then it stops.

use std::path::{Path, PathBuf};

use caustica_formats::files::{Files, Memory};
use caustica_formats::ir::{Scene, Shape, ShapeKind};
use caustica_formats::mesh::{self, Mesh, MeshOptions, builtin};
use caustica_formats::{Content, ReadOptions, read_scene, write_scene};

const MATERIAL: &str = r#"<bsdf type="diffuse"><rgb name="reflectance" value="0.2, 0.4, 0.6"/></bsdf>"#;

/// Beside a plain mesh of its material, one of each kind that has `flip_normals`, mirrored and not; the last one is of a
/// material that no other mesh has.
fn scene() -> String {
    let flipped = |kind: &str, file: &str, material: &str| {
        ["1, 2, 3", "-1, 2, 3"].map(|scale| {
            format!(
                r#"<shape type="{kind}">{file}<boolean name="flip_normals" value="true"/>
                <transform name="to_world"><scale value="{scale}"/><translate x="4"/></transform>{material}</shape>"#
            )
        })
    };
    let file = |name: &str| format!(r#"<string name="filename" value="{name}"/>"#);
    let mut text = format!(
        r#"<scene version="3.0.0"><sensor type="perspective"/><bsdf type="twosided" id="named">{MATERIAL}</bsdf>
        <shape type="cube"><bsdf type="twosided">{MATERIAL}</bsdf></shape>"#
    );
    for (kind, name) in
        [("cube", ""), ("rectangle", ""), ("ply", "flat.ply"), ("ply", "smooth.ply"), ("obj", "mesh.obj")]
    {
        let file = if name.is_empty() { String::new() } else { file(name) };
        text += &flipped(kind, &file, r#"<ref id="named"/>"#).concat();
    }
    text + &flipped("cube", "", MATERIAL)[0] + "</scene>"
}

fn beside() -> Memory {
    let ply = |normals: &str, tail: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n{normals}\
             element face 1\nproperty list uchar int vertex_indices\nend_header\n\
             0 0 0{tail}\n1 0 0{tail}\n0 1 0{tail}\n3 0 1 2\n"
        )
    };
    let normals = "property float nx\nproperty float ny\nproperty float nz\n";
    let all = [
        ("flat.ply", ply("", "")),
        ("smooth.ply", ply(normals, " 0 0.6 0.8")),
        ("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\n".to_owned()),
        ("scene.xml", scene()),
    ];
    Memory(all.into_iter().map(|(name, text)| (PathBuf::from(name), text.into_bytes())).collect())
}

fn mesh_of(shape: &Shape, files: &Memory) -> Mesh {
    match &shape.kind {
        ShapeKind::Cube => builtin::cube(),
        ShapeKind::Rectangle => builtin::rectangle(shape.to_world.determinant3() < 0.0),
        ShapeKind::Mesh(file) => {
            let options = MeshOptions { face_normals: file.face_normals, ..MeshOptions::default() };
            mesh::read(file.format, &files.read(&file.path).unwrap(), &options).unwrap()
        }
        other => panic!("{other:?}"),
    }
}

/// Of every triangle its normal by the winding in the world, and of every corner its shading normal.
fn normals(shape: &Shape, files: &Memory) -> Vec<[f64; 3]> {
    let mesh = mesh_of(shape, files);
    let m = &shape.to_world;
    let side = if shape.flip_normals { -1.0 } else { 1.0 };
    let mirrored = if mesh.computed_normals && m.determinant3() < 0.0 { -1.0 } else { 1.0 };
    let inverse = m.inverse().unwrap();
    let mut all = Vec::new();
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|i| m.point(mesh.positions[i as usize].map(f64::from)));
        let [u, v] = [b, c].map(|p| [0, 1, 2].map(|i| p[i] - a[i]));
        all.push(
            [0, 1, 2].map(|i| (u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3]) * side),
        );
        for i in corners {
            let Some(n) = mesh.normals.get(*i as usize).map(|n| n.map(f64::from)) else { continue };
            let turned = [0, 1, 2].map(|i| (0..3).map(|j| inverse.0[j][i] * n[j]).sum::<f64>());
            let length = turned.iter().map(|v| v * v).sum::<f64>().sqrt();
            all.push(turned.map(|v| v / length * side * mirrored));
        }
    }
    // A reversed triangle names its corners in another order.
    all.sort_by(|a, b| a.partial_cmp(b).unwrap());
    all
}

#[test]
fn a_flipped_mesh_that_mitsuba_would_join_with_another_is_reversed() {
    let mut files = beside();
    let read = read_scene(&files, Path::new("scene.xml"), &ReadOptions::default()).unwrap();
    let written = write_scene(&read, &files, Path::new("made.xml")).unwrap();
    assert!(written.losses.is_empty(), "{:?}", written.losses);
    // Nothing is left of the first attempt.
    for asset in &written.assets {
        assert!(written.text.contains(&asset.path.display().to_string()), "{}", asset.path.display());
        if let Content::Bytes(bytes) = &asset.content {
            files.0.insert(asset.path.clone(), bytes.clone());
        }
    }
    files.0.insert(written.path.clone(), written.text.clone().into_bytes());
    let copy = read_scene(&files, &written.path, &ReadOptions::default()).unwrap();
    let flips = |scene: &Scene| scene.shapes.iter().map(|shape| shape.flip_normals).collect::<Vec<_>>();
    let shapes = read.scene.shapes.len();
    assert_eq!(flips(&read.scene), (0..shapes).map(|i| i > 0).collect::<Vec<_>>());
    assert_eq!(
        flips(&copy.scene),
        (0..shapes).map(|i| i == shapes - 1).collect::<Vec<_>>(),
        "{}",
        written.text
    );
    for (i, (before, after)) in read.scene.shapes.iter().zip(&copy.scene.shapes).enumerate() {
        let (a, b) = (normals(before, &files), normals(after, &files));
        assert_eq!(a.len(), b.len(), "shape {i}");
        let near = |a: &[f64; 3], b: &[f64; 3]| (0..3).all(|c| (a[c] - b[c]).abs() < 1e-6);
        assert!(
            a.iter().zip(&b).all(|(a, b)| near(a, b)),
            "shape {i}: {a:?} against {b:?}\n{}",
            written.text
        );
    }
}
