//! Boundaries of media that light goes straight through: index-matched ones, masks and thin panes of glass. As in
//! Mitsuba's `volpath`, that is no scattering: it costs no depth, and shadow rays go through.

use super::{container, eye, fog, shows};
use crate::support::{area, diffuse, pbrt_scene_seen, rectangle, render, scene};

const SKY: &str = "<emitter type='constant'><rgb name='radiance' value='1,1,1'/></emitter>";
const SIGMA: [f64; 3] = [0.2, 0.7, 1.0];
const TINT: [f64; 3] = [0.9, 0.6, 0.3];

/// What a pane of index 1.5 lets through at right angles: 1 − R' with R' = 2R/(1 + R), R = 0.04.
const CLEAR: f64 = 1.0 - 0.08 / 1.04;

const NULL: &str = "<bsdf type='null'/>";
const MASK: &str = "<bsdf type='mask'><float name='opacity' value='0.25'/>
    <bsdf type='diffuse'><rgb name='reflectance' value='0,0,0'/></bsdf></bsdf>";
const PANE: &str =
    "<bsdf type='thindielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/>
    <rgb name='specular_transmittance' value='0.9,0.6,0.3'/></bsdf>";

/// The boundaries, with what each lets through.
fn boundaries() -> [(&'static str, &'static str, [f64; 3]); 3] {
    [("null", NULL, [1.0; 3]), ("mask", MASK, [0.75; 3]), ("pane", PANE, TINT.map(|t| t * CLEAR))]
}

/// Absorbing fog of thickness 1 across the view.
fn slab(boundary: &str) -> String {
    container("<scale value='9,9,0.5'/>", &fog("interior", "0.2,0.7,1", "0,0,0", "")).replace(NULL, boundary)
}

/// The sky through a slab, by paths of one segment. Rays of a narrow view are longer by less than 1e-5.
#[test]
fn straight_passages_cost_no_depth() {
    for (name, boundary, through) in boundaries() {
        let stage = scene(&[eye("0,0,-5", 0.1, 4, ""), SKY.to_owned(), slab(boundary)].concat());
        let exact = [0, 1, 2].map(|c| through[c].powi(2) * (-SIGMA[c]).exp());
        for integrator in ["path", "photonmap"] {
            let picture = render(&stage, &[("integrator", integrator), ("max_depth", "1")], 1024);
            shows(&format!("{name}, {integrator}"), &picture, exact, 0.02);
        }
    }
}

/// A lamp beside the camera lights a wall behind a slab: light goes through the slab twice, and only shadow rays and
/// photons find the lamp, which is a point. Photons look for it without next event estimation: where the wall is seen,
/// over the radius of their lookup, its light falls by less than 1 %.
#[test]
fn shadow_rays_and_photons_go_through() {
    let lamp = "<emitter type='point'><point name='position' value='0,0,-5'/>
        <rgb name='intensity' value='1000,1000,1000'/></emitter>";
    let wall = rectangle(6.0, "<rotate y='1' angle='180'/><translate z='5'/>", &diffuse("0.5,0.5,0.5"));
    for (name, boundary, through) in boundaries() {
        let stage =
            scene(&[eye("0,0,-5", 0.1, 4, ""), lamp.to_owned(), wall.clone(), slab(boundary)].concat());
        let white = 0.5 / std::f64::consts::PI * 1000.0 / 100.0;
        let exact = [0, 1, 2].map(|c| white * through[c].powi(4) * (-2.0 * SIGMA[c]).exp());
        let ways = [
            [("integrator", "path"), ("nee", "true"), ("radius", "auto")],
            [("integrator", "photonmap"), ("nee", "true"), ("radius", "auto")],
            [("integrator", "photonmap"), ("nee", "false"), ("radius", "0.5")],
        ];
        for way in ways {
            let settings = [&way[..], &[("max_depth", "2"), ("photons", "20000")]].concat();
            let picture = render(&stage, &settings, 256);
            shows(&format!("{name}, {way:?}"), &picture, exact, 0.04);
        }
    }
}

/// The light of an area lamp behind a pane is found by shadow rays and by rays that the wall scatters: together they
/// count it once.
#[test]
fn a_lamp_behind_a_pane_counts_once() {
    let lamp = rectangle(2.0, "<translate z='-6'/>", &area("1,1,1"));
    let wall = rectangle(6.0, "<rotate y='1' angle='180'/><translate z='5'/>", &diffuse("0.5,0.5,0.5"));
    let of = |boundary: &str| {
        let stage = scene(&[eye("0,0,-5", 0.1, 4, ""), lamp.clone(), wall.clone(), slab(boundary)].concat());
        let picture = render(&stage, &[("integrator", "path"), ("max_depth", "2")], 4096);
        [0, 1, 2].map(|c| picture.beauty(c).mean)
    };
    // Of index 1 the pane is nothing.
    let nothing = PANE.replace("'1.5'", "'1'").replace("0.9,0.6,0.3", "1,1,1");
    let (pane, null) = (of(&nothing), of(NULL));
    for c in 0..3 {
        // 16 pixels of 4096 samples: the noise is below 0.1 %.
        assert!((pane[c] / null[c] - 1.0).abs() < 0.005, "{pane:?} and {null:?}");
    }
}

/// To pbrt a thin pane is glass: each costs a segment.
#[test]
fn panes_of_pbrt_cost_depth() {
    let slab = "LightSource \"infinite\" \"rgb L\" [1 1 1]\n
        MakeNamedMedium \"dark\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [0.2 0.7 1] \"rgb sigma_s\" [0 0 0]
        MediumInterface \"dark\" \"\" Material \"thindielectric\" \"float eta\" 1.5
        Shape \"trianglemesh\" \"integer indices\" [0 2 1 0 3 2 4 5 6 4 6 7]
            \"point3 P\" [-9 -9 -.5 9 -9 -.5 9 9 -.5 -9 9 -.5 -9 -9 .5 9 -9 .5 9 9 .5 -9 9 .5]";
    let view = "LookAt 0 0 -5 0 0 0 0 1 0 Camera \"perspective\" \"float fov\" 0.1
        Film \"rgb\" \"integer xresolution\" 4 \"integer yresolution\" 4";
    let stage = pbrt_scene_seen(view, slab, Vec::new());
    let path = |depth| render(&stage, &[("integrator", "path"), ("max_depth", depth)], 1024);
    // The sky that the first one reflects, and then the sky behind both.
    shows("two segments", &path("2"), [1.0 - CLEAR; 3], 0.02);
    shows("three segments", &path("3"), SIGMA.map(|s| 1.0 - CLEAR + CLEAR * CLEAR * (-s).exp()), 0.02);
}
