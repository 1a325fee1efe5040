//! FLIP against the public evaluator: `flip_fixture.txt` was printed by `flip_fixture.py` with
//! flip-evaluator 1.7 from PyPI, on pictures that the same formulas make here.

use caustica_tools::flip::{self, DEFAULT_PPD, Exposures, FlipMap, FlipStats, Tonemapper};
use caustica_tools::pixels::Pixels;

const MEAN_TOLERANCE: f64 = 1e-4;
const PIXEL_TOLERANCE: f64 = 1e-3;

/// 16 bits from position, channel and seed.
fn mix(x: i64, y: i64, c: i64, seed: i64) -> i64 {
    let mask = 0xFFFF_FFFF;
    let mut h = ((x * 73_856_093) ^ (y * 19_349_663) ^ (c * 83_492_791) ^ (seed * 2_654_435_761)) & mask;
    h = ((h ^ (h >> 16)) * 0x7FEB_352D) & mask;
    h = ((h ^ (h >> 15)).wrapping_mul(0x846C_A68B)) & mask;
    (h ^ (h >> 16)) >> 16
}

/// Value of a picture at (x, y, channel); k = 0 is the reference, 1 the image.
type Formula = fn(i64, i64, i64, i64) -> f64;

fn noise(x: i64, y: i64, c: i64, k: i64) -> f64 {
    (64 * (x + 2 * y + 5 * c) + k * (mix(x, y, c, 1) >> 3)) as f64 / 16384.0
}

fn checker(x: i64, y: i64, c: i64, k: i64) -> f64 {
    if ((x + k) / 6 + y / 6) % 2 == 0 { 0.75 } else { 0.125 * (c + 1) as f64 }
}

fn patches(x: i64, y: i64, c: i64, k: i64) -> f64 {
    let patch = (x / 8 + 3 * (y / 8) + k) % 7 + 1;
    ((patch >> c) & 1) as f64
}

fn fireflies(x: i64, y: i64, _: i64, k: i64) -> f64 {
    if k == 1 && mix(x, y, 0, 2) < 655 { 1.0 } else { 0.03125 + x as f64 / 1024.0 }
}

fn texture(x: i64, y: i64, c: i64, k: i64) -> f64 {
    ((mix(x / 2, y / 2, c, 3) >> 8) / 2 + 64 * k * (x + y) / 80) as f64 / 256.0
}

fn tiny(x: i64, y: i64, c: i64, k: i64) -> f64 {
    (1 + x + y * c + k) as f64 / 16.0
}

fn caustic(x: i64, y: i64, c: i64, k: i64) -> f64 {
    let d = (x - 24).pow(2) + (y - 18).pow(2);
    let stops = (10 - d / 24).max(0) - 4;
    f64::exp2(stops as f64) * (256 + k * (mix(x, y, c, 4) >> 9)) as f64 / 512.0
}

fn lamp(x: i64, y: i64, c: i64, k: i64) -> f64 {
    let inside = (20..26).contains(&x) && (12..20).contains(&y);
    if inside { (900 - 16 * k * (x - 20) + 8 * c) as f64 } else { 0.0 }
}

fn night(x: i64, y: i64, c: i64, k: i64) -> f64 {
    let scale = if x < 30 { 1.0 } else { 1.0 / 32.0 };
    (mix(x, y, c, 5 + k) >> 4) as f64 / 65536.0 * scale
}

fn ranges(x: i64, y: i64, c: i64, k: i64) -> f64 {
    let v = 1.0 + (mix(x, y, c, 6 + k) >> 11) as f64 / 128.0;
    f64::exp2((x / 8 - 3) as f64) * v * (1.0 + c as f64 / 4.0)
}

fn picture(formula: Formula, (w, h): (usize, usize), k: i64) -> Pixels {
    Pixels::from_fn(w, h, |x, y| [0, 1, 2].map(|c| formula(x as i64, y as i64, c, k) as f32))
}

struct Expected {
    mean: f64,
    exposures: Vec<f64>,
    samples: Vec<f64>,
}

fn expected(name: &str) -> Expected {
    let line = include_str!("flip_fixture.txt")
        .lines()
        .find(|l| l.split(" | ").next() == Some(name))
        .expect("a line per pair");
    let numbers = |s: &str| s.split(' ').filter_map(|v| v.parse().ok()).collect::<Vec<f64>>();
    let parts: Vec<&str> = line.split(" | ").collect();
    Expected { mean: numbers(parts[1])[0], exposures: numbers(parts[2]), samples: numbers(parts[3]) }
}

