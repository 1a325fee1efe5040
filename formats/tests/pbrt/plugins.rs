//! What directives mean.

use std::f64::consts::PI;

use caustica_formats::ir::{
    BsdfKind, Color, ColorInput, ConductorMaterial, EmitterKind, Filter, FloatInput, Mapping, PartialQuadric,
    Projection, RoughnessRemap, Scalar, ShapeKind, TextureKind,
};

use crate::{problems, scene, world};

fn near(a: [f64; 3], b: [f64; 3]) {
    // Sines and inverses of a few matrices, in f64.
    assert!((0..3).all(|i| (a[i] - b[i]).abs() < 1e-12), "{a:?} {b:?}");
}

/// pbrt's camera space has +X on the right, ours on the left.
#[test]
fn the_camera_stands_and_looks_where_it_should() {
    let scene =
        scene("LookAt 1 2 3  1 2 0  0 1 0 Camera \"perspective\" WorldBegin LightSource \"infinite\"");
    let camera = &scene.sensors[0];
    near(camera.to_world.point([0.0; 3]), [1.0, 2.0, 3.0]);
    near(camera.to_world.vector([0.0, 0.0, 1.0]), [0.0, 0.0, -1.0]);
    near(camera.to_world.vector([0.0, 1.0, 0.0]), [0.0, 1.0, 0.0]);
    // Right in pbrt is up × forward = −x here; our +X is the other way.
    near(camera.to_world.vector([1.0, 0.0, 0.0]), [1.0, 0.0, 0.0]);
    assert_eq!(camera.film.width, 1280);
    assert_eq!(camera.film.filter, Filter::TruncatedGaussian { sigma: 0.5, radius: [1.5; 2] });
    assert_eq!(camera.sampler.sample_count, 16);
}

#[test]
fn an_orthographic_camera_shows_one_unit_of_the_shorter_side() {
    let head = "Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 100 Camera \"orthographic\"";
    let scene = scene(&format!("{head} WorldBegin LightSource \"infinite\""));
    let camera = &scene.sensors[0];
    assert_eq!(camera.projection, Projection::Orthographic);
    // Ours sees y in ±1/aspect = ±1/2 of its local frame, which is scaled by 2.
    near(camera.to_world.vector([0.0, 0.5, 0.0]), [0.0, 1.0, 0.0]);
}

#[test]
fn exposure_and_crop() {
    let film = "Film \"rgb\" \"integer xresolution\" 10 \"integer yresolution\" 10 \"float iso\" 200 \
                \"float cropwindow\" [.25 .75 0 1]";
    let camera = "Camera \"perspective\" \"float shutterclose\" 3";
    let scene = scene(&format!("{film} {camera} WorldBegin LightSource \"infinite\""));
    let film = &scene.sensors[0].film;
    assert_eq!(film.imaging_ratio, 6.0);
    assert_eq!(film.white_balance, None);
    let crop = film.crop.unwrap();
    assert_eq!((crop.x, crop.width, crop.height), (3, 5, 10));
}

#[test]
fn white_balance_is_a_temperature() {
    let film = |kelvin: &str| {
        format!("Film \"rgb\" \"float whitebalance\" {kelvin} WorldBegin LightSource \"infinite\"")
    };
    assert_eq!(scene(&film("5000")).sensors[0].film.white_balance, Some(5000.0));
    let said = problems(&film("12"));
    assert!(said.iter().any(|p| p.contains("12 K is not a daylight temperature")), "{said:?}");
}

#[test]
fn bounces_are_one_less_than_segments() {
    let scene = scene(
        "Integrator \"sppm\" \"integer maxdepth\" 7 \"float radius\" .5 \
         Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 4 WorldBegin LightSource \"infinite\"",
    );
    let integrator = scene.integrator.unwrap();
    let value = |name: &str| integrator.settings[name].value.clone();
    assert_eq!(value("max_depth"), Scalar::Integer(8));
    assert_eq!(value("initial_radius"), Scalar::Float(0.5));
    assert_eq!(value("photon_count"), Scalar::Integer(32));
}

