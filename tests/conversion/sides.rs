//! Which side of a mesh is its front: by the normals of its author, or by its winding in the world without.

use super::{Source, mean_of};

/// A square whose winding faces +Z, with the normals (0, 0, `normal`).
fn square(extension: &str, normal: i32) -> Vec<u8> {
    let corners = ["-1 -1 0", "1 -1 0", "1 1 0", "-1 1 0"];
    if extension == "obj" {
        let v: String = corners.iter().map(|c| format!("v {c}\n")).collect();
        let faces = match normal {
            0 => "f 1 2 3\nf 1 3 4\n".to_owned(),
            n => format!("vn 0 0 {n}\nf 1//1 2//1 3//1\nf 1//1 3//1 4//1\n"),
        };
        return (v + &faces).into_bytes();
    }
    let axes = |prefix: &str| ["x", "y", "z"].map(|axis| format!("property float {prefix}{axis}\n")).concat();
    let (named, values) = match normal {
        0 => (String::new(), String::new()),
        n => (axes("n"), format!(" 0 0 {n}")),
    };
    let v: String = corners.iter().map(|c| format!("{c}{values}\n")).collect();
    format!(
        "ply\nformat ascii 1.0\nelement vertex 4\n{}{named}element face 2\n\
         property list uchar int vertex_indices\nend_header\n{v}3 0 1 2\n3 0 2 3\n",
        axes("")
    )
    .into_bytes()
}

/// Seen from +Z.
fn lamp(version: &str, extension: &str, mirrored: bool, inside: &str) -> String {
    let scale = if mirrored { "<scale x='-1' y='1' z='1'/>" } else { "" };
    format!(
        "<scene version='{version}'><integrator type='path'/><sensor type='perspective'><float name='fov' value='10'/>
         <transform name='to_world'><lookat origin='0,0,5' target='0,0,0' up='0,1,0'/></transform>
         <film type='hdrfilm'><integer name='width' value='4'/><integer name='height' value='4'/>
         <rfilter type='box'/></film></sensor>
         <shape type='{extension}'><string name='filename' value='mesh.{extension}'/>{inside}
         <transform name='to_world'>{scale}</transform>
         <emitter type='area'><rgb name='radiance' value='1,1,1'/></emitter></shape></scene>"
    )
}

/// What Mitsuba 3.9.1 shows of such lamps: 40 of them were rendered with it.
#[test]
fn a_mirror_turns_meshes_without_normals_of_their_own() {
    let mut wrong = Vec::new();
    for case in 0..64 {
        let [ply, mirrored, flipped, flat] = [0, 1, 2, 3].map(|bit| case >> bit & 1 == 1);
        let normal = [0, 1, -1, 0][case >> 4];
        // The crease angle of version 0.6 replaces the normals of the file.
        let creased = case >> 4 == 3;
        let extension = if ply { "ply" } else { "obj" };
        let mut inside = format!("<boolean name='flip_normals' value='{flipped}'/>");
        inside += &format!("<boolean name='face_normals' value='{flat}'/>");
        if creased {
            inside = inside.replace("flip_normals", "flipNormals").replace("face_normals", "faceNormals");
            inside += "<float name='maxSmoothAngle' value='30'/>";
        }
        let by_winding = normal == 0 || flat;
        let front = if by_winding { !mirrored } else { normal > 0 };
        let right = if front != flipped { 1.0 } else { 0.0 };
        let version = if creased { "0.6.0" } else { "3.0.0" };
        let text = lamp(version, extension, mirrored, &inside)
            .replace("to_world", if creased { "toWorld" } else { "to_world" });
        let file = format!("mesh.{extension}");
        let source = Source::new("a.xml", &text, &[(&file, square(extension, normal))]);
        let mut shown = vec![mean_of(&source.picture(1).pixel_values())];
        shown.push(mean_of(&source.convert_to("own.xml").picture(1).pixel_values()));
        let there = source.convert();
        let mut back = Source { name: "made.pbrt", files: there.files.0.clone() };
        shown.push(mean_of(&there.picture(1).pixel_values()));
        for name in ["back.xml", "again.pbrt"] {
            let made = back.convert_to(name);
            shown.push(mean_of(&made.picture(1).pixel_values()));
            back = Source { name, files: made.files.0 };
        }
        if shown.iter().any(|mean| (mean - right).abs() > 1e-6) {
            wrong.push(format!("{extension} {normal} mirrored {mirrored} {inside}: {right}, not {shown:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
