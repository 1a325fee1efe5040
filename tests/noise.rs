//! The printed standard error equals the scatter of pictures over seeds.

use crate::support::{UP, area, box_camera, camera, diffuse, lamp, rectangle, render, scene, sphere, walls};

const SEEDS: usize = 16;

/// Root mean square over the picture of the standard deviation of a pixel's luminance over seeds, relative
/// to the mean; and the root mean square of the errors that the renders print.
fn measured(body: &str, integrator: &str, passes: u32) -> (f64, f64) {
    let scene = scene(body);
    let mut printed = 0.0;
    let pictures: Vec<Vec<f64>> = (0..SEEDS)
        .map(|seed| {
            let seed = seed.to_string();
            let picture = render(&scene, &[("integrator", integrator), ("seed", &seed)], passes);
            printed += picture.pixels.relative_error(passes).powi(2);
            let luminance = |[r, g, b]: [f64; 3]| 0.212671 * r + 0.715160 * g + 0.072169 * b;
            picture.pixel_values().into_iter().map(luminance).collect()
        })
        .collect();
    let count = SEEDS as f64;
    let (mut variance, mut mean) = (0.0, 0.0);
    for pixel in 0..pictures[0].len() {
        let values = || pictures.iter().map(|p| p[pixel]);
        let centre = values().sum::<f64>() / count;
        variance += values().map(|v| (v - centre).powi(2)).sum::<f64>() / (count - 1.0);
        mean += centre;
    }
    let pixels = pictures[0].len() as f64;
    ((variance / pixels).sqrt() / (mean / pixels), (printed / count).sqrt())
}

/// Within 30 %. The scatter itself is known to 1/√(2·15·pixels): below 1 % where all pixels contribute
/// to it, a few percent where a lamp's edge makes up most of it. The estimate assumes that V(n) follows one power
/// law over three doublings; measured: 0.85 to 1.00.
#[test]
fn the_printed_standard_error_is_the_scatter_over_seeds() {
    let glass =
        "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>";
    let diffuse_box = [box_camera(24), walls("0.6"), lamp(0.4, "3")].concat();
    let glass_box = [box_camera(24), walls("0.6"), lamp(0.4, "3"), sphere("0,-0.4,0", 0.5, glass)].concat();
    let open = [
        camera("0,2,5", "0,0,0", 40.0, 24),
        rectangle(3.0, UP, &diffuse("0.5")),
        sphere("0,1,0", 0.6, &diffuse("0.3")),
        sphere("1.5,2,1", 0.2, &area("20")),
        "<emitter type='constant'><rgb name='radiance' value='0.3'/></emitter>".to_owned(),
    ]
    .concat();
    for (name, body) in [("diffuse", diffuse_box), ("glass", glass_box), ("open", open)] {
        for integrator in ["path", "photonmap"] {
            for passes in [32, 100] {
                let (true_error, printed) = measured(&body, integrator, passes);
                let ratio = printed / true_error;
                println!(
                    "{name}, {integrator}, {passes} passes: {true_error:.5}, printed {ratio:.3} times that"
                );
                assert!((0.7..=1.3).contains(&ratio), "{name}, {integrator}, {passes}: {ratio}");
            }
        }
    }
}
