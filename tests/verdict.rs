//! `inspect`, `render` and `convert` say the same of the same scene.

use std::path::Path;
use std::process::Command;

use crate::support::box_camera;

/// Exit status and error messages with their places.
fn verdict(folder: &Path, arguments: &[&str]) -> (i32, Vec<String>) {
    let mut program = Command::new(env!("CARGO_BIN_EXE_caustica"));
    let output = program.args(arguments).current_dir(folder).output().unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let errors = lines.iter().enumerate().filter(|(_, line)| line.starts_with("error"));
    let placed =
        |(i, line): (usize, &&str)| format!("{line} {}", lines.get(i + 1).map_or("", |next| next.trim()));
    (output.status.code().unwrap_or(-1), errors.map(placed).collect())
}

/// Scenes with the errors of each stage: of reading, of compiling, of files beside them, and with none.
fn scenes() -> Vec<(&'static str, String, i32, &'static str)> {
    let camera = box_camera(4);
    let scene = |inside: &str| format!("<scene version='3.0.0'>{camera}{inside}</scene>");
    let mesh = |name: &str| format!("<shape type='obj'><string name='filename' value='{name}'/></shape>");
    let picture = "<shape type='cube'><bsdf type='diffuse'><texture type='bitmap' name='reflectance'>\
                   <string name='filename' value='page.png'/></texture></bsdf></shape>";
    let nested = "<shape type='cube'><bsdf type='bumpmap'><texture type='checkerboard'/><bsdf type='bumpmap'>\
                  <texture type='checkerboard'/><bsdf type='diffuse'/></bsdf></bsdf></shape>";
    vec![
        ("good.xml", scene("<shape type='cube'/>"), 0, ""),
        ("unknown.xml", scene("<shape type='cub'/>"), 1, "unknown shape plugin `cub`"),
        (
            "grid.xml",
            scene("<shape type='sdfgrid'><string name='filename' value='a'/></shape>"),
            1,
            "not supported",
        ),
        ("missing.xml", scene(&mesh("gone.obj")), 1, "`gone.obj` not found"),
        ("broken.xml", scene(&mesh("broken.obj")), 1, "refers to vertex 9, but 1 are defined"),
        (
            "pointer.xml",
            scene(&mesh("pointer.obj")),
            1,
            "a Git LFS pointer: fetch the file with `git lfs pull`",
        ),
        ("page.xml", scene(picture), 1, "it is an HTML page, probably of a failed download"),
        (
            "singular.xml",
            scene("<shape type='cube'><transform name='to_world'><scale value='0'/></transform></shape>"),
            1,
            "singular",
        ),
        ("nested.xml", scene(nested), 1, "a bump or normal map inside another one is not supported"),
        (
            "blind.xml",
            "<scene version='3.0.0'><shape type='cube'/></scene>".to_owned(),
            1,
            "the scene has no sensor",
        ),
    ]
}

#[test]
fn three_commands_agree() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("broken.obj", "v 0 0 0\nf 1 9 1\n");
    write("pointer.obj", "version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 1\n");
    write("page.png", "\n<!DOCTYPE html>\n<title>404</title>\n");
    for (name, text, status, message) in scenes() {
        write(name, &text);
        let inspected = verdict(folder.path(), &["inspect", name]);
        let rendered = verdict(folder.path(), &["render", name, "--spp", "1", "-q", "-o", "out.exr"]);
        let converted = verdict(folder.path(), &["convert", name, "out.pbrt", "--force"]);
        assert_eq!(inspected, rendered, "{name}");
        assert_eq!(inspected, converted, "{name}");
        assert_eq!(inspected.0, status, "{name}: {inspected:?}");
        assert!(
            message.is_empty() || inspected.1.iter().any(|e| e.contains(message)),
            "{name}: {inspected:?}"
        );
    }
}

/// One note names the one folder that all files outside are below, in a command line that works when it is copied.
#[test]
fn the_folder_to_allow_is_named_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for name in ["scenes/deep", "my meshes/a", "my meshes/b"] {
        std::fs::create_dir_all(path(name)).unwrap();
    }
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    std::fs::write(path("my meshes/a/x.obj"), triangle).unwrap();
    std::fs::write(path("my meshes/b/y.obj"), triangle).unwrap();
    let mesh = |name: &str| format!("<shape type='obj'><string name='filename' value='{name}'/></shape>");
    let (x, y) = (mesh("../../my meshes/a/x.obj"), mesh("../../my meshes/b/y.obj"));
    let text = format!("<scene version='3.0.0'>{}{x}{y}</scene>", box_camera(4));
    std::fs::write(path("scenes/deep/s.xml"), text).unwrap();
    for command in [&["render", "s.xml"][..], &["inspect", "s.xml"], &["convert", "s.xml", "out.pbrt"]] {
        let mut program = Command::new(env!("CARGO_BIN_EXE_caustica"));
        let output = program.args(command).current_dir(path("scenes/deep")).output().unwrap();
        assert_eq!(output.status.code(), Some(1));
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(said.matches("--allow-path").count(), 1, "{said}");
        assert!(said.contains("caustica render s.xml --allow-path '../../my meshes'\n"), "{said}");
    }
    let allowed = ["inspect", "s.xml", "--allow-path", "../../my meshes"];
    let (status, errors) = verdict(&path("scenes/deep"), &allowed);
    assert_eq!(status, 0, "{errors:?}");
}
