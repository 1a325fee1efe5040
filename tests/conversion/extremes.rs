//! Extreme scenes in both languages: their target languages have no words for them, or their renderers refuse them.

use super::{Source, asymmetric};
use crate::support::picture;

fn pbrt(head: &[&str], world: &str) -> String {
    let said = |directive: &str| head.iter().find(|line| line.starts_with(directive)).copied();
    let lines = [
        said("LookAt").unwrap_or("LookAt 0 0 4  0 0 0  0 1 0"),
        said("Camera").unwrap_or("Camera \"perspective\" \"float fov\" 40"),
        said("PixelFilter").unwrap_or("PixelFilter \"box\""),
        said("Sampler").unwrap_or("Sampler \"independent\""),
        said("Integrator").unwrap_or("Integrator \"volpath\" \"integer maxdepth\" 5"),
        "Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 24",
        "WorldBegin",
        if world.contains("LightSource") { "" } else { "LightSource \"infinite\" \"rgb L\" [1 1 1]" },
    ];
    format!("{}\n{world}\n", lines.join("\n"))
}

/// pbrt scenes: a name, lines of the head, the world.
const PBRT: &[(&str, &[&str], &str)] = &[
    (
        "a bump map of one height",
        &[],
        "Texture \"c\" \"float\" \"constant\" \"float value\" 3\nTexture \"d\" \"float\" \"scale\" \"texture tex\" \"c\" \"float scale\" 2\nMaterial \"diffuse\" \"texture displacement\" \"d\"\nShape \"sphere\"",
    ),
    (
        "a bump map by a checkerboard",
        &[],
        "Texture \"d\" \"float\" \"checkerboard\" \"float tex1\" 1 \"float tex2\" 0\nMaterial \"diffuse\" \"texture displacement\" \"d\"\nShape \"sphere\"",
    ),
    (
        "a bump map by noise",
        &[],
        "Texture \"d\" \"float\" \"fbm\"\nMaterial \"diffuse\" \"texture displacement\" \"d\"\nShape \"sphere\"",
    ),
    (
        "a bump map by dots",
        &[],
        "Texture \"d\" \"float\" \"dots\" \"float inside\" 1 \"float outside\" 0\nMaterial \"diffuse\" \"texture displacement\" \"d\"\nShape \"sphere\"",
    ),
    ("a gray normal map", &[], "Material \"diffuse\" \"string normalmap\" \"gray.pfm\"\nShape \"sphere\""),
    (
        "a lamp without area",
        &[],
        "Shape \"sphere\"\nAreaLightSource \"diffuse\"\nShape \"trianglemesh\" \"point3 P\" [0 0 0 0 0 0 0 0 0] \"integer indices\" [0 1 2]",
    ),
    (
        "normals of length 0",
        &[],
        "Shape \"trianglemesh\" \"point3 P\" [-1 -1 0 1 -1 0 0 1 0] \"integer indices\" [0 1 2] \"normal N\" [0 0 0 0 0 0 0 0 0]",
    ),
    (
        "a lamp of negative light",
        &[],
        "LightSource \"infinite\" \"rgb L\" [1 1 1]\nAreaLightSource \"diffuse\" \"float scale\" -1\nShape \"sphere\"",
    ),
    (
        "a lens and a shifted window",
        &[
            "Camera \"perspective\" \"float fov\" 40 \"float lensradius\" 0.1 \"float focaldistance\" 4 \"float screenwindow\" [0 2 -1 1]",
        ],
        "Shape \"sphere\"",
    ),
    (
        "a shifted orthographic window",
        &["Camera \"orthographic\" \"float screenwindow\" [-0.2 1.8 -1.3 0.7]"],
        "Shape \"sphere\"",
    ),
    (
        "a sheared camera",
        &["LookAt 0 0 4  0 0 0  0 1 0\nConcatTransform [1 0 0 0  0.5 1 0 0  0 0 1 0  0 0 0 1]"],
        "Shape \"sphere\"",
    ),
    (
        "a narrow box filter",
        &["PixelFilter \"box\" \"float xradius\" 0.1 \"float yradius\" 0.1"],
        "Shape \"sphere\"",
    ),
    (
        "a negative seed",
        &["Sampler \"independent\" \"integer pixelsamples\" 4 \"integer seed\" -5"],
        "Shape \"sphere\"",
    ),
    (
        "two thousand million samples",
        &["Sampler \"independent\" \"integer pixelsamples\" 2147483647"],
        "Shape \"sphere\"",
    ),
    (
        "two thousand million bounces",
        &["Integrator \"volpath\" \"integer maxdepth\" 2147483647"],
        "Shape \"sphere\"",
    ),
    ("a header with `obj_info`", &[], "Shape \"plymesh\" \"string filename\" \"info.ply\""),
    ("a lamp of two sides, disk", &[], TWO_SIDED_DISK),
    (
        "a lamp of two sides, mirrored and reversed disk",
        &[],
        "LightSource \"infinite\" \"rgb L\" [0.1 0.1 0.1]\nAreaLightSource \"diffuse\" \"bool twosided\" true \"rgb L\" [4 3 2]\nReverseOrientation\nRotate 60 1 0.2 0\nScale 1 1 -1\nShape \"disk\" \"float radius\" 0.6",
    ),
    (
        "a lamp of two sides, cylinder",
        &[],
        "LightSource \"infinite\" \"rgb L\" [0.1 0.1 0.1]\nAreaLightSource \"diffuse\" \"bool twosided\" true \"rgb L\" [4 3 2]\nRotate 60 1 0.2 0\nScale 1 -1 1\nShape \"cylinder\" \"float radius\" 0.5",
    ),
    (
        "a lamp of two sides, mesh with normals",
        &[],
        "LightSource \"infinite\" \"rgb L\" [0.1 0.1 0.1]\nAreaLightSource \"diffuse\" \"bool twosided\" true \"rgb L\" [4 3 2]\nShape \"trianglemesh\" \"point3 P\" [-1 -1 0 1 -1 0 0 1 0] \"integer indices\" [0 1 2] \"normal N\" [0 0 -1 0 0 -1 0 0 -1]\nMaterial \"diffuse\"\nTranslate 0 0 -1\nShape \"disk\" \"float radius\" 2",
    ),
    (
        "a lamp of two sides, bilinear patch",
        &[],
        "LightSource \"infinite\" \"rgb L\" [0.1 0.1 0.1]\nAreaLightSource \"diffuse\" \"bool twosided\" true \"string filename\" \"t.pfm\"\nShape \"bilinearmesh\" \"point3 P\" [-1 -1 0 1 -1 0.2 -1 1 0.3 1 1 0]\nAreaLightSource \"diffuse\" \"rgb L\" [0 0 0]\nMaterial \"diffuse\"\nTranslate 0 0 -1\nShape \"disk\" \"float radius\" 2",
    ),
    (
        "the power of a sphere",
        &[],
        "LightSource \"infinite\" \"rgb L\" [0.1 0.1 0.1]\nAreaLightSource \"diffuse\" \"rgb L\" [4 3 2] \"float power\" 60\nShape \"sphere\" \"float radius\" 0.7",
    ),
    (
        "the power of a lamp of two sides",
        &[],
        "LightSource \"infinite\" \"rgb L\" [0.1 0.1 0.1]\nAreaLightSource \"diffuse\" \"bool twosided\" true \"rgb L\" [4 3 2] \"float power\" 60 \"float scale\" 2\nShape \"disk\" \"float radius\" 0.7",
    ),
    (
        "the power of a projection",
        &[],
        "Translate 0 0 3\nRotate 180 0 1 0\nLightSource \"projection\" \"string filename\" \"t.pfm\" \"float power\" 60 \"float fov\" 70 \"float scale\" 3\nIdentity\nLookAt 0 0 4  0 0 0  0 1 0\nShape \"sphere\"",
    ),
    (
        "the power of a bulb",
        &[],
        "Translate 0 0 3\nLightSource \"goniometric\" \"float power\" 60 \"rgb I\" [3 2 1]\nShape \"sphere\"",
    ),
];

