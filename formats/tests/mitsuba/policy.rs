//! What is a warning and what is an error: by whether it changes the light, and by `--lenient`.

use caustica_formats::diagnostic::{Diagnostic, Severity};
use caustica_formats::ir::{BsdfKind, Color, ColorInput, Filter, FloatInput, PrincipledIndex, Projection};
use caustica_formats::{ReadOptions, ir};

use crate::{headlines, try_read};

/// All that is said of a scene, and the scene if it could be read.
fn said(text: &str, lenient: bool) -> (Option<ir::Scene>, Vec<Diagnostic>) {
    match try_read(text, &[], &ReadOptions { lenient, ..ReadOptions::default() }) {
        Ok(read) => (Some(read.scene), read.warnings),
        Err(failure) => (None, failure.diagnostics),
    }
}

/// The only thing that is said of `body` in a scene of `version`, and whether it is an error.
fn only(version: &str, body: &str, lenient: bool) -> (Severity, String, bool) {
    let (_, said) = said(&format!("<scene version='{version}'>{body}</scene>"), lenient);
    let [only] = said.as_slice() else { panic!("{version} {body}: {said:?}") };
    assert!(only.span.is_some(), "{only:?}");
    (only.severity, only.message.clone(), only.unsupported)
}

const SENSOR: &str = "<sensor type='perspective'>";

#[test]
fn how_light_is_computed_and_stored_is_only_warned_about() {
    let in_film = |inner: &str| format!("{SENSOR}<film type='hdrfilm'>{inner}</film></sensor>");
    let cases = [
        (
            "<integrator type='vrl'/>".to_owned(),
            "unknown integrator plugin `vrl`: photon mapping renders the scene",
        ),
        (
            format!("{SENSOR}<film type='transient_hdr_film'/></sensor>"),
            "unknown film plugin `transient_hdr_film`: hdrfilm is used",
        ),
        (format!("{SENSOR}<film type='mfilm'/></sensor>"), "film `mfilm` is rendered as `hdrfilm`"),
        (
            format!("{SENSOR}<sampler type='correlated'/></sensor>"),
            "unknown sampler plugin `correlated`: independent samples are used",
        ),
        (in_film("<rfilter type='sharp'/>"), "unknown rfilter plugin `sharp`: gaussian is used"),
        (
            "<integrator type='path'><float name='clamp' value='2'/></integrator>".to_owned(),
            "unknown parameter `clamp` of path is ignored",
        ),
        (in_film("<integer name='bins' value='2'/>"), "unknown parameter `bins` of hdrfilm is ignored"),
        (
            in_film("<rfilter type='box'><float name='soft' value='2'/></rfilter>"),
            "unknown parameter `soft` of box is ignored",
        ),
        (
            format!("{SENSOR}<rfilter type='box'/></sensor>"),
            "a reconstruction filter belongs inside the <film>, not beside it: it is ignored",
        ),
    ];
    for version in ["0.6.0", "2.0.0", "3.0.0"] {
        for (body, message) in &cases {
            for lenient in [false, true] {
                assert_eq!(only(version, body, lenient), (Severity::Warning, (*message).to_owned(), false));
            }
        }
    }
}

#[test]
fn unknown_parameters_are_errors_from_version_2_on() {
    let sphere = "<shape type='sphere'><float name='velocity' value='2'/></shape>";
    let light = "<emitter type='constant'/>";
    let body = format!("{sphere}{light}");
    let name = "unknown parameter `velocity` of sphere";
    let ignored = format!("{name} is ignored");
    assert_eq!(only("0.6.0", &body, false), (Severity::Warning, ignored.clone(), false));
    for version in ["2.0.0", "3.0.0"] {
        assert_eq!(only(version, &body, false), (Severity::Error, name.to_owned(), false));
        assert_eq!(only(version, &body, true), (Severity::Warning, ignored.clone(), true));
    }
    let of_scene = ("<float name='fogDensity' value='1'/>", "unknown parameter `fogDensity` of the scene");
    assert_eq!(
        only("0.6.0", of_scene.0, false),
        (Severity::Warning, format!("{} is ignored", of_scene.1), false)
    );
    assert_eq!(only("3.0.0", of_scene.0, false), (Severity::Error, of_scene.1.to_owned(), false));
    // Mitsuba 0.6 warns of parameters only: a nested object that has no place there stops it.
    let nested = format!("<shape type='sphere'><texture type='checkerboard' name='paint'/></shape>{light}");
    assert_eq!(only("0.6.0", &nested, false).0, Severity::Error);
    assert_eq!(only("0.6.0", &nested, true).0, Severity::Warning);
}

