//! Limiting cases of optics: matched indices, total reflection, grazing angles, no loss and no light.

use super::{METHODS, PATH, agree, black, record, same, sound};
use crate::support::{
    DOWN, Estimate, UP, area, box_camera, camera, diffuse, lamp, rectangle, render, scene, sphere, walls,
};

fn glass(eta: f64) -> String {
    format!(
        "<bsdf type='dielectric'><float name='int_ior' value='{eta:.9}'/><float name='ext_ior' value='1'/></bsdf>"
    )
}

const SKY: &str = "<emitter type='constant'><rgb name='radiance' value='1'/></emitter>";

/// Glass with the index of air is invisible: it neither reflects nor refracts. With the index off by 1e-6,
/// R = 2.5e-13, and rays are bent by 1e-6 except within 1e-3 of the radius from the rim.
#[test]
fn glass_with_the_index_of_air_is_invisible() {
    for (name, settings) in METHODS {
        let room = [box_camera(24), walls("0.7"), lamp(0.3, "15")].concat();
        let empty = render(&scene(&room), settings, 256);
        for eta in [1.0, 1.0 + 1e-6, 1.0 - 1e-6] {
            let filled = [&room, &*sphere("0,-0.3,0.2", 0.3, &glass(eta))].concat();
            let filled = render(&scene(&filled), settings, 256);
            // The ball turns direct light into caustics and its surface adds rounding, so the noise differs.
            agree(
                &format!("ball of eta 1{:+e}, {name}", eta - 1.0),
                "as without it",
                filled.beauty(1),
                empty.beauty(1),
                0.02,
            );
        }
    }
}

/// Light inside a glass cube is totally reflected; being lossless, the cube is invisible under a constant sky.
#[test]
fn total_reflection_loses_nothing() {
    let cube = |eta: f64| {
        format!(
            "{}{SKY}<shape type='cube'><transform name='to_world'><rotate x='1' y='1' angle='30'/></transform>{}</shape>",
            camera("0,0,5", "0,0,0", 40.0, 20),
            glass(eta)
        )
    };
    for (name, settings) in METHODS {
        let mut settings = settings.to_vec();
        settings.push(("max_depth", "-1"));
        // At √2 the critical angle is 45°: from there on light through one face of a cube cannot leave by the
        // next.
        for eta in [1.5, std::f64::consts::SQRT_2, 3.0] {
            let picture = render(&scene(&cube(eta)), &settings, 128);
            agree(
                &format!("cube of eta {eta:.4}, {name}"),
                "the sky's 1",
                picture.beauty(1),
                Estimate::exact(1.0),
                0.01,
            );
        }
    }
}

fn materials() -> Vec<(String, String)> {
    let rough = |kind: &str, alpha: f64, more: &str| {
        (
            format!("{kind} of alpha {alpha}"),
            format!("<bsdf type='{kind}'><float name='alpha' value='{alpha}'/>{more}</bsdf>"),
        )
    };
    let none = "<string name='material' value='none'/>";
    let mut all = vec![
        ("diffuse".to_owned(), diffuse("1")),
        (
            "plastic".to_owned(),
            "<bsdf type='plastic'><rgb name='diffuse_reflectance' value='1'/></bsdf>".to_owned(),
        ),
        ("glass".to_owned(), glass(1.5)),
    ];
    for alpha in [1e-4, 1e-3, 1e-2, 0.1, 0.5, 1.0] {
        all.push(rough("roughconductor", alpha, none));
        all.push(rough("roughdielectric", alpha, ""));
        all.push(rough("roughplastic", alpha, ""));
    }
    all
}

/// Under a sky of radiance 1 no surface shows more than 1 (within noise), at any roughness and for views up to
/// 89.999° from the normal.
#[test]
fn no_surface_is_brighter_than_its_sky() {
    let views = [
        ("ball", sphere("0,0,0", 1.0, "@"), camera("0,0,5", "0,0,0", 30.0, 12)),
        // From a height of 1.7e-5 at a distance of 1: 89.999° from the normal; the film shows 1e-6 around it.
        ("grazing", rectangle(2.0, UP, "@"), camera("0,1.7453e-5,1", "0,0,0", 1e-4, 4)),
    ];
    for (view, shape, camera) in &views {
        for (material, bsdf) in materials() {
            for (name, settings) in METHODS {
                let body = [camera.as_str(), SKY, &shape.replace('@', &bsdf)].concat();
                let picture = render(&scene(&body), settings, 64);
                let seen = picture.beauty(1);
                let case = format!("{view}, {material}, {name}");
                let bound = 1.0 + 4.5 * seen.sigma + 1e-4;
                record(&case, "at most the sky's 1", &format!("{:.4}", seen.mean), &format!("{bound:.4}"));
                assert!(seen.mean.is_finite() && seen.mean >= 0.0 && seen.mean <= bound, "{case}: {seen:?}");
            }
        }
    }
}

fn mirrors(reflectance: &str) -> String {
    format!(
        "{}<shape type='cube'><boolean name='flip_normals' value='true'/><bsdf type='conductor'>
         <string name='material' value='none'/><rgb name='specular_reflectance' value='{reflectance}'/></bsdf>
         {}</shape>",
        camera("0.1,0.2,0.3", "0,0,-1", 60.0, 12),
        area("1")
    )
}