const TWO_SIDED_DISK: &str = "LightSource \"infinite\" \"rgb L\" [0.1 0.1 0.1]\nAreaLightSource \"diffuse\" \"bool twosided\" true \"rgb L\" [4 3 2]\nRotate 120 1 0.2 0\nShape \"disk\" \"float radius\" 0.7";

const SENSOR: &str = "<sensor type='perspective'><float name='fov' value='40'/>";

fn mitsuba(version: &str, sensor: &str, integrator: &str, world: &str) -> String {
    let sky = if world.contains("<emitter") { "" } else { "<emitter type='constant'/>" };
    format!(
        "<scene version='{version}'>{integrator}{sensor}<transform name='to_world'>
         <lookat origin='0,0,4' target='0,0,0' up='0,1,0'/></transform>
         <film type='hdrfilm'><integer name='width' value='24'/><integer name='height' value='24'/>
         <rfilter type='box'/></film></sensor>{sky}{world}</scene>"
    )
}

const PATH: &str = "<integrator type='path'><integer name='max_depth' value='5'/></integrator>";

const BUMP: &str = "<texture type='bitmap' name='t'><string name='filename' value='t.pfm'/></texture>";

/// Scenes for Mitsuba: a name, the version, the sensor, the integrator, the world.
fn mitsuba_scenes() -> Vec<(String, String)> {
    let ball = |bsdf: &str| format!("<shape type='sphere'>{bsdf}</shape>");
    let mixed = "<bsdf type='blendbsdf'><float name='weight' value='0.5'/><bsdf type='diffuse'/><bsdf type='plastic'/></bsdf>";
    let nothing = "<bsdf type='blendbsdf'><float name='weight' value='0.5'/><bsdf type='null'/><bsdf type='null'/></bsdf>";
    let bumped = format!("<bsdf type='bumpmap'>{BUMP}{mixed}</bsdf>");
    let normals = |inside: &str| format!("<bsdf type='normalmap'>{inside}<bsdf type='diffuse'/></bsdf>");
    let depth = |name: &str, value: &str| {
        format!("<integrator type='path'><integer name='{name}' value='{value}'/></integrator>")
    };
    let direct = "<integrator type='direct'><integer name='emitter_samples' value='0'/><integer name='bsdf_samples' value='0'/></integrator>";
    let mut scenes = Vec::new();
    let mut add = |name: &str, version: &str, sensor: &str, integrator: &str, world: &str| {
        scenes.push((name.to_owned(), mitsuba(version, sensor, integrator, world)));
    };
    add("a bump map over a mix", "3.0.0", SENSOR, PATH, &ball(&bumped));
    add("a mix of nothing", "3.0.0", SENSOR, PATH, &ball(nothing));
    add(
        "a bump map over nothing",
        "3.0.0",
        SENSOR,
        PATH,
        &ball(&format!("<bsdf type='bumpmap'>{BUMP}<bsdf type='null'/></bsdf>")),
    );
    add(
        "a gray normal map",
        "0.6.0",
        SENSOR,
        PATH,
        &ball(&normals(
            "<texture type='bitmap' name='normalmap'><boolean name='raw' value='true'/><string name='filename' value='gray.pfm'/></texture>",
        )),
    );
    add(
        "a coat of index 0.5",
        "3.0.0",
        SENSOR,
        PATH,
        &ball(
            "<bsdf type='plastic'><float name='int_ior' value='0.5'/><float name='ext_ior' value='1'/></bsdf>",
        ),
    );
    add(
        "a spectrum of two wavelengths",
        "0.6.0",
        SENSOR,
        PATH,
        &ball("<bsdf type='diffuse'><spectrum name='reflectance' value='500:0.2, 600:0.3'/></bsdf>"),
    );
    add(
        "a spot with an even texture",
        "0.6.0",
        SENSOR,
        PATH,
        &format!(
            "{}<emitter type='spot'><texture type='scale' name='texture'><float name='scale' value='3'/><float name='value' value='1'/></texture><transform name='to_world'><translate z='-5'/></transform></emitter><emitter type='constant'/>",
            ball("")
        ),
    );
    add(
        "a picture in a channel Z",
        "3.0.0",
        SENSOR,
        PATH,
        &ball(
            "<bsdf type='diffuse'><texture type='bitmap' name='reflectance'><string name='filename' value='z.exr'/></texture></bsdf>",
        ),
    );
    add(
        "a shifted lens",
        "0.6.0",
        "<sensor type='thinlens'><float name='aperture_radius' value='0.1'/><float name='principal_point_offset_x' value='0.2'/><float name='fov' value='40'/>",
        PATH,
        &ball(""),
    );
    add(
        "a shifted orthographic picture",
        "0.6.0",
        "<sensor type='orthographic'><float name='principal_point_offset_x' value='0.2'/><float name='principal_point_offset_y' value='-0.1'/>",
        PATH,
        &ball(""),
    );
    for (name, value) in [("max_depth", "4000000000"), ("rr_depth", "2147483647")] {
        add(&format!("{name} {value}"), "3.0.0", SENSOR, &depth(name, value), &ball(""));
    }
    add("no samples at all", "3.0.0", SENSOR, direct, &ball(""));
    for file in MESHES.iter().map(|(name, _)| *name).filter(|name| name.ends_with("obj")) {
        let mesh = format!("<shape type='obj'><string name='filename' value='{file}'/></shape>");
        add(file, "3.0.0", SENSOR, PATH, &mesh);
    }
    scenes
}

