//! Direct light in closed form.

use std::f64::consts::PI;

use caustica::film::Layer;

use crate::support::{
    DOWN, Estimate, Stage, area, assert_agree, camera, diffuse, pbrt_scene_seen, rectangle, render, scene,
    sphere,
};

/// A patch of a large white plane around the origin, seen from above through one narrow pixel: 0.002
/// wide, over which the irradiances below change by less than 10⁻³.
fn plane(lamp: &str) -> Stage {
    let floor = rectangle(50.0, "", &diffuse("0.5"));
    scene(&format!("{}{floor}{lamp}", camera("0,0.0001,10", "0,0,0", 0.011, 1)))
}

/// The radiance of the patch is ρE/π. With next event estimation and a delta light the only noise is that of
/// the position within the patch.
fn check(what: &str, lamp: &str, irradiance: f64, passes: u32) {
    let scene = plane(lamp);
    let expected = Estimate::exact(0.5 * irradiance / PI);
    let path = render(&scene, &[("integrator", "path"), ("max_depth", "2")], passes);
    assert_agree(&format!("{what}, path"), path.beauty(0), expected, 0.003);
    let mapped = render(&scene, &[("max_depth", "2")], passes);
    assert_agree(&format!("{what}, next event"), mapped.beauty(0), expected, 0.003);
}

#[test]
fn irradiance_of_delta_lights_is_exact() {
    let point = "<emitter type='point'><point name='position' value='3,0,4'/><rgb name='intensity' value='10'/></emitter>";
    // E = I·cosθ/d², cosθ = 4/5, d² = 25.
    check("point", point, 10.0 * 0.8 / 25.0, 32);
    let sun = "<emitter type='directional'><vector name='direction' value='0.6,0,-0.8'/><rgb name='irradiance' value='2'/></emitter>";
    check("directional", sun, 2.0 * 0.8, 32);
    // 17.5° off the axis of a spot that falls off linearly in the angle from 15° to 20°: half the intensity.
    let angle = 17.5f64.to_radians();
    let spot = format!(
        "<emitter type='spot'><transform name='to_world'><lookat origin='0,0,2' target='{},0,0' up='0,1,0'/></transform>
         <rgb name='intensity' value='10'/><float name='cutoff_angle' value='20'/><float name='beam_width' value='15'/></emitter>",
        2.0 * angle.tan()
    );
    check("spot", &spot, 10.0 * 0.5 / 4.0, 1024);
    // Mitsuba's projector gives π·irradiance/z² on the plane at depth z.
    let projector = "<emitter type='projector'><transform name='to_world'><lookat origin='0,0,2' target='0.3,0.2,0' up='0,1,0'/></transform>
         <float name='fov' value='60'/><rgb name='irradiance' value='0.7'/></emitter>";
    // The patch is straight below at distance 2, at the angle θ to the axis with cosθ = 2/√4.13. The intensity
    // there is π·E/cos³θ, and the cosine at the floor is 1.
    let cos = 2.0 / 4.13f64.sqrt();
    check("projector", projector, PI * 0.7 / cos.powi(3) / 4.0, 32);
    // A beam of 0.7 W/m² straight down.
    let beam = "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='180'/><translate z='11'/></transform>
         <emitter type='directionalarea'><rgb name='radiance' value='0.7'/></emitter></shape>";
    check("directionalarea", beam, 0.7, 32);
}

/// A Lambertian disc lamp of radius a at height h over the patch: E = πL·a²/(a² + h²). Under
/// a constant sky: E = πL.
#[test]
fn irradiance_of_area_lights_is_exact() {
    let disk = format!(
        "<shape type='disk'><transform name='to_world'><rotate x='1' angle='180'/><translate z='1'/></transform>{}</shape>",
        area("3")
    );
    // The camera is below the lamp, whose back would hide the patch.
    let floor = rectangle(50.0, "", &diffuse("0.5"));
    let view = camera("0,0.0001,0.9", "0,0,0", 1.0, 8);
    let disk_scene = scene(&format!("{view}{floor}{disk}"));
    let sky = "<emitter type='constant'><rgb name='radiance' value='2'/></emitter>";
    let sky_scene = scene(&format!("{view}{floor}{sky}"));
    for (what, scene, irradiance) in [("disk", disk_scene, PI * 3.0 * 0.5), ("constant", sky_scene, PI * 2.0)]
    {
        let expected = Estimate::exact(0.5 * irradiance / PI);
        for integrator in ["path", "photonmap"] {
            let settings = [("integrator", integrator), ("max_depth", "2")];
            let got = render(&scene, &settings, 1 << 12).estimate(&[Layer::Direct], 0);
            // For noise, as measured; there is no bias, since the patch is only 0.016 wide.
            assert_agree(&format!("{what}, {integrator}"), got, expected, 0.005);
        }
    }
}

/// A point light in the middle of a diffuse sphere: E = I/R² everywhere, and with all bounces
/// L = ρE/(π(1 − ρ)); photon densities on a sphere are unbiased (see `furnace`).
#[test]
fn a_point_light_in_a_diffuse_sphere_lights_it_evenly() {
    let shell = format!("<boolean name='flip_normals' value='true'/>{}", diffuse("0.6"));
    let light = "<emitter type='point'><rgb name='intensity' value='4'/></emitter>";
    let scene =
        scene(&format!("{}{}{light}", camera("0,0,0.001", "0,0,1", 140.0, 20), sphere("0,0,0", 2.0, &shell)));
    let direct = 0.6 * 4.0 / 4.0 / PI;
    let all = Estimate::exact(direct / (1.0 - 0.6));
    let photons = ("photons", "16384");
    for (what, settings, passes) in [
        ("path", &[("integrator", "path")][..], 512),
        ("next event", &[photons][..], 24),
        ("photons only", &[photons, ("nee", "false")][..], 24),
    ] {
        let picture = render(&scene, settings, passes);
        assert_agree(what, picture.beauty(1), all, 0.01);
        assert_agree(what, picture.estimate(&[Layer::Direct], 1), Estimate::exact(direct), 0.01);
    }
}

