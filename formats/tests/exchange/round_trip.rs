//! Random scenes, written and read again.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use caustica_formats::files::Memory;
use caustica_formats::ir::{Scene, ShapeKind, canonical};
use caustica_formats::{Content, Read, ReadOptions, Written, read_scene, write_scene};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use crate::random::{self, Language};
use crate::random_media;

/// Files that random scenes refer to.
fn beside() -> BTreeMap<PathBuf, Vec<u8>> {
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let normals = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
                   property float z\nproperty float nx\nproperty float ny\nproperty float nz\nelement face 1\n\
                   property list uchar int vertex_indices\nend_header\n\
                   0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n";
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let pixels: Vec<f32> = (0..2 * 2 * 3).map(|i| i as f32 / 12.0).collect();
    let picture = caustica_formats::image::encode_pfm(2, 2, &pixels).unwrap();
    let text = |t: &str| t.as_bytes().to_vec();
    let all = [
        ("flat.ply", text(ply)),
        ("smooth.ply", text(normals)),
        ("mesh.obj", text(obj)),
        ("picture.pfm", picture),
    ];
    let volumes = random_media::FILES.map(|(name, channels)| (name, random_media::vol(channels)));
    all.into_iter().chain(volumes).map(|(name, bytes)| (PathBuf::from(name), bytes)).collect()
}

/// Writes `scene` into the folder it came from, so that its files stay where they are.
fn write(read: &Read, files: &Memory, name: &str) -> Written {
    write_scene(read, files, Path::new(name)).unwrap_or_else(|e| panic!("{e}"))
}

/// The files with those that were written.
pub fn placed(written: &Written, mut files: Memory) -> Memory {
    for asset in &written.assets {
        let bytes = match &asset.content {
            Content::Bytes(bytes) => bytes.clone(),
            Content::Copy(path) => files.0[path].clone(),
        };
        files.0.insert(asset.path.clone(), bytes);
    }
    files.0.insert(written.path.clone(), written.text.clone().into_bytes());
    files
}

fn read_back(written: &Written, files: &Memory) -> (Read, Memory) {
    let files = placed(written, files.clone());
    let read = read_scene(&files, &written.path, &ReadOptions::default())
        .unwrap_or_else(|e| panic!("{e}\n{}", written.text));
    assert!(read.warnings.is_empty(), "{}\n{}", read.sources.render(&read.warnings), written.text);
    (read, files)
}

/// As it would be if the writer had invented no names: a thing without a name has none in the copy.
fn without_new_names(original: &Scene, copy: &Scene) -> Scene {
    let mut copy = copy.clone();
    macro_rules! forget {
        ($arena:ident) => {
            let ids: Vec<_> = original.$arena.iter().map(|(id, _)| id).collect();
            for id in ids {
                if id.index() < copy.$arena.len() && original.$arena[id].name.is_none() {
                    copy.$arena[id].name = None;
                }
            }
        };
    }
    forget!(bsdfs);
    forget!(textures);
    forget!(groups);
    copy
}

/// A camera is written as LookAt, whose axes are computed again: equal up to rounding is equal.
fn keep_place(original: &Scene, copy: &mut Scene) {
    for (from, to) in original.sensors.iter().zip(&mut copy.sensors) {
        let pairs = from.to_world.0.as_flattened().iter().zip(to.to_world.0.as_flattened());
        if pairs.into_iter().all(|(a, b)| (a - b).abs() <= 1e-12 * a.abs().max(1.0)) {
            to.to_world = from.to_world;
        }
    }
}

/// A mesh that is reversed instead of flipped is the same; `joined.rs` compares the two.
fn keep_sides(original: &Scene, copy: &mut Scene) {
    for (from, to) in original.shapes.iter().zip(&mut copy.shapes) {
        let mesh = matches!(
            to.kind,
            ShapeKind::Mesh(_) | ShapeKind::Inline(_) | ShapeKind::Cube | ShapeKind::Rectangle
        );
        if from.flip_normals && !to.flip_normals && mesh {
            (to.kind, to.to_world, to.flip_normals) = (from.kind.clone(), from.to_world, true);
        }
    }
}