#[test]
fn transforms_apply_to_what_follows_and_end_with_their_scope() {
    let scene = world(
        "AttributeBegin Translate 1 0 0 Scale 2 2 2 Shape \"sphere\" AttributeEnd Shape \"sphere\" \
         CoordinateSystem \"here\" Translate 5 0 0 CoordSysTransform \"here\" Shape \"sphere\"",
    );
    near(scene.shapes[0].to_world.point([1.0, 0.0, 0.0]), [3.0, 0.0, 0.0]);
    near(scene.shapes[1].to_world.point([1.0, 0.0, 0.0]), [1.0, 0.0, 0.0]);
    near(scene.shapes[2].to_world.point([1.0, 0.0, 0.0]), [1.0, 0.0, 0.0]);
}

#[test]
fn matrices_are_listed_by_columns() {
    let scene = world("Transform [1 0 0 0  0 1 0 0  0 0 1 0  7 8 9 1] Shape \"sphere\"");
    near(scene.shapes[0].to_world.point([0.0; 3]), [7.0, 8.0, 9.0]);
}

/// A point light of intensity I emits 4πI; a spot's smoothstep rim counts half.
#[test]
fn lights_of_a_given_power() {
    let scene = world("LightSource \"point\" \"rgb I\" [1 2 3] \"float power\" 10 \"float scale\" 2");
    let EmitterKind::Point { intensity: Color::Rgb(rgb), .. } = &scene.emitters[1].kind else { panic!() };
    near(*rgb, [1.0, 2.0, 3.0].map(|c| c * 20.0 / (4.0 * PI)));
    let scene = world(
        "LightSource \"spot\" \"rgb I\" [1 1 1] \"float power\" 1 \"float coneangle\" 90 \
         \"float conedeltaangle\" 30 \"point3 from\" [0 5 0] \"point3 to\" [0 0 0]",
    );
    let EmitterKind::Spot { intensity: Color::Rgb(rgb), to_world, cutoff_angle, beam_width, .. } =
        &scene.emitters[1].kind
    else {
        panic!()
    };
    // 2π((1 − ½) + (½ − 0)/2) = 3π/2.
    near(*rgb, [2.0 / (3.0 * PI); 3]);
    near(to_world.vector([0.0, 0.0, 1.0]), [0.0, -1.0, 0.0]);
    assert_eq!((*cutoff_angle, *beam_width), (90.0, 60.0));
}

#[test]
fn emission_spectra_have_luminance_one() {
    let scene = world(
        "LightSource \"distant\" \"blackbody L\" 3000 \"float scale\" 3 \"point3 from\" [0 0 1] \"point3 to\" [0 0 0]",
    );
    let EmitterKind::Directional { direction, irradiance } = &scene.emitters[1].kind else { panic!() };
    assert_eq!(*direction, [0.0, 0.0, -1.0]);
    assert!(matches!(irradiance, Color::WithLuminance { luminance, .. } if *luminance == 3.0));
}

#[test]
fn opaque_materials_are_two_sided() {
    let scene = world(
        "Material \"conductor\" \"float roughness\" .25 Shape \"sphere\" Material \"dielectric\" Shape \"sphere\"",
    );
    let kind = |i: usize| &scene.bsdfs[scene.shapes[i].bsdf.unwrap()].kind;
    let BsdfKind::TwoSided { front, back: None } = kind(0) else { panic!() };
    let BsdfKind::RoughConductor { conductor, microfacet } = &scene.bsdfs[*front].kind else { panic!() };
    assert_eq!(microfacet.alpha_u, FloatInput::Value(0.25));
    assert_eq!(microfacet.remap, RoughnessRemap::Sqrt);
    let ConductorMaterial::EtaK { eta, .. } = &conductor.material else { panic!() };
    assert_eq!(*eta, ColorInput::Color(Color::Library("metal-Cu-eta".to_owned())));
    assert!(matches!(kind(1), BsdfKind::Dielectric(_)));
}

#[test]
fn a_named_material_may_be_used_before_it_is_made() {
    let scene = world(
        "NamedMaterial \"m\" Shape \"sphere\" MakeNamedMaterial \"m\" \"string type\" \"thindielectric\"",
    );
    let kind = &scene.bsdfs[scene.shapes[0].bsdf.unwrap()].kind;
    assert!(matches!(kind, BsdfKind::ThinDielectric(_)));
}

