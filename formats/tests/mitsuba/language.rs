//! The language: parameters, includes, references, transforms, colours, versions.

use caustica_formats::ReadOptions;
use caustica_formats::ir::{
    BsdfKind, Color, ColorInput, ConductorMaterial, EmitterKind, HideEmitters, Projection, Scalar, ShapeKind,
    SpectrumRule, TextureKind, Transform,
};

use crate::{headlines, scene, try_read, v3, v06, warnings};

fn radiance(scene: &caustica_formats::ir::Scene) -> &Color {
    match &scene.emitters[0].kind {
        EmitterKind::Constant { radiance } => radiance,
        other => panic!("{other:?}"),
    }
}

fn constant(version: &str, property: &str) -> Color {
    let text = format!("<scene version='{version}'><emitter type='constant'>{property}</emitter></scene>");
    radiance(&try_read(&text, &[], &ReadOptions::default()).unwrap().scene).clone()
}

#[test]
fn parameters_substitute_the_longest_name_and_escape() {
    let scene = v3(
        "<default name='s' value='bad'/><default name='size' value='3'/><default name='kind' value='sphere'/>\
        <shape type='$kind' id='price\\$s'><float name='radius' value='$size'/></shape>",
    );
    assert_eq!(scene.shapes[0].kind, ShapeKind::Sphere { center: [0.0; 3], radius: 3.0 });
    assert_eq!(scene.shapes[0].name.as_deref(), Some("price$s"));
}

#[test]
fn the_command_line_wins_over_defaults() {
    let options = ReadOptions { defines: vec![("r".into(), "7".into())], ..ReadOptions::default() };
    let text = "<scene version='3.0.0'><default name='r' value='1'/><shape type='sphere'><float name='radius' value='$r'/></shape></scene>";
    let scene = try_read(text, &[], &options).unwrap().scene;
    assert_eq!(scene.shapes[0].kind, ShapeKind::Sphere { center: [0.0; 3], radius: 7.0 });
}

#[test]
fn includes_splice_scenes_and_nest_objects() {
    let text = "<scene version='3.0.0'><default name='r' value='2'/><include filename='parts/all.xml'/>\
        <shape type='cube'><include filename='parts/white.xml'/></shape></scene>";
    let more = [
        (
            "parts/all.xml",
            "<scene version='0.6.0'><shape type='sphere'><float name='radius' value='$r'/>\
            <transform name='toWorld'><translate x='1'/></transform></shape><include filename='more.xml'/></scene>",
        ),
        (
            "parts/more.xml",
            "<scene version='3.0.0'><shape type='obj'><string name='filename' value='a.obj'/></shape></scene>",
        ),
        ("parts/white.xml", "<bsdf type='diffuse' version='3.0.0'/>"),
        ("parts/a.obj", ""),
    ];
    let scene = try_read(text, &more, &ReadOptions::default()).unwrap().scene;
    assert_eq!(scene.shapes.len(), 3);
    assert_eq!(scene.shapes[0].to_world, Transform::translate([1.0, 0.0, 0.0]));
    assert!(matches!(&scene.shapes[1].kind, ShapeKind::Mesh(m) if m.path.to_str() == Some("parts/a.obj")));
    assert!(scene.shapes[2].bsdf.is_some());
}

#[test]
fn definitions_of_a_later_include_are_found() {
    let text = "<scene version='2.0.0'><shape type='sphere'><float name='radius' value='$r'/></shape><include filename='d.xml'/></scene>";
    let more = [("d.xml", "<scene version='2.0.0'><default name='r' value='4'/></scene>")];
    let read = try_read(text, &more, &ReadOptions::default()).unwrap();
    assert_eq!(read.scene.shapes[0].kind, ShapeKind::Sphere { center: [0.0; 3], radius: 4.0 });
    assert_eq!(read.warnings.len(), 1);
}

#[test]
fn paths_are_searched_for_meshes() {
    let text = "<scene version='3.0.0'><path value='lib'/><shape type='ply'><string name='filename' value='a.ply'/></shape></scene>";
    let scene = try_read(text, &[("lib/a.ply", "")], &ReadOptions::default()).unwrap().scene;
    assert!(matches!(&scene.shapes[0].kind, ShapeKind::Mesh(m) if m.path.to_str() == Some("lib/a.ply")));
}

