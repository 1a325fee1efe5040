//! Lamps that the camera sees smaller than a pixel in mirrors and through glass.

use caustica::film::Layer;

use crate::support::{
    Estimate, Picture, Stage, area, assert_agree, camera, diffuse, rectangle, render, scene, sphere,
};

const PHOTONS: [(&str, &str); 3] =
    [("camera_samples", "1"), ("caustic_photons", "2000"), ("photons", "2000")];

fn emission(picture: &Picture) -> Estimate {
    picture.estimate(&[Layer::Emission], 1)
}

/// The camera at z = 2 looks straight into a mirror at z = 0, and a square lamp at z = 1, itself out of sight, shines into
/// it too. `change` is made to the text of the scene.
fn mirror(half: f64, change: impl Fn(String) -> String) -> Stage {
    let lamp = format!("{}{}", area("10000"), diffuse("0"));
    let body = [
        camera("0,0,2", "0,0,0", 24.0, 32),
        rectangle(2.0, "", "<bsdf type='conductor'><string name='material' value='none'/></bsdf>"),
        rectangle(half, "<rotate y='1' angle='180'/><translate x='0.31' y='0.205' z='1'/>", &lamp),
    ];
    scene(&change(body.concat()))
}

/// What the picture's mean is: the lamp's image is 3 away, where the film is 6 tan 12° wide.
fn mirrored(half: f64) -> Estimate {
    let share = half / (3.0 * 12f64.to_radians().tan());
    Estimate::exact(10000.0 * share * share)
}

/// An image of 0.02 pixels has its exact light, whatever the filter, the estimator and hidden lamps. 1024 passes take
/// 32 extra samples each, of which one in 4.5 finds the lamp: 1.1 % at most, 4.5 of them are within the bound. (At one
/// place of the film, the weights of a Gaussian in all pixels add up to 1 within 2.8 % only.)
#[test]
fn a_small_lamp_in_a_mirror_has_its_light() {
    let half = 0.003;
    let filters = ["box", "gaussian", "mitchell"];
    for filter in filters {
        let stage = mirror(half, |text| text.replace("'box'", &format!("'{filter}'")));
        let seen = emission(&render(&stage, &PHOTONS, 1024));
        assert_agree(filter, seen, mirrored(half), 0.05);
    }
    let stage = mirror(half, |text| text);
    for (name, value) in [("indirect", "density"), ("indirect", "trace"), ("hide_emitters", "true")] {
        let seen = emission(&render(&stage, &[&PHOTONS[..], &[(name, value)]].concat(), 1024));
        assert_agree(&format!("{name}={value}"), seen, mirrored(half), 0.05);
    }
}

/// A crop shows the images of its own pixels: cut through the image, both halves add up to it.
#[test]
fn crops_divide_an_image_between_them() {
    let half = 0.003;
    let part = |x: u32| {
        let size = "<integer name='height' value='32'/>";
        let crop = format!(
            "{size}<integer name='crop_offset_x' value='{x}'/><integer name='crop_offset_y' value='0'/>
             <integer name='crop_width' value='16'/><integer name='crop_height' value='32'/>"
        );
        // The lamp is at the line between them.
        let stage = mirror(half, |text| text.replace(size, &crop).replace("x='0.31'", "x='0.0005'"));
        emission(&render(&stage, &PHOTONS, 1024))
    };
    let (left, right) = (part(0), part(16));
    let (mean, sigma) = ((left.mean + right.mean) / 2.0, left.sigma.hypot(right.sigma) / 2.0);
    assert!(left.mean > 0.0 && right.mean > 0.0, "{left:?} {right:?}");
    assert_agree("halves", Estimate { mean, sigma }, mirrored(half), 0.05);
}

/// Extra samples leave noise of the kind that a visible lamp has. Of the samples of the filter alone, 64 passes bring
/// 64 × 0.0006 hits, whose relative error is 500 %; 64 × 32 extra ones, one in 4.5 of them a hit, leave 4.2 %, and
/// twice that is allowed.
#[test]
fn small_images_are_no_fireflies() {
    let stage = mirror(0.0005, |text| text);
    let truth = mirrored(0.0005).mean;
    let seeds = 8;
    let square: f64 = (0..seeds)
        .map(|seed: i32| {
            let seed = seed.to_string();
            let seen = emission(&render(&stage, &[&PHOTONS[..], &[("seed", &seed)]].concat(), 64));
            (seen.mean / truth - 1.0).powi(2)
        })
        .sum();
    let error = (square / f64::from(seeds)).sqrt();
    println!("relative error {error:.4}");
    assert!(error < 0.09, "{error}");
}