/// t = 0 is the bottom row of the image, v = 0 our top one.
#[test]
fn images_are_turned_upside_down() {
    let scene = world(
        "Texture \"w\" \"spectrum\" \"imagemap\" \"string filename\" \"wood.png\" \"float vscale\" 2 \
         \"float udelta\" .5",
    );
    let TextureKind::Bitmap(bitmap) = &scene.textures.iter().next().unwrap().1.kind else { panic!() };
    let Mapping::Uv(m) = bitmap.mapping else { panic!() };
    near(m.point([0.25, 0.25, 0.0]), [0.75, 0.5, 0.0]);
    near(m.point([0.0; 3]), [0.5, 1.0, 0.0]);
}

#[test]
fn whole_quadrics_are_plain_unless_their_uv_matter() {
    let scene = world(
        "Shape \"sphere\" \"float radius\" 3 Shape \"disk\" \"float height\" 2 \"float radius\" 3 \
         Shape \"cylinder\" \"float phimax\" 90 \
         Texture \"c\" \"spectrum\" \"checkerboard\" Material \"diffuse\" \"texture reflectance\" \"c\" Shape \"sphere\"",
    );
    let kinds: Vec<_> = scene.shapes.iter().map(|s| s.kind.clone()).collect();
    assert!(matches!(kinds[0], ShapeKind::Sphere { radius: 3.0, .. }));
    assert!(matches!(kinds[1], ShapeKind::Disk));
    near(scene.shapes[1].to_world.point([1.0, 0.0, 0.0]), [3.0, 0.0, 2.0]);
    assert!(matches!(kinds[2], ShapeKind::Partial(PartialQuadric::Cylinder { phi_max: 90.0, .. })));
    assert!(matches!(kinds[3], ShapeKind::Partial(PartialQuadric::Sphere { .. })));
}

#[test]
fn a_file_of_its_own_keeps_its_normals_only() {
    let scene = world("Shape \"plymesh\" \"string filename\" \"mesh.ply\"");
    let ShapeKind::Mesh(file) = &scene.shapes[0].kind else { panic!() };
    assert!(file.authored_normals && !file.face_normals);
}

#[test]
fn objects_and_instances() {
    let scene = world(
        "Translate 1 0 0 ObjectBegin \"o\" Translate 0 1 0 Shape \"sphere\" ObjectEnd \
         Translate 0 0 5 ObjectInstance \"o\"",
    );
    let ShapeKind::Instance { group } = scene.shapes[0].kind else { panic!() };
    let inner = &scene.groups[group].shapes[0];
    near(scene.shapes[0].to_world.after(&inner.to_world).point([0.0; 3]), [2.0, 1.0, 5.0]);
}

#[test]
fn includes_share_the_state_and_imports_do_not() {
    let scene = world("Translate 1 0 0 Include \"ball.pbrt\" Import \"ball.pbrt\" Shape \"sphere\"");
    assert_eq!(scene.shapes.len(), 3);
    near(scene.shapes[1].to_world.point([0.0; 3]), [1.0, 0.0, 0.0]);
}

#[test]
fn attributes_give_defaults() {
    let scene = world(
        "Attribute \"shape\" \"float radius\" 4 Shape \"sphere\" Shape \"sphere\" \"float radius\" 2 \
         Shape \"plymesh\" \"string filename\" \"mesh.ply\"",
    );
    assert!(matches!(scene.shapes[0].kind, ShapeKind::Sphere { radius: 4.0, .. }));
    assert!(matches!(scene.shapes[1].kind, ShapeKind::Sphere { radius: 2.0, .. }));
}

#[test]
fn an_interface_does_not_shine_and_a_lamp_may_turn() {
    let scene = world(
        "AreaLightSource \"diffuse\" \"rgb L\" [1 2 3] \"float scale\" 2 \"bool twosided\" true \
         ReverseOrientation Shape \"sphere\"",
    );
    let emission = scene.shapes[0].emission.as_ref().unwrap();
    assert!(emission.two_sided && emission.scale == 2.0 && scene.shapes[0].flip_normals);
    let dark = problems(
        "WorldBegin LightSource \"infinite\"\nAreaLightSource \"diffuse\" Material \"interface\" Shape \"sphere\"",
    );
    assert_eq!(
        dark,
        ["scene.pbrt:2:17: a shape with material `interface` does not emit light: the area light is ignored"]
    );
}
