//! Settings that change the noise, but not the mean.

use caustica::film::Layer;

use crate::support::{ALL, Stage, assert_agree, assert_same, box_camera, lamp, render, scene, sphere, walls};

/// A box with spheres like those of `scenes/cornell-owner.xml`: plastic kd 0.7 ks 0.2 and glass ks 0.1 kt 0.8.
fn owners_box() -> Stage {
    let plastic = "<bsdf type='plastic'><rgb name='diffuse_reflectance' value='0.7'/><rgb name='specular_reflectance' value='0.2'/></bsdf>";
    let glass = "<bsdf type='dielectric'><rgb name='specular_reflectance' value='0.1'/><rgb name='specular_transmittance' value='0.8'/></bsdf>";
    scene(
        &[
            box_camera(24),
            walls("0.6"),
            lamp(0.5, "4"),
            sphere("-0.45,-0.5,-0.2", 0.45, plastic),
            sphere("0.45,-0.5,0.2", 0.45, glass),
        ]
        .concat(),
    )
}

/// All three policies draw the same events, so their expectations are equal. With the same photons only the camera
/// paths differ, and 0.5 % is at least 4.5 sigma of both renders (asserted).
#[test]
fn roulette_policies_have_the_same_mean() {
    let scene = owners_box();
    let with = |policy: &str| {
        render(&scene, &[("roulette", policy), ("photons", "8000"), ("caustic_photons", "8000")], 256)
    };
    let renormalise = with("renormalise");
    for policy in ["absorb", "retry"] {
        let other = with(policy);
        for channel in 0..3 {
            assert_same(policy, &other, &renormalise, ALL, channel, 0.005);
        }
    }
}

/// That mean is right: `path` has no such policies. Within 1 %, for noise and the blur of shadows and caustics.
#[test]
fn owners_spheres_agree_with_path_tracing() {
    let scene = owners_box();
    let path = render(&scene, &[("integrator", "path")], 4096);
    let mapped = render(&scene, &[("photons", "8000"), ("caustic_photons", "8000")], 128);
    for channel in 0..3 {
        assert_agree("progressive", mapped.beauty(channel), path.beauty(channel), 0.01);
    }
}

/// One map with a fixed radius: a disc of 0.08 blurs the indirect light by ½·E[d²]·∇²L, about a percent
/// of it on walls of size 2; the mean over the picture changes less. The noise of one map, 10⁶ photons of
/// equal power, is 0.1 %. Lookups of the k nearest within a maximum radius blur about as much.
#[test]
fn classic_mode_and_nearest_lookups_agree_with_path_tracing() {
    let scene = scene(&[box_camera(24), walls("0.6"), lamp(0.5, "4")].concat());
    let path = render(&scene, &[("integrator", "path")], 1024);
    let classic = [("mode", "classic"), ("photons", "500000"), ("radius", "0.08")];
    let nearest = [("lookup", "nearest"), ("neighbours", "200"), ("radius", "0.3")];
    let off = [("nee", "false")];
    for (what, changes) in [
        ("classic", classic.to_vec()),
        ("classic, nearest", [&classic[..2], &nearest[..]].concat()),
        ("classic, nearest, nee off", [&classic[..2], &nearest[..], &off[..]].concat()),
    ] {
        let picture = render(&scene, &changes, 32);
        for channel in 0..3 {
            assert_agree(what, picture.beauty(channel), path.beauty(channel), 0.015);
        }
    }
}

/// If the disc holds more photons than the cap, a smaller disc is used: the mean is the same where the caustic is
/// smooth. Within 4 %, for noise and the different blur at the caustic's rim.
#[test]
fn a_cap_on_caustic_photons_keeps_the_mean() {
    let scene = owners_box();
    let caustic = |cap: &str| {
        let settings = [
            ("caustic_photons", "100000"),
            ("caustic_radius", "0.06"),
            ("caustic_cap", cap),
            ("photons", "1024"),
        ];
        render(&scene, &settings, 48)
    };
    let all = caustic("-1");
    assert_same("cap 40", &caustic("40"), &all, &[Layer::Caustic], 0, 0.04);
    // Few: three photons over the disc through the fourth. Through the second the variance has no bound (of 1/area, where
    // the area is that of the k nearest, it is finite for k > 2 only), so that no number of passes would do.
    assert_same("cap 4", &caustic("4"), &all, &[Layer::Caustic], 0, 0.06);
}