#[test]
fn lenient_renders_the_nearest_thing_to_what_is_unknown() {
    let body = "<shape type='sphere'><bsdf type='velvet'/></shape><shape type='teapot'/><emitter type='glow'/>\
        <shape type='cube'><bsdf type='diffuse'><texture type='marble' name='reflectance'/></bsdf></shape>\
        <shape type='cube'><emitter type='neon'/></shape><fog/>";
    let text = format!("<scene version='3.0.0'>{body}</scene>");
    let (scene, strict) = said(&text, false);
    assert!(scene.is_none());
    assert!(strict.iter().all(|d| d.severity == Severity::Error), "{strict:?}");
    let (scene, lenient) = said(&text, true);
    let messages: Vec<&str> = lenient.iter().map(|d| d.message.as_str()).collect();
    assert_eq!(
        messages,
        [
            "unknown bsdf plugin `velvet`: diffuse gray 0.5 is used",
            "unknown shape plugin `teapot`: it is skipped",
            "unknown emitter plugin `glow`: it is skipped",
            "unknown texture plugin `marble`: gray 0.5 is used",
            "unknown emitter plugin `neon`: the shape does not emit light",
            "unknown element <fog>: it is skipped",
        ]
    );
    assert!(lenient.iter().all(|d| d.unsupported), "{lenient:?}");
    let scene = scene.unwrap();
    assert_eq!((scene.shapes.len(), scene.emitters.len()), (3, 0));
    let half = ColorInput::Color(Color::Gray(0.5));
    for shape in &scene.shapes[..2] {
        let bsdf = &scene.bsdfs[shape.bsdf.unwrap()];
        assert_eq!(bsdf.kind, BsdfKind::Diffuse { reflectance: half.clone() });
    }
}

#[test]
fn what_nothing_uses_is_a_warning() {
    for (plugin, message) in
        [("velvet", "unknown bsdf plugin `velvet`"), ("hair", "bsdf plugin `hair` is not rendered")]
    {
        let found = only("3.0.0", &format!("<bsdf type='{plugin}' id='a'/>"), false);
        assert_eq!(found, (Severity::Warning, format!("{message}: nothing uses it"), false));
    }
}

#[test]
fn undefined_parameters_take_the_defaults_of_their_places() {
    let text = "<scene version='3.0.0'><integrator type='$kind'/><sensor type='perspective'><film type='hdrfilm'>\
        <integer name='width' value='$res'/></film></sensor>\
        <bsdf type='diffuse' id='a'><float name='reflectance' value='$gray'/></bsdf></scene>";
    let (scene, strict) = said(text, false);
    assert!(scene.is_none() && strict.len() == 1, "{strict:?}");
    let (scene, lenient) = said(text, true);
    let messages: Vec<&str> = lenient.iter().map(|d| d.message.as_str()).collect();
    assert_eq!(messages, ["undefined parameters `$kind`, `$res`, `$gray`: every place has its default"]);
    let scene = scene.unwrap();
    assert_eq!(scene.sensors[0].film.width, 768);
    let half = ColorInput::Color(Color::Gray(0.5));
    assert_eq!(scene.bsdfs.iter().next().unwrap().1.kind, BsdfKind::Diffuse { reflectance: half });
}

/// What a missing file may define is not reported as missing once more.
#[test]
fn a_missing_include_has_no_echo() {
    let text = "<scene version='3.0.0'><include filename='materials.xml'/>\
        <shape type='sphere'><ref id='white'/><float name='radius' value='$size'/></shape>\
        <alias id='white' as='wall'/></scene>";
    assert_eq!(headlines(text), ["included file `materials.xml` not found"]);
}