/// Emitting mirror walls show 1/(1 − ρ). At reflectances 0.999 and 1 the variance of Russian roulette is
/// unbounded, so those renders only have to end.
#[test]
fn boxes_of_mirrors_end_and_conserve_energy() {
    for (name, settings) in METHODS {
        let mut settings = settings.to_vec();
        settings.push(("max_depth", "-1"));
        let picture = render(&scene(&mirrors("0.8")), &settings, 256);
        agree(
            &format!("box of mirrors of 0.8, {name}"),
            "1/(1 − ρ)",
            picture.beauty(1),
            Estimate::exact(5.0),
            0.02,
        );
        for reflectance in ["0.999", "1"] {
            let picture = render(&scene(&mirrors(reflectance)), &settings, 16);
            sound(&format!("box of mirrors of {reflectance}, {name}"), &picture);
        }
        let white =
            mirrors("1").replace("conductor", "diffuse").replace("specular_reflectance", "reflectance");
        let white = white.replace("<string name='material' value='none'/>", "");
        sound(&format!("furnace of albedo 1, {name}"), &render(&scene(&white), &settings, 4));
    }
}

/// Without roulette and with depth D the mirrors show 1 + ρ + … + ρ^(D−1) along every path. A factor that is wrong
/// by 1e-6 at each of 2000 bounces would show as 1e-3.
#[test]
fn mirrors_show_the_geometric_series() {
    for (name, settings) in METHODS {
        for (reflectance, depth) in [("0.999", 2000_u32), ("1", 200)] {
            let rho: f64 = reflectance.parse().expect("a number");
            let limit = depth.to_string();
            let settings = [settings, &[("max_depth", &*limit), ("rr_depth", "1000000")]].concat();
            let picture = render(&scene(&mirrors(reflectance)), &settings, 2);
            let truth = (0..depth).map(|k| rho.powi(k as i32)).sum();
            let case = format!("box of mirrors of {reflectance}, {depth} bounces, {name}");
            agree(&case, "Σ ρ^k", picture.beauty(1), Estimate::exact(truth), 1e-3);
        }
    }
}

/// Perfect mirrors of radiance 1 over 2000 bounces: every pixel is exactly 2000 unless a path leaves the box.
/// One or two in 3.3e7 bounces once did, where a hit in a corner was rounded to behind the wall.
#[test]
fn no_path_leaves_a_box_of_mirrors() {
    let settings = [PATH.1, &[("max_depth", "2000"), ("rr_depth", "1000000")]].concat();
    let picture = render(&scene(&mirrors("1")), &settings, 114);
    let lost = picture.pixel_values().into_iter().flatten().filter(|v| *v != 2000.0).count();
    record("box of mirrors, 3.3e7 bounces", "none leaves", &format!("{lost} wrong pixels"), "0");
    assert_eq!(lost, 0);
}

/// A diffuse ball and a lamp between mirrors: photons and camera paths meet after any number of bounces.
#[test]
fn light_between_mirrors_agrees() {
    let body = [
        camera("0.8,0.7,0.9", "0,-0.3,0", 60.0, 16),
        "<shape type='cube'><boolean name='flip_normals' value='true'/><bsdf type='conductor'>
         <string name='material' value='none'/><rgb name='specular_reflectance' value='0.5'/></bsdf></shape>"
            .to_owned(),
        sphere("0.3,0.5,0", 0.3, &area("10")),
        sphere("0,-0.4,0", 0.4, &diffuse("0.5")),
    ];
    let scene = scene(&body.concat());
    let path = render(&scene, PATH.1, 4096);
    let maps = render(&scene, &[("photons", "8000"), ("caustic_photons", "60000")], 256);
    agree(
        "diffuse ball and lamp between mirrors, photon map",
        "as path",
        maps.beauty(1),
        path.beauty(1),
        0.02,
    );
}

#[test]
fn black_surfaces_show_nothing_but_lamps() {
    let room = |reflectance: &str| {
        let wall = diffuse(reflectance);
        let view = camera("0,0,3", "0,-1,0", 30.0, 12);
        let floor = rectangle(1.0, &format!("{UP}<translate y='-1'/>"), &wall);
        let lamp = rectangle(0.3, &format!("{DOWN}<translate y='1'/>"), &area("10"));
        [view, floor, rectangle(1.0, "<translate z='-1'/>", &wall), lamp].concat()
    };
    for (name, settings) in METHODS {
        black(&format!("black walls, {name}"), &render(&scene(&room("0")), settings, 16));
        let settings = [settings, &[("max_depth", "1")]].concat();
        black(&format!("depth 1, {name}"), &render(&scene(&room("0.5")), &settings, 4));
    }
}

/// A camera inside glass sees the sky with radiance n²; one inside a closed opaque object sees black.
#[test]
fn cameras_may_be_inside_objects() {
    for (name, settings) in METHODS {
        let mut settings = settings.to_vec();
        settings.push(("max_depth", "-1"));
        let inside = |bsdf: &str| {
            [&camera("0.1,0,0", "0,0.2,-1", 60.0, 12), SKY, &*sphere("0,0,0", 1.0, bsdf)].concat()
        };
        let in_glass = render(&scene(&inside(&glass(1.5))), &settings, 64);
        let in_diffuse = render(&scene(&inside(&diffuse("0.5"))), &settings, 16);
        let by_path = render(&scene(&inside(&glass(1.5))), &[PATH.1, &[("max_depth", "-1")]].concat(), 64);
        sound(&format!("camera in glass, {name}"), &in_glass);
        // Every path leaves in the end, and radiance is n² times higher inside.
        let expected = Estimate::exact(1.5 * 1.5);
        agree(
            &format!("camera in glass, {name}"),
            "n² times the sky's 1",
            in_glass.beauty(1),
            expected,
            0.005,
        );
        same(&format!("camera in glass, {name}, against path"), "the same", &in_glass, &by_path, 0.01);
        black(&format!("camera in a closed opaque ball, {name}"), &in_diffuse);
    }
}
