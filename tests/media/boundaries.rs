//! Boundaries that contradict each other, and very many of them.

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
