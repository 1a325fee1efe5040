//! Defaults and rules of the plugins.

use caustica_formats::ir::{
    BsdfKind, Color, ColorInput, ComponentFormat, Crop, EmitterKind, Filter, FloatInput, Fov, FovAxis, Ior,
    MeshFormat, MicrofacetDistribution, PixelFormat, Projection, ShapeKind, TextureEncoding, TextureFilter,
    TextureKind, Tonemap, WrapMode,
};

use std::path::Path;

use caustica_formats::{ReadOptions, write_scene};

use crate::{files, headlines, try_read, v3, v06};

fn bsdf(text: &str) -> BsdfKind {
    let scene = v3(text);
    let (_, last) = scene.bsdfs.iter().last().unwrap();
    last.kind.clone()
}

const HALF: ColorInput = ColorInput::Color(Color::Gray(0.5));
const ONE: ColorInput = ColorInput::Color(Color::Gray(1.0));

fn named(name: &str) -> Ior {
    Ior::Named(name.to_owned())
}

#[test]
fn a_bare_sensor_has_the_defaults_of_the_manual() {
    let scene = v3("<sensor type='perspective'/>");
    let sensor = &scene.sensors[0];
    let perspective = Projection::Perspective { fov: Fov::FocalLength(50.0), axis: FovAxis::X };
    assert_eq!(sensor.projection, perspective);
    assert_eq!((sensor.near_clip, sensor.far_clip), (0.01, 10_000.0));
    let film = &sensor.film;
    assert_eq!((film.width, film.height, film.crop), (768, 576, None));
    assert_eq!(film.filter, Filter::Gaussian { stddev: 0.5 });
    assert_eq!((film.pixel_format, film.component_format), (PixelFormat::Rgb, ComponentFormat::Float16));
    assert_eq!((sensor.sampler.sample_count, sensor.sampler.plugin.as_str()), (4, "independent"));
}

#[test]
fn bsdf_defaults() {
    assert_eq!(bsdf("<bsdf type='diffuse'/>"), BsdfKind::Diffuse { reflectance: HALF });
    let BsdfKind::Dielectric(d) = bsdf("<bsdf type='dielectric'/>") else { panic!() };
    assert_eq!((d.int_ior, d.ext_ior), (named("bk7"), named("air")));
    let BsdfKind::RoughPlastic { plastic, microfacet } = bsdf("<bsdf type='roughplastic'/>") else {
        panic!()
    };
    assert_eq!((plastic.int_ior, plastic.nonlinear), (named("polypropylene"), false));
    assert_eq!((plastic.diffuse_reflectance, plastic.specular_reflectance), (HALF, ONE));
    assert_eq!(microfacet.distribution, MicrofacetDistribution::Beckmann);
    assert_eq!((microfacet.alpha_u, microfacet.alpha_v), (FloatInput::Value(0.1), FloatInput::Value(0.1)));
    let BsdfKind::Mask { opacity, .. } = bsdf("<bsdf type='mask'><bsdf type='diffuse'/></bsdf>") else {
        panic!()
    };
    assert_eq!(opacity, FloatInput::Value(0.5));
}

#[test]
fn indices_of_refraction_by_number_and_name() {
    let text = "<bsdf type='dielectric'><string name='int_ior' value='Water Ice'/><integer name='ext_ior' value='1'/></bsdf>";
    let BsdfKind::Dielectric(d) = bsdf(text) else { panic!() };
    assert_eq!((d.int_ior, d.ext_ior), (named("water ice"), Ior::Value(1.0)));
}

#[test]
fn two_sides_may_differ_but_not_transmit() {
    let text = "<bsdf type='twosided'><bsdf type='diffuse'/><bsdf type='plastic'/></bsdf>";
    assert!(matches!(bsdf(text), BsdfKind::TwoSided { back: Some(_), .. }));
    let glass = "<scene version='3.0.0'><bsdf type='twosided'><bsdf type='dielectric'/></bsdf></scene>";
    assert_eq!(headlines(glass), ["twosided takes only materials that let no light through"]);
}