#[track_caller]
fn check_map(name: &str, map: &FlipMap, expected: &Expected) {
    let mean = FlipStats::of(map).mean - expected.mean;
    let values = map.values.iter().step_by(7);
    assert_eq!(values.len(), expected.samples.len());
    let pixel = values.zip(&expected.samples).map(|(a, b)| (f64::from(*a) - b).abs()).fold(0.0, f64::max);
    eprintln!("{name}: mean {:.5}, off by {mean:+.1e} in the mean, {pixel:.1e} in a pixel", expected.mean);
    assert!(mean.abs() <= MEAN_TOLERANCE, "{name}: mean off by {mean}");
    assert!(pixel <= PIXEL_TOLERANCE, "{name}: a pixel off by {pixel}");
}

#[test]
fn ldr_agrees_with_the_evaluator() {
    let pairs: [(&str, Formula, (usize, usize), f64); 6] = [
        ("noise", noise, (61, 47), DEFAULT_PPD),
        ("checker", checker, (64, 48), DEFAULT_PPD),
        ("patches", patches, (56, 40), DEFAULT_PPD),
        ("fireflies", fireflies, (64, 48), DEFAULT_PPD),
        ("texture", texture, (80, 33), 30.0),
        ("tiny", tiny, (5, 3), DEFAULT_PPD),
    ];
    for (name, formula, size, ppd) in pairs {
        let map = flip::ldr(&picture(formula, size, 1), &picture(formula, size, 0), ppd);
        check_map(name, &map, &expected(name));
    }
}

#[test]
fn hdr_agrees_with_the_evaluator() {
    let pairs: [(&str, Formula, (usize, usize), Tonemapper); 6] = [
        ("caustic", caustic, (48, 40), Tonemapper::Aces),
        ("lamp", lamp, (45, 31), Tonemapper::Aces),
        ("night", night, (50, 40), Tonemapper::Aces),
        ("ranges", ranges, (64, 24), Tonemapper::Aces),
        ("ranges-hable", ranges, (64, 24), Tonemapper::Hable),
        ("ranges-reinhard", ranges, (64, 24), Tonemapper::Reinhard),
    ];
    for (name, formula, size, tonemapper) in pairs {
        let (image, reference) = (picture(formula, size, 1), picture(formula, size, 0));
        let exposures = Exposures::automatic(&reference, tonemapper);
        let expected = expected(name);
        assert!((exposures.start - expected.exposures[0]).abs() < 1e-4, "{name}: {exposures:?}");
        assert!((exposures.stop - expected.exposures[1]).abs() < 1e-4, "{name}: {exposures:?}");
        assert_eq!(exposures.count as f64, expected.exposures[2], "{name}");
        let hdr = flip::hdr(&image, &reference, DEFAULT_PPD, exposures, tonemapper);
        check_map(name, &hdr.map, &expected);
    }
}

#[test]
fn equal_images_and_extremes() {
    let p = picture(ranges, (70, 20), 0);
    assert!(flip::ldr(&p, &p, DEFAULT_PPD).values.iter().all(|v| *v == 0.0));
    let flat = |v: [f32; 3]| Pixels::from_fn(40, 40, |_, _| v);
    let worst = flip::ldr(&flat([0.0, 1.0, 0.0]), &flat([0.0, 0.0, 1.0]), DEFAULT_PPD);
    assert!(worst.values.iter().all(|v| (v - 1.0).abs() < 1e-4));
    // Values beyond the display look alike.
    assert!(flip::ldr(&flat([2.0; 3]), &flat([9.0; 3]), DEFAULT_PPD).values.iter().all(|v| *v == 0.0));
}

#[test]
fn tiles_leave_no_seams() {
    // Wider and taller than a tile and a band: the left part must equal a picture cut there, except
    // where the cut is within reach of the filters.
    let wide = |k| picture(noise, (420, 130), k);
    let cut = |k| picture(noise, (260, 130), k);
    let (a, b) = (flip::ldr(&wide(1), &wide(0), DEFAULT_PPD), flip::ldr(&cut(1), &cut(0), DEFAULT_PPD));
    for y in 0..130 {
        for x in 0..260 - 10 {
            assert_eq!(a.values[y * 420 + x], b.values[y * 260 + x], "{x} {y}");
        }
    }
}
