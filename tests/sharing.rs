//! Camera samples that share the indirect light of diffuse surfaces: less noise, the same light, and sharp edges.

use caustica::film::Layer;

use crate::support::{Picture, Stage, assert_agree, box_camera, diffuse, lamp, render, scene, sphere, walls};

const SIDE: usize = 64;

/// A ball stands on the floor of a room, seen directly and in a mirror ball.
fn room() -> Stage {
    let balls = [
        sphere("0.4,-0.7,0.2", 0.3, &diffuse("0.2,0.5,0.7")),
        sphere("-0.45,-0.6,-0.2", 0.4, "<bsdf type='conductor'/>"),
    ];
    scene(&[box_camera(SIDE as u32), walls("0.7"), lamp(0.3, "8"), balls.concat()].concat())
}

fn indirect(picture: &Picture) -> Vec<f64> {
    (0..picture.pixels.len())
        .map(|i| picture.pixels.layer(i, Layer::Indirect, picture.passes).iter().sum::<f64>() / 3.0)
        .collect()
}

/// Mean squared difference, relative to the mean of the picture.
fn error(picture: &[f64], reference: &[f64]) -> f64 {
    let n = reference.len() as f64;
    let mean = reference.iter().sum::<f64>() / n;
    picture.iter().zip(reference).map(|(a, b)| ((a - b) / mean).powi(2)).sum::<f64>() / n
}

/// With one way to gather and few passes, most of the noise is that of the directions in which samples look. Without bias
/// sharing within three pixels (a disc of 28 places, the outer ones of less weight) would leave a tenth of it; the noise of
/// the map, and places that share with few others, leave more.
#[test]
fn sharing_takes_noise_away_and_no_light() {
    let stage = room();
    for indirect_by in ["gather", "trace"] {
        let render = |radius: &str, seed: &str, passes: u32| {
            let changes = [
                ("indirect", indirect_by),
                ("gather_radius", radius),
                ("gather_rays", "1"),
                ("camera_samples", "4"),
                ("photons", "20000"),
                ("caustic_photons", "4000"),
                ("seed", seed),
            ];
            render(&stage, &changes, passes)
        };
        let reference = render("0", "5", 512);
        let (own, shared) = (render("0", "1", 8), render("auto", "1", 8));
        let [own_error, shared_error] = [&own, &shared].map(|p| error(&indirect(p), &indirect(&reference)));
        println!("{indirect_by}: {own_error:.2e} alone, {shared_error:.2e} shared");
        assert!(shared_error < 0.5 * own_error, "{indirect_by}: {shared_error} of {own_error}");
        // After 64 passes noise is about 0.1 % of the mean; the bias of regression over three pixels in the corners of a
        // picture of 64 is a few tenths of a percent.
        let long = render("auto", "2", 64);
        for (layer, bound) in [(Layer::Indirect, 0.006), (Layer::Direct, 0.002), (Layer::Emission, 0.003)] {
            let name = format!("{indirect_by}, {layer:?}");
            let of = |picture: &Picture| picture.estimate(&[layer], 1);
            assert_agree(&name, of(&long), of(&reference), bound);
        }
    }
}

/// Where photons are seen directly, nothing is shared.
#[test]
fn density_estimation_shares_nothing() {
    let stage = room();
    let of = |radius: &str| {
        let changes = [("indirect", "density"), ("gather_radius", radius), ("photons", "4000")];
        render(&stage, &changes, 2).pixel_values()
    };
    assert!(of("0") == of("6"));
}
