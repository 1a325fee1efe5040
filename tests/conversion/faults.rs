//! Conversions that were wrong once: each with the value that is right.

use super::{Difference, Source, asymmetric, mean_of};
use crate::support::picture;

#[track_caller]
fn assert_noise(what: &str, source: &Source) -> super::Converted {
    let made = source.convert();
    let found = Difference::of(source, &made);
    println!("{what}: {found:?}");
    assert!(found.is_noise(), "{what}: {found:?}\n{:#?}\n{}", made.losses, made.text);
    made
}

fn seen(camera: &str, world: &str) -> String {
    format!(
        "<scene version='3.0.0'><integrator type='path'/><sensor type='perspective'>{camera}
         <film type='hdrfilm'><integer name='width' value='40'/><integer name='height' value='24'/>
         <rfilter type='box'/></film></sensor>{world}</scene>"
    )
}

const BOARD: &str = "<shape type='rectangle'><transform name='to_world'><scale value='3'/></transform>
    <bsdf type='twosided'><bsdf type='diffuse'><texture name='reflectance' type='bitmap'>
    <string name='filename' value='t.pfm'/></texture></bsdf></bsdf></shape><emitter type='constant'/>";

/// The window moves with the film: by 0.15 of its width and 0.2 of its height.
#[test]
fn principal_points_become_screen_windows() {
    let camera = "<float name='fov' value='50'/><float name='principal_point_offset_x' value='0.15'/>
        <float name='principal_point_offset_y' value='-0.2'/>
        <transform name='to_world'><lookat origin='0,0,5' target='0,0,0' up='0,1,0'/></transform>";
    let source = Source::new("a.xml", &seen(camera, BOARD), &[("t.pfm", asymmetric(1.0))]);
    let made = assert_noise("principal point", &source);
    let (_, rest) = made.text.split_once("\"float screenwindow\" [").unwrap();
    let window: Vec<f64> = rest.split(']').next().unwrap().split(' ').map(|v| v.parse().unwrap()).collect();
    // ±5/3 and ±1, moved by 0.15·10/3 and by 0.2·2.
    for (found, right) in window.iter().zip([-7.0 / 6.0, 13.0 / 6.0, -0.6, 1.4]) {
        assert!((found - right).abs() < 1e-9, "{window:?}");
    }
}

#[test]
fn screen_windows_become_principal_points() {
    let text = "LookAt 0 0 5 0 0 0 0 1 0\nCamera \"perspective\" \"float fov\" 30 \"float screenwindow\" [-1.2 2.2 -0.6 1.44]\n\
        Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 24\nPixelFilter \"box\"\nSampler \"independent\"\nWorldBegin\n\
        LightSource \"infinite\" \"rgb L\" [1 1 1]\n\
        Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"t.pfm\"\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\n\
        Shape \"bilinearmesh\" \"point3 P\" [-3 -3 0 3 -3 0 -3 3 0 3 3 0]\n";
    let source = Source::new("a.pbrt", text, &[("t.pfm", asymmetric(1.0))]);
    let made = assert_noise("screen window", &source);
    assert!(made.losses.is_empty(), "{:?}", made.losses);
    assert!(made.text.contains("principal_point_offset_x"), "{}", made.text);
}

const VIEW: &str = "<float name='fov' value='60'/><transform name='to_world'>
    <lookat origin='0,1,3.5' target='0,0,0' up='0,1,0'/></transform>";

fn floor(lamp: &str) -> String {
    format!(
        "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/><scale value='2'/><translate y='-1'/></transform>
         <bsdf type='twosided'><bsdf type='diffuse'><rgb name='reflectance' value='0.6'/></bsdf></bsdf></shape>{lamp}"
    )
}

/// pbrt takes the name of a lamp's picture and nothing else: all the rest has to be in the picture.
#[test]
fn lamps_keep_the_reading_of_their_pictures() {
    let lamp = |texture: &str| {
        floor(&format!(
            "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='60'/><translate y='1.2' z='-1'/></transform>
             <emitter type='area'>{texture}</emitter></shape>"
        ))
    };
    let bitmap = |inside: &str| {
        format!(
            "<texture name='radiance' type='bitmap'><string name='filename' value='t.pfm'/>{inside}</texture>"
        )
    };
    let cases = [
        ("plain", bitmap("")),
        ("to_uv", bitmap("<transform name='to_uv'><scale x='3' y='2'/></transform>")),
        ("turned", bitmap("<transform name='to_uv'><rotate z='1' angle='30'/></transform>")),
        (
            "clamped",
            bitmap(
                "<string name='wrap_mode' value='clamp'/><transform name='to_uv'><scale value='1.5'/></transform>",
            ),
        ),
        (
            "mirrored",
            bitmap(
                "<string name='wrap_mode' value='mirror'/><transform name='to_uv'><scale value='2.5'/></transform>",
            ),
        ),
        ("nearest", bitmap("<string name='filter_type' value='nearest'/>")),
        (
            "checkerboard",
            "<texture name='radiance' type='checkerboard'><rgb name='color0' value='0.9,0.3,0'/>
             <transform name='to_uv'><scale x='3' y='2'/></transform></texture>"
                .to_owned(),
        ),
    ];
    for (what, texture) in cases {
        let source = Source::new("a.xml", &seen(VIEW, &lamp(&texture)), &[("t.pfm", asymmetric(5.0))]);
        assert_noise(what, &source);
    }
}

