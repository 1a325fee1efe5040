//! Direct light is the same by next event estimation and from photons at their first hit.

use crate::support::{ALL, assert_same, box_camera, lamp, render, scene, walls};

/// Within 0.5 % per channel after 200 progressive passes. The noise of both renders is asserted to be well below
/// that; what remains is the bias of the boundary correction in both.
#[test]
fn next_event_estimation_on_and_off_agree() {
    let block = "<shape type='cube'><transform name='to_world'><scale value='0.3'/><rotate y='1' angle='20'/>
                 <translate x='0.3' y='-0.7' z='-0.2'/></transform>
                 <bsdf type='diffuse'><rgb name='reflectance' value='0.7'/></bsdf></shape>";
    let scene = scene(&[box_camera(24), walls("0.7"), lamp(0.4, "5"), block.to_owned()].concat());
    let on = render(&scene, &[("nee", "true"), ("photons", "10000")], 200);
    let off = render(&scene, &[("nee", "false"), ("photons", "10000")], 200);
    for channel in 0..3 {
        assert_same("nee off against on", &off, &on, ALL, channel, 0.005);
    }
}