#[test]
fn empty_ids_name_nothing() {
    let twice = "<bsdf type='diffuse' id=''/><bsdf type='diffuse' id=''/>";
    assert!(headlines(&format!("<scene version='0.5.0'>{twice}</scene>")).is_empty());
    let referred = format!("<scene version='3.0.0'>{twice}<shape type='cube'><ref id=''/></shape></scene>");
    assert_eq!(headlines(&referred), ["no object has the id ``"]);
}

#[test]
fn names_are_spelt_as_in_the_file() {
    let old = "<scene version='0.6.0'><integrator type='path'><boolean name='useRr' value='true'/></integrator>\
        <sensor type='perspective'><float name='nearClip' value='5'/><float name='farClip' value='2'/>\
        <float name='apertureRadius' value='1'/></sensor>\
        <bsdf type='roughconductor'><float name='alphaU' value='.1'/></bsdf>\
        <shape type='obj'><string name='filename' value='mesh.obj'/><string name='flipNormals' value='x'/></shape>\
        <emitter type='constant'/></scene>";
    assert_eq!(
        headlines(old),
        [
            "`nearClip` (5) must be below `farClip` (2)",
            "`alphaU` and `alphaV` must be given together",
            "parameter `flipNormals` of obj expects a boolean, got a string",
            "unknown parameter `useRr` of path is ignored",
            "parameter `apertureRadius` is ignored: a perspective sensor has no lens; thinlens has",
        ]
    );
    // Before 0.4, radiance was called intensity.
    let older = "<scene version='0.3.0'><shape type='sphere'><luminaire type='area'><string name='intensity' value='1'/></luminaire></shape></scene>";
    assert_eq!(headlines(older), ["parameter `intensity` of area expects a colour or texture, got a string"]);
    let new = "<scene version='3.0.0'><integrator type='path'><boolean name='useRr' value='true'/></integrator></scene>";
    assert_eq!(headlines(new), ["unknown parameter `useRr` of path is ignored"]);
}

#[test]
fn a_sensor_inside_of_a_shape_is_one_of_the_scene() {
    let text = "<scene version='3.0.0'><sensor type='orthographic'/>\
        <shape type='disk'><sensor type='perspective'><film type='hdrfilm'><rfilter type='box'/></film></sensor></shape></scene>";
    let (scene, said) = said(text, false);
    assert!(said.is_empty(), "{said:?}");
    let sensors = scene.unwrap().sensors;
    assert_eq!(sensors.len(), 2);
    assert!(matches!(sensors[1].projection, Projection::Perspective { .. }));
    assert_eq!(sensors[1].film.filter, Filter::Box { radius: 0.5 });
    for plugin in ["irradiancemeter", "nlos_capture_meter", "realisticlens"] {
        let body = format!("<shape type='disk'><sensor type='{plugin}'/></shape><emitter type='constant'/>");
        let message = format!("sensor plugin `{plugin}` is not supported yet");
        assert_eq!(only("2.0.0", &body, false), (Severity::Error, message, true));
    }
}

#[test]
fn values_that_only_stop_mitsuba() {
    let count = "<sensor type='perspective'><sampler type='independent'><integer name='sample_count' value='99999999999'/></sampler></sensor>";
    assert_eq!(only("2.0.0", count, false).1, "`sample_count` of 99999999999 is cut to 1073741824");
    let turn = |angle| {
        format!("<shape type='cube'><transform name='to_world'><rotate angle='{angle}'/></transform></shape>")
    };
    let found = only("3.0.0", &turn("0"), false);
    assert_eq!(
        (found.0, found.1.as_str()),
        (Severity::Warning, "the axis of <rotate> is zero, and so is the angle: nothing is turned")
    );
    assert_eq!(only("3.0.0", &turn("1"), false).0, Severity::Error);
}

