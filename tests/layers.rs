//! The layers are the picture, and each is the same light in both integrators: no path is lost, none
//! counted twice.

use caustica::film::{LAYERS, Layer};
use caustica::photon::trace::{TraceJob, trace};
use caustica::transport::{Owner, PathClass};

use crate::support::{
    Picture, Stage, UP, assert_agree, box_camera, lamp, rectangle, render, scene, sphere, walls,
};

fn glass_box() -> Stage {
    let glass =
        "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>";
    scene(&[box_camera(24), walls("0.6"), lamp(0.6, "3"), sphere("0,-0.3,0", 0.5, glass)].concat())
}

/// Sums are kept in f64 per layer, so only the order of additions differs.
fn assert_layers_sum(picture: &Picture) {
    for i in 0..picture.pixels.len() {
        let beauty = picture.pixel(i);
        for (channel, whole) in beauty.into_iter().enumerate() {
            let sum: f64 =
                LAYERS.iter().map(|(l, _)| picture.pixels.layer(i, *l, picture.passes)[channel]).sum();
            assert!((sum - whole).abs() <= 1e-5 * whole, "pixel {i}: {sum} against {whole}");
        }
    }
}

#[test]
fn layers_sum_to_the_beauty_and_agree_between_integrators() {
    let scene = glass_box();
    let path = render(&scene, &[("integrator", "path")], 4096);
    let photons = [("photons", "20000"), ("caustic_photons", "20000")];
    let mapped = render(&scene, &photons, 128);
    let off = render(&scene, &[&photons[..], &[("nee", "false")]].concat(), 128);
    let single = render(&scene, &[&photons[..], &[("caustic_map", "false")]].concat(), 128);
    let gathered = render(&scene, &[&photons[..], &[("indirect", "gather")]].concat(), 128);
    let traced = render(&scene, &[&photons[..], &[("indirect", "trace")]].concat(), 128);
    let chosen = render(&scene, &[("camera_samples", "32")], 128);
    for picture in [&path, &mapped, &off, &single, &gathered, &traced, &chosen] {
        assert_layers_sum(picture);
    }
    for channel in 0..3 {
        // 4.5 times the measured standard error of the difference (seeds are fixed: at most 0.05 % of emission, 0.13 %
        // of direct light, 0.73 % of caustics, which path tracing meets by chance through glass, 0.44 % of indirect
        // light and 0.07 % of the sum), and a quarter to half a percent for the bias of discs near edges, which Emission
        // has none of.
        for (layer, bound) in [
            (Layer::Emission, 0.0025),
            (Layer::Direct, 0.008),
            (Layer::Caustic, 0.038),
            (Layer::Indirect, 0.025),
        ] {
            let expected = path.estimate(&[layer], channel);
            let name = |what: &str| format!("{layer:?}, {what}");
            assert_agree(&name("maps"), mapped.estimate(&[layer], channel), expected, bound);
            assert_agree(&name("nee off"), off.estimate(&[layer], channel), expected, bound);
            assert_agree(&name("one map"), single.estimate(&[layer], channel), expected, bound);
            assert_agree(&name("gathered"), gathered.estimate(&[layer], channel), expected, bound);
            assert_agree(&name("traced"), traced.estimate(&[layer], channel), expected, bound);
            assert_agree(&name("chosen"), chosen.estimate(&[layer], channel), expected, bound);
        }
        let pictures = [
            ("maps", &mapped),
            ("nee off", &off),
            ("one map", &single),
            ("gathered", &gathered),
            ("traced", &traced),
        ];
        for (what, picture) in pictures {
            assert_agree(&format!("sum, {what}"), picture.beauty(channel), path.beauty(channel), 0.006);
        }
    }
}

/// Lobes that are followed, beside lobes of the same surface that hold photons: a polished floor, a ball
/// of brushed metal and one of frosted glass, under a lamp and a point light that only next event
/// estimation finds.
fn glossy_box() -> Stage {
    let rough = |kind: &str, alpha: f64, rest: &str| {
        format!(
            "<bsdf type='{kind}'><string name='distribution' value='ggx'/><float name='alpha' value='{alpha}'/>{rest}</bsdf>"
        )
    };
    let floor = rough("roughplastic", 0.15, "<rgb name='diffuse_reflectance' value='0.5'/>");
    scene(
        &[
            box_camera(16),
            walls("0.6"),
            rectangle(1.0, &format!("{UP}<translate y='-0.98'/>"), &floor),
            lamp(0.6, "3"),
            "<emitter type='point'><point name='position' x='0.3' y='0.2' z='0.8'/><rgb name='intensity' value='0.3'/></emitter>".to_owned(),
            sphere("-0.45,-0.5,-0.2", 0.4, &rough("roughconductor", 0.12, "")),
            sphere("0.45,-0.5,0.2", 0.35, &rough("roughdielectric", 0.15, "<float name='int_ior' value='1.5'/>")),
        ]
        .concat(),
    )
}

