//! Where nothing is absorbed and all around shines with radiance 1, radiance is 1 everywhere: whatever scatters,
//! however often, in whatever directions.

use super::{container, dense_fog, eye, fog, hg, shows, vol};
use crate::support::{Stage, render, scene, scene_with_bytes, sphere};

const SKY: &str = "<emitter type='constant'><rgb name='radiance' value='1,1,1'/></emitter>";
const GLASS: &str =
    "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>";

/// Unbiased: only the noise, which is asserted to be below the bound over 4.5.
fn check(what: &str, stage: &Stage, bound: f64) {
    shows(what, &render(stage, &[("integrator", "path")], 512), [1.0; 3], bound);
}

#[test]
fn fog_without_absorption_is_invisible_under_an_even_sky() {
    let phases = [
        ("isotropic", String::new()),
        ("hg 0.9", hg(0.9)),
        ("hg -0.6", hg(-0.6)),
        ("rayleigh", "<phase type='rayleigh'/>".to_owned()),
        ("table", "<phase type='tabphase'><string name='values' value='1, 0.1, 0.1, 2'/></phase>".to_owned()),
        (
            "blend",
            format!(
                "<phase type='blendphase'><float name='weight' value='0.3'/>{}<phase type='rayleigh'/></phase>",
                hg(0.5)
            ),
        ),
    ];
    for (name, phase) in phases {
        let fog = container("", &fog("interior", "0.3,1,0.7", "1,1,1", &phase));
        check(name, &scene(&[eye("0,0,-4", 40.0, 8, ""), SKY.to_owned(), fog].concat()), 0.02);
    }
}

/// Flakes on fibres, which block light along and across the fibre differently, and send it on by their normals.
#[test]
fn fibres_without_absorption_are_invisible() {
    for stddev in [0.05, 0.4, 2.0] {
        let medium = format!(
            "<medium type='heterogeneous' name='interior'>
             <volume name='density' type='constvolume'><float name='value' value='1.5'/></volume>
             <volume name='albedo' type='constvolume'><spectrum name='value' value='1'/></volume>
             <volume name='orientation' type='constvolume'><vector name='value' x='1' y='2' z='0.5'/></volume>
             <phase type='microflake'><float name='stddev' value='{stddev}'/></phase></medium>"
        );
        let body = [eye("0,0,-4", 40.0, 8, ""), SKY.to_owned(), container("", &medium)].concat();
        let stage = crate::support::scene_of_version("0.6.0", &body);
        check(&format!("fibres of {stddev}"), &stage, 0.03);
    }
}

/// Mean free paths from a thousandth of the box to a thousand of them, and the whole scene from 10⁻⁴ to 10⁴ in size.
#[test]
fn neither_size_nor_density_matters() {
    for (size, depth) in [(1e-4, 1.0), (1e4, 1.0), (1.0, 1e-3), (1.0, 30.0), (1e4, 1e-3)] {
        let fog = container(
            &format!("<scale value='{size}'/>"),
            &dense_fog("interior", depth / size, "1,1,1", &hg(0.3)),
        );
        let eye = eye(&format!("0,0,{}", -4.0 * size), 40.0, 6, "");
        check(&format!("size {size}, depth {depth}"), &scene(&[eye, SKY.to_owned(), fog].concat()), 0.04);
    }
}

/// A mean free path of a thousandth of the box: a walk of a million steps to the other side, and albedo exactly 1. The
/// render ends, and what it shows is what came back by walks of the length that roulette lets them have.
#[test]
fn dense_media_without_absorption_end() {
    let fog = container("", &dense_fog("interior", 1000.0, "1,1,1", ""));
    let stage = scene(&[eye("0,0,-4", 40.0, 2, ""), SKY.to_owned(), fog].concat());
    let mean = render(&stage, &[("integrator", "path")], 16).beauty(1).mean;
    assert!(mean > 0.8 && mean < 1.2, "{mean}");
}

/// A grid with cells that are empty and cells that are dense, of three channels.
#[test]
fn grids_without_absorption_are_invisible() {
    let bytes = vol([4, 4, 4], 3, |[x, y, z]| {
        (0..3)
            .map(|c| {
                if (x + y * 3 + z * 5) % 3 == 0 {
                    0.0
                } else {
                    ((x * 7 + y * 3 + z + c * 2) % 5) as f32 * 0.2
                }
            })
            .collect()
    });
    for filter in ["trilinear", "nearest"] {
        let medium = format!(
            "<medium type='heterogeneous' name='interior'><float name='scale' value='3'/>
             <volume type='gridvolume' name='sigma_t'><string name='filename' value='a.vol'/><boolean name='raw' value='true'/>
             <string name='filter_type' value='{filter}'/><transform name='to_world'><scale value='2'/><translate value='-1,-1,-1'/></transform></volume>
             <float name='albedo' value='1'/>{}</medium>",
            hg(0.5)
        );
        let body = [eye("0,0,-4", 40.0, 8, ""), SKY.to_owned(), container("", &medium)].concat();
        check(filter, &scene_with_bytes(&body, vec![("a.vol", bytes.clone())]), 0.03);
    }
}

/// Glass with a medium inside touching fog outside, a box of fog that shares a face with another, spheres of fog in
/// fog: all that is nested or touches.
#[test]
fn nested_and_touching_media_are_invisible() {
    let outer = |name| fog(name, "0.3,0.2,0.4", "1,1,1", &hg(0.5));
    let inner = |name| fog(name, "1,0.6,0.8", "1,1,1", "");
    let both = |a: String, b: String| format!("{a}{b}");
    let scenes = [
        (
            "glass in fog",
            [
                container("<scale value='2'/>", &outer("interior")),
                sphere("0,0,0", 0.8, &format!("{GLASS}{}", both(inner("interior"), outer("exterior")))),
            ],
        ),
        (
            "boxes that touch",
            [
                container("<translate x='-1'/>", &inner("interior")),
                container("<translate x='1'/>", &outer("interior")),
            ],
        ),
        (
            "fog in fog",
            [
                container("<scale value='1.5'/>", &outer("interior")),
                sphere(
                    "0.2,0,0",
                    0.7,
                    &format!("<bsdf type='null'/>{}", both(inner("interior"), outer("exterior"))),
                ),
            ],
        ),
    ];
    for (name, parts) in scenes {
        check(name, &scene(&[eye("0,0,-5", 40.0, 8, ""), SKY.to_owned(), parts.concat()].concat()), 0.02);
    }
}

/// The camera in a medium, in one shared with a box around it; and a lamp all around, as a surface of the fog's.
#[test]
fn a_camera_may_stand_in_fog() {
    let medium = |name| fog(name, "0.5,0.3,0.9", "1,1,1", &hg(0.2));
    let inside =
        [eye("0,0,0", 60.0, 8, &medium("medium")), SKY.to_owned(), container("", &medium("interior"))];
    check("in a box", &scene(&inside.concat()), 0.02);
    let shell = "<boolean name='flip_normals' value='true'/><bsdf type='diffuse'><rgb name='reflectance' value='0,0,0'/></bsdf>
                 <emitter type='area'><rgb name='radiance' value='1,1,1'/></emitter>";
    let around = [
        eye("0,0,0", 60.0, 8, &medium("medium")),
        sphere("0,0,0", 2.0, &format!("{shell}{}", medium("exterior"))),
    ];
    check("in a lamp", &scene(&around.concat()), 0.02);
}
