//! Materials of pbrt-v3 against the values of its own code.

use caustica::bsdf::{Range, Transport};

use super::{closure, direction, of_pbrt_material};
use crate::support::{assert_agree, pbrt_scene_seen, render};

const GOLDEN: &str = include_str!("version3.txt");

/// Lambertian and cosine lobes on both sides behind an index of 1.3, which obey reciprocity at all nodes.
pub const TABLE: &[u8] = include_bytes!("../fuzz-corpus/bsdf/rgb.bsdf");

/// The materials that the table was made with.
const MATERIALS: [(&str, &str); 13] = [
    ("uber", r#"Material "uber" "rgb Kd" [.2 .5 .6] "rgb Ks" [.3 .3 .3]"#),
    (
        "uber, brushed",
        r#"Material "uber" "rgb Kd" [.2 .5 .6] "rgb Ks" [.3 .3 .3] "rgb Kr" [.1 .1 .1]
           "float uroughness" .05 "float vroughness" .3 "float index" 1.33"#,
    ),
    (
        "uber, plain roughness",
        r#"Material "uber" "rgb Kd" [.2 .5 .6] "rgb Ks" [.3 .3 .3] "float roughness" .25 "float eta" 1.8
           "bool remaproughness" false"#,
    ),
    (
        "translucent",
        r#"Material "translucent" "rgb Kd" [.2 .5 .6] "rgb Ks" [.3 .4 .1] "float roughness" .2
           "rgb reflect" [.4 .5 .6] "rgb transmit" [.6 .3 .2]"#,
    ),
    ("substrate", r#"Material "substrate" "rgb Kd" [.2 .5 .6] "rgb Ks" [.1 .05 .2]"#),
    (
        "substrate, brushed",
        r#"Material "substrate" "rgb Kd" [.2 .5 .6] "rgb Ks" [.1 .05 .2]
           "float uroughness" .05 "float vroughness" .3"#,
    ),
    ("matte", r#"Material "matte" "rgb Kd" [.2 .5 .6] "float sigma" 25"#),
    ("plastic", r#"Material "plastic" "rgb Kd" [.2 .5 .6] "rgb Ks" [.3 .3 .3]"#),
    (
        "disney",
        r#"Material "disney" "rgb color" [.2 .5 .8] "float speculartint" .7 "float sheen" .5 "float flatness" .5"#,
    ),
    (
        "disney, half metal",
        r#"Material "disney" "rgb color" [.8 .5 .2] "float metallic" .4 "float roughness" .3
           "float speculartint" .5 "float anisotropic" .5 "float sheen" .3"#,
    ),
    (
        "disney, metal",
        r#"Material "disney" "rgb color" [.8 .5 .2] "float metallic" 1 "float roughness" .3
           "float anisotropic" .5"#,
    ),
    (
        "disney, glass",
        r#"Material "disney" "rgb color" [.8 .5 .2] "float eta" 1.4 "float roughness" .4 "float spectrans" 1"#,
    ),
    ("fourier", r#"Material "fourier" "string bsdffile" "table.bsdf""#),
];

/// What the laws are tested on: little enough of each lobe that no light is made where pbrt-v3 could.
pub const EXAMPLES: &[(&str, &str)] = &[
    ("pbrt-v3 uber", MATERIALS[1].1),
    (
        "pbrt-v3 uber, transparent",
        r#"Material "uber" "rgb Kd" [.1 .2 .3] "rgb Ks" [.2 .2 .2] "rgb Kr" [.3 .3 .3] "rgb Kt" [.5 .4 .3]
           "rgb opacity" [.7 .7 .7]"#,
    ),
    ("pbrt-v3 translucent", MATERIALS[3].1),
    ("pbrt-v3 substrate", MATERIALS[5].1),
    ("pbrt-v3 plastic", MATERIALS[7].1),
    (
        "pbrt-v3 disney",
        r#"Material "disney" "rgb color" [.8 .5 .2] "float metallic" .4 "float roughness" .6
           "float anisotropic" .5 "float sheen" .3"#,
    ),
    (
        "pbrt-v3 disney, translucent sheet",
        r#"Material "disney" "rgb color" [.2 .4 .5] "bool thin" true "float spectrans" .3 "float roughness" .6
           "float anisotropic" .4"#,
    ),
    ("pbrt-v3 fourier, transparent", MATERIALS[12].1),
];

/// f·cosθo in both modes for nine pairs of directions: relative 1e-4, what f32 leaves in both programs.
#[test]
fn values_match_pbrt_v3() {
    let near = |got: f32, expected: f32| (got - expected).abs() <= 1e-4 * expected.abs() + 1e-6;
    let (mut scene, mut name, mut rows) = (None, "", 0);
    for line in GOLDEN.lines().filter(|l| !l.starts_with('#')) {
        if let Some(section) = line.strip_prefix("= ") {
            name = section;
            let (_, material) =
                MATERIALS.iter().find(|(known, _)| *known == name).expect("a material of the list");
            scene = Some(of_pbrt_material(material));
            continue;
        }
        let scene = scene.as_ref().expect("a section comes first");
        let row: Vec<f32> = line.split(' ').map(|x| x.parse().expect("a number")).collect();
        let (wi, wo) = (direction(row[0], row[1]), direction(row[2], row[3]));
        // Behind an opaque surface `disney` is what it is before it.
        if name.starts_with("disney") && name != "disney, glass" && wi.z < 0.0 {
            continue;
        }
        let c = closure(scene, wi);
        for (mode, expected) in [(Transport::Radiance, &row[4..7]), (Transport::Importance, &row[7..10])] {
            // Here photons see what cameras see; between its nodes a table need not be the same from both ends.
            if name == "fourier" && mode == Transport::Importance {
                continue;
            }
            let f = (c.eval(wi, wo, mode, Range::ALL) * wo.z.abs()).lanes();
            assert!((0..3).all(|k| near(f[k], expected[k])), "{name}, {mode:?}: {f:?} against {line}");
        }
        rows += 1;
    }
    assert_eq!(rows, 9 * 10 + 7 * 3);
}

/// A ball of each on a floor, with a lamp: photons and camera paths meet it from both ends. Maps blur what they hold:
/// 64 passes leave less than 1 %, and 4.5 times the noise of both is less than 3 %.
#[test]
fn photon_maps_show_what_paths_show() {
    for (name, material) in EXAMPLES {
        let scene = pbrt_scene_seen(
            "LookAt 0 -5 2.5 0 0 .6 0 0 1 Camera \"perspective\" \"float fov\" 30 \
             Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 16",
            &format!(
                "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [9 9 9] Translate 2 -2 4 \
                 Shape \"sphere\" \"float radius\" 1 AttributeEnd \
                 Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \
                 \"point3 P\" [-4 -4 0  4 -4 0  4 4 0  -4 4 0] \
                 {material} Translate 0 0 .8 Shape \"sphere\" \"float radius\" .8"
            ),
            vec![("table.bsdf", TABLE.to_vec())],
        );
        let photons = render(&scene, &[("integrator", "photonmap"), ("max_depth", "7")], 64);
        let paths = render(&scene, &[("integrator", "path"), ("max_depth", "7")], 512);
        (0..3).for_each(|c| assert_agree(name, photons.beauty(c), paths.beauty(c), 0.03));
    }
}
