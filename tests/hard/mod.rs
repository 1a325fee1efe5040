//! Hard cases: each has an exact or derived expectation, and is rendered by path tracing and by photon
//! mapping. The measurements are written to `target/hard-cases.md`.

mod density;
mod geometry;
mod leaks;
mod light;
mod maps;
mod media;
mod numbers;
mod optics;
mod place;
mod sky;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, PoisonError};

use caustica::session::{Options, Session};
use caustica_formats::files::Disk;

use crate::support::{ALL, Estimate, Picture, Stage, assert_agree, assert_same, plain};

/// A name and the settings that choose the integrator.
type Method = (&'static str, &'static [(&'static str, &'static str)]);

const PATH: Method = ("path", &[("integrator", "path")]);
const MAPS: Method = ("photon map", &[("photons", "8000"), ("caustic_photons", "8000")]);
const METHODS: [Method; 2] = [PATH, MAPS];

type Rows = BTreeMap<String, [String; 3]>;
static TABLE: LazyLock<Mutex<Rows>> = LazyLock::new(Mutex::default);

/// Adds a row to the table and rewrites the file, so that a failing case does not hide the others.
fn record(case: &str, expectation: &str, measured: &str, bound: &str) {
    let mut rows = TABLE.lock().unwrap_or_else(PoisonError::into_inner);
    rows.insert(case.to_owned(), [expectation, measured, bound].map(str::to_owned));
    let mut text = "| case | expectation | measured | bound |\n|---|---|---|---|\n".to_owned();
    for (case, [expectation, measured, bound]) in rows.iter() {
        text.push_str(&format!("| {case} | {expectation} | {measured} | {bound} |\n"));
    }
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/hard-cases.md");
    std::fs::create_dir_all(file.parent().expect("has a folder")).expect("target/ can be made");
    caustica_formats::image::atomic_write(file, text.as_bytes()).expect("the table can be written");
}

/// Compiles a scene of `scenes/hard/` with the given parameters.
fn hard_scene(name: &str, parameters: &[(&str, &str)]) -> Stage {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes/hard").join(format!("{name}.xml"));
    let defines = parameters.iter().map(|(n, v)| ((*n).to_owned(), (*v).to_owned())).collect();
    let options = Options { defines, ..plain() };
    Stage(Session::open_in(&Disk, &path, &options).unwrap_or_else(|e| panic!("{e}")))
}

fn percent(part: f64) -> String {
    format!("{:.3} %", 100.0 * part)
}

/// Records and asserts that a mean is as expected; see [`assert_agree`].
#[track_caller]
fn agree(case: &str, expectation: &str, a: Estimate, b: Estimate, relative: f64) {
    let sigma = a.sigma.hypot(b.sigma) / b.mean.abs();
    let measured = format!("{:+.3} % ± {}", 100.0 * (a.mean / b.mean - 1.0), percent(sigma));
    record(case, expectation, &measured, &percent(relative));
    assert_agree(case, a, b, relative);
}

/// Records and asserts that two renders with the same random numbers differ by at most `relative` in the mean of
/// every channel.
#[track_caller]
fn same(case: &str, expectation: &str, a: &Picture, b: &Picture, relative: f64) {
    let worst = (0..3).map(|c| a.minus(b, ALL, c).mean / b.beauty(c).mean);
    let worst = worst.fold(0.0_f64, |w, d| if d.abs() > w.abs() { d } else { w });
    record(case, expectation, &format!("{:+.4} %", 100.0 * worst), &percent(relative));
    (0..3).for_each(|c| assert_same(case, a, b, ALL, c, relative));
}

/// The largest value of any pixel.
fn brightest(picture: &Picture) -> f64 {
    picture.pixel_values().into_iter().flatten().fold(0.0, f64::max)
}

/// Records and asserts that every pixel is exactly black.
#[track_caller]
fn black(case: &str, picture: &Picture) {
    let most = brightest(picture);
    record(case, "black", &format!("brightest pixel {most:e}"), "0");
    assert!(most == 0.0, "{case}: {most:e}");
}

/// Records that the render ended, and asserts that every value is finite and not negative (`render` has asserted
/// that no sample was rejected).
#[track_caller]
fn sound(case: &str, picture: &Picture) {
    let all = picture.pixel_values();
    let bad = all.iter().flatten().filter(|v| !v.is_finite() || **v < 0.0).count();
    record(case, "ends, finite, not negative", &format!("{bad} invalid values"), "0");
    assert_eq!(bad, 0, "{case}");
}
