//! Scenes of pbrt-v3 and before: what they mean by their own rules.

use caustica_formats::ir::{
    BsdfKind, Color, ColorInput, ConductorMaterial, Dielectric, EmitterKind, EnvironmentMapping, Filter,
    FloatInput, Ior, Mapping, Scalar, Scene, ShapeKind, SpotFalloff, TextureKind,
};
use caustica_formats::{Read, ReadOptions};

use crate::{problems, try_read};

fn read(head: &str, body: &str) -> Read {
    let text = format!("{head} WorldBegin LightSource \"infinite\"\n{body}\nWorldEnd\n");
    try_read(&text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// The scene, of which nothing is said but that it is old.
fn silent(head: &str, body: &str) -> Scene {
    let read = read(head, body);
    assert_eq!(read.warnings.len(), 1, "{}", read.sources.render(&read.warnings));
    assert!(read.warnings[0].message.contains("read by the rules of pbrt-v3"));
    read.scene
}

/// What is said of `body` beside the note, line and column first.
fn said(body: &str) -> Vec<String> {
    let all = problems(&format!("WorldBegin LightSource \"infinite\"\n{body}\nWorldEnd"));
    let said: Vec<_> = all.iter().filter(|p| !p.contains("which is read by the rules")).cloned().collect();
    assert_eq!(all.len(), said.len() + 1, "{all:?}");
    said
}

fn material(text: &str) -> (Scene, BsdfKind) {
    let scene = silent("", &format!("{text} Shape \"sphere\""));
    let kind = match &scene.bsdfs[scene.shapes[0].bsdf.expect("shapes have one")].kind {
        BsdfKind::TwoSided { front, .. } => scene.bsdfs[*front].kind.clone(),
        other => other.clone(),
    };
    (scene, kind)
}

fn lamp(text: &str) -> EmitterKind {
    silent("", text).emitters[1].kind.clone()
}

#[test]
fn an_old_scene_is_named_once() {
    let old = "Film \"image\" \"integer xresolution\" 8 WorldBegin LightSource \"point\" \"color I\" [1 1 1]\n\
        Material \"matte\" \"color Kd\" [.2 .3 .4] Shape \"sphere\"\nWorldEnd\n";
    let note = "a scene of pbrt-v3 or before (film `image`), which is read by the rules of pbrt-v3";
    assert_eq!(problems(old), [format!("scene.pbrt:1:6: {note}")]);
}

/// A word of pbrt-v3 in a scene of pbrt-v4 changes the meaning of nothing else.
#[test]
fn one_old_word_does_not_make_a_new_scene_old() {
    let text = "Film \"rgb\" WorldBegin LightSource \"infinite\"\nTransformBegin Material \"conductor\" TransformEnd\n\
        Shape \"sphere\" \"float radus\" 1 WorldEnd";
    assert_eq!(
        problems(text),
        [
            "scene.pbrt:3:16: shape `sphere` takes no parameter `radus` (did you mean `radius`?)",
            "scene.pbrt:2:1: TransformBegin acts as AttributeBegin in pbrt-v4",
            "scene.pbrt:3:32: `WorldEnd` is of pbrt-v3; pbrt-v4 does not read it",
        ]
    );
}

/// A sampler is changed soon: the lights and materials around it say what was meant.
#[test]
fn one_new_setting_does_not_make_an_old_scene_new() {
    let old = "Film \"image\" Sampler \"independent\" WorldBegin LightSource \"infinite\" \"rgb L\" [ 1 .5 .25 ]\n\
        Material \"matte\" \"rgb Kd\" [.2 .3 .4] Shape \"sphere\"";
    assert_eq!(
        problems(old),
        [
            "scene.pbrt:1:22: sampler `independent` is of pbrt-v4; pbrt-v3 does not read it",
            "scene.pbrt:1:6: a scene of pbrt-v3 or before (film `image`), which is read by the rules of pbrt-v3",
        ]
    );
    // A material of pbrt-v4 would be another one in pbrt-v3.
    let new = problems(&old.replace("matte", "diffuse"));
    assert!(
        new.iter().any(|text| text.ends_with("film `image` is of pbrt-v3; pbrt-v4 does not read it")),
        "{new:?}"
    );
}

#[test]
fn glass_is_tinted_on_both_sides_and_rough_by_two_numbers() {
    let (_, kind) =
        material("Material \"glass\" \"rgb Kr\" [.5 .5 .5] \"rgb Kt\" [.1 .2 .3] \"float index\" 1.3");
    let BsdfKind::Dielectric(Dielectric { int_ior, specular_reflectance, specular_transmittance, .. }) = kind
    else {
        panic!("{kind:?}")
    };
    assert_eq!(int_ior, Ior::Value(1.3));
    assert_eq!(specular_reflectance, ColorInput::Color(Color::Rgb([0.5; 3])));
    assert_eq!(specular_transmittance, ColorInput::Color(Color::Rgb([0.1, 0.2, 0.3])));
    let (_, kind) =
        material("Material \"glass\" \"float uroughness\" .2 \"float vroughness\" .1 \"float eta\" 2");
    assert!(matches!(kind, BsdfKind::RoughDielectric { .. }), "{kind:?}");
}

#[test]
fn a_mirror_reflects_the_same_from_everywhere() {
    let (_, kind) = material("Material \"mirror\"");
    let BsdfKind::Conductor(mirror) = kind else { panic!("{kind:?}") };
    assert_eq!(mirror.material, ConductorMaterial::Mirror);
    assert_eq!(mirror.specular_reflectance, ColorInput::Color(Color::Gray(0.9)));
}

/// pbrt-v3's `amount` weighs the first material, pbrt-v4's the second, which is what the IR has.
#[test]
fn a_mix_weighs_the_first_also_by_a_texture_of_colours() {
    let parts = "MakeNamedMaterial \"a\" \"string type\" \"mirror\" MakeNamedMaterial \"b\" \"string type\" \"glass\"\n\
        Texture \"t\" \"color\" \"imagemap\" \"string filename\" \"wood.png\"\n";
    let mix = "Material \"mix\" \"string namedmaterial1\" \"a\" \"string namedmaterial2\" \"b\"";
    for (amount, constant) in
        [("\"rgb amount\" [.2 .2 .2]", Some(0.2)), ("", Some(0.5)), ("\"texture amount\" \"t\"", None)]
    {
        let (scene, kind) = material(&format!("{parts}{mix} {amount}"));
        let BsdfKind::Blend { weight, first, second } = kind else { panic!("{kind:?}") };
        assert!(matches!(scene.bsdfs[first].kind, BsdfKind::Dielectric(_)));
        assert_eq!(scene.bsdfs[second].name.as_deref(), Some("a"));
        match (weight, constant) {
            (FloatInput::Value(v), Some(right)) => assert!((v - right).abs() < 1e-12, "{v}"),
            (FloatInput::Texture(id), None) => {
                assert!(matches!(scene.textures[id].kind, TextureKind::Bitmap(_)))
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn a_scale_texture_multiplies_two_colours() {
    let (scene, _) = material(
        "Texture \"w\" \"color\" \"imagemap\" \"string filename\" \"wood.png\" \"bool gamma\" \"false\"\n\
         Texture \"s\" \"color\" \"scale\" \"texture tex1\" \"w\" \"rgb tex2\" [.1 .2 .3]\n\
         Material \"matte\" \"texture Kd\" \"s\"",
    );
    let scale = scene.textures.iter().find_map(|(_, texture)| match &texture.kind {
        TextureKind::Scale { value, factor } => Some((value.clone(), factor.clone())),
        _ => None,
    });
    let (ColorInput::Texture(id), factor) = scale.expect("there is one") else { panic!() };
    assert!(matches!(scene.textures[id].kind, TextureKind::Bitmap(_)));
    assert_eq!(factor, ColorInput::Color(Color::Rgb([0.1, 0.2, 0.3])));
}

/// pbrt-v4 scales the spectra of lights to luminance 1; pbrt-v3 takes them as they are, its blackbodies with a peak of 1.
#[test]
fn spectra_of_lights_are_taken_as_they_are() {
    use caustica_formats::ir::{ColorSlot, SpectrumRule};
    use caustica_formats::spectrum::{luminance, to_linear_rgb};
    let y = |text: &str| {
        let EmitterKind::Directional { irradiance, .. } = lamp(&format!("LightSource \"distant\" {text}"))
        else {
            panic!()
        };
        luminance(to_linear_rgb(&irradiance, ColorSlot::Emission, SpectrumRule::Pbrt).expect("a colour"))
    };
    // The peak of 3000 K is in the infrared: by the curves of CIE 1931 the luminance is 0.416, ± 0.5 % of their fit.
    assert!((y("\"blackbody L\" [3000 1.5]") / (1.5 * 0.4164) - 1.0).abs() < 5e-3);
    assert!((y("\"blackbody L\" [3000 1] \"rgb scale\" [2 2 2]") / (2.0 * 0.4164) - 1.0).abs() < 5e-3);
    // Equal energy of 7 has Y = 7; the ends of the samples are all but invisible.
    assert!((y("\"spectrum L\" [360 7 830 7]") / 7.0 - 1.0).abs() < 1e-3);
    let EmitterKind::Point { intensity, .. } =
        lamp("LightSource \"point\" \"color I\" [1 2 3] \"color scale\" [2 1 .5]")
    else {
        panic!()
    };
    assert_eq!(intensity, Color::Rgb([2.0, 2.0, 1.5]));
    let area = silent(
        "",
        "AreaLightSource \"area\" \"color L\" [1 2 3] \"color scale\" [2 2 2] \"integer nsamples\" 4 Shape \"sphere\"",
    );
    let emission = area.shapes[0].emission.as_ref().expect("it shines");
    assert_eq!((&emission.radiance, emission.scale), (&ColorInput::Color(Color::Rgb([2.0, 4.0, 6.0])), 1.0));
}

#[test]
fn pictures_of_lights() {
    let projection = "LightSource \"projection\" \"color I\" [10 10 10] \"string mapname\" \"wood.png\"";
    let EmitterKind::Projection { image, fov, .. } = lamp(projection) else { panic!() };
    assert_eq!((image.scale, fov), (10.0, 45.0));
    let map = "LightSource \"infinite\" \"string mapname\" \"wood.png\"";
    let EmitterKind::Environment { image, mapping, .. } = lamp(&format!("{map} \"blackbody L\" [6500 0]"))
    else {
        panic!()
    };
    assert_eq!((image.scale, mapping), (0.0, EnvironmentMapping::LatLong));
    let coloured = read("", &format!("{map} \"rgb L\" [1 .5 .25] \"rgb scale\" [2 2 2]"));
    let EmitterKind::Environment { image, .. } = &coloured.scene.emitters[1].kind else { panic!() };
    assert!((image.scale - 2.0 * 1.75 / 3.0).abs() < 1e-12, "{}", image.scale);
    let lost = "the colour (2.0000, 1.0000, 0.5000) of a light with a picture is left out: its mean is kept";
    assert!(coloured.warnings.iter().any(|d| d.message == lost), "{:?}", coloured.warnings);
    let refused = said("LightSource \"goniometric\" \"string mapname\" \"wood.png\"");
    assert!(
        refused[0].contains("latitude-longitude picture of a goniometric light is not supported"),
        "{refused:?}"
    );
}

/// pbrt-v3 applies `from` of a point light after the transform, and a spot's rim falls with the fourth power.
#[test]
fn places_and_rims_of_lights() {
    let EmitterKind::Point { position, .. } =
        lamp("Translate 1 0 0 Rotate 90 0 0 1 Scale 2 2 2 LightSource \"point\" \"point from\" [1 2 3]")
    else {
        panic!()
    };
    assert_eq!(position, [2.0, 2.0, 3.0]);
    let EmitterKind::Spot { falloff, cutoff_angle, beam_width, .. } = lamp("LightSource \"spot\"") else {
        panic!()
    };
    assert_eq!((falloff, cutoff_angle, beam_width), (SpotFalloff::Quartic, 30.0, 25.0));
}

#[test]
fn camera_film_and_filter() {
    // The shutter moves things and exposes nothing.
    let head = "Film \"image\" \"float scale\" 2 Camera \"perspective\" \"float halffov\" 20 \"float shutterclose\" .25";
    let camera = &silent(head, "").sensors[0];
    assert_eq!(camera.film.imaging_ratio, 2.0);
    assert_eq!(camera.film.filter, Filter::Box { radius: 0.5 });
    assert!(format!("{:?}", camera.projection).contains("40.0"), "{:?}", camera.projection);
    let gauss = &silent("PixelFilter \"gaussian\" \"float xwidth\" 3", "").sensors[0];
    assert_eq!(gauss.film.filter, Filter::TruncatedGaussian { radius: [3.0, 2.0], sigma: 0.5 });
}

#[test]
fn photon_mapping_counts_its_own_iterations() {
    let sppm = |given: &str| {
        let scene = silent(&format!("Integrator \"sppm\" {given}"), "");
        scene.integrator.expect("there is one").settings["max_passes"].value.clone()
    };
    assert_eq!(sppm(""), Scalar::Integer(64));
    assert_eq!(sppm("\"integer numiterations\" 5"), Scalar::Integer(5));
    assert_eq!(sppm("\"integer iterations\" 7"), Scalar::Integer(7));
}

/// TransformBegin saves the transform alone, and names end with their scope.
#[test]
fn scopes() {
    let scene = silent(
        "",
        "TransformBegin Translate 5 0 0 Material \"mirror\" TransformEnd Shape \"sphere\"\n\
         MakeNamedMaterial \"m\" \"string type\" \"glass\"\n\
         AttributeBegin NamedMaterial \"m\" AttributeEnd NamedMaterial \"m\" Shape \"sphere\"",
    );
    assert_eq!(scene.shapes[0].to_world.point([0.0; 3]), [0.0; 3]);
    let BsdfKind::TwoSided { front, .. } = scene.bsdfs[scene.shapes[0].bsdf.expect("one")].kind else {
        panic!()
    };
    assert!(matches!(scene.bsdfs[front].kind, BsdfKind::Conductor(_)));
    let ended =
        "AttributeBegin MakeNamedMaterial \"m\" \"string type\" \"glass\" AttributeEnd\nNamedMaterial \"m\"";
    assert_eq!(
        said(ended),
        [
            "scene.pbrt:3:15: no material named `m`: the material stays as it is (MakeNamedMaterial defines one)"
        ]
    );
}

#[test]
fn names_may_be_given_again() {
    let read = read(
        "",
        "MakeNamedMaterial \"m\" \"string type\" \"glass\" NamedMaterial \"m\" Shape \"sphere\"\n\
         MakeNamedMaterial \"m\" \"string type\" \"mirror\" NamedMaterial \"m\" Shape \"sphere\"\n\
         ObjectBegin \"o\" Shape \"sphere\" ObjectEnd ObjectInstance \"o\"\n\
         ObjectBegin \"o\" Shape \"disk\" ObjectEnd ObjectInstance \"o\"",
    );
    let again: Vec<_> = read.warnings.iter().filter(|d| d.message.contains("defined twice")).collect();
    assert_eq!(again.len(), 2, "{:?}", read.warnings);
    let kind = |i: usize| &read.scene.bsdfs[read.scene.shapes[i].bsdf.expect("one")].kind;
    assert!(matches!(kind(0), BsdfKind::Dielectric(_)) && matches!(kind(1), BsdfKind::TwoSided { .. }));
    let first = |i: usize| {
        let ShapeKind::Instance { group } = read.scene.shapes[i].kind else { panic!() };
        read.scene.groups[group].shapes[0].kind.clone()
    };
    assert!(matches!(first(2), ShapeKind::Sphere { .. }) && matches!(first(3), ShapeKind::Disk));
}

/// Only what is 0 lets light through, and shadows are those of what is seen.
#[test]
fn cut_out_shapes() {
    let mesh = "Shape \"trianglemesh\" \"point P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]";
    let alpha = |text: &str| silent("", &format!("{mesh} {text}")).shapes[0].alpha.clone();
    assert_eq!(alpha("\"float alpha\" .5"), None);
    assert_eq!(alpha("\"float alpha\" 0 \"float shadowalpha\" 0"), Some(FloatInput::Value(0.0)));
    assert_eq!(
        said(&format!("{mesh} \"float shadowalpha\" 0")),
        ["scene.pbrt:2:78: `shadowalpha` is ignored: shadows are those of what is seen"]
    );
    let uv = silent("", &format!("{mesh} \"float uv\" [0 0 1 0 0 1]"));
    let ShapeKind::Inline(mesh) = &uv.shapes[0].kind else { panic!() };
    assert_eq!(mesh.uvs[1], [1.0, 0.0]);
}

#[test]
fn images_are_as_dark_as_their_gamma_says() {
    let scene = material("Texture \"w\" \"color\" \"imagemap\" \"string filename\" \"wood.png\" \"bool gamma\" \"false\" \"bool trilinear\" \"true\" Material \"matte\" \"texture Kd\" \"w\"").0;
    let TextureKind::Bitmap(bitmap) = &scene.textures.iter().next().expect("one").1.kind else { panic!() };
    assert_eq!(bitmap.encoding, caustica_formats::ir::TextureEncoding::Linear);
    assert!(matches!(bitmap.mapping, Mapping::Uv(_)));
}

#[test]
fn materials_of_the_first_versions() {
    let all = said("Material \"bluepaint\" Shape \"sphere\" Material \"shinymetal\" Shape \"sphere\"");
    assert_eq!(
        all,
        [
            "scene.pbrt:2:10: material `bluepaint` of old versions is approximated: only its diffuse part is rendered",
            "scene.pbrt:2:46: material `shinymetal` of old versions is approximated: the mirror on top of its gloss is left out",
        ]
    );
    let volume = said("Volume \"homogeneous\" \"color sigma_a\" [1 1 1]");
    assert!(volume[0].contains("participating medium `homogeneous` is not supported"), "{volume:?}");
}

/// As pbrt-v3: the shape's own colour, for this shape only.
#[test]
fn shapes_may_change_their_material() {
    let scene = silent(
        "",
        "Material \"mirror\" \"rgb Kr\" [.5 .5 .5] Shape \"sphere\" \"rgb Kr\" [.1 .2 .3] Shape \"sphere\"",
    );
    let tint = |i: usize| {
        let BsdfKind::TwoSided { front, .. } = scene.bsdfs[scene.shapes[i].bsdf.expect("one")].kind else {
            panic!()
        };
        let BsdfKind::Conductor(mirror) = &scene.bsdfs[front].kind else { panic!() };
        mirror.specular_reflectance.clone()
    };
    assert_eq!(tint(0), ColorInput::Color(Color::Rgb([0.1, 0.2, 0.3])));
    assert_eq!(tint(1), ColorInput::Color(Color::Rgb([0.5; 3])));
}

/// pbrt-v3 makes gray spectra of noise; pbrt-v4 has it as floats only.
#[test]
fn noise_may_be_a_spectrum() {
    for kind in ["fbm", "windy", "wrinkled"] {
        let text = format!("Texture \"t\" \"spectrum\" \"{kind}\" Material \"matte\" \"texture Kd\" \"t\"");
        let (scene, kind) = material(&text);
        let BsdfKind::Diffuse { reflectance: ColorInput::Texture(id) } = kind else { panic!("{kind:?}") };
        let TextureKind::Scale { factor: ColorInput::Texture(noise), .. } = &scene.textures[id].kind else {
            panic!("{:?}", scene.textures[id].kind)
        };
        assert!(matches!(scene.textures[*noise].kind, TextureKind::Noise { .. }));
    }
}
