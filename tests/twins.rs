//! Every scene of `scenes/` exists in both languages, written by hand, and both give the same picture.

use std::path::{Path, PathBuf};

use caustica::session::{Options, Session};
use caustica_formats::files::Disk;
use caustica_formats::ir::{
    self, BsdfKind, Coat, Color, ColorInput, ConductorMaterial, Dielectric, EmitterKind, FloatInput, Ior,
    Microfacet, MicrofacetDistribution, RoughnessRemap, Shadowing, SpotFalloff,
};
use caustica_formats::{ReadOptions, read_scene};

use crate::support::{Picture, Stage, render};

/// Scenes that pbrt cannot express completely; the first comment of each .pbrt says why.
const DIFFERENT: &[&str] = &[
    "cornell-glass",
    "cornell-owner",
    "caustic-spot",
    "lamps",
    "plastic",
    "sky",
    "spot-cone",
    "thindielectric",
];

const PASSES: u32 = 16;
const SIDE: u32 = 48;

fn scenes() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut found = Vec::new();
    for folder in [root.clone(), root.join("hard"), root.join("reference"), root.join("media")] {
        found.extend(std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()));
    }
    found.retain(|path| path.is_file());
    found.sort();
    found
}

fn extension(path: &Path) -> &str {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default()
}

#[test]
fn every_scene_exists_in_both_languages() {
    for path in scenes() {
        let other = match extension(&path) {
            "xml" => "pbrt",
            "pbrt" => "xml",
            _ => continue,
        };
        assert!(path.with_extension(other).is_file(), "{} has no twin in .{other}", path.display());
    }
}

fn read(path: &Path) -> ir::Scene {
    let read = read_scene(&Disk, path, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    assert!(read.warnings.is_empty(), "{}", read.sources.render(&read.warnings));
    read.scene
}

fn picture(mut scene: ir::Scene, seed: &str) -> Picture {
    let film = &mut scene.sensors[0].film;
    (film.width, film.height) = (SIDE, SIDE);
    let session = Session::of(scene, &Disk, Path::new("twin"), &Options::default());
    render(
        &Stage(session.unwrap_or_else(|e| panic!("{e}"))),
        &[("integrator", "path"), ("max_depth", "100"), ("seed", seed)],
        PASSES,
    )
}

/// Root of the mean square difference of two pictures.
fn rmse(a: &Picture, b: &Picture) -> f64 {
    let (a, b) = (a.pixel_values(), b.pixel_values());
    let squares = a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| (a - b).powi(2));
    (squares.sum::<f64>() / a.as_flattened().len() as f64).sqrt()
}

/// Replaces what pbrt cannot express by what the twin has instead, and changes nothing else.
fn replace_by_pbrt_models(scene: &mut ir::Scene, twin: &ir::Scene) {
    let white = || ColorInput::Color(Color::Gray(1.0));
    let ids: Vec<_> = scene.bsdfs.iter().map(|(id, _)| id).collect();
    for id in ids {
        let kind = &mut scene.bsdfs[id].kind;
        match kind {
            // Clear glass.
            BsdfKind::Dielectric(d) | BsdfKind::ThinDielectric(d) => {
                *d = Dielectric {
                    specular_reflectance: white(),
                    specular_transmittance: white(),
                    ..d.clone()
                };
            }
            // A metal with the mirror's colour at normal incidence.
            BsdfKind::Conductor(c) if c.material == ConductorMaterial::Mirror => {
                let color = std::mem::replace(&mut c.specular_reflectance, white());
                c.material = ConductorMaterial::Reflectance(color);
            }
            BsdfKind::Plastic(plastic) => {
                let smooth = Microfacet {
                    distribution: MicrofacetDistribution::Ggx,
                    alpha_u: FloatInput::Value(0.0),
                    alpha_v: FloatInput::Value(0.0),
                    sample_visible: true,
                    shadowing: Shadowing::HeightCorrelated,
                    remap: RoughnessRemap::None,
                };
                let coat = Coat {
                    eta: plastic.int_ior.clone(),
                    microfacet: smooth,
                    thickness: FloatInput::Value(0.0),
                    albedo: ColorInput::Color(Color::Gray(0.0)),
                    g: FloatInput::Value(0.0),
                    max_depth: 10,
                    samples: 1,
                };
                assert!(matches!(coat.eta, Ior::Value(_)));
                *kind = BsdfKind::CoatedDiffuse { reflectance: plastic.diffuse_reflectance.clone(), coat };
            }
            _ => {}
        }
    }
    // A picture, and a parallel light for the sun.
    if scene.emitters.iter().any(is_sky) {
        scene.emitters.clone_from(&twin.emitters);
    }
    for emitter in &mut scene.emitters {
        if let EmitterKind::Spot { falloff, .. } = &mut emitter.kind {
            *falloff = SpotFalloff::Smoothstep;
        }
    }
}

fn is_sky(emitter: &ir::Emitter) -> bool {
    matches!(emitter.kind, EmitterKind::SunSky(_))
}

#[test]
fn twins_give_the_same_picture() {
    let mut bits = Vec::new();
    for path in scenes().into_iter().filter(|path| extension(path) == "xml") {
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let twin = read(&path.with_extension("pbrt"));
        let mut scene = read(&path);
        // pbrt has no clip planes. Nothing is clipped in these scenes, but rays start at the near plane.
        let (from, to) = (&twin.sensors[0], &mut scene.sensors[0]);
        (to.near_clip, to.far_clip) = (from.near_clip, from.far_clip);
        let pbrt = picture(twin.clone(), "1");
        let plain = picture(scene.clone(), "1");
        if scene.emitters.iter().any(is_sky) {
            // The picture of the sky goes on below the horizon, where the formula is black: less than 1 % of the light.
            for channel in 0..3 {
                let (formula, seen) = (plain.beauty(channel), pbrt.beauty(channel));
                let bound = 0.01 * formula.mean + crate::support::SIGMAS * formula.sigma.hypot(seen.sigma);
                assert!((seen.mean - formula.mean).abs() <= bound, "{name}: {seen:?} and {formula:?}");
            }
        }
        replace_by_pbrt_models(&mut scene, &twin);
        let (mitsuba, other) = (picture(scene.clone(), "1"), picture(scene, "2"));
        let (found, noise) = (rmse(&pbrt, &mitsuba), rmse(&mitsuba, &other));
        println!("{name}: {found:e} of {noise:e} noise");
        // Rounding (matrices are composed and triangles listed in another order) sends some light paths
        // elsewhere. If it were all of them, the pictures would differ by the noise between two seeds.
        assert!(found <= noise, "{name}: {found} against {noise} of noise");
        for channel in 0..3 {
            let (difference, whole) = (pbrt.beauty(channel), mitsuba.beauty(channel));
            let sigma = difference.sigma.hypot(whole.sigma);
            let off = difference.mean - whole.mean;
            assert!(off.abs() <= crate::support::SIGMAS * sigma, "{name}: {difference:?} and {whole:?}");
        }
        if found == 0.0 {
            bits.push(name.clone());
        }
        let differs = rmse(&pbrt, &plain) > noise || pbrt.pixel_values() != plain.pixel_values();
        if DIFFERENT.contains(&name.as_str()) {
            assert!(differs, "{name} does not differ from its twin: take it off the list");
        } else {
            assert_eq!(plain.pixel_values(), mitsuba.pixel_values(), "{name} differs from its twin");
        }
    }
    println!("the same to the last bit: {bits:?}");
}
