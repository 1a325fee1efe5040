//! Photon maps at their limits.

use caustica::math::kernel::KernelKind;
use caustica::math::{Color, Vec3};
use caustica::photon::radius::shrinkage;
use caustica::photon::{Photon, PhotonMap, Query};
use caustica::render::Outcome;
use caustica::transport::{PathClass, Smallness};

use super::{agree, record};
use crate::support::{Estimate, Stage, UP, area, camera, diffuse, outcome, rectangle, scene, sphere};

fn photon(p: Vec3) -> Photon {
    Photon {
        p,
        flux: Color::ONE,
        wi: Vec3::Z,
        n: Vec3::Z,
        class: PathClass::Direct,
        depth: 1,
        smallness: Smallness::default(),
    }
}

fn found(map: &PhotonMap, p: Vec3, radius: f32) -> usize {
    let mut count = 0;
    map.within(&Query { p, n: Vec3::Z, radius, lift: 1e-6 }, &mut |_, _| count += 1);
    count
}

#[track_caller]
fn count(case: &str, measured: usize, expected: usize) {
    record(case, &format!("{expected} photons"), &measured.to_string(), "exact");
    assert_eq!(measured, expected, "{case}");
}

#[test]
fn lookups_are_right_at_the_limits() {
    // Photons on the corners of cells, in every one of which four or more meet.
    let grid: Vec<Photon> = (0..441)
        .map(|i| photon(Vec3::new((i % 21) as f32 - 10.0, (i / 21) as f32 - 10.0, 0.0) * 0.5))
        .collect();
    let map = PhotonMap::build(&grid, 0.5);
    // Closer than 0.6: the place itself and four at 0.5.
    count("photons on borders of cells", found(&map, Vec3::ZERO, 0.6), 5);
    for p in [Vec3::new(1e3, 0.0, 0.0), Vec3::new(-1e9, 1e9, 0.0), Vec3::new(f32::MAX, 0.0, 0.0)] {
        count(&format!("lookup outside of the map, at {:e}", p.x), found(&map, p, 0.6), 0);
    }
    count("lookup in an empty map", found(&PhotonMap::build(&[], 0.5), Vec3::ZERO, 1e9), 0);
    let one_place = PhotonMap::build(&vec![photon(Vec3::new(0.3, 0.3, 0.0)); 10_000], 1e-3);
    count("10 000 photons at one place", found(&one_place, Vec3::new(0.3, 0.3, 0.0), 1e-3), 10_000);
    // The spacing of f32 at 1000 is 6e-5; a radius of 1e-6 holds what is at the very place.
    let far =
        PhotonMap::build(&[photon(Vec3::new(1000.0, 0.0, 0.0)), photon(Vec3::new(1000.001, 0.0, 0.0))], 1e-6);
    count("radius below the spacing of f32", found(&far, Vec3::new(1000.0, 0.0, 0.0), 1e-6), 1);
    let mut nearest = Vec::new();
    let few = PhotonMap::build_for_nearest(&grid[..3], 50, 100.0);
    few.nearest(&Query { p: grid[0].p, n: Vec3::Z, radius: 100.0, lift: 1e-6 }, 50, &mut 0.0, &mut nearest);
    count("50 nearest of a map of 3", nearest.len(), 3);
}

/// Midpoint rule with 10⁵ cells; see the kernels' own test for its error.
#[test]
fn kernels_have_unit_mass_on_a_plane() {
    let n = 100_000;
    let off = |kernel: &KernelKind| {
        let ring = |i: i32| {
            let u = (f64::from(i) + 0.5) / f64::from(n);
            f64::from(kernel.weight((u * u) as f32)) * 2.0 * std::f64::consts::PI * u / f64::from(n)
        };
        ((0..n).map(ring).sum::<f64>() - 1.0).abs()
    };
    let worst = KernelKind::ALL.iter().map(off).fold(0.0, f64::max);
    record("mass of every kernel", "1", &format!("within {worst:.1e}"), "1e-6");
    assert!(worst < 1e-6);
}

fn run(scene: &Stage, changes: &[(&str, &str)], passes: u32) -> Outcome {
    outcome(scene, changes, passes, &mut |_| {})
}

/// The radius falls as its formula says and the mean stays where it is, after ten thousand passes too.
#[test]
fn ten_thousand_passes_do_not_drift() {
    let shell = format!("<boolean name='flip_normals' value='true'/>{}{}", diffuse("0.5"), area("1"));
    let body = format!("{}{}", camera("0,0,0", "0,0,1", 100.0, 4), sphere("0,0,0", 1.0, &shell));
    let scene = scene(&body);
    let changes = [("nee", "false"), ("photons", "400"), ("alpha", "0.7")];
    let outcome = run(&scene, &changes, 10_000);
    let s = &outcome.statistics;
    let expected = f64::from(s.first_radius) * shrinkage(9_999, 0.7).sqrt();
    let off = f64::from(s.last_radius) / expected - 1.0;
    record("radius of pass 10 000", "the product of its factors", &format!("{off:+.1e}"), "1e-5");
    assert!(off.abs() < 1e-5, "{} against {expected}", s.last_radius);
    let values: Vec<f64> = (0..16).map(|i| outcome.pixels.beauty(i, 10_000)[1]).collect();
    let mean = values.iter().sum::<f64>() / 16.0;
    let square = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 15.0;
    let estimate = Estimate { mean, sigma: (square / 16.0).sqrt() };
    agree("10 000 passes in a furnace", "1/(1 − ρ)", estimate, Estimate::exact(2.0), 0.01);
}

