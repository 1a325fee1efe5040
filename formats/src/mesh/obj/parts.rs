//! The materials of an OBJ file, by the names its faces use.

use super::{Words, take_statement, text};
use crate::encoding::to_utf8;

/// What an OBJ file says of its materials.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ObjParts {
    /// The material library, the last one given.
    pub library: Option<String>,
    /// Names of the materials with faces, in the order of their first face; faces before any `usemtl` have the
    /// empty name.
    pub materials: Vec<String>,
}

/// Finds the materials of an OBJ file without reading its geometry.
pub fn obj_parts(bytes: &[u8]) -> ObjParts {
    let bytes = to_utf8(bytes);
    let text = text(&bytes);
    let mut parts = ObjParts::default();
    let (mut rest, mut current, mut seen) = (&*text, String::new(), false);
    // Most files name no materials; after their first face there is nothing to find.
    let names = text.contains("mtl");
    while !rest.is_empty() && (names || !seen) {
        let (statement, _) = take_statement(&mut rest);
        let mut words = Words::new(statement);
        match words.next() {
            Some("mtllib") => parts.library = Some(name(statement)),
            Some("usemtl") => (current, seen) = (name(statement), false),
            // A face of two corners is none.
            Some("f") if !seen && words.count() > 2 => {
                seen = true;
                if !parts.materials.contains(&current) {
                    parts.materials.push(current.clone());
                }
            }
            _ => {}
        }
    }
    parts
}

/// What stands after the first word: a name may have blanks in it.
pub(super) fn name(statement: &str) -> String {
    let statement = statement.trim();
    statement.split_once(char::is_whitespace).map_or("", |(_, name)| name.trim()).to_owned()
}
