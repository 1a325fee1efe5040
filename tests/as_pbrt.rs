//! What pbrt-v4 makes of its parameters where another reading is at hand; measured on pbrt itself.

use crate::support::{Picture, pbrt_scene, pbrt_scene_seen, render};

/// A wall that fills the view, in a sky of radiance 1: its mean is the mean reflectance.
fn wall(texture: &str, files: Vec<(&str, Vec<u8>)>) -> f64 {
    let world = format!(
        "LightSource \"infinite\" \"rgb L\" [1 1 1]\n{texture}\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\n
         Shape \"bilinearmesh\" \"point3 P\" [-40 -40 0  40 -40 0  -40 40 0  40 40 0]"
    );
    seen(&world, files, &[("max_depth", "2")]).beauty(1).mean
}

fn seen(world: &str, files: Vec<(&str, Vec<u8>)>, settings: &[(&str, &str)]) -> Picture {
    let mut scene = pbrt_scene(world, files);
    scene.0.view.film = caustica::film::FilmSize::full(24, 16);
    render(&scene, &[settings, &[("integrator", "path")]].concat(), 64)
}

/// The wall receives the same light everywhere, so that its picture has the noise of the texture's edges only, which lie
/// between columns of pixels.
#[test]
fn reflectance_is_clamped() {
    let thrice = "Texture \"t\" \"spectrum\" \"scale\" \"rgb tex\" [0.5 0.5 0.5] \"float scale\" 3";
    let mean = wall(thrice, vec![]);
    assert!((mean - 1.0).abs() < 0.01, "{mean}");
    // Pictures, of numbers above 1 and scaled.
    let pfm = |value: f32| [b"PF\n1 1\n-1.0\n".to_vec(), value.to_le_bytes().repeat(3)].concat();
    for (value, scale) in [(3.0, 1.0), (0.5, 3.0)] {
        let picture = format!(
            "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"t.pfm\" \"float scale\" {scale}"
        );
        let mean = wall(&picture, vec![("t.pfm", pfm(value))]);
        assert!((mean - 1.0).abs() < 0.01, "{value} {scale}: {mean}");
    }
    // From far below 0 on the left to far above 1 on the right.
    let ramp = "Texture \"t\" \"spectrum\" \"bilerp\" \"string mapping\" \"planar\" \"vector3 v1\" [1000 0 0]
        \"rgb v00\" [0 0 0] \"rgb v01\" [0 0 0] \"rgb v10\" [1 1 1] \"rgb v11\" [1 1 1]";
    let mean = wall(ramp, vec![]);
    assert!((mean - 0.5).abs() < 0.01, "{mean}");
}

/// Dots cover 0.155 of the plane, of the 1000 cells seen a few percent more or less.
#[test]
fn dots_are_outside_of_dots() {
    let dots =
        "Texture \"t\" \"spectrum\" \"dots\" \"rgb inside\" [0.9 0.9 0.9] \"rgb outside\" [0.1 0.1 0.1]
        \"float uscale\" 240 \"float vscale\" 240";
    let expected = 0.155 * 0.1 + 0.845 * 0.9;
    let mean = wall(dots, vec![]);
    assert!((mean - expected).abs() < 0.8 * 0.05, "{mean} {expected}");
}

/// Each of the two triangles is a lamp of the power that is asked for, times the luminance of the colour: the radiance is
/// the colour, where the power is π times the area of one of them.
#[test]
fn power_of_area_lights_is_that_of_each_triangle() {
    let power = std::f64::consts::PI * 3200.0;
    let world = format!(
        "AreaLightSource \"diffuse\" \"rgb L\" [2 1 0.5] \"float power\" {power}
         Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [-40 -40 0 40 -40 0 40 40 0 -40 40 0]"
    );
    let picture = seen(&world, vec![], &[("max_depth", "1")]);
    for (c, expected) in [2.0, 1.0, 0.5].into_iter().enumerate() {
        let mean = picture.beauty(c).mean;
        assert!((mean / expected - 1.0).abs() < 1e-3, "channel {c}: {mean}");
    }
}

/// The highlight of a smooth metal below a rough coat is as wide as the coat makes it, and so nearly all of the light of a
/// small lamp comes back from a ball. pbrt's walk gives a mean of 0.00672; the closed form of `coats` is 40 % brighter there.
#[test]
fn a_rough_coat_spreads_what_a_smooth_metal_reflects() {
    let world = "LightSource \"point\" \"rgb I\" [100 100 100] \"point3 from\" [0 6 6]
        Material \"coatedconductor\" \"float interface.roughness\" 0.3 \"rgb reflectance\" [0.9 0.9 0.9]
        Shape \"sphere\" \"float radius\" 3";
    let mean = seen(world, vec![], &[("max_depth", "2")]).beauty(1).mean / 0.00672;
    assert!((0.9..1.5).contains(&mean), "{mean}");
}

/// Patterns in space lie where their own transform puts them, wherever the camera stands: moved with it, all of the scene
/// is the same picture, and a camera that moves alone sees another part. Rounding moves edges by far less than a pixel.
#[test]
fn patterns_in_space_stay_where_they_are() {
    let patterns = [
        "\"fbm\"",
        "\"checkerboard\" \"integer dimension\" 3 \"float tex1\" 0 \"float tex2\" 1",
        "\"checkerboard\" \"string mapping\" \"planar\" \"float tex1\" 0 \"float tex2\" 1",
    ];
    for pattern in patterns {
        let picture = |eye: [f64; 2], moved: [f64; 2]| {
            let [x, y] = eye;
            let view = format!(
                "LookAt {x} {y} 13 {x} {y} 0 0 1 0
                 Camera \"orthographic\" \"float screenwindow\" [-3 3 -3 3]
                 Film \"rgb\" \"integer xresolution\" 32 \"integer yresolution\" 32"
            );
            let world = format!(
                "LightSource \"infinite\" \"rgb L\" [1 1 1]
                 Translate {} {} 0
                 Texture \"b\" \"float\" {pattern}
                 Texture \"s\" \"spectrum\" \"mix\" \"texture amount\" \"b\" \"rgb tex1\" [0 0 0] \"rgb tex2\" [1 1 1]
                 Material \"diffuse\" \"texture reflectance\" \"s\"
                 Shape \"bilinearmesh\" \"point3 P\" [-90 -90 0.3 90 -90 0.3 -90 90 0.3 90 90 0.3]",
                moved[0], moved[1]
            );
            let stage = pbrt_scene_seen(&view, &world, Vec::new());
            render(&stage, &[("integrator", "path")], 16).pixel_values()
        };
        let off = |a: &[[f64; 3]], b: &[[f64; 3]]| {
            a.iter().zip(b).map(|(a, b)| (a[1] - b[1]).abs()).sum::<f64>() / a.len() as f64
        };
        let still = picture([0.0; 2], [0.0; 2]);
        let together = off(&picture([-3.3, 1.7], [-3.3, 1.7]), &still);
        let alone = off(&picture([-3.3, 1.7], [0.0; 2]), &still);
        println!("{pattern}: together {together:.5}, alone {alone:.5}");
        assert!(together < 0.002 && alone > 0.05, "{pattern}: {together} {alone}");
    }
}
