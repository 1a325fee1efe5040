//! Values and densities against Mitsuba's.

use caustica::bsdf::{Range, Transport};

use super::{NONLINEAR, RHO, bsdf, closure, direction, float, ggx, ggx_uv, material, plastic, rgb, string};

/// The BSDF that a section of the table was measured on.
fn example(name: &str) -> Option<String> {
    let diffuse = bsdf("diffuse", RHO);
    let base = |color: &str| rgb("base_color", color);
    let metal = |material: &str, rest: &str| bsdf("roughconductor", &(string("material", material) + rest));
    Some(match name {
        "diffuse" => diffuse,
        "twosided_diffuse" => bsdf("twosided", &diffuse),
        "plastic" => plastic("plastic", ""),
        "plastic_nonlinear" => plastic("plastic", NONLINEAR),
        "roughplastic_beck_.1" => plastic("roughplastic", ""),
        "roughplastic_ggx_.3" => plastic("roughplastic", &ggx(0.3)),
        "roughplastic_ggx_.3_nl" => plastic("roughplastic", &(ggx(0.3) + NONLINEAR)),
        "roughconductor_Au_beck_.2" => metal("Au", &float("alpha", 0.2)),
        "roughconductor_Au_ggx_.2" => metal("Au", &ggx(0.2)),
        "roughconductor_Al_ggx_.1_.4" => metal("Al", &ggx_uv(0.1, 0.4)),
        "roughconductor_none_beck_.3" => bsdf("roughconductor", &float("alpha", 0.3)),
        "roughdielectric_beck_.2" => bsdf("roughdielectric", &float("alpha", 0.2)),
        "roughdielectric_ggx_.4" => {
            bsdf("roughdielectric", &(ggx(0.4) + &float("int_ior", 1.5) + &float("ext_ior", 1.0)))
        }
        "principled_def" => bsdf("principled", &base("0.2,0.5,0.8")),
        "principled_metal" => {
            bsdf("principled", &(base("0.8,0.5,0.2") + &float("metallic", 1.0) + &float("roughness", 0.3)))
        }
        "principled_glass" => bsdf(
            "principled",
            &(base("0.9,0.9,0.9")
                + &float("spec_trans", 1.0)
                + &float("roughness", 0.3)
                + &float("eta", 1.5)),
        ),
        "principled_clear" => {
            let rest = [
                ("clearcoat", 1.0),
                ("clearcoat_gloss", 0.5),
                ("sheen", 0.5),
                ("flatness", 0.5),
                ("anisotropic", 0.5),
                ("roughness", 0.4),
            ];
            let rest = rest.map(|(name, value)| float(name, value)).concat();
            bsdf("principled", &(base("0.2,0.5,0.8") + &rest))
        }
        "blend_.25" => {
            let color = |c: &str| bsdf("diffuse", &rgb("reflectance", c));
            bsdf("blendbsdf", &(float("weight", 0.25) + &color("1,0,0") + &color("0,1,0")))
        }
        "mask_.3" => bsdf("mask", &(float("opacity", 0.3) + &diffuse)),
        _ => return None,
    })
}

/// f·cosθo in both modes and the density, for nine pairs of directions: relative 1e-4, what five digits of
/// f32 directions leave.
#[test]
fn values_and_densities_match_mitsuba() {
    let near = |got: f32, expected: f32| (got - expected).abs() <= 1e-4 * expected.abs() + 1e-7;
    let (mut scene, mut name, mut rows) = (None, "", 0);
    for line in include_str!("golden.txt").lines().filter(|l| !l.starts_with('#')) {
        if let Some(section) = line.strip_prefix("= ") {
            name = section;
            scene = example(name).map(|b| material(&b));
            continue;
        }
        let Some(scene) = &scene else { continue };
        let row: Vec<f32> = line.split(' ').map(|x| x.parse().unwrap()).collect();
        let (wi, wo) = (direction(row[0], row[1]), direction(row[2], row[3]));
        let c = closure(scene, wi);
        let importance = row.get(8..11).unwrap_or(&row[4..7]);
        for (mode, expected) in [(Transport::Radiance, &row[4..7]), (Transport::Importance, importance)] {
            let f = (c.eval(wi, wo, mode, Range::ALL) * wo.z.abs()).lanes();
            assert!((0..3).all(|k| near(f[k], expected[k])), "{name}, {mode:?}: {f:?} against {line}");
        }
        let pdf = c.pdf(wi, wo, Transport::Radiance, Range::ALL);
        // Mitsuba's default never draws from the clear coat; here it has its share. And Mitsuba states
        // densities behind `principled`, where nothing is scattered.
        let dark = row[4..7] == [0.0; 3];
        let agrees = near(pdf, row[7]) || dark || name == "principled_clear";
        assert!(agrees, "{name}: density {pdf} against {line}");
        rows += 1;
    }
    assert_eq!(rows, 9 * SECTIONS);
}

const SECTIONS: usize = 19;