#[test]
fn references_go_forwards_through_aliases_and_are_shared() {
    let scene =
        v3("<shape type='cube'><ref id='b'/></shape><shape type='cube'><ref name='bsdf' id='a'/></shape>\
        <bsdf type='diffuse' id='a'/><alias id='a' as='b'/>");
    assert_eq!(scene.bsdfs.len(), 1);
    assert_eq!(scene.shapes[0].bsdf, scene.shapes[1].bsdf);
}

#[test]
fn an_area_emitter_may_stand_in_the_scene_for_shapes_to_refer_to() {
    let scene = v3(
        "<shape type='cube'><ref id='lamp'/></shape><emitter type='area' id='lamp'><rgb name='radiance' value='1 2 3'/></emitter>",
    );
    assert!(scene.emitters.is_empty());
    let emission = scene.shapes[0].emission.as_ref().unwrap();
    assert_eq!(emission.radiance, ColorInput::Color(Color::Rgb([1.0, 2.0, 3.0])));
    let alone = headlines("<scene version='3.0.0'><emitter type='area'/></scene>");
    assert_eq!(alone, ["an area emitter must be part of a shape"]);
}

#[test]
fn transforms_apply_in_document_order() {
    let scene = v3("<shape type='cube'><transform name='to_world'><scale value='2'/><translate x='1'/>\
        <rotate z='1' angle='90'/></transform></shape>");
    let p = scene.shapes[0].to_world.point([1.0, 0.0, 0.0]);
    assert!((p[0]).abs() < 1e-12 && (p[1] - 3.0).abs() < 1e-12);
    let scene = v3(
        "<shape type='cube'><transform name='to_world'><matrix value='2 0 0  0 3 0  0 0 4'/></transform></shape>",
    );
    assert_eq!(scene.shapes[0].to_world, Transform::scale([2.0, 3.0, 4.0]));
    let scene = v06(
        "<emitter type='point'><transform name='toWorld'><lookAt origin='1,2,3' target='1 2 4' up='0 1 0'/></transform></emitter>",
    );
    assert!(matches!(scene.emitters[0].kind, EmitterKind::Point { position: [1.0, 2.0, 3.0], .. }));
}

#[test]
fn points_take_both_forms() {
    let scene = v3(
        "<shape type='cylinder'><point name='p0' value='1, 2 3'/><vector name='p1' x='4' y='5' z='6'/></shape>",
    );
    assert_eq!(
        scene.shapes[0].kind,
        ShapeKind::Cylinder { p0: [1.0, 2.0, 3.0], p1: [4.0, 5.0, 6.0], radius: 1.0 }
    );
}

#[test]
fn colours_keep_what_was_written() {
    for (property, color) in [
        ("<float name='radiance' value='2'/>", Color::Gray(2.0)),
        ("<integer name='radiance' value='2'/>", Color::Gray(2.0)),
        ("<rgb name='radiance' value='2'/>", Color::Rgb([2.0; 3])),
        ("<rgb name='radiance' value='#ff0033'/>", Color::Rgb([1.0, 0.0, 0.2])),
        ("<srgb name='radiance' value='0.5 0 1'/>", Color::Srgb([0.5, 0.0, 1.0])),
        ("<spectrum name='radiance' value='2'/>", Color::UniformSpectrum(2.0)),
        ("<spectrum name='radiance' value='1 2 3'/>", Color::Rgb([1.0, 2.0, 3.0])),
        (
            "<spectrum name='radiance' value='400:1, 700:.5'/>",
            Color::Samples(vec![[400.0, 1.0], [700.0, 0.5]]),
        ),
        (
            "<blackbody name='radiance' temperature='5000[K]' scale='2'/>",
            Color::Blackbody { kelvin: 5000.0, scale: 2.0 },
        ),
        ("<spectrum name='radiance' type='d65'/>", Color::D65 { scale: 1.0, color: None }),
        (
            "<spectrum name='radiance' type='d65'><float name='scale' value='3'/><rgb name='color' value='1 .5 0'/></spectrum>",
            Color::D65 { scale: 3.0, color: Some([1.0, 0.5, 0.0]) },
        ),
        (
            "<spectrum name='radiance' type='uniform'><float name='value' value='3'/></spectrum>",
            Color::UniformPlugin(3.0),
        ),
        (
            "<spectrum name='radiance' type='srgb'><rgb name='color' value='1 .5 0'/></spectrum>",
            Color::BoundedRgb([1.0, 0.5, 0.0]),
        ),
        (
            "<spectrum name='radiance' type='irregular'><string name='wavelengths' value='400, 500'/><string name='values' value='1, 2'/></spectrum>",
            Color::Samples(vec![[400.0, 1.0], [500.0, 2.0]]),
        ),
        (
            "<spectrum name='radiance' type='rawconstant'><float name='value' value='2.5'/></spectrum>",
            Color::Gray(2.5),
        ),
        (
            "<spectrum name='radiance' type='rawconstant'><vector name='value' x='1' y='2' z='3'/></spectrum>",
            Color::Rgb([1.0, 2.0, 3.0]),
        ),
        (
            "<spectrum name='radiance' type='srgb_d65'><rgb name='color' value='0.2,2,0.4'/></spectrum>",
            Color::D65 { scale: 1.0, color: Some([0.2, 2.0, 0.4]) },
        ),
    ] {
        assert_eq!(constant("0.6.0", property), color, "{property}");
        assert_eq!(constant("3.5.0", property), color, "{property}");
    }
}