/// The bytes of a picture are sRGB unless it is raw.
#[test]
fn lamps_keep_the_encoding_of_their_pictures() {
    for raw in ["true", "false"] {
        let lamp = floor(&format!(
            "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='60'/><translate y='1.2' z='-1'/></transform>
             <emitter type='area'><texture name='radiance' type='bitmap'><string name='filename' value='t.png'/>
             <boolean name='raw' value='{raw}'/></texture></emitter></shape>"
        ));
        let bytes: Vec<u8> = (0..4 * 3 * 3).map(|i| (i * 7) as u8).collect();
        let png = caustica_formats::image::encode_png(4, 3, &bytes).unwrap();
        assert_noise(raw, &Source::new("a.xml", &seen(VIEW, &lamp), &[("t.png", png)]));
    }
}

#[test]
fn spots_keep_their_texture() {
    let spot = "<emitter type='spot'><rgb name='intensity' value='20,15,10'/><float name='cutoff_angle' value='30'/>
        <texture name='texture' type='bitmap'><string name='filename' value='t.pfm'/></texture>
        <transform name='to_world'><lookat origin='0.5,2,1' target='0,-1,0' up='0,0,1'/></transform></emitter>";
    let source = Source::new("a.xml", &seen(VIEW, &floor(spot)), &[("t.pfm", asymmetric(1.0))]);
    let made = assert_noise("spot", &source);
    assert!(made.losses.is_empty(), "{:?}", made.losses);
}

#[test]
fn projectors_keep_the_place_of_their_picture() {
    let projector = "<emitter type='projector'><float name='fov' value='40'/><float name='scale' value='9'/>
        <texture name='irradiance' type='bitmap'><string name='filename' value='t.pfm'/>
        <transform name='to_uv'><scale x='2'/></transform></texture>
        <transform name='to_world'><lookat origin='0.5,2,1' target='0,-1,0' up='0,0,1'/></transform></emitter>";
    assert_noise(
        "projector",
        &Source::new("a.xml", &seen(VIEW, &floor(projector)), &[("t.pfm", asymmetric(1.0))]),
    );
}

/// A plain raw picture of normals was dropped.
#[test]
fn plain_normal_maps_survive() {
    let texel = |x: usize, _| if x == 0 { [0.9, 0.5, 0.8] } else { [0.5, 0.7, 0.95] };
    let world = "<emitter type='directional'><vector name='direction' value='-1,0,-1'/></emitter><shape type='rectangle'>
        <bsdf type='normalmap'><boolean name='flip_invalid_normals' value='false'/><boolean name='use_shadowing_function' value='false'/>
        <texture name='normalmap' type='bitmap'><boolean name='raw' value='true'/>
        <string name='filename' value='n.pfm'/></texture><bsdf type='diffuse'/></bsdf></shape>";
    let made = assert_noise(
        "normals",
        &Source::new("a.xml", &seen(VIEW, world), &[("n.pfm", picture(2, texel, 2))]),
    );
    assert!(made.text.contains("\"string normalmap\""), "{}", made.text);
}

const PBRT: &str = "LookAt 0 0 4  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" [40]\nPixelFilter \"box\"\nSampler \"independent\"\n\
    Film \"rgb\" \"integer xresolution\" [32] \"integer yresolution\" [32]\nWorldBegin\n\
    LightSource \"infinite\" \"rgb L\" [1 1 1]\n";

/// Mitsuba 3 refuses `roughdielectric` and `roughplastic` with equal indices.
#[test]
fn interfaces_between_equal_indices_are_written_as_what_they_are() {
    let cases = [
        (
            "Material \"dielectric\" \"float eta\" 1 \"float roughness\" 0.2",
            "type=\"dielectric\"",
            "roughdielectric",
        ),
        (
            "Material \"coateddiffuse\" \"float eta\" 1 \"float roughness\" 0.2",
            "type=\"diffuse\"",
            "roughplastic",
        ),
        ("Material \"coatedconductor\" \"float interface.eta\" 1", "conductor", "plastic"),
    ];
    for (material, wanted, refused) in cases {
        let text = format!("{PBRT}{material}\nShape \"sphere\"\n");
        let made = Source::new("a.pbrt", &text, &[]).convert();
        assert!(made.text.contains(wanted) && !made.text.contains(refused), "{}", made.text);
    }
}

/// The wrapped white sphere has albedo 1: a furnace of 1 everywhere, eta 1 or not.
#[test]
fn equal_indices_keep_the_light() {
    let text =
        format!("{PBRT}Material \"dielectric\" \"float eta\" 1 \"float roughness\" 0.2\nShape \"sphere\"\n");
    let made = Source::new("a.pbrt", &text, &[]).convert();
    let mean = mean_of(&made.picture(1).pixel_values());
    assert!((mean - 1.0).abs() < 1e-3, "{mean}");
}

/// Mitsuba 3 draws a stretched sphere as a ball.
#[test]
fn ellipsoids_become_meshes() {
    let text = format!("{PBRT}Material \"diffuse\"\nScale 1 0.4 0.7\nShape \"sphere\"\n");
    let made = assert_noise("ellipsoid", &Source::new("a.pbrt", &text, &[]));
    assert!(made.text.contains("type=\"ply\"") && !made.text.contains("type=\"sphere\""), "{}", made.text);
    let loss = made.losses.iter().find(|loss| loss.what.contains("quadric")).unwrap();
    assert!(loss.instead.contains("0.03 %"), "{loss:?}");
}

/// pbrt mixes materials only; a blend with nothing is an opacity.
#[test]
fn blends_with_nothing_become_opacities() {
    let world = "<emitter type='constant'/><shape type='sphere'><bsdf type='blendbsdf'><float name='weight' value='0.3'/>
        <bsdf type='null'/><bsdf type='twosided'><bsdf type='diffuse'/></bsdf></bsdf></shape>";
    let made = assert_noise("blend", &Source::new("a.xml", &seen(VIEW, world), &[]));
    assert!(made.text.contains("\"float alpha\" 0.3") && !made.text.contains("mix"), "{}", made.text);
}
