//! Which part of the scene a pixel shows: crop, filters, focus, clip planes, projection.

use crate::support::{
    Estimate, Picture, UP, area, assert_agree, camera, diffuse, film, rectangle, render, scene,
};

/// A lamp facing the camera, which looks along −z.
fn panel(half: f64, place: &str, radiance: &str) -> String {
    rectangle(half, place, &area(radiance))
}

const EMISSION: &[(&str, &str)] = &[("max_depth", "1")];

#[test]
fn a_crop_shows_the_pixels_of_the_whole_film() {
    let crop = "<integer name='crop_offset_x' value='5'/><integer name='crop_offset_y' value='3'/>
                <integer name='crop_width' value='6'/><integer name='crop_height' value='7'/>";
    let body = |film: &str| {
        format!(
            "<sensor type='perspective'><float name='fov' value='42'/><transform name='to_world'>
             <lookat origin='0,0,3.6' target='0,0,0' up='0,1,0'/></transform>{film}</sensor>{}{}",
            crate::support::walls("0.6"),
            crate::support::lamp(0.4, "3")
        )
    };
    let whole_film = film(16, 16);
    let whole = scene(&body(&whole_film));
    let part = scene(&body(&whole_film.replace("</film>", &format!("{crop}</film>"))));
    assert_eq!(part.0.view.film.crop, [5, 3, 6, 7]);
    // Photon counts, radii and numbers of samples are given, because the automatic ones depend on the rendered film.
    let given = [("photons", "2000"), ("radius", "0.1"), ("nee", "false"), ("camera_samples", "4")];
    for settings in [&[("integrator", "path")][..], &given] {
        let (all, some) = (render(&whole, settings, 3), render(&part, settings, 3));
        for y in 0..7 {
            for x in 0..6 {
                let (a, b) = (all.pixels.numbers((y + 3) * 16 + x + 5), some.pixels.numbers(y * 6 + x));
                assert_eq!(a, b, "pixel {x}, {y}");
            }
        }
    }
}

/// Half of the film shows a lamp of radiance 1. Filters are symmetric, so the mean is ½ for each of
/// them, with negative lobes or without. Noise as measured, at most 1 % / 4.5.
#[test]
fn every_filter_keeps_the_mean() {
    let lamp = panel(2.0, "<translate x='-2'/>", "1");
    for row in caustica::session::Filter::NAMED {
        let name = row.name;
        let view = camera("0,0,3", "0,0,0", 30.0, 16).replace("type='box'", &format!("type='{name}'"));
        let picture = render(&scene(&format!("{view}{lamp}")), EMISSION, 2048);
        assert_agree(name, picture.beauty(0), Estimate::exact(0.5), 0.01);
    }
}

fn values(picture: &Picture) -> Vec<f64> {
    picture.pixel_values().iter().map(|p| p[0]).collect()
}

/// A lamp covers exactly the middle 4 × 4 of 8 × 8 pixels: at the focus distance every pixel is 0 or 1 however
/// wide the lens, at other distances the edge is blurred. Rounding may move a ray across the edge: with 256
/// samples per pixel, this changes a pixel by less than 1e-2.
#[test]
fn only_the_plane_of_focus_is_sharp() {
    let view = |focus: f64| {
        format!(
            "<sensor type='thinlens'><float name='fov' value='90'/><float name='aperture_radius' value='0.3'/>
             <float name='focus_distance' value='{focus}'/><transform name='to_world'>
             <lookat origin='0,0,2' target='0,0,0' up='0,1,0'/></transform>{}</sensor>",
            film(8, 8)
        )
    };
    let lamp = panel(1.0, "", "1");
    let sharp = values(&render(&scene(&format!("{}{lamp}", view(2.0))), EMISSION, 256));
    for (i, v) in sharp.iter().enumerate() {
        let inside = (2..6).contains(&(i % 8)) && (2..6).contains(&(i / 8));
        assert!((v - f64::from(u8::from(inside))).abs() < 0.01, "pixel {i}: {v}");
    }
    let blurred = values(&render(&scene(&format!("{}{lamp}", view(1.0))), EMISSION, 256));
    let between = blurred.iter().filter(|v| (0.1..0.9).contains(*v)).count();
    assert!(between > 12, "{between} pixels at the edge are blurred");
    // The lamp covers a quarter of the film.
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    assert!((mean(&sharp) - 0.25).abs() < 1e-3);
}