#[test]
fn spd_files_are_read() {
    let text = "<scene version='3.0.0'><emitter type='constant'><spectrum name='radiance' filename='a.spd'/></emitter></scene>";
    let scene =
        try_read(text, &[("a.spd", "# c\n400 1\n500 2 # d\n")], &ReadOptions::default()).unwrap().scene;
    assert_eq!(radiance(&scene), &Color::Samples(vec![[400.0, 1.0], [500.0, 2.0]]));
    let failed = try_read(text, &[("a.spd", "500 1\n400 2\n")], &ReadOptions::default()).unwrap_err();
    assert_eq!(failed.diagnostics[0].message, "a.spd: wavelengths must ascend, but 400 follows 500");
}

#[test]
fn bad_numbers_are_refused() {
    for value in ["2.0f", "nan", "inf", "-infinity", "1e999", "", "0x10", "1,5"] {
        let text = format!(
            "<scene version='3.0.0'><shape type='sphere'><float name='radius' value='{value}'/></shape></scene>"
        );
        assert_eq!(headlines(&text), [format!("`{value}` is not a number")]);
    }
}

#[test]
fn booleans_are_exact_in_old_files_only() {
    let text = |version, value| {
        format!(
            "<scene version='{version}'><shape type='sphere'><boolean name='flip_normals' value='{value}'/></shape></scene>"
        )
    };
    assert!(headlines(&text("3.0.0", "True")).is_empty());
    assert_eq!(headlines(&text("0.6.0", "True"))[0], "`True` is not a boolean; write `true` or `false`");
    assert_eq!(headlines(&text("3.0.0", "1")), ["`1` is not a boolean; write `true` or `false`"]);
}

