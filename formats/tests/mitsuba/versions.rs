//! What each version of Mitsuba makes of the same words; right values are those of Mitsuba 3.9.1 unless a test says
//! otherwise.

use std::path::Path;

use caustica_formats::ir::{
    BsdfKind, Color, ColorInput, EmitterKind, FloatInput, MeshFormat, ShapeKind, Transform,
};
use caustica_formats::{Read, ReadOptions, read_scene};

use crate::{UNSEEN, failure, files, headlines, try_read, v3};

fn read(text: &str, more: &[(&str, &str)]) -> Read {
    try_read(text, more, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn said(read: &Read) -> Vec<String> {
    read.warnings.iter().map(|d| d.message.clone()).collect()
}

fn shape(version: &str, transform: &str) -> (Transform, Vec<String>) {
    let name = if version.starts_with('0') { "toWorld" } else { "to_world" };
    let text = format!(
        "<scene version='{version}'><shape type='rectangle'><transform name='{name}'>{transform}</transform></shape>\
         <shape type='cube'><transform name='{name}'>{transform}</transform></shape></scene>"
    );
    let read = read(&text, &[]);
    (read.scene.shapes[0].to_world, said(&read).into_iter().filter(|s| s.contains("rotate")).collect())
}

#[test]
fn rotations_about_axes_that_are_not_unit_vectors() {
    let turn = "<rotate x='1' y='2' z='0' angle='-15'/>";
    for version in ["2.1.0", "3.0.0"] {
        let (m, said) = shape(version, turn);
        // The matrix of Mitsuba 3.9.1, in its single precision.
        let expected = [
            [1.0, 0.06814834, -0.5176381],
            [0.06814834, 1.1022226, 0.25881904],
            [0.5176381, -0.25881904, 0.9659258],
        ];
        for (row, expected) in m.0.iter().zip(expected) {
            assert!(row.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{m:?}");
        }
        assert!((m.determinant3() - 1.4407665).abs() < 1e-6);
        assert_eq!(
            said,
            [
                "the axis of <rotate> is not a unit vector: Mitsuba 2 and 3 shear and scale by it (volume × 1.441)"
            ],
            "once for each file"
        );
    }
    let (m, said) = shape("0.6.0", turn);
    assert!((m.determinant3() - 1.0).abs() < 1e-12);
    assert!(said.is_empty());
    // Three digits of a unit vector are no mistake.
    assert!(shape("3.0.0", "<rotate x='0.577' y='0.577' z='0.577' angle='30'/>").1.is_empty());
    assert!(shape("3.0.0", "<rotate y='1' angle='30'/>").1.is_empty());
}

#[test]
fn a_stretched_sphere_is_a_ball_as_large_as_its_x_axis() {
    // Centres and radii that Mitsuba 3.9.1 prints.
    for (transform, center, radius) in [
        ("<scale x='1' y='0.4' z='1'/><translate y='1'/>", [1.0, 1.0, 0.0], 2.0),
        ("<scale x='2' y='0.4' z='1'/>", [2.0, 0.0, 0.0], 4.0),
        ("<scale x='0.4' y='1' z='3'/>", [0.4, 0.0, 0.0], 0.8),
        ("<scale x='3' y='1' z='0.4'/><rotate y='1' angle='30'/>", [2.59808, 0.0, -1.5], 6.0),
        ("<matrix value='1 .5 0 0  0 1 0 0  0 0 1 0  0 0 0 1'/>", [1.0, 0.0, 0.0], 2.0),
    ] {
        let text = format!(
            "<scene version='3.0.0'><shape type='sphere'><float name='radius' value='2'/><point name='center' x='1' y='0' z='0'/>\
             <transform name='to_world'>{transform}</transform></shape></scene>"
        );
        let read = read(&text, &[]);
        let shape = &read.scene.shapes[0];
        let ShapeKind::Sphere { center: own, radius: size } = shape.kind else { panic!("{shape:?}") };
        assert!(shape.to_world.is_similarity(), "{transform}");
        let at = shape.to_world.point(own);
        assert!((0..3).all(|i| (at[i] - center[i]).abs() < 1e-5), "{transform}: {at:?}");
        let edge = shape.to_world.vector([size, 0.0, 0.0]).iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((edge - radius).abs() < 1e-9, "{transform}: {edge}");
        assert_eq!(
            said(&read),
            [format!("a sphere stays a ball: its radius is the {radius:.4} that its own x axis has here")]
        );
    }
    // A mirrored sphere stays mirrored.
    let text = "<scene version='3.0.0'><shape type='sphere'><transform name='to_world'><scale x='-1' y='2' z='2'/></transform></shape></scene>";
    assert!(read(text, &[]).scene.shapes[0].to_world.determinant3() < 0.0);
}

fn light(emitter: &str, transform: &str) -> (EmitterKind, Vec<String>) {
    let text = format!(
        "<scene version='3.0.0'><emitter type='{emitter}'>{}<transform name='to_world'>{transform}</transform></emitter></scene>",
        if emitter == "envmap" { "<string name='filename' value='wood.png'/>" } else { "" }
    );
    let read = read(&text, &[]);
    (read.scene.emitters[0].kind.clone(), said(&read))
}

#[test]
fn scaled_lights_are_what_mitsuba_makes_of_them() {
    // A projector's light times the length of its axis: 0.3035 and 0.0759 where it is 0.1517 without a scale.
    for (transform, factor) in
        [("<scale value='2'/>", 2.0), ("<scale value='0.5'/>", 0.5), ("<scale z='2'/>", 2.0)]
    {
        let (kind, said) = light("projector", transform);
        let EmitterKind::Projector { scale, to_world, .. } = kind else { panic!("{kind:?}") };
        assert_eq!(scale, factor);
        assert_eq!(to_world.vector([0.0, 0.0, 1.0]), [0.0, 0.0, 1.0]);
        assert_eq!(
            said,
            [format!("`to_world` scales the projector: Mitsuba multiplies its light by {factor:.4}")]
        );
    }
    // A diffuse plane receives 0.2757 and 0.0689 where it is 0.1378 without a scale.
    for (transform, factor) in
        [("<scale value='2'/>", 2.0), ("<scale value='0.5'/>", 0.5), ("<scale x='2'/>", 1.0)]
    {
        let (kind, said) = light("directional", transform);
        let EmitterKind::Directional { irradiance, .. } = kind else { panic!("{kind:?}") };
        assert_eq!(irradiance, Color::Gray(factor));
        assert_eq!(said.is_empty(), factor == 1.0, "{said:?}");
    }
    let (kind, said) = light("envmap", "<scale value='2'/>");
    let EmitterKind::Environment { to_world, .. } = kind else { panic!("{kind:?}") };
    assert_eq!(to_world, Transform::IDENTITY);
    assert_eq!(said, ["`to_world` scales the environment, which can only be turned: the scale is left out"]);
    assert!(light("spot", "<scale value='2'/>").1.is_empty());
    assert_eq!(
        light("spot", "<scale z='2'/>").1,
        ["`to_world` stretches the cone of the spot, as in Mitsuba 3"]
    );
}

#[test]
fn spectrum_plugins_stand_for_textures() {
    let alpha = |texture: &str| {
        let scene = v3(&format!("<shape type='sphere'><bsdf type='roughconductor'>{texture}</bsdf></shape>"));
        match &scene.bsdfs.iter().next().unwrap().1.kind {
            BsdfKind::RoughConductor { microfacet, .. } => microfacet.alpha_u.clone(),
            other => panic!("{other:?}"),
        }
    };
    for tag in ["texture", "spectrum"] {
        for (plugin, value) in [("rawconstant", "value"), ("uniform", "value"), ("d65", "scale")] {
            let texture =
                format!("<{tag} name='alpha' type='{plugin}'><float name='{value}' value='0.3'/></{tag}>");
            assert_eq!(alpha(&texture), FloatInput::Value(0.3), "{texture}");
        }
    }
    let bsdf = |text: &str| {
        v3(&format!("<shape type='sphere'>{text}</shape>")).bsdfs.iter().last().unwrap().1.kind.clone()
    };
    let vector = "type='rawconstant'><vector name='value' value='0.5 0.25 1'/></texture>";
    let kind = bsdf(&format!(
        "<bsdf type='normalmap'><texture name='normalmap' {vector}<bsdf type='diffuse'/></bsdf>"
    ));
    let BsdfKind::NormalMap { normals, .. } = kind else { panic!("{kind:?}") };
    assert_eq!(normals, ColorInput::Color(Color::Rgb([0.5, 0.25, 1.0])));
    let flat = "<bsdf type='bumpmap'><texture type='uniform'><float name='value' value='0.3'/></texture><bsdf type='diffuse'/></bsdf>";
    assert!(matches!(bsdf(flat), BsdfKind::BumpMap { height: FloatInput::Value(_), .. }));
    // A colour where a number is wanted is its luminance, as in Mitsuba: 0.55784 here.
    let text = "<scene version='3.0.0'><shape type='sphere'><bsdf type='mask'><texture name='opacity' type='srgb'>\
                <rgb name='color' value='0.3 0.6 0.9'/></texture><bsdf type='diffuse'/></bsdf></shape></scene>";
    let read = read(text, &[]);
    let kind = &read.scene.bsdfs.iter().last().unwrap().1.kind;
    let BsdfKind::Mask { opacity: FloatInput::Value(opacity), .. } = kind else { panic!("{kind:?}") };
    assert!((opacity - 0.557_85).abs() < 1e-4, "{opacity}");
    assert_eq!(said(&read), ["`opacity` is one number: the luminance of the colour is used"]);
    let spot = "<scene version='3.0.0'><emitter type='spot'><texture name='texture' type='uniform'/></emitter></scene>";
    assert!(failure(spot).contains("the `texture` of a spot must vary"), "Mitsuba refuses it");
}

#[test]
fn emitters_inside_shapes_stand_in_the_scene() {
    let text = |version: &str, emitter: &str| {
        format!(
            "<scene version='{version}'><shape type='sphere'><transform name='to_world'><translate x='5'/></transform>\
             <emitter type='{emitter}'/></shape></scene>"
        )
    };
    for emitter in ["point", "spot", "directional", "constant", "projector"] {
        let scene = read(&text("3.0.0", emitter), &[]).scene;
        let [light] = &scene.emitters[..] else { panic!("{emitter}: {:?}", scene.emitters) };
        assert_eq!(light.kind.name(), emitter);
        // The shape does not move it, does not shine, and is black as every shape with an emitter and no bsdf.
        if let EmitterKind::Point { position, .. } = light.kind {
            assert_eq!(position, [0.0; 3]);
        }
        let shape = &scene.shapes[0];
        assert!(shape.emission.is_none());
        let black = BsdfKind::Diffuse { reflectance: ColorInput::Color(Color::Gray(0.0)) };
        assert_eq!(scene.bsdfs[shape.bsdf.unwrap()].kind, black);
    }
    let old = failure(&text("0.6.0", "point").replace("to_world", "toWorld"));
    assert!(old.contains("Mitsuba 0.6 takes no emitter of type `point` inside a shape"), "{old}");
    let group = "<scene version='3.0.0'><shape type='shapegroup' id='g'><shape type='sphere'><emitter type='point'/></shape></shape>\
                 <shape type='instance'><ref id='g'/></shape></scene>";
    assert!(failure(group).contains("shapes of a shapegroup may not emit light"));
}

#[test]
fn document_types_and_latin_1_are_read_and_entities_are_not() {
    let plain = "<!DOCTYPE scene><scene version='3.0.0'><shape type='cube' id='a'/></scene>";
    assert_eq!(read(plain, &[]).scene.shapes.len(), 1);
    let system = "<!DOCTYPE scene SYSTEM 'scene.dtd'><scene version='3.0.0'><shape type='cube'/></scene>";
    assert_eq!(read(system, &[]).scene.shapes.len(), 1);
    let entities = "<!DOCTYPE scene [<!ENTITY a 'b'>]><scene version='3.0.0'/>";
    assert!(failure(entities).contains("a document type may not define entities"));
    let mut bytes =
        b"<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?><scene version='3.0.0'><shape type='cube' id='w"
            .to_vec();
    bytes.extend(b"\xfcrfel'/></scene>");
    let files = caustica_formats::files::Memory([("scene.xml".into(), bytes)].into_iter().collect());
    let read = read_scene(&files, Path::new("scene.xml"), &ReadOptions::default()).unwrap();
    assert_eq!(read.scene.shapes[0].name.as_deref(), Some("würfel"));
}

#[test]
fn the_first_message_names_the_program_a_file_is_of() {
    for (text, first) in [
        (
            "<scene><integrator type='path_mis'/><camera type='perspective'/><mesh type='obj'/></scene>",
            "this is not a Mitsuba scene: <mesh> is an element of Nori's files",
        ),
        (
            "<scene><integrator type='whitted'/><camera type='perspective'/></scene>",
            "this is not a Mitsuba scene: <camera> is an element of Nori's files",
        ),
        (
            "<scene><Group><TriangleMesh/></Group></scene>",
            "this is not a Mitsuba scene: <Group> is an element of Embree's files",
        ),
        (
            "<scene version='1.0'><renderer type='vpt'/><brdf type='phong' id='white'/></scene>",
            "this is not a Mitsuba scene: <brdf> is an element of AdaPT's files",
        ),
    ] {
        assert_eq!(headlines(text), [first]);
    }
}

const TWO: &str = "mtllib two.mtl\no left part\nv -1 -1 0\nv 0 -1 0\nv 0 1 0\nv -1 1 0\nusemtl red\nf 1 2 3 4\n\
    o right\nv 0 -1 0\nv 1 -1 0\nv 1 1 0\nv 0 1 0\nusemtl Blue.001\nf 5 6 7 8\n";
const MATERIALS: &str = "newmtl red\nKd 0.8 0.1 0.1\nillum 1\nnewmtl Blue.001\nKd 0.1 0.1\nKd 0.1 0.1 0.8\n\
    Ks .5 .5 .5\nNs 20\nillum 2\nd 0.25\nmap_Bump nothing.png\n";

fn obj(version: &str, inside: &str) -> Read {
    let text = format!(
        "<scene version='{version}'><shape type='obj'><string name='filename' value='two.obj'/>{inside}</shape>\
         <emitter type='constant'/></scene>"
    );
    read(&text, &[("two.obj", TWO), ("two.mtl", MATERIALS)])
}

/// By the loader of Mitsuba 0.6: `Kd` is encoded, `illum` decides the model, `d` is a mask around it.
#[test]
fn an_obj_of_0_6_has_the_materials_of_its_library() {
    let read = obj("0.6.0", "");
    assert!(said(&read).is_empty(), "{:?}", said(&read));
    let scene = &read.scene;
    let kinds: Vec<_> = scene.shapes.iter().map(|s| (&s.kind, &scene.bsdfs[s.bsdf.unwrap()].kind)).collect();
    let [(ShapeKind::Mesh(left), red), (ShapeKind::Mesh(right), blue)] = &kinds[..] else {
        panic!("{kinds:?}")
    };
    assert_eq!(
        (left.format, right.format),
        (MeshFormat::ObjPart { index: 0 }, MeshFormat::ObjPart { index: 1 })
    );
    let encoded = |rgb: [f32; 3]| ColorInput::Color(Color::Srgb(rgb.map(f64::from)));
    assert_eq!(**red, BsdfKind::Diffuse { reflectance: encoded([0.8, 0.1, 0.1]) });
    let BsdfKind::Mask { opacity: FloatInput::Value(0.25), nested } = blue else { panic!("{blue:?}") };
    let BsdfKind::Phong { exponent, diffuse_reflectance, .. } = &scene.bsdfs[*nested].kind else { panic!() };
    assert_eq!((exponent, diffuse_reflectance), (&FloatInput::Value(20.0), &encoded([0.1, 0.1, 0.8])));
}

#[test]
fn bsdfs_by_name_win_over_the_library_and_one_without_a_name_over_all() {
    let green = "<bsdf type='diffuse' name='Blue.001'><rgb name='reflectance' value='0 1 0'/></bsdf>";
    let read = obj("0.6.0", green);
    let scene = &read.scene;
    let colors: Vec<_> = scene.shapes.iter().map(|s| scene.bsdfs[s.bsdf.unwrap()].kind.clone()).collect();
    let diffuse = |color| BsdfKind::Diffuse { reflectance: ColorInput::Color(color) };
    assert_eq!(colors[1], diffuse(Color::Rgb([0.0, 1.0, 0.0])));
    assert_eq!(colors[0], diffuse(Color::Srgb([0.8f32, 0.1, 0.1].map(f64::from))));
    let off = obj("0.6.0", &format!("{green}<boolean name='loadMaterials' value='false'/>"));
    assert_eq!(off.scene.shapes.iter().map(|s| s.bsdf.is_some()).collect::<Vec<_>>(), [false, true]);
    let all = obj("0.6.0", "<bsdf type='plastic'/>").scene;
    assert_eq!(all.shapes.len(), 1);
    assert_eq!(all.bsdfs.len(), 1);
    let one = obj("0.6.0", "<integer name='shapeIndex' value='1'/>").scene;
    assert_eq!(one.shapes.len(), 1);
    let missing = obj("0.6.0", "<bsdf type='plastic' name='Green'/>");
    assert!(
        said(&missing).contains(&"no face of `two.obj` has the material `Green`".to_owned()),
        "{:?}",
        said(&missing)
    );
    // Mitsuba 3 knows no libraries.
    let new = obj("3.0.0", "").scene;
    assert_eq!((new.shapes.len(), new.shapes[0].bsdf), (1, None));
}

/// 45° across a scene that is 4 wide: 2/tan 22.5° away from its nearest point, as in Mitsuba 0.6.
#[test]
fn an_old_scene_without_sensor_gets_one_that_sees_all_of_it() {
    let shapes = "<shape type='sphere'><float name='radius' value='2'/><point name='center' x='1' y='2' z='3'/></shape>
        <shape type='cube'><transform name='toWorld'><translate x='1' y='1' z='7'/></transform></shape>
        <shape type='cylinder'><point name='p0' x='1' y='2' z='4'/><point name='p1' x='1' y='2' z='6'/><float name='radius' value='1'/></shape>
        <shape type='disk'><transform name='toWorld'><translate x='1' y='2' z='5'/></transform></shape>
        <shape type='obj'><string name='filename' value='a.obj'/></shape>";
    let mesh = "v 0 1 2\nv 1 1 2\nv 1 2 2\nf 1 2 3\n";
    let files = files(&format!("<scene version='0.6.0'>{shapes}</scene>"), &[("a.obj", mesh)]);
    let read = read_scene(&files, Path::new("scene.xml"), &ReadOptions::default()).unwrap();
    let [sensor] = &read.scene.sensors[..] else { panic!("{:?}", read.scene.sensors) };
    let place = sensor.to_world.point([0.0; 3]);
    let right = [1.0, 2.0, 1.0 - 2.0 / 22.5f64.to_radians().tan()];
    assert!((0..3).all(|i| (place[i] - right[i]).abs() < 1e-9), "{place:?}, not {right:?}");
    assert_eq!(sensor.to_world.vector([0.0, 0.0, 1.0]), [0.0, 0.0, 1.0]);
    assert_eq!((sensor.film.width, sensor.film.height), (768, 576));
    assert!(said(&read).contains(&UNSEEN.to_owned()));
    // Mitsuba 3 renders nothing without one.
    let new = shapes.replace("toWorld", "to_world");
    assert!(
        try_read(
            &format!("<scene version='3.0.0'>{new}</scene>"),
            &[("a.obj", mesh)],
            &ReadOptions::default()
        )
        .is_ok_and(|read| read.scene.sensors.is_empty())
    );
}
