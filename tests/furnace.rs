//! Closed white furnaces: walls of albedo ρ that all emit radiance 1 show 1 + ρ + ρ² + … = 1/(1 − ρ)
//! everywhere, and lossless objects inside them are invisible.

use crate::support::{Estimate, area, assert_agree, camera, diffuse, render, scene, sphere};

const WHITE: &str = "0.5";

/// A cube of half size 1, seen from inside at a wall's centre: the view ends 0.23 before the edges,
/// far more than the discs of these photon counts reach (0.05).
fn cube(albedo: &str, inside: &str) -> String {
    format!(
        "{}<shape type='cube'><boolean name='flip_normals' value='true'/>{}{}</shape>{inside}",
        camera("0,0,0", "0,0,1", 75.0, 20),
        diffuse(albedo),
        area("1")
    )
}

/// A sphere needs no boundary correction at all: the cap within a chord r has the area πr² exactly
/// (Archimedes), so every radial kernel is unbiased in the whole picture.
fn ball(albedo: &str, inside: &str) -> String {
    let shell = format!("<boolean name='flip_normals' value='true'/>{}{}", diffuse(albedo), area("1"));
    format!("{}{}{inside}", camera("0,0,0", "0,0,1", 140.0, 20), sphere("0,0,0", 1.0, &shell))
}

/// Within 1 %: there is no bias, and the noise is asserted to be below 1 % / 4.5.
fn check(what: &str, body: &str, albedo: f64, settings: &[(&str, &str)], passes: u32) {
    let picture = render(&scene(body), settings, passes);
    // Everything is grey here.
    assert_agree(what, picture.beauty(1), Estimate::exact(1.0 / (1.0 - albedo)), 0.01);
}

#[test]
fn path_tracing_shows_the_closed_form_at_a_wall_centre() {
    for (text, albedo) in [(WHITE, 0.5), ("0.8", 0.8)] {
        check("cube, path", &cube(text, ""), albedo, &[("integrator", "path")], 512);
    }
}

#[test]
fn photon_mapping_shows_the_closed_form_at_a_wall_centre() {
    for (text, albedo, photons, passes) in [(WHITE, 0.5, "20000", 16), ("0.8", 0.8, "30000", 40)] {
        for nee in ["true", "false"] {
            for kernel in ["constant", "epanechnikov"] {
                check(
                    &format!("cube, albedo {albedo}, nee {nee}, {kernel}"),
                    &cube(text, ""),
                    albedo,
                    &[("nee", nee), ("kernel", kernel), ("photons", photons)],
                    passes,
                );
            }
        }
    }
}

#[test]
fn every_kernel_is_unbiased_on_a_sphere() {
    for kernel in caustica::math::kernel::KernelKind::ALL {
        check(
            &format!("ball, {kernel}"),
            &ball("0.8", ""),
            0.8,
            &[("nee", "false"), ("kernel", kernel.name()), ("photons", "16000")],
            20,
        );
    }
}

/// The k − 1 photons within the distance of the k-th nearest give an unbiased density too.
#[test]
fn nearest_lookups_are_unbiased_on_a_sphere() {
    let settings = [("nee", "false"), ("lookup", "nearest"), ("neighbours", "50"), ("photons", "12000")];
    for mode in ["progressive", "classic"] {
        let mut settings = settings.to_vec();
        settings.push(("mode", mode));
        if mode == "classic" {
            // All passes share one map, so its noise does not show in their scatter; with 2¹⁸ paths it is
            // √(1/(2¹⁸·5)) ≈ 0.1 % of the mean.
            settings.push(("photons", "262144"));
        }
        check(&format!("ball, nearest, {mode}"), &ball("0.8", ""), 0.8, &settings, 16);
    }
}

/// In equilibrium lossless glass and mirrors change nothing. The caustic map blurs the light that passes through
/// the glass, which cancels in the mean over the shell.
#[test]
fn lossless_objects_inside_a_furnace_are_invisible() {
    let glass =
        "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>";
    let mirror = "<bsdf type='conductor'><string name='material' value='none'/></bsdf>";
    for (name, bsdf) in [("glass", glass), ("mirror", mirror)] {
        for z in ["-0.5", "0.5"] {
            // Behind the camera, and in the middle of the view.
            let body = ball("0.5", &sphere(&format!("0,0,{z}"), 0.2, bsdf));
            check(&format!("{name} at {z}, path"), &body, 0.5, &[("integrator", "path")], 256);
            for nee in ["true", "false"] {
                let settings = [("nee", nee), ("photons", "8000"), ("caustic_photons", "8000")];
                check(&format!("{name} at {z}, nee {nee}"), &body, 0.5, &settings, 48);
            }
        }
    }
}
