//! Boundaries that contradict each other, and very many of them.

use std::fmt::Write;

use super::{container, eye, fog};
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
    assert_eq!(stage.0.warnings().matches("rays from the camera arrive there in vacuum").count(), 1);
    // The same with the camera where the boundaries want it: nothing to say.
    let outside = scene(&[eye("0,0,-4", 1.0, 2, ""), SKY.to_owned(), container("", &dark)].concat());
    assert_eq!(outside.0.warnings(), "");
    let expected = (-2.0f64).exp();
    assert!((render(&outside, &[("integrator", "path")], 4).beauty(1).mean - expected).abs() < 1e-4);
}

/// 10⁴ boundaries along every ray, between them fog and vacuum by turns: half of the way is fog. Rays are lifted off
/// each sheet by 2⁻¹⁹ of its size, 2 % of the distance to the next.
#[test]
fn ten_thousand_boundaries_are_passed() {
    let n = 10_000;
    let mut mesh = String::new();
    for i in 0..n {
        let z = (f64::from(i) + 0.5) / f64::from(n) - 0.5;
        let corners = if i % 2 == 0 { "-1 -2 -3" } else { "-3 -2 -1" };
        let _ = writeln!(mesh, "v -1 -1 {z:.9}\nv 1 -1 {z:.9}\nv 0 1 {z:.9}\nf {corners}");
    }
    let fog = fog("interior", "1,0.5,0.2", "0,0,0", "");
    let stack =
        format!("<shape type='obj'><string name='filename' value='a.obj'/><bsdf type='null'/>{fog}</shape>");
    let body = [eye("0,0,-1", 0.1, 1, ""), SKY.to_owned(), stack].concat();
    let stage = crate::support::scene_with_bytes(&body, vec![("a.obj", mesh.into_bytes())]);
    let picture = render(&stage, &[("integrator", "path")], 1);
    for (channel, sigma) in [1.0f64, 0.5, 0.2].into_iter().enumerate() {
        let (mean, exact) = (picture.beauty(channel).mean, (-0.5 * sigma).exp());
        assert!((mean - exact).abs() < 0.03 * sigma, "channel {channel}: {mean} against {exact}");
    }
}