/// Meshes that our readers mend and Mitsuba's refuse.
const MESHES: &[(&str, &str)] = &[
    ("backwards.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf -4 -3 -2\nf -4 -2 -1\n"),
    ("continued.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 \\\n3 4\n"),
    ("ahead.obj", "f 1 2 3 4\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n"),
    ("no-normals.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvn 0 0 0\nf 1//1 2//1 3//1\n"),
    ("one-uv.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0.5\nf 1/1 2/1 3/1\n"),
    ("mark.obj", "\u{feff}v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n"),
    ("returns.obj", "v -1 -1 0\rv 1 -1 0\rv 1 1 0\rv -1 1 0\rf 1 2 3 4\r"),
    (
        "info.ply",
        "ply\nformat ascii 1.0\nobj_info of nobody\nelement vertex 3\nproperty float x\nproperty float y\n\
         property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
         -1 -1 0\n1 -1 0\n0 1 0\n3 0 1 2\n",
    ),
];

pub fn sources() -> Vec<(String, Source)> {
    let gray = b"Pf\n2 2\n-1.0\n"
        .iter()
        .copied()
        .chain([0.4f32, 0.5, 0.6, 0.5].iter().flat_map(|v| v.to_le_bytes()));
    let layer = caustica_formats::image::ExrLayer {
        name: "",
        channels: &["Z"],
        data: &[0.1, 0.9, 0.5, 0.3, 0.2, 0.7],
    };
    let z = caustica_formats::image::encode_exr(3, 2, &[layer], &[], Default::default()).unwrap();
    let mut beside = vec![
        ("t.pfm", asymmetric(1.0)),
        ("gray.pfm", gray.collect()),
        ("z.exr", z),
        ("square.pfm", picture(4, |x, y| [0.1 * x as f32, 0.1 * y as f32, 0.2], 4)),
    ];
    beside.extend(MESHES.iter().map(|(name, text)| (*name, text.as_bytes().to_vec())));
    let from_pbrt = PBRT
        .iter()
        .map(|(name, head, world)| ((*name).to_owned(), Source::new("a.pbrt", &pbrt(head, world), &beside)));
    let from_mitsuba =
        mitsuba_scenes().into_iter().map(|(name, text)| (name, Source::new("a.xml", &text, &beside)));
    from_pbrt.chain(from_mitsuba).collect()
}
