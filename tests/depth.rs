//! How path segments are counted: as in Mitsuba's `path` or `volpath`, by photon mapping too.

use crate::support::{
    DOWN, Estimate, UP, area, assert_agree, box_camera, camera, diffuse, lamp, rectangle, render, scene,
    walls,
};
use caustica::film::Layer;

const LIT: &[Layer] = &[Layer::Direct, Layer::Caustic, Layer::Indirect];

#[test]
fn the_first_depths_are_black_emission_and_direct_light() {
    let scene = scene(&[box_camera(12), walls("0.6"), lamp(0.4, "3")].concat());
    for (name, variant) in [
        ("path", &[("integrator", "path")][..]),
        ("next event", &[][..]),
        ("photons only", &[("nee", "false")][..]),
        ("final gathering", &[("indirect", "gather")][..]),
        ("no global map", &[("indirect", "trace")][..]),
    ] {
        let at = |depth: &str| {
            let given = [("max_depth", depth), ("photons", "4000"), ("camera_samples", "16")];
            let settings = [&given[..], variant].concat();
            render(&scene, &settings, 16)
        };
        let [black, emission, direct, indirect] = ["0", "1", "2", "3"].map(at);
        let part = |p: &crate::support::Picture, layer| p.estimate(&[layer], 0).mean;
        assert_eq!(black.beauty(0).mean, 0.0, "{name}");
        assert_eq!(emission.beauty(0).mean, part(&emission, Layer::Emission), "{name}");
        assert!(part(&emission, Layer::Emission) > 0.0, "{name}");
        // Emission is the same at every depth, up to the order of additions.
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b;
        assert!(close(part(&direct, Layer::Emission), part(&emission, Layer::Emission)), "{name}");
        assert!(part(&direct, Layer::Direct) > 0.0, "{name}");
        assert_eq!(part(&direct, Layer::Indirect), 0.0, "{name}");
        assert!(part(&indirect, Layer::Indirect) > 0.0, "{name}");
    }
}

/// Reflected light only (the edges of visible lamps would add noise), within 1.5 % for noise, as measured. The
/// blur of discs at shadow edges stays inside the picture and cancels in its mean; what is left is the bias of
/// the boundary correction at the walls' edges.
#[test]
fn every_depth_agrees_between_integrators() {
    let scene = scene(&[box_camera(16), walls("0.6"), lamp(0.5, "3")].concat());
    for depth in ["2", "3", "4"] {
        let path = render(&scene, &[("integrator", "path"), ("max_depth", depth)], 1024);
        let ways = [("nee", "true"), ("nee", "false"), ("indirect", "gather"), ("indirect", "trace")];
        for way in ways {
            let settings = [("max_depth", depth), way, ("photons", "6000")];
            let mapped = render(&scene, &settings, 128);
            for channel in 0..3 {
                let what = format!("depth {depth}, {way:?}");
                assert_agree(&what, mapped.estimate(LIT, channel), path.estimate(LIT, channel), 0.015);
            }
        }
    }
}

const NULL: &str = "<bsdf type='null'/>";

/// Mitsuba 3.9.1: a lamp behind a null surface is black at depth 1.
#[test]
fn passing_a_null_surface_is_a_segment() {
    let behind = rectangle(1.0, "", &area("2"));
    let before = rectangle(3.0, "<translate z='1'/>", NULL);
    let scene = scene(&format!("{}{behind}{before}", camera("0,0,3", "0,0,0", 10.0, 4)));
    for integrator in ["path", "photonmap"] {
        let seen = |depth: &str| {
            let settings = [("integrator", integrator), ("max_depth", depth)];
            render(&scene, &settings, 2).beauty(0).mean
        };
        assert_eq!(seen("1"), 0.0, "{integrator}");
        assert_eq!(seen("2"), 2.0, "{integrator}");
    }
}

