//! Checkerboards as textures of scalar parameters.

use caustica::bsdf::{Range, Transport};
use caustica::math::Ray;

use crate::support::{camera, scene_of_version};

/// Mitsuba 2 and 3 swap the two values of a checkerboard that gives a roughness (their `eval_1`), but not those
/// of one that gives a colour; 0.6 never does. The rays hit the four cells of the pattern from above.
#[test]
fn scalar_checkerboards_are_swapped_in_mitsuba_2_and_3_only() {
    for (version, swapped) in [("0.6.0", false), ("2.0.0", true), ("3.0.0", true)] {
        let text =
            "<shape type='rectangle'><bsdf type='roughconductor'><string name='distribution' value='ggx'/>
             <texture type='checkerboard' name='alpha'><float name='color0' value='0.1'/>
             <float name='color1' value='0.5'/></texture></bsdf></shape>";
        let scene = scene_of_version(version, &format!("{}{text}", camera("0,0,9", "0,0,0", 40.0, 4)));
        for (x, y) in [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)] {
            let ray = Ray::new([x, y, 1.0].into(), [0.0, 0.0, -1.0].into());
            let hit = scene.geometry.closest(&ray).expect("the rectangle");
            let s = scene.surface(&ray, &hit);
            let wi = s.frame.to_local(-ray.d);
            let closure = scene.closure(&s, wi);
            let rough = closure.has_smooth(wi, Range::rough(0.3));
            let odd = (x > 0.0) != (y > 0.0);
            assert_eq!(rough, odd != swapped, "{version} at {x}, {y}");
            assert!(closure.eval(wi, wi, Transport::Radiance, Range::ALL).min_element() > 0.0);
        }
    }
}