/// 0.6 takes the last of several BSDFs of a shape; Mitsuba 2 and 3 refuse a second one.
#[test]
fn the_last_bsdf_of_an_old_shape_counts() {
    let text = |version| {
        format!(
            "<scene version='{version}'><shape type='cube'><bsdf type='plastic'/><bsdf type='dielectric'/></shape><emitter type='constant'/></scene>"
        )
    };
    let (scene, said) = said(&text("0.5.0"), false);
    assert_eq!(said[0].message, "a shape has one bsdf: this one is used instead of that before it");
    let scene = scene.unwrap();
    assert!(matches!(scene.bsdfs[scene.shapes[0].bsdf.unwrap()].kind, BsdfKind::Dielectric(_)));
    assert_eq!(headlines(&text("3.0.0")), ["cube takes one bsdf; this is a second one"]);
}

/// Marks of a renderer that samples specular chains and glints, which came from Mitsuba 2.
#[test]
fn marks_of_manifold_sampling_are_no_unknown_parameters() {
    let text = "<scene version='2.0.0'><emitter type='point'><boolean name='caustic_emitter_multi' value='true'/></emitter>\
        <shape type='obj'><string name='filename' value='mesh.obj'/><boolean name='glinty' value='true'/>\
        <bsdf type='normalmap'><bsdf type='dielectric'/><string name='filename' value='wood.png'/>\
        <boolean name='use_slopes' value='true'/><boolean name='lean_fallback' value='true'/><float name='tiles' value='4'/></bsdf></shape></scene>";
    assert!(headlines(text).is_empty(), "{:?}", headlines(text));
    // That the picture is missing is said alone.
    assert_eq!(headlines(&text.replace("wood.png", "no.png")), ["texture `no.png` not found"]);
}

/// Up to 3.6 Mitsuba takes the colours of a texture inside of an emitter as light.
#[test]
fn textures_of_emitters_may_exceed_one() {
    let texture = "<texture type='checkerboard' name='NAME'><rgb name='color1' value='30'/></texture>";
    let light = format!(
        "<shape type='cube'><emitter type='area'>{}</emitter></shape>",
        texture.replace("NAME", "radiance")
    );
    let found = only("3.0.0", &light, false);
    assert_eq!(
        (found.0, found.1.as_str()),
        (Severity::Warning, "`color1` is light here and may be more than 1: [30, 30, 30]")
    );
    let paint = format!("<bsdf type='diffuse'>{}</bsdf>", texture.replace("NAME", "reflectance"));
    let found = only("3.0.0", &paint, false);
    assert_eq!(
        (found.0, found.1.as_str()),
        (Severity::Error, "`color1` is a reflectance and must lie between 0 and 1, not [30, 30, 30]")
    );
}

/// The teaching renderer lajolla has Disney's model under names of its own.
#[test]
fn disney_models_become_principled() {
    let read = |plugin: &str, inner: &str| {
        let text = format!("<scene version='0.5.0'><bsdf type='{plugin}'>{inner}</bsdf></scene>");
        let (scene, said) = said(&text, false);
        assert_eq!(said.len(), 1, "{said:?}");
        assert_eq!(said[0].message, format!("bsdf `{plugin}` is rendered as `principled`"));
        match scene.unwrap().bsdfs.iter().next().unwrap().1.kind.clone() {
            BsdfKind::Principled(p) => *p,
            other => panic!("{other:?}"),
        }
    };
    let whole = read(
        "disneybsdf",
        "<rgb name='baseColor' value='.8 .6 .2'/><float name='specularTransmission' value='.25'/><float name='clearcoatGloss' value='.75'/><float name='eta' value='1.4'/>",
    );
    assert_eq!(whole.base_color, ColorInput::Color(Color::Rgb([0.8, 0.6, 0.2])));
    assert_eq!((whole.spec_trans, whole.clearcoat_gloss), (FloatInput::Value(0.25), FloatInput::Value(0.75)));
    assert_eq!(whole.index, PrincipledIndex::Eta(1.4));
    let metal = read("disneymetal", "<float name='roughness' value='.2'/>");
    assert_eq!((metal.metallic, metal.roughness), (FloatInput::Value(1.0), FloatInput::Value(0.2)));
    assert_eq!(read("disneyglass", "").spec_trans, FloatInput::Value(1.0));
    assert_eq!(
        read("disneydiffuse", "<float name='subsurface' value='.5'/>").flatness,
        FloatInput::Value(0.5)
    );
}
