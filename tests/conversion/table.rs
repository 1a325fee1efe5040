//! Every shape × every use of a texture × both directions, by picture; the table is left in `target/`.

use std::fmt::Write;

use super::{Difference, Source, asymmetric};
use crate::support::picture;

const USES: [&str; 4] = ["surface", "lamp", "opacity", "normal map"];

/// Cut out along a diagonal of the picture, with a hole.
fn holes() -> Vec<u8> {
    let texel = |x: usize, y: usize| [if x > y || (x, y) == (0, 2) { 1.0 } else { 0.0 }; 3];
    picture(4, texel, 3)
}

/// Normals that lean to all sides, as they are stored.
fn normals() -> Vec<u8> {
    let texel = |x: usize, y: usize| {
        let (a, b) = (0.5 * x as f32 / 3.0 - 0.1, 0.4 * y as f32 / 2.0 - 0.3);
        let c = (1.0 - a * a - b * b).sqrt();
        [a, b, c].map(|v| 0.5 + 0.5 * v)
    };
    picture(4, texel, 3)
}

const OBJ: &str = "v -1 -1 0\nv 1 -1 0.2\nv 1 1 0\nv -1 1 0.3\nvt 0.1 0\nvt 1 0.2\nvt 0.9 1\nvt 0 0.8\n\
                   f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                   property float u\nproperty float v\nelement face 2\nproperty list uchar int vertex_indices\n\
                   end_header\n-1 -1 0 0.1 0\n1 -1 0.2 1 0.2\n1 1 0 0.9 1\n-1 1 0.3 0 0.8\n3 0 1 2\n3 0 2 3\n";

fn beside() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("t.pfm", asymmetric(1.0)),
        ("holes.pfm", holes()),
        ("n.pfm", normals()),
        ("mesh.obj", OBJ.as_bytes().to_vec()),
        ("mesh.ply", PLY.as_bytes().to_vec()),
    ]
}

const TURN: &str = "<rotate x='1' angle='-30'/><rotate y='1' angle='25'/>";

/// Name, plugin, what stands inside, and the transforms.
const MITSUBA: [(&str, &str, &str, &str); 11] = [
    ("rectangle", "rectangle", "", TURN),
    ("cube", "cube", "", TURN),
    ("sphere", "sphere", "", TURN),
    ("disk", "disk", "", TURN),
    ("stretched disk", "disk", "", "<scale x='1.3' y='0.6'/><rotate x='1' angle='-30'/>"),
    ("mirrored disk", "disk", "", "<scale x='-1'/><rotate x='1' angle='-30'/>"),
    (
        "cylinder",
        "cylinder",
        "<point name='p0' value='-0.7,-0.9,0.2'/><point name='p1' value='0.6,0.8,-0.1'/><float name='radius' value='0.6'/>",
        "",
    ),
    (
        "turned cylinder",
        "cylinder",
        "<point name='p0' value='0,-0.8,0'/><point name='p1' value='0,0.8,0'/><float name='radius' value='0.7'/>",
        "<rotate x='0.957826285' y='0.287347886' angle='50'/><rotate z='1' angle='-70'/>",
    ),
    ("obj", "obj", "<string name='filename' value='mesh.obj'/>", TURN),
    ("ply", "ply", "<string name='filename' value='mesh.ply'/>", TURN),
    (
        "flipped ply",
        "ply",
        "<string name='filename' value='mesh.ply'/><boolean name='flip_normals' value='true'/>",
        TURN,
    ),
];