/// Bounds as above from the standard error: at most 0.09 % of emission, 0.11 % of direct light, 1.5 % of caustics, where
/// glossy chains make path tracing noisy, 0.34 % of indirect light and 0.08 % of the sum.
#[test]
fn glossy_lobes_are_followed_without_loss() {
    let scene = glossy_box();
    let path = render(&scene, &[("integrator", "path")], 6144);
    let photons = [("photons", "20000"), ("caustic_photons", "20000")];
    let mapped = render(&scene, &photons, 128);
    let off = render(&scene, &[&photons[..], &[("nee", "false")]].concat(), 128);
    let rough = render(&scene, &[&photons[..], &[("glossy", "0.01")]].concat(), 128);
    let gathered = render(&scene, &[&photons[..], &[("indirect", "gather")]].concat(), 128);
    let traced = render(&scene, &[&photons[..], &[("indirect", "trace")]].concat(), 128);
    for channel in 0..3 {
        for (layer, bound) in [
            (Layer::Emission, 0.005),
            (Layer::Direct, 0.008),
            (Layer::Caustic, 0.072),
            (Layer::Indirect, 0.02),
        ] {
            let expected = path.estimate(&[layer], channel);
            let name = |what: &str| format!("{layer:?}, {what}");
            assert_agree(&name("maps"), mapped.estimate(&[layer], channel), expected, bound);
            assert_agree(&name("nee off"), off.estimate(&[layer], channel), expected, bound);
            assert_agree(&name("gathered"), gathered.estimate(&[layer], channel), expected, bound);
            assert_agree(&name("traced"), traced.estimate(&[layer], channel), expected, bound);
        }
        for (what, picture) in
            [("maps", &mapped), ("nee off", &off), ("gathered", &gathered), ("traced", &traced)]
        {
            assert_agree(&format!("sum, {what}"), picture.beauty(channel), path.beauty(channel), 0.006);
        }
        // The same light with glossy lobes read from photons: 4.5 times 0.11 %, and half a percent that discs of a tenth
        // of the balls' size may lose over their horizon.
        assert_agree("sum, photons only", rough.beauty(channel), path.beauty(channel), 0.01);
    }
}

fn flux(photons: &caustica::photon::Stored, wanted: impl Fn(PathClass) -> bool) -> (usize, f64) {
    let chosen = photons.iter().filter(|p| wanted(p.class));
    chosen.fold((0, 0.0), |(n, sum), p| (n + 1, sum + f64::from(p.flux.lanes()[0])))
}

/// With the same random numbers, the photons of the owners are exactly a partition of all photons.
#[test]
fn owners_divide_the_photons_without_loss_or_overlap() {
    let scene = glass_box();
    let job = |owner, next_event, caustic_map| TraceJob {
        beams: false,
        all: false,
        glints: false,
        focused: false,
        key: 7,
        paths: 50_000,
        owner,
        next_event,
        caustic_map,
        glossy: 0.2,
        max_depth: u32::MAX,
    };
    let photons =
        |owner, next_event, caustic_map| trace(&scene, &job(owner, next_event, caustic_map)).photons;
    let all = photons(Owner::GlobalMap, false, false);
    let (direct, specular, scattered) = (
        flux(&all, |p| p == PathClass::Direct),
        flux(&all, |p| p == PathClass::Caustic),
        flux(&all, |p| p == PathClass::Indirect),
    );
    assert!(direct.0 > 10_000 && specular.0 > 1000 && scattered.0 > 10_000);
    assert_eq!(flux(&photons(Owner::GlobalMap, true, true), |_| true), scattered);
    assert_eq!(flux(&photons(Owner::CausticMap, true, true), |_| true), specular);
    assert_eq!(flux(&photons(Owner::CausticMap, false, true), |_| true), specular);
    assert_eq!(flux(&photons(Owner::NextEvent, true, true), |_| true), direct);
    let both = photons(Owner::GlobalMap, false, true);
    assert_eq!(both.len(), direct.0 + scattered.0);
    assert_eq!(flux(&both, |p| p == PathClass::Caustic).0, 0);
    let both = photons(Owner::GlobalMap, true, false);
    assert_eq!(both.len(), specular.0 + scattered.0);
    assert_eq!(flux(&both, |p| p == PathClass::Direct).0, 0);
}
