//! Scenes and photons for the benchmarks.
#![allow(dead_code, reason = "every benchmark uses a part")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use caustica::photon::Stored;
use caustica::photon::trace::{TraceJob, trace};
use caustica::scene::Scene;
use caustica::session::{Options, Session};
use caustica::transport::Owner;
use caustica_formats::files::Memory;

/// The Cornell box with diffuse boxes.
const CORNELL: &str = include_str!("../../scenes/cornell-diffuse.xml");

/// Opens a scene with the files it names.
fn open(xml: &str, more: Vec<(&str, Vec<u8>)>, options: &Options) -> Session {
    let mut files: BTreeMap<PathBuf, Vec<u8>> =
        more.into_iter().map(|(name, bytes)| (PathBuf::from(name), bytes)).collect();
    files.insert("scene.xml".into(), xml.as_bytes().to_vec());
    match Session::open_in(&Memory(files), Path::new("scene.xml"), options) {
        Ok(session) => session,
        Err(problem) => panic!("{problem}"),
    }
}

/// The box with a film of `size` pixels squared.
pub fn cornell(size: u32) -> Session {
    open(CORNELL, vec![], &Options { size: Some([size; 2]), ..Options::default() })
}

/// Smoke in a grid, on a floor, with a film of `size` pixels squared.
pub fn smoke(size: u32) -> Session {
    let grid = include_bytes!("../../scenes/media/smoke.vol").to_vec();
    let options = Options { size: Some([size; 2]), ..Options::default() };
    open(include_str!("../../scenes/media/smoke.xml"), vec![("smoke.vol", grid)], &options)
}

/// A million triangles: a hilly sheet, seen from above under a lamp.
pub fn hills() -> Session {
    let side = 708;
    let mut ply = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n\
         property float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        side * side,
        (side - 1) * (side - 1) * 2
    )
    .into_bytes();
    for j in 0..side {
        for i in 0..side {
            let (x, y) = (i as f32 / side as f32 * 2.0 - 1.0, j as f32 / side as f32 * 2.0 - 1.0);
            let z = 0.1 * (9.0 * x).sin() * (7.0 * y).cos() + 0.01 * (90.0 * x + 40.0 * y).sin();
            [x, y, z].iter().for_each(|c| ply.extend(c.to_le_bytes()));
        }
    }
    for j in 0..side - 1 {
        for i in 0..side - 1 {
            let a = j * side + i;
            for face in [[a, a + 1, a + side], [a + 1, a + side + 1, a + side]] {
                ply.push(3);
                face.iter().for_each(|&v: &i32| ply.extend(v.to_le_bytes()));
            }
        }
    }
    let xml = r#"<scene version="3.0.0">
        <sensor type="perspective">
            <float name="fov" value="40"/>
            <transform name="to_world"><lookat origin="0, -2.5, 2" target="0, 0, 0" up="0, 0, 1"/></transform>
            <film type="hdrfilm"><integer name="width" value="256"/><integer name="height" value="256"/></film>
        </sensor>
        <shape type="ply"><string name="filename" value="hills.ply"/><bsdf type="diffuse"/></shape>
        <shape type="sphere"><point name="center" x="0" y="0" z="3"/><float name="radius" value="0.3"/>
            <emitter type="area"><rgb name="radiance" value="10"/></emitter></shape>
    </scene>"#;
    open(xml, vec![("hills.ply", ply)], &Options::default())
}

/// The photons of the global map in a default render, all of which have scattered at least once.
pub fn photons(scene: &Scene, count: usize) -> Stored {
    let job = |paths| TraceJob {
        beams: false,
        all: false,
        glints: false,
        focused: false,
        key: 1,
        paths,
        owner: Owner::GlobalMap,
        next_event: true,
        glossy: 0.2,
        caustic_map: true,
        max_depth: u32::MAX,
    };
    let trial = trace(scene, &job(20_000)).photons.len();
    let photons = trace(scene, &job(count as u64 * 20_000 / trial as u64 * 101 / 100)).photons;
    photons.iter().take(count).collect()
}

/// A pool of one thread, to measure per core.
pub fn one_thread() -> rayon::ThreadPool {
    match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
        Ok(pool) => pool,
        Err(e) => panic!("{e}"),
    }
}