/// A rectangle emits from its front only: the side it does not face stays black.
#[test]
fn lamps_emit_from_their_front_only() {
    let floor = rectangle(5.0, "<rotate x='1' angle='-90'/><translate y='-1'/>", &diffuse("0.5"));
    let view = camera("0,0,3", "0,-1,0", 10.0, 4);
    let lit = |turn: &str| {
        let lamp = rectangle(0.5, &format!("{turn}<translate y='1'/>"), &area("3"));
        let scene = scene(&format!("{view}{floor}{lamp}"));
        ["path", "photonmap"].map(|i| render(&scene, &[("integrator", i)], 16).beauty(0).mean)
    };
    assert!(lit(DOWN).iter().all(|&l| l > 0.01));
    assert_eq!(lit("<rotate x='1' angle='-90'/>"), [0.0; 2]);
}

/// Opacity cuts the light of a pbrt lamp as it cuts the lamp: by half, by half of its places, and by a texture
/// that leaves one half of it. Opacity 0 makes it invisible, and it shines. Relative to lamps that are whole,
/// so that only noise is left; seen by camera rays, by shadow rays, and by photons.
#[test]
fn opacity_cuts_the_light_of_a_lamp() {
    let stage = |texture: &str, corner: f64, shape: &str| {
        let lamp = format!(
            "AttributeBegin\n{texture}\nAreaLightSource \"diffuse\" \"rgb L\" [ 2 2 2 ]\nShape \"trianglemesh\" \"point3 P\" \
             [ -1 2 -1 {corner} 2 -1 {corner} 2 1 -1 2 1 ] \"integer indices\" [ 0 1 2 0 2 3 ] \
             \"point2 uv\" [ 0 0 1 0 1 1 0 1 ] {shape}\nAttributeEnd\n"
        );
        let floor = "Shape \"trianglemesh\" \"point3 P\" [ -3 0 -3 3 0 -3 3 0 3 -3 0 3 ] \"integer indices\" [ 0 2 1 0 3 2 ]";
        let view = "LookAt 0 3 6 0 0 0 0 1 0\nCamera \"perspective\" \"float fov\" 40\n\
                    Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nPixelFilter \"box\"";
        pbrt_scene_seen(view, &format!("{lamp}{floor}"), vec![])
    };
    let checks = "Texture \"a\" \"float\" \"checkerboard\" \"float uscale\" 2 \"float vscale\" 0.5 \
                  \"float tex1\" 1 \"float tex2\" 0";
    let (whole, half) = (stage("", 1.0, ""), stage("", 0.0, ""));
    for (how, changes) in [
        ("path", &[("integrator", "path"), ("max_depth", "2")][..]),
        ("next event", &[("max_depth", "2")]),
        ("photons", &[("max_depth", "2"), ("nee", "false"), ("photons", "20000")]),
    ] {
        let direct = |stage: &Stage| render(stage, changes, 256).estimate(&[Layer::Direct], 1);
        let (all, some) = (direct(&whole), direct(&half));
        let scaled = |e: Estimate, factor: f64| Estimate { mean: e.mean * factor, sigma: e.sigma * factor };
        for (what, cut, expected) in [
            ("opacity 0.5", stage("", 1.0, "\"float alpha\" 0.5"), scaled(all, 0.5)),
            ("opacity 0", stage("", 1.0, "\"float alpha\" 0"), all),
            ("half", stage(checks, 1.0, "\"texture alpha\" \"a\""), some),
        ] {
            assert_agree(&format!("{what}, {how}"), direct(&cut), expected, 0.03);
        }
    }
}

/// In Mitsuba 3 a spectrum of 0.6 is (0.723, 0.569, 0.545) as the radiance of a lamp, and gray in a texture, be it that of a
/// lamp (3.9.1: area, spot).
#[test]
fn spectra_in_textures_of_lamps_have_no_tint() {
    let radiance = |inside: &str| {
        let lamp = rectangle(1.0, "", &format!("<emitter type='area'>{inside}</emitter>"));
        let stage = scene(&format!("{}{lamp}", camera("0,0,3", "0,0,0", 10.0, 2)));
        let seen = render(&stage, &[("integrator", "path")], 1);
        [0, 1, 2].map(|channel| seen.beauty(channel).mean as f32)
    };
    let [r, g, b] = radiance("<spectrum name='radiance' value='0.6'/>");
    assert!(
        (r - 0.7229).abs() < 1e-3 && (g - 0.5689).abs() < 1e-3 && (b - 0.5456).abs() < 1e-3,
        "{r} {g} {b}"
    );
    let spectrum = "<spectrum name='color0' value='0.6'/><spectrum name='color1' value='0.6'/>";
    let checks = format!("<texture type='checkerboard' name='radiance'>{spectrum}</texture>");
    assert_eq!(radiance(&checks), [0.6; 3]);
}