#[test]
fn nothing_is_seen_nearer_than_the_near_clip_or_beyond_the_far_clip() {
    let lamps =
        format!("{}{}", panel(1.0, "<translate z='1'/>", "1"), panel(8.0, "<translate z='-3'/>", "5"));
    let seen = |near: f64, far: f64| {
        let view = camera("0,0,2", "0,0,0", 20.0, 4).replace(
            "<transform",
            &format!(
                "<float name='near_clip' value='{near}'/><float name='far_clip' value='{far}'/><transform"
            ),
        );
        render(&scene(&format!("{view}{lamps}")), EMISSION, 2).beauty(0).mean
    };
    assert_eq!(seen(0.5, 100.0), 1.0);
    assert_eq!(seen(1.1, 100.0), 5.0);
    assert_eq!(seen(1.1, 4.9), 0.0);
}

/// The film is ±2 units wide at any distance: a lamp of ±1 covers its middle half, and one of ±1.5 farther
/// back, at the right edge of the view, the rest of the right side. The camera looks along −z, so +x is on the
/// right.
#[test]
fn an_orthographic_camera_shows_the_same_scale_at_any_distance() {
    let view = format!(
        "<sensor type='orthographic'><transform name='to_world'><scale x='2' y='2'/>
         <lookat origin='0,0,5' target='0,0,0' up='0,1,0'/></transform>{}</sensor>",
        film(8, 4)
    );
    let lamps = format!("{}{}", panel(1.0, "", "1"), panel(1.5, "<translate x='1.5' z='-40'/>", "0.25"));
    let seen = values(&render(&scene(&format!("{view}{lamps}")), EMISSION, 16));
    for (i, v) in seen.iter().enumerate() {
        // The film is twice as wide as high: y spans ±1.
        let expected = match i % 8 {
            0 | 1 => 0.0,
            2..=5 => 1.0,
            _ => 0.25,
        };
        assert!((v - expected).abs() < 1e-6, "pixel {i}: {v}");
    }
}

/// Its pixel is the radiance along one ray. A diffuse floor lit by a point lamp sends ρ/π·I·cosθ/d² of it: here the ray
/// ends 2 below the lamp and 1.5 aside, past a mirror at 45°. The lamp is reached by a shadow ray, so there is no noise;
/// 0.1 % is for single precision.
#[test]
fn a_radiancemeter_measures_radiance_along_its_ray() {
    let meter = format!(
        "<sensor type='radiancemeter'><point name='origin' value='-3,1,0'/>
         <vector name='direction' value='1,0,0'/>{}</sensor>",
        film(1, 1)
    );
    let mirror = rectangle(
        0.2,
        "<rotate y='1' angle='90'/><rotate z='1' angle='-135'/><translate value='1.5,1,0'/>",
        "<bsdf type='twosided'><bsdf type='conductor'><string name='material' value='none'/></bsdf></bsdf>",
    );
    let floor = rectangle(5.0, UP, &diffuse("0.6"));
    let lamp = "<emitter type='point'><point name='position' value='0,2,0'/>
                <rgb name='intensity' value='3'/></emitter>";
    let stage = scene(&format!("{meter}{mirror}{floor}{lamp}"));
    let square = 2.0f64 * 2.0 + 1.5 * 1.5;
    let expected = 0.6 / std::f64::consts::PI * 3.0 * (2.0 / square.sqrt()) / square;
    for settings in [&[("integrator", "path")][..], &[("max_depth", "3")][..]] {
        let picture = render(&stage, settings, 4);
        assert_agree("radiancemeter", picture.beauty(0), Estimate::exact(expected), 0.001);
    }
}
