//! Volume files that NanoVDB's own tools (version 32.9) wrote.

use std::path::Path;

use caustica_formats::ir::VolumeFormat;
use caustica_formats::volume::{self, Grid, VolumeError};

fn bytes(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/readers/volumes");
    std::fs::read(folder.join(format!("{name}.nvdb"))).unwrap()
}

fn grid(bytes: &[u8], grid: &str) -> Result<Grid, VolumeError> {
    volume::read(bytes, &VolumeFormat::NanoVdb { grid: grid.to_owned() })
}

/// The values of all files but `two`: a wave in x −3..4, y 0..4, z 5..12, and 0.75 in x 16..24, y 0..8, z 8..16.
fn value([x, y, z]: [i32; 3]) -> f32 {
    match [x, y, z] {
        [-3..4, 0..4, 5..12] => 0.5 + 0.5 * (0.7 * x as f32 + 0.3 * (y * z) as f32).sin(),
        [16..24, 0..8, 8..16] => 0.75,
        _ => 0.0,
    }
}

#[test]
fn nanovdb_grids_of_all_encodings() {
    // A leaf has values from 0 to 1 at most; codes are rounded, and may be dithered by a step. `fpN` chose its bits for
    // an error of 0.01 at most.
    let files =
        [("float", 1e-6), ("fp16", 1.0 / 65_535.0), ("fp8", 1.0 / 255.0), ("fp4", 1.0 / 15.0), ("fpn", 0.01)];
    for (name, tolerance) in files {
        let grid = grid(&bytes(name), "density").unwrap();
        assert_eq!((grid.resolution, grid.channels), ([27, 8, 11], 1), "{name}");
        let mut worst: f32 = 0.0;
        for x in 0..27 {
            for y in 0..8 {
                for z in 0..11 {
                    let wanted = value([x as i32 - 3, y as i32, z as i32 + 5]);
                    worst = worst.max((grid.value([x, y, z], 0) - wanted).abs());
                }
            }
        }
        assert!(worst <= tolerance, "{name}: {worst}");
        if name != "float" {
            assert!(worst > 0.0, "{name} was rounded");
        }
    }
}

/// Index (0, 0, 0) is the world's (1, 2, 3), and a step 0.25; values stand in the middle of their cells.
#[test]
fn nanovdb_grids_have_a_place() {
    let place = grid(&bytes("float"), "density").unwrap().place.unwrap();
    let near = |a: [f64; 3], b: [f64; 3]| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-9);
    assert!(near(place.point([3.5 / 27.0, 0.5 / 8.0, -4.5 / 11.0]), [1.0, 2.0, 3.0]));
    assert!(near(place.vector([1.0 / 27.0, 1.0 / 8.0, 1.0 / 11.0]), [0.25; 3]));
}

#[test]
fn several_grids_of_a_file() {
    let two = bytes("two");
    assert_eq!(volume::grid_names(&two).unwrap(), ["density", "temperature"]);
    let density = grid(&two, "density").unwrap();
    assert_eq!(density.resolution, [201, 4, 5]);
    assert_eq!([0, 4, 5, 200].map(|x| density.value([x, 0, 0], 0)), [1.0, 5.0, 0.0, 0.0]);
    assert_eq!(density.value([200, 3, 4], 0), 0.5);
    // Most of it is empty.
    assert!(density.bytes() < 201 * 4 * 5 * 4, "{}", density.bytes());
    let temperature = grid(&two, "temperature").unwrap();
    assert_eq!([1, 4].map(|x| temperature.value([x, 0, 0], 0)), [1000.0, 4000.0]);
    let missing = grid(&two, "heat").unwrap_err().to_string();
    assert_eq!(missing, "the file has no grid named `heat`; it has `density`, `temperature`");
}

#[test]
fn faults_of_nanovdb_files_are_named() {
    let sound = bytes("two");
    let changed = |at: usize, value: u8| {
        let mut bytes = sound.clone();
        bytes[at] = value;
        grid(&bytes, "density").unwrap_err().to_string()
    };
    assert_eq!(changed(0, b'X'), "not a volume file: it does not begin with NanoVDB");
    assert_eq!(changed(7, b'1'), "a volume file that is a bare NanoVDB grid is not supported");
    assert_eq!(changed(11, 5), "a volume file of NanoVDB version 40 is not supported");
    assert_eq!(changed(14, 2), "a volume file compressed by BLOSC is not supported");
    assert!(changed(sound.len() / 4, 0xff).starts_with("the grid cannot be unpacked"));
    let cut = grid(&sound[..300], "density").unwrap_err();
    assert!(matches!(cut, VolumeError::Short { .. }), "{cut}");
}