/// Light paths counted, photons stored, and the most bytes of memory that the program ever held, where every
/// path leaves the scene.
#[cfg(target_os = "linux")]
fn program(paths: &str) -> (u64, u64, u64) {
    let lamp = "<emitter type='spot'><float name='cutoff_angle' value='20'/>
        <transform name='to_world'><lookat origin='0,1,0' target='0,9,0' up='1,0,0'/></transform></emitter>";
    let body =
        [camera("0,3,0", "0,0,0", 30.0, 4), rectangle(1.0, UP, &diffuse("0.5")), lamp.to_owned()].concat();
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.xml"), format!("<scene version='3.0.0'>{body}</scene>"))
        .unwrap();
    let photons = format!("photons={paths}");
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_caustica"))
        .current_dir(&folder)
        .args(["render", "scene.xml", "-o", "out.exr", "-q", "--stats", "stats.json", "--threads", "2"])
        .args(["--integrator", "photonmap", "--passes", "1", "--set", &photons])
        .args(["--set", "nee=false", "--set", "radius=0.1"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = std::fs::read_to_string(folder.path().join("stats.json")).unwrap();
    let stats: serde_json::Value = serde_json::from_str(&text).unwrap();
    let number = |value: &serde_json::Value| value.as_u64().unwrap();
    let render = &stats["render"];
    (number(&render["light_paths"]), number(&render["photons_stored"]), number(&stats["peak_memory_bytes"]))
}

/// A hundred million paths that leave no photon: all are counted, and each 2048 of them, which are traced as one
/// piece, hold 120 bytes of results. A piece may grow to 200, and two runs differ by less than 2 MB otherwise;
/// a single byte a path would be 100 MB.
#[cfg(target_os = "linux")]
#[test]
fn a_hundred_million_light_paths_need_hardly_any_memory() {
    let (_, _, few) = program("100000");
    let (paths, photons, many) = program("100000000");
    let pieces = paths.div_ceil(2048);
    let more = many.saturating_sub(few);
    let measured = format!("{paths} paths, {photons} photons, {} bytes a piece", more / pieces);
    record("1e8 light paths", "all counted, below 200 bytes for 2048 misses", &measured, "2 MB");
    assert_eq!((paths, photons), (100_000_000, 0));
    assert!(more < pieces * 200 + (2 << 20), "{measured}");
    // What is measured is really the memory of the results.
    assert!(more > pieces * 64, "{measured}");
}

/// A lamp beyond f32 makes infinities: they are counted and the film is finite.
#[test]
fn what_is_not_finite_is_counted_and_kept_from_the_film() {
    let body = [
        camera("0,3,0", "0,0,0", 30.0, 8),
        rectangle(1.0, UP, &diffuse("0.5")),
        "<emitter type='point'><point name='position' value='0,1e-3,0'/><rgb name='intensity' value='3e38'/></emitter>"
            .to_owned(),
    ]
    .concat();
    for (name, settings) in super::METHODS {
        let outcome = run(&scene(&body), settings, 4);
        let finite = (0..64).all(|i| outcome.pixels.beauty(i, 4).iter().all(|v| v.is_finite()));
        let rejected = outcome.statistics.rejected;
        let causes: Vec<String> = rejected
            .causes()
            .iter()
            .filter(|(_, n)| *n > 0)
            .map(|(cause, n)| format!("{n} {cause}"))
            .collect();
        let measured = format!("{}; film finite: {finite}", causes.join(", "));
        record(&format!("light beyond f32, {name}"), "counted by cause, film finite", &measured, "—");
        // All of it is light that comes straight from the lamp.
        assert!(finite && rejected.direct.infinite > 0, "{name}: {measured}");
        assert_eq!(rejected.total(), rejected.direct.infinite, "{name}: {measured}");
    }
}

/// A first radius whose square f32 cannot hold, shrunk ten thousand times: it stays above its floor, and
/// what no disc can find is missing light, never a NaN.
#[test]
fn radii_stay_above_their_floor() {
    let lamp = "<emitter type='directional'><vector name='direction' value='0,-1,0'/>
        <rgb name='irradiance' value='1'/></emitter>";
    let body =
        [camera("0,3,0", "0,0,0", 30.0, 2), rectangle(1.0, UP, &diffuse("0.5")), lamp.to_owned()].concat();
    let changes = [("photons", "16"), ("nee", "false"), ("radius", "1e-30")];
    for lookup in ["radius", "nearest"] {
        let outcome = run(&scene(&body), &[&changes[..], &[("lookup", lookup)]].concat(), 10_000);
        let s = &outcome.statistics;
        let measured = format!("{:e}, {} rejected", s.last_radius, s.rejected.total());
        record(&format!("radius of 1e-30 after 10 000 passes, {lookup}"), "above 1e-18", &measured, "—");
        assert!(s.last_radius >= 1e-18 && s.rejected.total() == 0, "{measured}");
    }
}
