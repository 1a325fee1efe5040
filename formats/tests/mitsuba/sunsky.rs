//! Sun and sky of both Mitsubas.

use std::path::Path;

use caustica_formats::ir::{Color, Day, EmitterKind, Place, Scene, SunModel, SunPosition, SunSky, Transform};
use caustica_formats::sky::{Daylight, FROM_OLD, sun_direction};

use caustica_formats::spectrum::luminance;
use caustica_formats::{ReadOptions, write_scene};

use crate::{headlines, v3, v06};

fn light(scene: Scene) -> SunSky {
    match scene.emitters.into_iter().next().map(|e| e.kind) {
        Some(EmitterKind::SunSky(light)) => *light,
        other => panic!("no sky: {other:?}"),
    }
}

const TOKYO: Place = Place { latitude: 35.6894, longitude: 139.6917, timezone: 9.0 };

fn afternoon() -> SunPosition {
    SunPosition::Moment { place: TOKYO, day: Day { year: 2010, month: 7, day: 10 }, hour: 15.0 }
}

#[test]
fn defaults_are_those_of_the_sources() {
    assert_eq!(light(v3("<emitter type='sunsky'/>")), SunSky::new(afternoon()));
    let old = SunSky {
        to_world: FROM_OLD,
        albedo: Color::Gray(0.2),
        sun_model: SunModel::Preetham,
        ..SunSky::new(afternoon())
    };
    // Mitsuba 0.6 divides by another integral of ȳ.
    let sky_scale = 106.750_259_399_414_06 / 106.856_98;
    assert_eq!(light(v06("<emitter type='sunsky'/>")), SunSky { sky_scale, ..old.clone() });
    assert_eq!(light(v06("<emitter type='sky'/>")), SunSky { sky_scale, sun_scale: 0.0, ..old.clone() });
    assert_eq!(light(v06("<emitter type='sun'/>")), SunSky { sky_scale: 0.0, ..old });
}

#[test]
fn every_parameter_counts() {
    let body = "<emitter type='sunsky'><vector name='sun_direction' value='0, 1, 1'/><float name='turbidity' value='4'/>
        <rgb name='albedo' value='0.1, 0.2, 0.3'/><float name='sun_scale' value='2'/><float name='sky_scale' value='0.5'/>
        <float name='sun_aperture' value='3'/><boolean name='complex_sun' value='true'/></emitter>";
    let expected = SunSky {
        turbidity: 4.0,
        albedo: Color::Rgb([0.1, 0.2, 0.3]),
        sun_scale: 2.0,
        sky_scale: 0.5,
        sun_aperture: 3.0,
        sun_model: SunModel::LimbDarkened,
        ..SunSky::new(SunPosition::Direction([0.0, 1.0, 1.0]))
    };
    assert_eq!(light(v3(body)), expected);
    let old = light(v06(
        "<emitter type='sunsky'><float name='scale' value='3'/><float name='sunScale' value='5'/>
         <float name='sunRadiusScale' value='4'/><float name='stretch' value='1.5'/><boolean name='extend' value='true'/>
         <integer name='resolution' value='64'/><float name='minute' value='30'/></emitter>",
    ));
    assert!((old.sky_scale - 3.0).abs() < 0.004 && old.sun_scale == 5.0, "{old:?}");
    assert!((old.sun_aperture - 4.0 * SunSky::APERTURE).abs() < 1e-12 && old.stretch == 1.5 && old.extend);
    assert!(matches!(old.sun, SunPosition::Moment { hour: 15.5, .. }));
}

