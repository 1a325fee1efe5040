//! Scaling or moving a scene does not change its picture.

use super::{METHODS, hard_scene, same};
use crate::support::render;

/// The same random numbers give the same paths, except where rounding moves one across an edge. The bound is far
/// below the effect of shadow acne, a leak or a radius that does not scale (several percent).
const SAME: f64 = 0.005;

fn scaled(power: i32) -> Vec<(&'static str, String)> {
    let times = |x: f64| format!("{:e}", x * 10f64.powi(power));
    vec![("scale", times(1.0)), ("camera", times(3.6)), ("near", times(0.1)), ("far", times(100.0))]
}

#[test]
fn scaled_and_moved_boxes_look_the_same() {
    for (name, settings) in METHODS {
        let picture = |changes: Vec<(&str, String)>| {
            let mut parameters: Vec<(&str, &str)> = changes.iter().map(|(n, v)| (*n, v.as_str())).collect();
            parameters.push(("size", "32"));
            render(&hard_scene("box", &parameters), settings, 64)
        };
        let plain = picture(Vec::new());
        for power in [-4, 4, 6] {
            let case = format!("box of 1e{power} units, {name}");
            same(&case, "as at 1 unit", &picture(scaled(power)), &plain, SAME);
        }
        // 1e4 sizes of the box, which is 2 wide.
        let moved = picture(vec![("shift", "20000".to_owned())]);
        same(&format!("box moved by 1e4 of its size, {name}"), "as at the origin", &moved, &plain, SAME);
    }
}