/// Mitsuba takes them and makes something of them; what that is nobody means.
#[test]
fn numbers_that_make_no_sense() {
    let of = |plugin: &str, name: &str, value: &str| {
        let float = format!("<float name='{name}' value='{value}'/>");
        let inside = if plugin == "mask" { "<bsdf type='diffuse'/>" } else { "" };
        headlines(&format!("<scene version='3.0.0'><bsdf type='{plugin}'>{float}{inside}</bsdf></scene>"))
    };
    assert_eq!(of("roughplastic", "alpha", "-0.1")[0], "`alpha` should not be negative; it is -0.1");
    assert_eq!(of("principled", "metallic", "7")[0], "`metallic` should lie between 0 and 1; it is 7");
    assert_eq!(of("mask", "opacity", "3")[0], "`opacity` should lie between 0 and 1; it is 3");
    let sound = of("principled", "roughness", "0.3");
    assert!(!sound.iter().any(|line| line.contains("should")), "{sound:?}");
}

#[test]
fn metals_have_case_sensitive_names() {
    let text =
        "<scene version='3.0.0'><bsdf type='conductor'><string name='material' value='au'/></bsdf></scene>";
    assert_eq!(headlines(text), ["no metal named `au`"]);
    let both = "<scene version='3.0.0'><bsdf type='conductor'><string name='material' value='Au'/><float name='eta' value='1'/><float name='k' value='1'/></bsdf></scene>";
    assert_eq!(headlines(both), ["a conductor takes either `material` or `eta` and `k`, not both"]);
}

#[test]
fn mesh_defaults_differ_by_format() {
    let scene = v3(
        "<shape type='obj'><string name='filename' value='mesh.obj'/></shape><shape type='ply'><string name='filename' value='mesh.ply'/></shape>\
        <shape type='serialized'><string name='filename' value='mesh.obj'/><integer name='shape_index' value='3'/></shape>",
    );
    let mesh = |i: usize| match &scene.shapes[i].kind {
        ShapeKind::Mesh(mesh) => mesh.clone(),
        other => panic!("{other:?}"),
    };
    assert!(mesh(0).flip_tex_coords && !mesh(1).flip_tex_coords);
    assert_eq!(mesh(2).format, MeshFormat::Serialized { index: 3 });
}

#[test]
fn groups_are_shared_by_their_instances() {
    let scene =
        v3("<shape type='instance'><ref id='g'/></shape><shape type='instance'><ref id='g'/></shape>\
        <shape type='shapegroup' id='g'><shape type='cube'/><shape type='disk'/></shape>");
    assert_eq!((scene.shapes.len(), scene.groups.len()), (2, 1));
    assert_eq!(scene.groups.iter().next().unwrap().1.shapes.len(), 2);
}

#[test]
fn emitter_defaults_and_exclusions() {
    let scene = v3(
        "<emitter type='spot'><float name='cutoff_angle' value='40'/></emitter><emitter type='directional'/>",
    );
    assert!(matches!(scene.emitters[0].kind, EmitterKind::Spot { cutoff_angle: 40.0, beam_width: 30.0, .. }));
    assert!(matches!(scene.emitters[1].kind, EmitterKind::Directional { direction: [0.0, 0.0, 1.0], .. }));
    let text = "<scene version='3.0.0'><emitter type='point'><point name='position' value='1'/><transform name='to_world'/></emitter></scene>";
    assert_eq!(headlines(text), ["point takes either `position` or `to_world`, not both"]);
    let text = "<scene version='3.0.0'><emitter type='constant'/><emitter type='constant'/></scene>";
    assert_eq!(headlines(text), ["a scene may have only one environment; this is a second one"]);
}