/// The language says all of the scene: the copy is equal, names included.
fn survives(scene: Scene, language: Language) {
    let files = Memory(beside());
    let read = Read { scene, ..random::empty(language) };
    let written = write(&read, &files, language.file());
    assert!(written.losses.is_empty(), "{:#?}\n{}", written.losses, written.text);
    let (again, _) = read_back(&written, &files);
    let original = canonical(&read.scene);
    let mut copy = without_new_names(&original, &canonical(&again.scene));
    keep_place(&original, &mut copy);
    keep_sides(&original, &mut copy);
    if original != copy {
        let [a, b] = [&original, &copy].map(|s| serde_json::to_string_pretty(s).unwrap());
        let first = a.lines().zip(b.lines()).find(|(a, b)| a != b);
        panic!("{first:?}\n{original:#?}\n{copy:#?}\n{}", written.text);
    }
}

/// What the other language cannot say is listed, and lost once only: there, back and there again, the
/// second copy is the first one.
fn settles(scene: Scene, from: Language, to: Language) {
    let files = Memory(beside());
    let read = Read { scene, ..random::empty(from) };
    let there = write(&read, &files, to.file());
    let (first, files) = read_back(&there, &files);
    let back = write(&first, &files, from.file());
    let (second, files) = read_back(&back, &files);
    let again = write(&second, &files, to.file());
    let (third, _) = read_back(&again, &files);
    for loss in there.losses.iter().chain(&back.losses) {
        assert!(!loss.what.is_empty() && !loss.instead.is_empty(), "{loss:?}");
    }
    let [a, mut b] = [&first.scene, &third.scene].map(|scene| random::without_names(&canonical(scene)));
    keep_sides(&a, &mut b);
    if back.losses.is_empty() && again.losses.is_empty() {
        random::assert_near(&a, &b, &there.text, &again.text);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, rng_seed: RngSeed::Fixed(4), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mitsuba_scenes_survive_their_own_language(scene in random::scene(Language::Mitsuba)) {
        survives(scene, Language::Mitsuba);
    }

    #[test]
    fn pbrt_scenes_survive_their_own_language(scene in random::scene(Language::Pbrt)) {
        survives(scene, Language::Pbrt);
    }

    #[test]
    fn mitsuba_scenes_settle_in_pbrt(scene in random::scene(Language::Mitsuba)) {
        settles(scene, Language::Mitsuba, Language::Pbrt);
    }

    #[test]
    fn pbrt_scenes_settle_in_mitsuba(scene in random::scene(Language::Pbrt)) {
        settles(scene, Language::Pbrt, Language::Mitsuba);
    }
}

/// Only attributes of one or three numbers can be shown: another goes when the mesh is made anew, and is
/// listed once with the place of its shape.
#[test]
fn attributes_that_a_made_mesh_lacks_are_listed() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               property float flow_0\nproperty float flow_1\nproperty float heat_0\nelement face 1\n\
               property list uchar int vertex_indices\nend_header\n0 0 0 1 2 3\n1 0 0 1 2 3\n0 1 0 1 2 3\n3 0 1 2\n";
    let scene = "<scene version=\"3.0.0\">\n<sensor type=\"perspective\"/>\n<emitter type=\"constant\"/>\n\
                 <shape type=\"ply\"><string name=\"filename\" value=\"m.ply\"/></shape>\n</scene>\n";
    let files = [("m.ply", ply), ("s.xml", scene)];
    let files = Memory(files.map(|(name, text)| (PathBuf::from(name), text.as_bytes().to_vec())).into());
    let read = read_scene(&files, Path::new("s.xml"), &ReadOptions::default()).unwrap();
    let written = write(&read, &files, "made.pbrt");
    let listed: Vec<_> = written.losses.iter().filter(|loss| loss.what.contains("attribute")).collect();
    assert_eq!(listed.len(), 1, "{:#?}", written.losses);
    assert!(listed[0].what.contains("`vertex_flow`") && listed[0].what.contains("2 numbers"));
    assert!(listed[0].place.as_deref().is_some_and(|place| place.starts_with("s.xml:4:")), "{listed:?}");
}
