//! The fuzz targets: every reader through its public entry point, with files in memory, and rendering from scene
//! text to picture.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use caustica::render::Budget;
use caustica::session::{Options, Session};
use caustica_formats::files::Memory;
use caustica_formats::mesh::{self, MeshOptions};
use caustica_formats::{ReadOptions, fourier, image, ir, read_scene, volume};

use super::memory::most_held;

/// A fuzz target: its name, which is also that of its folder in the corpus, and what it does with an input.
#[derive(Debug)]
pub struct Target {
    pub name: &'static str,
    /// Bytes of memory allowed per byte of input, in addition to [`FIXED`].
    growth: usize,
    run: fn(&[u8]),
}

/// Bytes of memory allowed to any input: tables, decoder buffers, stacks.
const FIXED: usize = 64 << 20;

/// All targets. `growth` is the highest compression ratio of the format times the bytes held per unpacked byte.
pub const TARGETS: &[Target] = &[
    // A character makes at most one node of the tree or one value, with its name, origin and defaults.
    Target { name: "mitsuba", growth: 4096, run: |data| scene("scene.xml", data) },
    Target { name: "pbrt", growth: 4096, run: |data| scene("scene.pbrt", data) },
    Target { name: "ply", growth: 4096, run: |data| meshes(ir::MeshFormat::Ply, data) },
    Target { name: "obj", growth: 4096, run: |data| meshes(ir::MeshFormat::Obj, data) },
    Target {
        name: "serialized",
        growth: 4 * 1032,
        run: |data| (0..3).for_each(|index| meshes(ir::MeshFormat::Serialized { index }, data)),
    },
    Target { name: "bsdf", growth: 16, run: tabulated },
    // The DCT codecs compress up to 64 × 1032 times. For a half float of two bytes their decoder holds blocks of
    // floats for three channels (12 bytes) and copies by channel, by line and as samples (4 × 2 at most), and we
    // hold 4, some of it twice while a buffer grows: at most 38 bytes for two.
    Target { name: "exr", growth: 19 * 64 * 1032, run: |data| picture(b"\x76\x2f\x31\x01", data) },
    // One bit a pixel through a palette: three bytes, then three floats.
    Target { name: "png", growth: 1032 * 8 * 15, run: |data| picture(b"\x89PNG\r\n\x1a\n", data) },
    Target { name: "hdr", growth: 64 * 6, run: |data| picture(b"#?", data) },
    Target { name: "pfm", growth: 4, run: |data| picture(b"P", data) },
    // JPEG, BMP and TGA: two bits end a block of 64 pixels.
    Target { name: "raster", growth: 4096 * 15, run: |data| picture(b"", data) },
    // Sixteen bits for a direction of three floats.
    Target { name: "vol", growth: 8, run: |data| volumes(&ir::VolumeFormat::Vol, data) },
    // A leaf of 160 bytes holds 512 steps of one bit, each a float, kept twice while the list of bricks grows; four
    // times as much may be reserved. Beside it is the table of bricks, of 32 MB at most.
    Target {
        name: "nvdb",
        growth: 1032 * 4 * 13,
        run: |data| volumes(&ir::VolumeFormat::NanoVdb { grid: "density".to_owned() }, data),
    },
    Target { name: "render_mitsuba", growth: 4096, run: |data| render("scene.xml", data) },
    Target { name: "render_pbrt", growth: 4096, run: |data| render("scene.pbrt", data) },
];

/// Runs a target by name.
///
/// # Panics
/// If the target takes more memory than its row allows, or fails a check of its own.
pub fn run(name: &str, data: &[u8]) {
    let target = TARGETS.iter().find(|t| t.name == name).expect("a target's name");
    let held = most_held(|| (target.run)(data));
    let bound = FIXED + target.growth * data.len();
    assert!(held <= bound, "{name}: {held} bytes held for {} of input, bound {bound}", data.len());
}

const OBJ: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";
const PLY: &[u8] =
    b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const PART_XML: &[u8] = b"<scene version='3.0.0'><bsdf type='diffuse' id='part'/></scene>";
const PART_PBRT: &[u8] = b"MakeNamedMaterial \"part\" \"string type\" \"diffuse\"\n";