fn mitsuba(shape: (&str, &str, &str, &str), usage: &str) -> Source {
    let (_, plugin, inside, turn) = shape;
    let texture = |name: &str, file: &str| {
        format!(
            "<texture name='{name}' type='bitmap'><boolean name='raw' value='true'/><string name='filename' value='{file}'/></texture>"
        )
    };
    let sided = |bsdf: String| format!("<bsdf type='twosided'>{bsdf}</bsdf>");
    let matte = |inside: &str| format!("<bsdf type='diffuse'>{inside}</bsdf>");
    let plain = matte("<rgb name='reflectance' value='0.5'/>");
    let look = match usage {
        "surface" => sided(matte(&texture("reflectance", "t.pfm"))),
        "lamp" => format!("{}<emitter type='area'>{}</emitter>", sided(plain), texture("radiance", "t.pfm")),
        "opacity" => format!("<bsdf type='mask'>{}{}</bsdf>", texture("opacity", "holes.pfm"), sided(plain)),
        _ => sided(format!(
            "<bsdf type='normalmap'><boolean name='flip_invalid_normals' value='false'/>
             <boolean name='use_shadowing_function' value='false'/>{}{plain}</bsdf>",
            texture("normalmap", "n.pfm")
        )),
    };
    let text = format!(
        "<scene version='3.0.0'><integrator type='path'/><sensor type='perspective'><float name='fov' value='40'/>
         <transform name='to_world'><lookat origin='0.3,0.8,4' target='0,0,0' up='0,1,0'/></transform>
         <film type='hdrfilm'><integer name='width' value='32'/><integer name='height' value='32'/>
         <rfilter type='box'/></film></sensor>
         <emitter type='directional'><vector name='direction' value='-0.4,-0.6,-1'/><rgb name='irradiance' value='2,1.5,1'/></emitter>
         <emitter type='constant'><rgb name='radiance' value='0.1,0.15,0.2'/></emitter>
         <shape type='{plugin}'>{inside}<transform name='to_world'>{turn}</transform>{look}</shape></scene>"
    );
    Source::new("source.xml", &text, &beside())
}

const PBRT: [(&str, &str); 13] = [
    ("sphere", "Rotate 35 1 0.3 0\nShape \"sphere\""),
    ("mirrored sphere", "Rotate 35 1 0.3 0\nScale -1 1 1\nShape \"sphere\""),
    ("ellipsoid", "Rotate 35 1 0.3 0\nScale 1.2 0.5 0.8\nShape \"sphere\""),
    (
        "cut sphere",
        "Rotate 60 1 0.3 0\nShape \"sphere\" \"float zmin\" -0.6 \"float zmax\" 0.8 \"float phimax\" 250",
    ),
    ("disk", "Rotate -30 1 0.3 0\nShape \"disk\""),
    ("cut disk", "Rotate -30 1 0.3 0\nShape \"disk\" \"float innerradius\" 0.3 \"float phimax\" 300"),
    ("cylinder", "Rotate 60 1 0.3 0\nShape \"cylinder\" \"float radius\" 0.7"),
    ("stretched cylinder", "Rotate 60 1 0.3 0\nScale 1.2 0.5 0.9\nShape \"cylinder\" \"float radius\" 0.7"),
    (
        "trianglemesh",
        "Rotate -30 1 0.3 0\nShape \"trianglemesh\" \"point3 P\" [-1 -1 0 1 -1 0.2 1 1 0 -1 1 0.3]\n\
         \"point2 uv\" [0.1 0 1 0.2 0.9 1 0 0.8] \"integer indices\" [0 1 2 0 2 3]",
    ),
    (
        "mirrored trianglemesh",
        "Rotate -30 1 0.3 0\nScale -1 1 1\nShape \"trianglemesh\" \"point3 P\" [-1 -1 0 1 -1 0.2 1 1 0 -1 1 0.3]\n\
         \"point2 uv\" [0.1 0 1 0.2 0.9 1 0 0.8] \"integer indices\" [0 1 2 0 2 3]",
    ),
    (
        "mirrored mesh with normals",
        "Rotate -30 1 0.3 0\nScale -1 1 1\nShape \"trianglemesh\" \"point3 P\" [-1 -1 0 1 -1 0.2 1 1 0 -1 1 0.3]\n\
         \"normal N\" [-0.1 0 1 0.1 0 1 0 0.2 1 0 0 1]\n\
         \"point2 uv\" [0.1 0 1 0.2 0.9 1 0 0.8] \"integer indices\" [0 1 2 0 2 3]",
    ),
    (
        "bilinearmesh",
        "Rotate -30 1 0.3 0\nShape \"bilinearmesh\" \"point3 P\" [-1 -1 0 1 -1 0.2 -1 1 0.3 1 1 0]",
    ),
    ("plymesh", "Rotate -30 1 0.3 0\nShape \"plymesh\" \"string filename\" \"mesh.ply\""),
];

