//! XML scenes of other programs, which the first message names.

use super::tree::Element;
use crate::diagnostic::Diagnostic;

/// What only the files of one program have: the element, and the program.
struct Mark {
    tag: &'static str,
    /// As the root, or as a child of it.
    root: bool,
    program: &'static str,
}

const fn root(tag: &'static str, program: &'static str) -> Mark {
    Mark { tag, root: true, program }
}

const fn child(tag: &'static str, program: &'static str) -> Mark {
    Mark { tag, root: false, program }
}

const MARKS: &[Mark] = &[
    root("BGFscene", "Embree"),
    root("COLLADA", "a COLLADA exporter"),
    root("X3D", "an X3D exporter"),
    root("mxs", "Maxwell"),
    root("cycles", "Cycles"),
    root("project", "appleseed"),
    child("Group", "Embree"),
    child("TriangleMesh", "Embree"),
    child("QuadMesh", "Embree"),
    child("Transform", "Embree"),
    child("PointLight", "Embree"),
    child("AmbientLight", "Embree"),
    child("DirectionalLight", "Embree"),
    child("mesh", "Nori"),
    child("brdf", "AdaPT"),
    child("renderer", "AdaPT"),
    child("light", "YafaRay"),
    child("render", "YafaRay"),
];

/// The error about a file that was written for another program; `None` for what Mitsuba may have written.
pub(super) fn of_another_program(root: &Element) -> Option<Diagnostic> {
    let is_scene = root.tag == "scene";
    // Nori's cameras are Mitsuba's of old, but its scenes have no version.
    let camera = is_scene && root.attribute("version").is_none();
    let found = MARKS.iter().find_map(|mark| {
        let at = if mark.root {
            (root.tag == mark.tag).then_some(root)
        } else {
            root.children.iter().find(|child| is_scene && child.tag == mark.tag)
        };
        at.map(|at| (at, mark.program))
    });
    let (at, program) = found.or_else(|| {
        let camera = root.children.iter().find(|child| camera && child.tag == "camera");
        camera.map(|at| (at, "Nori"))
    })?;
    let text = format!("this is not a Mitsuba scene: <{}> is an element of {program}'s files", at.tag);
    let problem = Diagnostic::error(text, Some(at.tag_span));
    Some(problem.help("caustica reads scenes of Mitsuba (.xml) and pbrt (.pbrt)"))
}