#[test]
fn old_bitmaps() {
    let scene = v06(
        "<texture type='bitmap'><string name='filename' value='wood.png'/><float name='gamma' value='2.2'/>\
        <string name='filterType' value='nearest'/><string name='wrapMode' value='clamp'/><string name='wrapModeV' value='one'/>\
        <string name='channel' value='g'/><float name='maxAnisotropy' value='20'/></texture>",
    );
    let (_, texture) = scene.textures.iter().next().unwrap();
    let TextureKind::Bitmap(bitmap) = &texture.kind else { panic!() };
    assert_eq!((bitmap.encoding, bitmap.filter), (TextureEncoding::Gamma(2.2), TextureFilter::Nearest));
    assert_eq!((bitmap.wrap_u, bitmap.wrap_v, bitmap.channel), (WrapMode::Clamp, WrapMode::One, Some('g')));
}

#[test]
fn low_range_films_become_a_tone_map() {
    let scene = v06(
        "<sensor type='perspective'><film type='ldrfilm'><float name='exposure' value='2'/><boolean name='banner' value='true'/></film></sensor>",
    );
    assert_eq!(scene.sensors[0].film.tonemap, Some(Tonemap { exposure: 2.0, gamma: None }));
    assert_eq!(scene.sensors[0].film.file_format, "png");
}

#[test]
fn crops_lie_within_the_film() {
    let film = |x: u32| {
        format!(
            "<sensor type='perspective'><film type='hdrfilm'><integer name='width' value='10'/><integer name='height' value='8'/>\
            <integer name='crop_offset_x' value='{x}'/><integer name='crop_width' value='4'/></film></sensor>"
        )
    };
    assert_eq!(v3(&film(2)).sensors[0].film.crop, Some(Crop { x: 2, y: 0, width: 4, height: 8 }));
    let outside = headlines(&format!("<scene version='3.0.0'>{}</scene>", film(7)));
    assert_eq!(outside, ["the crop (4×8 at 7, 0) does not lie within the film (10×8)"]);
}

#[test]
fn odd_parameters_of_samplers_and_films_are_warnings() {
    let text = "<scene version='3.0.0'><sensor type='perspective'><sampler type='independent'><integer name='foo' value='1'/></sampler>\
        <film type='hdrfilm'><float name='bar' value='1'/></film></sensor></scene>";
    let found = headlines(text);
    assert_eq!(
        found,
        [
            "unknown parameter `foo` of independent is ignored",
            "unknown parameter `bar` of hdrfilm is ignored"
        ]
    );
}

#[test]
fn sensors_may_mirror_but_not_scale() {
    let sensor = |step: &str| {
        format!(
            "<scene version='3.0.0'><sensor type='thinlens'><float name='aperture_radius' value='.1'/>\
            <transform name='to_world'>{step}</transform></sensor></scene>"
        )
    };
    assert!(headlines(&sensor("<scale x='-1'/>")).is_empty());
    assert_eq!(
        headlines(&sensor("<scale value='2'/>")),
        ["`to_world` of a sensor may not scale, but scales by [2.0, 2.0, 2.0]"]
    );
    let pinhole = "<scene version='3.0.0'><sensor type='perspective'><float name='aperture_radius' value='1'/></sensor></scene>";
    assert_eq!(
        headlines(pinhole),
        ["parameter `aperture_radius` is ignored: a perspective sensor has no lens; thinlens has"]
    );
    let bare = "<scene version='3.0.0'><sensor type='thinlens'/></scene>";
    assert_eq!(headlines(bare), ["thinlens needs the parameter `aperture_radius`"]);
}

#[test]
fn substitutes_are_those_that_the_warning_names() {
    let text = "<scene version='3.0.0'><bsdf type='conductor' id='c'><texture type='wireframe' name='specular_reflectance'>\
        <string name='name' value='vertex_color'/></texture></bsdf><shape type='cube'><bsdf type='hk'><ref id='c'/></bsdf></shape></scene>";
    let options = ReadOptions { lenient: true, ..ReadOptions::default() };
    let read = try_read(text, &[], &options).unwrap();
    let messages: Vec<&str> = read.warnings.iter().map(|w| w.message.as_str()).collect();
    assert_eq!(
        messages,
        [
            "texture plugin `wireframe` is not supported yet: gray 0.5 is used",
            "bsdf plugin `hk` is not supported yet: its nested bsdf is used",
        ]
    );
    assert_eq!(read.scene.bsdfs.len(), 1);
    let used = &read.scene.bsdfs[read.scene.shapes[0].bsdf.unwrap()];
    assert!(matches!(&used.kind, BsdfKind::Conductor(c) if c.specular_reflectance == HALF));
}