/// 0.6 has up at +Y, east at +X and north at −Z: in the afternoon the sun stands in the west. Mitsuba 3 has −X at north
/// and −Y at east.
#[test]
fn the_afternoon_sun_stands_in_the_west() {
    let world = |light: &SunSky| light.to_world.vector(sun_direction(light).expect("a direction"));
    let [x, y, z] = world(&light(v06("<emitter type='sunsky'/>")));
    assert!(x < -0.6 && y > 0.6 && z.abs() < 0.2, "{x} {y} {z}");
    let [x3, y3, z3] = world(&light(v3("<emitter type='sunsky'/>")));
    assert!((x3 - z).abs() < 1e-12 && (y3 + x).abs() < 1e-12 && (z3 - y).abs() < 1e-12, "{x3} {y3} {z3}");
    // Mitsuba 3.9.1 prints (0.0513854, 0.691748, 0.720308) for `sun_direction`; it takes the date in single precision, to
    // a quarter of a day.
    for (got, expected) in [x3, y3, z3].into_iter().zip([0.051_385_4, 0.691_748, 0.720_308]) {
        assert!((got - expected).abs() < 0.003, "{x3} {y3} {z3}");
    }
    // A direction is of the world, wherever the light is turned.
    let turned = light(v06("<emitter type='sunsky'><vector name='sunDirection' x='1' y='1' z='0'/>
         <transform name='toWorld'><rotate x='1' angle='90'/></transform></emitter>"));
    let [x, y, z] = world(&turned);
    assert!((x - y).abs() < 1e-12 && x > 0.7 && z.abs() < 1e-12);
}

/// Without a radius the sun is parallel light of the same irradiance.
#[test]
fn a_sun_without_radius_is_parallel_light() {
    let body = "<emitter type='sunsky'><vector name='sunDirection' x='0' y='3' z='4'/>
        <float name='sunRadiusScale' value='0'/><float name='sunScale' value='2'/></emitter>";
    let scene = v06(body);
    let parallel = scene.emitters.iter().find_map(|e| match &e.kind {
        EmitterKind::Directional { direction, irradiance: Color::Rgb(rgb) } => Some((*direction, *rgb)),
        _ => None,
    });
    let (direction, rgb) = parallel.expect("a directional light");
    let sky = scene.emitters.iter().find_map(|e| match &e.kind {
        EmitterKind::SunSky(light) => Some(light.clone()),
        _ => None,
    });
    assert_eq!(sky.expect("a sky").sun_scale, 0.0);
    assert!((direction[1] + 0.6).abs() < 1e-12 && (direction[2] + 0.8).abs() < 1e-12, "{direction:?}");
    let disc =
        light(v06(&body.replace("name='sunRadiusScale' value='0'", "name='sunRadiusScale' value='1'")));
    let toward = sun_direction(&disc).expect("a direction");
    let expected = Daylight::new(&disc, toward, [0.2; 3]).sun().expect("it shines").irradiance();
    for (got, expected) in rgb.into_iter().zip(expected) {
        assert!((got / expected - 1.0).abs() < 1e-9, "{rgb:?}");
    }
    let sun = v06("<emitter type='sun'><float name='sunRadiusScale' value='0'/></emitter>");
    assert!(matches!(sun.emitters.as_slice(), [e] if matches!(e.kind, EmitterKind::Directional { .. })));
}

/// The sensor says when its shutter is open.
#[test]
fn hours_of_many_days_are_those_of_the_shutter() {
    let sensor = "<sensor type='perspective'><float name='shutter_open' value='1'/><float name='shutter_close' value='2'/></sensor>";
    let emitter = "<emitter type='timed_sunsky'><integer name='start_year' value='2024'/><integer name='start_month' value='3'/>
        <float name='window_start_time' value='8'/><float name='shutter_open' value='0'/><float name='shutter_close' value='4'/></emitter>";
    let expected = SunPosition::Days {
        place: TOKYO,
        start: Day { year: 2024, month: 3, day: 1 },
        end: Day { year: 2025, month: 3, day: 1 },
        hours: [8.0, 19.0],
        shutter: [0.25, 0.5],
    };
    assert_eq!(light(v3(&format!("{sensor}{emitter}"))).sun, expected);
    let still = "<scene version='3.0.0'><emitter type='timed_sunsky'/></scene>";
    assert_eq!(headlines(still), ["the shutter of the sensor opens for no time: the sun stands still"]);
}

#[test]
fn what_is_wrong_is_named() {
    let v3 = |body: &str| format!("<scene version='3.0.0'><emitter type='sunsky'>{body}</emitter></scene>");
    for (body, message) in [
        ("<float name='turbidity' value='0.5'/>", "`turbidity` must lie between 1 and 10, not be 0.5"),
        (
            "<vector name='sun_direction' value='0,0,1'/><float name='hour' value='9'/>",
            "sunsky takes either `sun_direction` or `hour`, not both",
        ),
        ("<vector name='sun_direction' value='0,0,0'/>", "`sun_direction` is zero"),
        (
            "<vector name='sun_direction' value='0,1,-0.1'/>",
            "the sun is below the horizon: the light is black",
        ),
        ("<float name='sun_aperture' value='180'/>", "`sun_aperture` must be below 180 degrees"),
        ("<float name='hour' value='23'/>", "the sun is below the horizon: the light is black"),
    ] {
        assert_eq!(headlines(&v3(body)), [message], "{body}");
    }
    assert_eq!(Transform::IDENTITY, light(crate::v3("<emitter type='sunsky'/>")).to_world);
}

/// Written as Mitsuba 3 says it, and read again, the light is the same.
#[test]
fn lights_survive_their_own_language() {
    let scene = |light: &str| {
        format!(
            "<scene version='3.0.0'><sensor type='perspective'><float name='shutter_open' value='0.25'/>\
             <float name='shutter_close' value='0.75'/></sensor>{light}</scene>"
        )
    };
    let turn = "<transform name='to_world'><rotate x='1' angle='-90'/></transform>";
    for text in [
        format!(
            "<emitter type='sunsky'><vector name='sun_direction' value='0.3, 0.9, 0.2'/><float name='turbidity' value='4.5'/>\
             <float name='sun_aperture' value='2'/><boolean name='complex_sun' value='true'/>{turn}</emitter>"
        ),
        format!(
            "<emitter type='sunsky'><float name='hour' value='9.25'/><float name='sun_scale' value='0.5'/>{turn}</emitter>"
        ),
        format!("<emitter type='timed_sunsky'><float name='window_end_time' value='17'/>{turn}</emitter>"),
    ] {
        let first =
            crate::try_read(&scene(&text), &[], &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
        let written = write_scene(&first, &crate::files(&scene(&text), &[]), Path::new("copy.xml")).unwrap();
        assert!(written.losses.is_empty(), "{:?}", written.losses);
        let again = crate::scene(&written.text);
        assert_eq!(light(first.scene), light(again), "{}", written.text);
    }
}

/// 0.6's sun is written as Mitsuba 3's of the same luminance, and its lower half as a picture.
#[test]
fn old_lights_become_new_ones() {
    let written = |body: &str| {
        let scene = format!("<scene version='0.6.0'><emitter type='sunsky'>{body}</emitter></scene>");
        let read = crate::try_read(&scene, &[], &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
        write_scene(&read, &crate::files(&scene, &[]), Path::new("copy.xml")).unwrap()
    };
    let plain = written("<vector name='sunDirection' x='1' y='1' z='0'/>");
    assert!(
        plain.losses.len() == 1 && plain.losses[0].what.starts_with("the sun of Mitsuba 0.6"),
        "{:?}",
        plain.losses
    );
    let made = light(crate::scene(&plain.text));
    let toward = sun_direction(&made).expect("a direction");
    let new = luminance(Daylight::new(&made, toward, [0.2; 3]).sun().expect("it shines").irradiance());
    let old = SunSky { sun_model: SunModel::Preetham, sun_scale: 1.0, ..made };
    let old = luminance(Daylight::new(&old, toward, [0.2; 3]).sun().expect("it shines").irradiance());
    assert!((new / old - 1.0).abs() < 1e-9, "{new} {old}");
    let extended = written("<boolean name='extend' value='true'/>");
    assert!(extended.text.contains("envmap") && extended.assets.len() == 1, "{}", extended.text);
}
