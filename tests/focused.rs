//! Indirect light that specular surfaces focus: photons of it are read apart from the others, with a radius of their own.

use caustica::film::Layer;
use caustica::photon::Stored;
use caustica::photon::trace::{TraceJob, trace};
use caustica::transport::{Owner, PathClass};

use crate::support::{Picture, Stage, camera, render, scene, sphere, walls};

const POINT: &str = "<emitter type='point'><point name='position' value='0,0.9,0'/><rgb name='intensity' value='1'/></emitter>";

/// A ball of glass and one of mirror under a point lamp.
fn room(size: u32) -> Stage {
    let glass =
        "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>";
    scene(
        &[
            camera("0,0,4.2", "0,0,0", 34.5, size),
            walls("0.7"),
            sphere("-0.44,-0.58,-0.36", 0.42, "<bsdf type='conductor'/>"),
            sphere("0.42,-0.62,0.34", 0.38, glass),
            POINT.to_owned(),
        ]
        .concat(),
    )
}

/// Place, flux and class of all photons of some lists, sorted.
fn sorted(lists: &[&Stored]) -> Vec<([u32; 3], [u32; 3], u8)> {
    let bits = |v: [f32; 3]| v.map(f32::to_bits);
    let photons = lists.iter().flat_map(|list| list.iter());
    let mut all: Vec<_> =
        photons.map(|p| (bits(p.p.to_array()), bits(p.flux.lanes()), p.class as u8)).collect();
    all.sort_unstable();
    all
}

/// The same paths leave the same photons, each in one of the two lists; what lies apart is indirect light, and no photon
/// of a scene without specular surfaces does.
#[test]
fn photons_apart_are_some_of_those_of_the_global_map() {
    let job = TraceJob {
        key: 3,
        paths: 1 << 15,
        owner: Owner::GlobalMap,
        all: false,
        next_event: true,
        caustic_map: true,
        beams: false,
        glossy: 0.2,
        glints: false,
        focused: true,
        max_depth: 8,
    };
    let stage = room(8);
    let divided = trace(&stage, &job);
    let whole = trace(&stage, &TraceJob { focused: false, ..job });
    assert!(whole.apart.is_empty());
    assert_eq!(sorted(&[&divided.photons, &divided.apart]), sorted(&[&whole.photons]));
    // The two balls take up some hundredths of what walls see.
    let share = divided.apart.len() as f64 / whole.photons.len() as f64;
    println!("apart: {:.1} %", 100.0 * share);
    assert!((0.01..0.3).contains(&share), "{share}");
    assert!(divided.apart.iter().all(|photon| photon.class == PathClass::Indirect));
    let plain = scene(&[camera("0,0,4.2", "0,0,0", 34.5, 8), walls("0.7"), POINT.to_owned()].concat());
    let plain = trace(&plain, &job);
    assert!(plain.apart.is_empty() && !plain.photons.is_empty());
}

/// Mean squared relative difference of indirect light below the glass.
fn error(picture: &Picture, reference: &Picture) -> f64 {
    let (rows, columns) = (57..62, 38..54);
    let count = (rows.len() * columns.len()) as f64;
    let pixels = rows.flat_map(|y| columns.clone().map(move |x| y * 64 + x));
    let of = |picture: &Picture, i: usize| picture.pixels.layer(i, Layer::Indirect, picture.passes)[1];
    pixels.map(|i| (of(picture, i) / of(reference, i) - 1.0).powi(2)).sum::<f64>() / count
}

/// With a radius that is given, all photons have it; it is the one that is measured here. Over four seeds the squared error
/// was 0.34 to 0.45 of that.
#[test]
fn focused_indirect_light_is_sharper_than_the_rest() {
    let stage = room(64);
    let path = render(&stage, &[("integrator", "path")], 4096);
    let density = [("indirect", "density"), ("photons", "4096"), ("caustic_photons", "4096")];
    let apart = render(&stage, &density, 64);
    let radius = format!("{}", 0.1 * stage.sphere.radius);
    let together = render(&stage, &[&density[..], &[("radius", &radius)]].concat(), 64);
    let [apart, together] = [apart, together].map(|picture| error(&picture, &path));
    println!("squared error {apart:.4}, {together:.4} with one radius");
    assert!(apart < 0.6 * together, "{apart} {together}");
}