const PIXEL: &str =
    "<film type='hdrfilm'><integer name='width' value='1'/><integer name='height' value='1'/></film>";

/// `to_world` wins over `origin` and `direction`, as in Mitsuba 3.9; both are the same ray here.
#[test]
fn a_radiancemeter_is_a_ray() {
    let ray = "<point name='origin' x='1' y='2' z='3'/><vector name='direction' x='0' y='-2' z='0'/>";
    let place = "<transform name='to_world'><lookat origin='1,2,3' target='1,0,3' up='1,0,0'/></transform>";
    for body in [ray.to_owned(), place.to_owned(), format!("{place}{}", ray.replace('1', "7"))] {
        let scene = v3(&format!("<sensor type='radiancemeter'>{body}{PIXEL}</sensor>"));
        let sensor = &scene.sensors[0];
        assert_eq!(sensor.projection, Projection::Ray);
        assert_eq!(sensor.to_world.point([0.0; 3]), [1.0, 2.0, 3.0]);
        assert_eq!(sensor.to_world.vector([0.0, 0.0, 1.0]), [0.0, -1.0, 0.0]);
        assert_eq!(sensor.near_clip, 0.0);
    }
    for (body, message) in [
        (PIXEL.replace("'1'", "'2'"), "a radiancemeter sees along one ray: its film has 1×1 pixels, not 2×2"),
        (
            format!("<point name='origin' x='1' y='0' z='0'/>{PIXEL}"),
            "a radiancemeter takes both `origin` and `direction`, or neither",
        ),
        (format!("{ray}{PIXEL}").replace("-2", "0"), "`direction` has no length"),
        (
            format!("<float name='near_clip' value='1'/>{PIXEL}"),
            "unknown parameter `near_clip` of radiancemeter",
        ),
    ] {
        let text = format!("<scene version='3.0.0'><sensor type='radiancemeter'>{body}</sensor></scene>");
        assert_eq!(headlines(&text), [message], "{body}");
    }
    // Mitsuba 0.6 takes any film.
    let old = v06("<sensor type='radiancemeter'/><emitter type='constant'/>");
    assert_eq!(old.sensors[0].projection, Projection::Ray);
}

/// Mitsuba has it back as it was; pbrt has an orthographic camera instead.
#[test]
fn a_radiancemeter_is_written() {
    let text = format!(
        "<scene version='3.0.0'><sensor type='radiancemeter'><point name='origin' x='1' y='2' z='3'/>
         <vector name='direction' x='1' y='-2' z='0.5'/>{PIXEL}</sensor><emitter type='constant'/></scene>"
    );
    let read = try_read(&text, &[], &ReadOptions::default()).unwrap();
    let written = |name: &str| write_scene(&read, &files(&text, &[]), Path::new(name)).unwrap();
    let copy = written("copy.xml");
    assert!(copy.losses.is_empty(), "{:?}", copy.losses);
    let again = try_read(&copy.text, &[], &ReadOptions::default()).unwrap();
    assert_eq!(again.warnings, []);
    let [a, b] = [&read, &again].map(|read| &read.scene.sensors[0]);
    assert_eq!((a.projection, a.near_clip, a.far_clip), (b.projection, b.near_clip, b.far_clip));
    for (a, b) in a.to_world.0.as_flattened().iter().zip(b.to_world.0.as_flattened()) {
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    }
    let pbrt = written("copy.pbrt");
    assert!(pbrt.text.contains("Camera \"orthographic\""), "{}", pbrt.text);
    assert_eq!(pbrt.losses[0].what, "a radiancemeter, which sees along one ray");
}
