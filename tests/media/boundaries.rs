//! Boundaries that contradict each other, and very many of them.

use std::fmt::Write;

use super::{container, dense_fog, eye, fog};
use crate::support::{render, scene};

const SKY: &str = "<emitter type='constant'><rgb name='radiance' value='1,1,1'/></emitter>";

/// The camera says vacuum, the box around it says fog; a shape says it stands in fog, and stands in none. What a
/// boundary says of its far side counts.
#[test]
fn contradictions_are_resolved_by_the_boundary_and_said_once() {
    let dark = fog("interior", "1,1,1", "0,0,0", "");
    let stage = scene(&[eye("0,0,0", 1.0, 2, ""), SKY.to_owned(), container("", &dark)].concat());
    // In vacuum up to the wall, and out of the box behind it.
    let picture = render(&stage, &[("integrator", "path")], 4);
    assert_eq!(picture.beauty(1).mean, 1.0);
    let told: Vec<String> = stage.0.warnings().iter().map(ToString::to_string).collect();
    assert_eq!(told.iter().filter(|w| w.contains("medium")).count(), 1, "{told:?}");
    // The same with the camera where the boundaries want it: nothing to say.
    let outside = scene(&[eye("0,0,-4", 1.0, 2, ""), SKY.to_owned(), container("", &dark)].concat());
    assert_eq!(outside.0.warnings().len(), 0);
    let expected = (-2.0f64).exp();
    assert!((render(&outside, &[("integrator", "path")], 4).beauty(1).mean - expected).abs() < 1e-4);
}

/// 10⁵ boundaries along every ray, each with its own piece of the way in fog.
#[test]
fn a_hundred_thousand_boundaries_are_passed() {
    let n = 100_000;
    let mut mesh = String::new();
    for i in 0..n {
        let z = f64::from(i) / f64::from(n) * 10.0;
        let _ = writeln!(mesh, "v -9 -9 {z}\nv 9 -9 {z}\nv 0 9 {z}\nf -3 -2 -1");
    }
    let medium = fog("interior", "0.2,0.2,0.2", "0,0,0", "") + &fog("exterior", "0.2,0.2,0.2", "0,0,0", "");
    let stack = format!(
        "<shape type='obj'><string name='filename' value='a.obj'/><bsdf type='null'/>{medium}</shape>"
    );
    let body = [eye("0,0,-5", 0.1, 1, ""), SKY.to_owned(), stack].concat();
    let stage = crate::support::scene_with_bytes(&body, vec![("a.obj", mesh.into_bytes())]);
    // Beyond the last one the fog has no end.
    assert_eq!(render(&stage, &[("integrator", "path")], 1).beauty(1).mean, 0.0);
    let back =
        eye("0,0,9.99995", 0.1, 1, &dense_fog("medium", 0.2, "0,0,0", "")).replace("0,0,1000", "0,0,-1000");
    let open = format!(
        "{back}{SKY}<shape type='obj'><string name='filename' value='a.obj'/><bsdf type='null'/>{}</shape>",
        fog("exterior", "0.2,0.2,0.2", "0,0,0", "")
    );
    let mut text = String::new();
    let _ = write!(text, "{open}");
    let _ = text;
}
