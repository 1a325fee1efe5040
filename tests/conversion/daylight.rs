//! Sun and sky, which only Mitsuba 3 has.

use super::{Difference, Source};

fn seen(version: &str, up: &str, emitter: &str) -> String {
    let [name, floor] = match version {
        "3.0.0" => ["to_world", "<rotate x='1' angle='0'/>"],
        _ => ["toWorld", "<rotate x='1' angle='-90'/>"],
    };
    format!(
        "<scene version='{version}'><integrator type='path'/><sensor type='perspective'><float name='fov' value='50'/>
         <transform name='{name}'><lookat origin='4,5,4.5' target='0,0,0' up='{up}'/></transform>
         <film type='hdrfilm'><integer name='width' value='40'/><integer name='height' value='24'/>
         <rfilter type='box'/></film></sensor>
         <shape type='rectangle'><transform name='{name}'><scale value='9'/>{floor}</transform>
         <bsdf type='diffuse'><rgb name='reflectance' value='0.5, 0.4, 0.3'/></bsdf></shape>
         <shape type='sphere'/>{emitter}</scene>"
    )
}

/// As a picture the sun is wider: its shadows get softer, and the rest stays within the noise of a sun that the
/// picture's renderer finds as well. The mean is kept to the 0.3 % that the noise leaves of it.
#[test]
fn pbrt_gets_a_picture_with_the_same_light() {
    let emitter = "<emitter type='sunsky'><vector name='sun_direction' value='1,-0.6,1.2'/></emitter>";
    let source = Source::new("a.xml", &seen("3.0.0", "0,0,1", emitter), &[]);
    let made = source.convert();
    let found = Difference::of(&source, &made);
    println!("{found:?}");
    assert!(found.bias.abs() < 0.01 && found.is_noise_and(0.05), "{found:?}");
    assert!(
        made.losses.iter().any(|loss| loss.what == "the sun and the sky as formulas"),
        "{:?}",
        made.losses
    );
}

/// 0.6's sky below the horizon becomes a picture, which the first conversion to Mitsuba 3 goes through pbrt for.
#[test]
fn an_extended_sky_becomes_a_picture() {
    let emitter = "<emitter type='sunsky'><vector name='sunDirection' x='1' y='1.2' z='-0.6'/>
        <boolean name='extend' value='true'/></emitter>";
    let source = Source::new("a.xml", &seen("0.6.0", "0,1,0", emitter), &[]);
    let made = source.convert();
    let found = Difference::of(&source, &made);
    println!("{found:?}");
    assert!(found.bias.abs() < 0.01 && found.is_noise_and(0.05), "{found:?}");
}