#[test]
fn the_version_decides_the_meaning() {
    let conductor = |version: &str| {
        let scene = scene(&format!("<scene version='{version}'><bsdf type='conductor'/></scene>"));
        let (_, bsdf) = scene.bsdfs.iter().next().unwrap();
        match &bsdf.kind {
            BsdfKind::Conductor(c) => c.material.clone(),
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(conductor("3.0.0"), ConductorMaterial::Mirror);
    assert!(
        matches!(conductor("0.5.0"), ConductorMaterial::Named { name, ext_eta: Some(_) } if name == "Cu")
    );

    let two = "<sensor type='perspective' id='a'/><sensor type='perspective' id='b'/>";
    assert_eq!((v3(two).default_sensor, v06(two).default_sensor), (0, 1));
    assert_eq!(
        (v3("").spectrum_rule, v06("").spectrum_rule),
        (SpectrumRule::Mitsuba3, SpectrumRule::Mitsuba06)
    );
    assert_eq!(
        (v3("").hide_emitters, v06("").hide_emitters),
        (HideEmitters::Surface, HideEmitters::Emission)
    );
    assert_eq!(scene("<scene version='2.2.1'/>").spectrum_rule, SpectrumRule::Mitsuba2);
}

#[test]
fn a_missing_version_is_guessed_from_the_names() {
    let old =
        "<scene><shape type='cube'><transform name='toWorld'/></shape><emitter type='constant'/></scene>";
    assert_eq!(headlines(old), ["<scene> has no version; read as 0.5"]);
    assert_eq!(
        headlines("<scene><emitter type='constant'/></scene>"),
        ["<scene> has no version; read as 3.0"]
    );
}

#[test]
fn old_texture_offsets_follow_0_6() {
    let scene = v06(
        "<texture type='checkerboard'><float name='uscale' value='2'/><float name='uoffset' value='.5'/></texture>",
    );
    let (_, texture) = scene.textures.iter().next().unwrap();
    let TextureKind::Checkerboard { to_uv, .. } = texture.kind else { panic!() };
    assert_eq!(to_uv.point([1.0, 1.0, 0.0]), [2.5, 1.0, 0.0]);
}

#[test]
fn scenes_before_0_4_are_upgraded() {
    let read = scene(
        "<scene version='0.3.0'><camera type='perspective'><boolean name='mapSmallerSide' value='true'/>\
        <film type='exrfilm'><boolean name='alpha' value='true'/></film></camera>\
        <luminaire type='constant'><rgb name='intensity' value='1 2 3'/></luminaire></scene>",
    );
    assert_eq!(read.sensors[0].to_world, Transform::scale([-1.0, 1.0, 1.0]));
    let Projection::Perspective { axis, .. } = read.sensors[0].projection else { panic!() };
    assert_eq!(axis, caustica_formats::ir::FovAxis::Smaller);
    assert_eq!(read.sensors[0].film.pixel_format, caustica_formats::ir::PixelFormat::Rgba);
    assert_eq!(radiance(&read), &Color::Rgb([1.0, 2.0, 3.0]));
    let read = scene(
        "<scene version='0.2.0'><bsdf type='mirror'/><shape type='sphere'><boolean name='inverted' value='true'/></shape><emitter type='point'/></scene>",
    );
    assert!(read.shapes[0].flip_normals);
    assert!(
        matches!(&read.bsdfs.iter().next().unwrap().1.kind, BsdfKind::Conductor(c) if c.material == ConductorMaterial::Mirror)
    );
}

#[test]
fn plugin_names_may_be_capitals_and_text_is_noticed() {
    assert!(matches!(v3("<shape type='SPHERE'/>").shapes[0].kind, ShapeKind::Sphere { .. }));
    assert!(
        warnings("<scene version='3.0.0'>stray</scene>", false).contains("text between elements is ignored")
    );
}

#[test]
fn integrator_settings_keep_their_types() {
    let scene = v06(
        "<integrator type='adaptive'><integrator type='photonmapper'><integer name='causticPhotons' value='9'/>\
        <float name='globalLookupRadius' value='.1'/><string name='kernel' value='cone'/></integrator></integrator>",
    );
    let integrator = scene.integrator.unwrap();
    assert_eq!(integrator.plugin, "photonmapper");
    assert_eq!(integrator.settings["caustic_photons"].value, Scalar::Integer(9));
    assert_eq!(integrator.settings["global_lookup_radius"].value, Scalar::Float(0.1));
    assert_eq!(integrator.settings["kernel"].value, Scalar::String("cone".into()));
}

#[test]
fn an_included_file_may_add_a_path() {
    let text = "<scene version='3.0.0'><include filename='parts/p.xml'/><shape type='ply'><string name='filename' value='a.ply'/></shape></scene>";
    let more =
        [("parts/p.xml", "<scene version='3.0.0'><path value='lib'/></scene>"), ("parts/lib/a.ply", "")];
    assert_eq!(try_read(text, &more, &ReadOptions::default()).unwrap().scene.shapes.len(), 1);
}

#[test]
fn a_parameter_given_twice_counts_last_where_mitsuba_allows_it() {
    let body =
        "<shape type='sphere'><float name='radius' value='1'/><float name='radius' value='2'/></shape>";
    let two =
        try_read(&format!("<scene version='2.0.0'>{body}</scene>"), &[], &ReadOptions::default()).unwrap();
    assert_eq!(two.scene.shapes[0].kind, ShapeKind::Sphere { center: [0.0; 3], radius: 2.0 });
    assert_eq!(
        headlines(&format!("<scene version='3.0.0'>{body}</scene>")),
        ["parameter `radius` is given twice"]
    );
}

/// A fork's own parameter says what a nested picture says elsewhere.
#[test]
fn a_normal_map_may_name_its_file_itself() {
    let kind = |normals: &str| {
        let bsdf = format!("<bsdf type='normalmap'><bsdf type='dielectric'/>{normals}</bsdf>");
        v3(&format!("<shape type='sphere'>{bsdf}</shape>"))
            .textures
            .iter()
            .next()
            .map(|(_, t)| t.kind.clone())
    };
    let own = kind("<string name='filename' value='wood.png'/><float name='tiles' value='3'/>");
    let nested = kind(
        "<texture type='bitmap' name='normalmap'><string name='filename' value='wood.png'/>\
         <boolean name='raw' value='true'/><transform name='to_uv'><scale value='3'/></transform></texture>",
    );
    assert!(own.is_some());
    assert_eq!(own, nested);
}
