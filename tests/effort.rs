//! Camera samples where the noise is: less of it from as many samples, the same light, and one picture however its passes
//! are divided.

use std::path::Path;

use caustica::film::Pixels;
use caustica::render::Budget;
use caustica::session::{Content, Merge, Session};

use crate::support::{
    ALL, Picture, assert_agree, box_camera, diffuse, lamp, part, rectangle, render, scene, sphere, walls,
};

const SIDE: u32 = 64;

/// Of the passes that take as many samples in every pixel: eight samples of four a pass.
const EVEN: u32 = 2;

/// A small ball of glass in a room: what is seen through it is far noisier than the walls.
fn room() -> Session {
    let ball = sphere("0.3,-0.6,0.2", 0.3, "<bsdf type='dielectric'/>");
    scene(&[box_camera(SIDE), walls("0.6"), lamp(0.2, "10"), ball].concat()).0
}

/// How light is found is said, so that the samples of pixels are all that is open.
fn with<'a>(changes: &[(&'a str, &'a str)]) -> Vec<(&'a str, &'a str)> {
    let said =
        [("indirect", "trace"), ("gather_radius", "0"), ("photons", "1000"), ("caustic_photons", "20000")];
    said.iter().chain(changes).copied().collect()
}

/// Mean squared error relative to what is seen.
fn error(picture: &Picture, reference: &Picture) -> f64 {
    let light = |picture: &Picture| -> Vec<f64> {
        picture.pixel_values().iter().map(|rgb| rgb.iter().sum::<f64>() / 3.0).collect()
    };
    let (light, truth) = (light(picture), light(reference));
    let n = truth.len() as f64;
    let dark = 0.1 * truth.iter().sum::<f64>() / n;
    light.iter().zip(truth).map(|(a, b)| (a - b).powi(2) / (b * b + dark * dark)).sum::<f64>() / n
}

fn mean_samples(pixels: &Pixels, passes: u32) -> f64 {
    let sum: u64 = (0..pixels.len()).map(|i| pixels.samples(i, passes, EVEN)).sum();
    sum as f64 / pixels.len() as f64
}

/// Against at least as many samples spread evenly, two seeds. A point lamp lights a wall, a hundredth of which has squares
/// smaller than a pixel: nothing else is noisy. Eight times the samples there, a tenth more in all, leave at most an eighth of
/// the variance; of the first two of 96 passes, whose eight samples count as much as those of others, about as much again is
/// left, because samples that are stratified over all passes err less than their number says.
#[test]
fn samples_go_where_the_noise_is() {
    let squares = "<bsdf type='diffuse'><texture name='reflectance' type='checkerboard'>\
         <rgb name='color0' value='0.05'/><rgb name='color1' value='0.8'/>\
         <transform name='to_uv'><scale x='7' y='5'/></transform></texture></bsdf>";
    let wall = rectangle(5.0, "<translate z='-1'/>", &diffuse("0.5"));
    let lamp = "<emitter type='point'><point name='position' x='0' y='0' z='2'/></emitter>";
    let patch = rectangle(0.15, "<translate x='0.4' y='0.3' z='-0.99'/>", squares);
    let stage = scene(&[box_camera(SIDE), wall, patch, lamp.to_owned()].concat());
    let depth = ("max_depth", "2");
    let reference = render(&stage, &[depth, ("camera_samples", "16"), ("seed", "9")], 256);
    let (mut evenly, mut by_noise) = (0.0, 0.0);
    for seed in ["1", "2"] {
        let passes = 96;
        let one = render(&stage, &[depth, ("seed", seed)], passes);
        let each = one.pixels.common.samples_a_pass;
        let taken = mean_samples(&one.pixels, passes);
        by_noise += error(&one, &reference);
        let as_many = (taken / f64::from(each)).ceil() as u32;
        let each = each.to_string();
        let other = render(&stage, &[depth, ("camera_samples", &each), ("seed", seed)], as_many);
        assert!(other.pixels.counts().each.is_empty());
        evenly += error(&other, &reference);
        println!("{taken:.1} samples a pixel; {by_noise:.3e} by noise, {evenly:.3e} evenly");
    }
    assert!(by_noise < 0.3 * evenly, "{by_noise} of {evenly}");
}

/// Light whose square leaves the range of single precision tells no noise, and takes no pixel's samples away.
#[test]
fn light_may_be_as_bright_as_it_likes() {
    let stage = scene(&[box_camera(16), walls("0.6"), lamp(0.2, "1e25")].concat());
    for integrator in ["gather", "density"] {
        let picture = render(&stage, &[("indirect", integrator)], 12);
        let counts = &picture.pixels.counts().each;
        assert!(!counts.is_empty() && counts.iter().all(|count| *count > 0), "{counts:?}");
        assert!(picture.pixel_values().iter().flatten().all(|value| value.is_finite() && *value > 0.0));
    }
}

/// What the first passes found decides how many samples follow, and must not decide what they are worth: a pixel whose first
/// samples were dark takes few others. Were all samples of a pixel counted alike, the picture would be too dark. 48 renders
/// of 6 passes are as much light as one of 288.
#[test]
fn the_light_stays_the_same() {
    let stage = crate::support::Stage(room());
    let n = 48;
    let channel = |picture: &Picture| picture.estimate(ALL, 1).mean;
    let means: Vec<f64> =
        (0..n).map(|seed: u32| channel(&render(&stage, &with(&[("seed", &seed.to_string())]), 6))).collect();
    let even = render(&stage, &with(&[("camera_samples", "4"), ("seed", "77")]), 512);
    assert_agree("mean", crate::support::estimate(&means), even.estimate(ALL, 1), 0.004);
}

/// Parts find out themselves what the first passes say, those that begin between them as well. So do resumed ones, before
/// and after it is known. Each has the samples of every pixel, which `samples` shows.
#[test]
fn parts_take_the_samples_of_the_whole() {
    let settings: Vec<(String, String)> =
        with(&[]).iter().map(|(n, v)| ((*n).to_owned(), (*v).to_owned())).collect();
    let session = room().with(&settings, None).expect("settings");
    let passes = 9;
    let outcome = session.render(Budget::passes(passes), &mut |_| {});
    let whole = session.picture(&outcome);
    let everything = 0..(SIDE * SIDE) as usize;
    let samples = whole.channels(Content::Samples, everything.clone());
    let expected: Vec<f32> =
        outcome.pixels.counts().each.iter().map(|count| (8 + 7 * u32::from(*count)) as f32).collect();
    assert_eq!(samples, expected);
    for parts in
        [vec![(0..1, 0), (1..9, 3)], vec![(0..9, 1)], vec![(0..4, 3), (4..9, 1)], vec![(3..9, 0), (0..3, 0)]]
    {
        let mut merge = Merge::new();
        for (range, stopped) in &parts {
            merge.add(Path::new("part"), &part(&session, range.clone(), *stopped)).expect("a part");
        }
        let merged = merge.finish(None, false).expect("all passes");
        let picture = merged.picture();
        assert_eq!(picture.channels(Content::Samples, everything.clone()), samples, "{parts:?}");
        let same = picture.rgb().zip(whole.rgb()).all(|(a, b)| a == b);
        assert!(same, "{parts:?}");
    }
}