/// Paths of two segments: a floor below a veil that half of all light passes, two sheets that are all holes, and a boundary
/// of one index. Mitsuba's `path` counts every passage, so that nothing arrives; with its `volpath` they cost nothing, for
/// camera paths, shadow rays and photons. Of the radiance 0.5 of the open floor, the veil lets half pass either way.
/// Each of 16 × 1024 samples passes it or does not: noise of 0.8 %, times 4.5; photons add as much.
#[test]
fn passages_cost_segments_where_they_do_in_the_renderer_of_the_file() {
    let sheet = |z: f64, bsdf: &str| rectangle(3.0, &format!("<translate z='{z}'/>"), bsdf);
    let open = format!("<bsdf type='mask'><float name='opacity' value='0'/>{}</bsdf>", diffuse("0"));
    let veil = format!("<bsdf type='mask'><float name='opacity' value='0.5'/>{}</bsdf>", diffuse("0"));
    let lamp = "<emitter type='directional'><vector name='direction' value='0,0,-1'/>
                <rgb name='irradiance' value='3.1415926536'/></emitter>";
    let body = [
        &*camera("0,0,3", "0,0,0", 10.0, 4),
        &rectangle(3.0, "", &diffuse("0.5")),
        &sheet(0.5, &veil),
        &sheet(1.0, &open),
        &sheet(1.5, NULL),
        &sheet(2.0, &open),
        lamp,
    ]
    .concat();
    for (plugin, expected) in [("path", 0.0), ("volpath", 0.125)] {
        let text = scene(&format!("<integrator type='{plugin}'/>{body}"));
        let ways = [
            [("integrator", "path"), ("nee", "true")],
            [("indirect", "density"), ("nee", "true")],
            [("indirect", "trace"), ("nee", "true")],
            [("indirect", "density"), ("nee", "false")],
        ];
        for way in ways {
            let settings = [&[("max_depth", "2"), ("photons", "20000")][..], &way].concat();
            let seen = render(&text, &settings, 1024).beauty(0);
            let exact = Estimate { mean: expected, sigma: 0.0 };
            match expected {
                0.0 => assert_eq!(seen.mean, 0.0, "{plugin}, {way:?}"),
                _ => assert_agree(&format!("{plugin}, {way:?}"), seen, exact, 0.05),
            }
        }
    }
}

/// A mask of opacity 0.3 between lamp and floor lets 0.7 of the light through, whether it is carried by photons,
/// shadow rays or scattered rays. The bounds are for noise, as measured: 1 % for `path`, 2 % for photons, most of
/// which miss the view. The floor is wide enough to catch all light.
#[test]
fn masks_let_the_same_light_through_in_both_integrators() {
    let floor = rectangle(6.0, UP, &diffuse("0.5"));
    let light = rectangle(0.5, &format!("{DOWN}<translate y='2'/>"), &area("5"));
    let veil = |opacity: f64| {
        let mask =
            format!("<bsdf type='mask'><float name='opacity' value='{opacity}'/>{}</bsdf>", diffuse("0"));
        rectangle(6.0, &format!("{DOWN}<translate y='1'/>"), &mask)
    };
    let view = camera("0,0.9,0.5", "0,0,0", 50.0, 8);
    let open = scene(&format!("{view}{floor}{light}"));
    let veiled = scene(&format!("{view}{floor}{light}{}", veil(0.3)));
    let path = [("integrator", "path")];
    let bare = render(&open, &path, 2048).estimate(&[Layer::Direct], 0);
    let masked = render(&veiled, &path, 4096);
    let (through, whole) = (masked.estimate(&[Layer::Direct], 0), masked.beauty(0));
    let dimmed = Estimate { mean: 0.7 * bare.mean, sigma: 0.7 * bare.sigma };
    assert_agree("path", through, dimmed, 0.01);
    for nee in ["true", "false"] {
        let mapped = render(&veiled, &[("nee", nee), ("photons", "60000")], 128);
        assert_agree(&format!("nee {nee}"), mapped.estimate(&[Layer::Direct], 0), through, 0.02);
        assert_agree(&format!("nee {nee}, all"), mapped.beauty(0), whole, 0.02);
    }
}