/// A lamp behind a ball of glass is seen several times, straight and after reflections inside. Path tracing finds 0.1 %
/// or so of its paths there: 2 % of noise, as the bound allows for.
#[test]
fn lamps_in_glass_have_the_light_of_path_tracing() {
    let glass =
        "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>";
    let lamp = format!("{}{}", area("1000"), diffuse("0"));
    let stage = scene(
        &[
            camera("0,0.2,3", "0,0,0", 24.0, 32),
            sphere("0,0,0", 0.5, glass),
            sphere("0.6,0.7,-1.2", 0.02, &lamp),
            sphere("-0.3,0.9,1.5", 0.02, &lamp),
        ]
        .concat(),
    );
    let path = emission(&render(&stage, &[("integrator", "path")], 1 << 14));
    for indirect in ["density", "trace"] {
        let seen = emission(&render(&stage, &[&PHOTONS[..], &[("indirect", indirect)]].concat(), 1024));
        assert_agree(indirect, seen, path, 0.1);
    }
}

/// A lamp behind the camera is reflected by a ball of glass in front and, after up to three ways inside, from its back: 4 %
/// of its light and less, which a camera sample that chooses its way sees as rarely, but then in full. A quarter of a
/// sample that follows all ways leaves less than a quarter of the squared error, pixel by pixel, where no corner shows the lamp
/// and where one does; and the mean is that of path tracing.
#[test]
fn faint_reflections_in_glass_are_no_fireflies() {
    let glass =
        "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>";
    let lamp = sphere("1.5,2.2,4", 0.5, &format!("{}{}", area("30"), diffuse("0")));
    let stage = scene(&[camera("0,0.2,3", "0,0,0", 24.0, 48), sphere("0,0,0", 0.5, glass), lamp].concat());
    let pixels = |settings: &[(&str, &str)], passes: u32| {
        let picture = render(&stage, settings, passes);
        let of = |i| picture.pixels.layer(i, Layer::Emission, picture.passes)[1];
        (emission(&picture), (0..48 * 48).map(of).collect::<Vec<f64>>())
    };
    let (mean, truth) = pixels(&PHOTONS, 1 << 11);
    let (path, _) = pixels(&[("integrator", "path")], 1 << 12);
    assert_agree("mean", mean, path, 0.03);
    let floor = 0.01 * truth.iter().sum::<f64>() / truth.len() as f64;
    let error = |settings: &[(&str, &str)]| {
        let (_, found) = pixels(&[settings, &[("seed", "5")]].concat(), 16);
        found.iter().zip(&truth).map(|(a, b)| (a - b).powi(2) / (b * b + floor * floor)).sum::<f64>()
    };
    let (plain, weighed) = (error(&[("integrator", "path")]), error(&PHOTONS));
    println!("{plain:.3e} {weighed:.3e}");
    assert!(weighed < plain / 4.0, "{weighed} {plain}");
}

/// A square lamp that the camera, 2 away, sees directly.
fn seen_directly(half: f64, pixels: u32) -> Stage {
    let lamp = format!("{}{}", area("10000"), diffuse("0"));
    let turned = "<rotate z='1' angle='10'/><translate x='0.031' y='0.0205'/>";
    scene(&[camera("0,0,2", "0,0,0", 24.0, pixels), rectangle(half, turned, &lamp)].concat())
}

/// Root mean square of the relative error of all emission over eight seeds.
fn error_over_seeds(stage: &Stage, truth: f64, settings: &[(&str, &str)], passes: u32) -> f64 {
    let square = |seed: u32| {
        let seed = seed.to_string();
        let seen = emission(&render(stage, &[settings, &[("seed", &seed)]].concat(), passes));
        (seen.mean / truth - 1.0).powi(2)
    };
    ((0..8).map(square).sum::<f64>() / 8.0).sqrt()
}

/// As in a mirror: 64 passes bring 64 × 0.0014 hits, 64 × 32 extra samples are nearly all hits of a square that is at most
/// (1.2 · √2)² times as large as the lamp's image: 2.9 %, and three times that is allowed.
#[test]
fn a_small_lamp_seen_directly_is_no_firefly() {
    let half = 0.0005;
    let truth = 10000.0 * (half / (2.0 * 12f64.to_radians().tan())).powi(2);
    let error = error_over_seeds(&seen_directly(half, 32), truth, &PHOTONS, 64);
    assert!(error < 0.09, "{error}");
}

/// 36 pixels lie on the border of a lamp. They take 5 samples beside their own, which leaves √6 times less noise; 1.5 times
/// less is asked for.
#[test]
fn borders_of_lamps_take_more_samples() {
    let half = 0.06;
    let truth = 10000.0 * (half / (2.0 * 12f64.to_radians().tan())).powi(2);
    let stage = seen_directly(half, 64);
    let plain = error_over_seeds(&stage, truth, &[("integrator", "path")], 16);
    let error = error_over_seeds(&stage, truth, &PHOTONS, 16);
    println!("{error} {plain}");
    assert!(error < plain / 1.5, "{error} {plain}");
}