/// The input itself, which may include itself, and one file of each kind that a scene may refer to.
fn files(name: &str, data: &[u8]) -> Memory {
    let picture = image::encode_pfm(2, 1, &[0.1, 0.2, 0.3, 0.4, 0.5, 0.6]).expect("two pixels");
    let all: [(&str, &[u8]); 6] = [
        ("mesh.obj", OBJ),
        ("mesh.ply", PLY),
        ("part.xml", PART_XML),
        ("part.pbrt", PART_PBRT),
        ("map.pfm", &picture),
        (name, data),
    ];
    Memory(all.into_iter().map(|(n, b)| (PathBuf::from(n), b.to_vec())).collect::<BTreeMap<_, _>>())
}

fn read(name: &str, files: &Memory) -> Option<ir::Scene> {
    let options = ReadOptions { lenient: true, ..ReadOptions::default() };
    match read_scene(files, Path::new(name), &options) {
        Ok(read) => {
            let _ = read.sources.render(&read.warnings);
            Some(read.scene)
        }
        Err(failure) => {
            assert!(!failure.to_string().is_empty(), "a failure without a message");
            None
        }
    }
}

fn scene(name: &str, data: &[u8]) {
    read(name, &files(name, data));
}

fn meshes(format: ir::MeshFormat, data: &[u8]) {
    let plain = MeshOptions::default();
    for options in [plain, MeshOptions { max_smooth_angle: Some(30.0), flip_tex_coords: true, ..plain }] {
        if let Ok(mesh) = mesh::read(format, data, &options) {
            let count = mesh.positions.len();
            assert!(mesh.triangles.iter().flatten().all(|&i| (i as usize) < count));
            assert!(mesh.positions.iter().flatten().all(|c| c.is_finite()));
        }
    }
}

/// All values that are read are numbers.
fn volumes(format: &ir::VolumeFormat, data: &[u8]) {
    let _ = volume::grid_names(data);
    if let Ok(grid) = volume::read(data, format) {
        let last = grid.resolution.map(|n| n - 1);
        for point in [[0; 3], last, last.map(|i| i / 2)] {
            assert!((0..grid.channels).all(|channel| grid.value(point, channel).is_finite()));
        }
    }
}

/// What is read holds together.
fn tabulated(data: &[u8]) {
    if let Ok(table) = fourier::read(data) {
        assert_eq!(table.series.len(), table.mu.len() * table.mu.len());
        let end = |&(first, length): &(u32, u32)| first as usize + length as usize * table.channels;
        assert!(table.series.iter().all(|series| end(series) <= table.coefficients.len()));
    }
}

/// Image formats are recognised by their first bytes, which the target prepends to inputs that lack them.
fn picture(start: &[u8], data: &[u8]) {
    let whole;
    let data = if data.starts_with(start) {
        data
    } else {
        whole = [start, data].concat();
        &whole
    };
    if let Ok(picture) = image::read(data) {
        assert_eq!(picture.data.len(), picture.width * picture.height * picture.channels.len());
    }
}

/// A scene that can be read must compile or be refused, and then give a finite picture.
fn render(name: &str, data: &[u8]) {
    let files = files(name, data);
    let options = Options { lenient: true, spectrum_rule: None, ..Options::default() };
    let mut session = match Session::open_in(&files, Path::new(name), &options) {
        Ok(session) => session,
        Err(problem) => {
            assert!(!problem.to_string().is_empty(), "a failure without words");
            return;
        }
    };
    let crop = &mut session.view.film.crop;
    (crop[2], crop[3]) = (crop[2].min(3), crop[3].min(2));
    for integrator in ["path", "photonmap"] {
        for (name, value) in [("integrator", integrator), ("photons", "64"), ("caustic_photons", "64")] {
            session.settings.set(name, value).expect("a setting of the table");
        }
        let outcome = session.render(Budget::passes(2), &mut |_| {});
        for (i, value) in session.picture(&outcome).rgb().enumerate() {
            assert!(value.iter().all(|v| v.is_finite()), "{integrator}: pixel {i} is {value:?}");
        }
    }
}
