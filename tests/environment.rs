//! Environment maps.

use std::f64::consts::PI;

use caustica::math::{Color, Vec3};

use crate::support::{
    ALL, Estimate, Stage, UP, assert_agree, camera, diffuse, pbrt_scene_seen, picture, rectangle, render,
    room_with_window, scene_with_bytes, sphere,
};

fn lit(picture: Vec<u8>, turn: &str, body: &str) -> Stage {
    let light = format!(
        "<emitter type='envmap'><string name='filename' value='sky.pfm'/>
         <transform name='to_world'>{turn}</transform></emitter>"
    );
    scene_with_bytes(&format!("{body}{light}"), vec![("sky.pfm", picture)])
}

/// A dim sky with a small sun, sixty degrees above the horizon.
fn sky() -> Vec<u8> {
    picture(
        24,
        |x, y| match (x, y) {
            (5, 2) => [60.0, 50.0, 30.0],
            (_, 0..=6) => [0.2, 0.3, 0.6],
            _ => [0.1, 0.08, 0.05],
        },
        12,
    )
}

/// The camera sees only the sky: +Z is the middle of the picture, and `to_world` rotates it.
#[test]
fn the_background_is_the_picture() {
    let columns = || picture(8, |x, _| [x as f32; 3], 5);
    // Four columns either side of the middle of a wide view along ±z: the middle lies between 3 and 4.
    for (turn, target, expected) in [
        ("", "0,0,1", 3.5),
        ("<rotate y='1' angle='90'/>", "1,0,0", 3.5),
        ("", "1,0,0", 1.5),
        ("", "-1,0,0", 5.5),
    ] {
        let scene = lit(columns(), turn, &camera("0,0,0", target, 0.5, 1));
        // A quarter of a degree either way is 6e-3 of a column.
        let seen = render(&scene, &[("integrator", "path")], 16).beauty(0);
        assert_agree(&format!("{turn} {target}"), seen, Estimate::exact(expected), 0.005);
    }
}

/// A diffuse plane under a sky of radiance 1 + y reflects ρ∫(1 + cosθ)cosθ dω/π = ρ(1 + 2/3). The
/// picture is interpolated linearly in v, so its 65 rows represent the cosine to within (π/64)²/8 = 3e-4.
#[test]
fn irradiance_of_a_gradient_is_exact() {
    let gradient = picture(4, |_, y| [1.0 + (PI * y as f64 / 64.0).cos() as f32; 3], 65);
    let floor = rectangle(50.0, UP, &diffuse("0.5"));
    let scene = lit(gradient, "", &format!("{}{floor}", camera("0,10,0.0001", "0,0,0", 0.011, 1)));
    let expected = Estimate::exact(0.5 * (1.0 + 2.0 / 3.0));
    for (integrator, passes) in [("path", 4096), ("photonmap", 4096)] {
        let got = render(&scene, &[("integrator", integrator), ("max_depth", "2")], passes);
        assert_agree(integrator, got.beauty(0), expected, 0.004);
    }
}

/// Environment lights add up (pbrt allows several): under two constant ones and a map of 1, a diffuse plane has
/// the radiance ρ(0.3 + 0.2 + 1).
#[test]
fn several_environments_add_up() {
    let picture = picture(8, |_, _| [1.0; 3], 8);
    let view = "LookAt 0 0 9 0 0 0 0 1 0\nCamera \"perspective\" \"float fov\" 1\n\
        Film \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1";
    let world = "LightSource \"infinite\" \"rgb L\" [0.3 0.3 0.3]\n\
        LightSource \"infinite\" \"rgb L\" [0.2 0.2 0.2]\n\
        LightSource \"infinite\" \"string filename\" \"sky.pfm\"\n";
    let plane = "Material \"diffuse\" \"rgb reflectance\" [0.5 0.5 0.5]\nShape \"disk\" \"float radius\" 2";
    for (what, shape, expected) in [("the sky itself", "", 1.5), ("a plane below", plane, 0.5 * 1.5)] {
        let scene = pbrt_scene_seen(view, &format!("{world}{shape}"), vec![("sky.pfm", picture.clone())]);
        let rgb = scene.background(Vec3::ZERO, Vec3::Z).map(|(light, _)| light).sum::<Color>();
        assert!((rgb - Color::splat(1.5)).abs().max_element() < 1e-5, "{rgb}");
        for integrator in ["path", "photonmap"] {
            let got = render(&scene, &[("integrator", integrator)], 1024).beauty(1);
            // Light and direction are sampled; the noise of 1024 samples is measured, and below 1 %.
            assert_agree(&format!("{what}, {integrator}"), got, Estimate::exact(expected), 0.01);
        }
    }
}

/// Sunlight between a sphere and a floor by photons, with and without next event estimation, against path
/// tracing. Discs of the density estimate overlap the edge of the contact shadow; as the picture is far larger
/// than the discs, that biases its mean by a fraction of a percent.
#[test]
fn photons_and_paths_agree() {
    let floor = rectangle(3.0, UP, &diffuse("0.6,0.5,0.4"));
    let ball = sphere("0,1,0", 1.0, &diffuse("0.3,0.6,0.7"));
    let view = camera("0,4,7", "0,0.5,0", 35.0, 24);
    let scene = lit(sky(), "<rotate y='1' angle='30'/>", &format!("{view}{floor}{ball}"));
    let path = render(&scene, &[("integrator", "path"), ("max_depth", "5")], 256);
    for nee in ["true", "false"] {
        let settings = [("max_depth", "5"), ("nee", nee), ("photons", "40000"), ("radius", "0.06")];
        let mapped = render(&scene, &settings, 128);
        for c in 0..3 {
            let what = format!("nee {nee}, channel {c}");
            assert_agree(&what, mapped.estimate(ALL, c), path.estimate(ALL, c), 0.012);
        }
    }
}

/// A room that sun and sky light through a window of a tenth of its ceiling, where photons are aimed.
#[test]
fn photons_and_paths_agree_below_a_window() {
    let room = room_with_window(0.3, "0.6,0.5,0.4");
    let light = "<emitter type='sunsky'><vector name='sun_direction' value='-0.3,0.2,1'/>
        <float name='sun_aperture' value='3'/></emitter>";
    let view = camera("0,-0.9,0.3", "0,1,-0.6", 70.0, 24);
    let scene = scene_with_bytes(&format!("{view}{room}{light}"), vec![]);
    let path = render(&scene, &[("integrator", "path"), ("max_depth", "5")], 2048);
    for nee in ["true", "false"] {
        let settings = [("max_depth", "5"), ("nee", nee), ("photons", "40000"), ("radius", "0.04")];
        let mapped = render(&scene, &settings, 768);
        for c in 0..3 {
            let what = format!("nee {nee}, channel {c}");
            assert_agree(&what, mapped.estimate(ALL, c), path.estimate(ALL, c), 0.015);
        }
    }
}