fn pbrt(shape: &str, usage: &str) -> Source {
    let image = |kind: &str, file: &str| {
        format!(
            "Texture \"t\" \"{kind}\" \"imagemap\" \"string filename\" \"{file}\" \"string encoding\" \"linear\"\n"
        )
    };
    let (before, after) = match usage {
        "surface" => (
            image("spectrum", "t.pfm") + "Material \"diffuse\" \"texture reflectance\" \"t\"\n",
            String::new(),
        ),
        "lamp" => ("AreaLightSource \"diffuse\" \"string filename\" \"t.pfm\"\n".to_owned(), String::new()),
        "opacity" => {
            (image("float", "holes.pfm") + "Material \"diffuse\"\n", " \"texture alpha\" \"t\"".to_owned())
        }
        _ => ("Material \"diffuse\" \"string normalmap\" \"n.pfm\"\n".to_owned(), String::new()),
    };
    let text = format!(
        "LookAt 0.3 0.8 4 0 0 0 0 1 0\nCamera \"perspective\" \"float fov\" 40\n\
         Film \"rgb\" \"integer xresolution\" 32 \"integer yresolution\" 32\nPixelFilter \"box\"\nSampler \"independent\"\n\
         Integrator \"path\" \"integer maxdepth\" 5\nWorldBegin\n\
         LightSource \"distant\" \"point3 from\" [0.4 0.6 1] \"point3 to\" [0 0 0] \"rgb L\" [2 1.5 1]\n\
         LightSource \"infinite\" \"rgb L\" [0.1 0.15 0.2]\n\
         AttributeBegin\n{before}{shape}{after}\nAttributeEnd\n"
    );
    Source::new("source.pbrt", &text, &beside())
}

/// Losses that say how large they are, and stay below what the test sees.
fn is_small(what: &str, instead: &str) -> bool {
    instead.contains("0.03 % of the radius")
        // The picture decides: only surfaces that turn their front to the camera are seen here.
        || what.contains("black on its back")
}

#[test]
fn textured_shapes_keep_their_picture() {
    let mut table = String::from("direction | shape | use | noise | difference | bias | losses\n");
    let mut wrong = Vec::new();
    let mut row = |direction: &str, shape: &str, usage: &str, source: &Source| {
        let made = source.convert();
        let found = Difference::of(source, &made);
        let losses: Vec<_> = made.losses.iter().map(|l| format!("{} ({})", l.what, l.instead)).collect();
        let line = format!(
            "{direction} | {shape} | {usage} | {:.2} % | {:.2} % | {:+.2} % | {}",
            100.0 * found.noise,
            100.0 * found.rmse,
            100.0 * found.bias,
            losses.join("; ")
        );
        let _ = writeln!(table, "{line}");
        let small = made.losses.iter().all(|loss| is_small(&loss.what, &loss.instead));
        // Normals that lean 1.4° aside change the light by 2.5 % at most, and half of that on average.
        let room = if made.losses.is_empty() { 0.0 } else { 0.0125 };
        if !(found.is_noise_and(room) && small) {
            wrong.push(line);
        }
    };
    for usage in USES {
        for shape in MITSUBA {
            row("Mitsuba to pbrt", shape.0, usage, &mitsuba(shape, usage));
        }
        for (name, shape) in PBRT {
            row("pbrt to Mitsuba", name, usage, &pbrt(shape, usage));
        }
    }
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("target/conversion.txt");
    std::fs::write(&path, &table).unwrap();
    assert!(wrong.is_empty(), "see {}:\n{}", path.display(), wrong.join("\n"));
}
