//! How deep textures refer to each other.

use std::collections::HashMap;

use crate::ir::{Part, TextureKind};

/// Limit on nesting, because the walks over textures are recursive.
pub(super) const MAX_DEPTH: u32 = 256;

/// Nesting depth of textures by index; 1 where there is no entry.
#[derive(Default)]
pub(super) struct Depths(HashMap<usize, u32>);

impl Depths {
    pub fn set(&mut self, texture: usize, depth: u32) {
        self.0.insert(texture, depth);
    }

    /// The greatest depth among the textures that this one refers to.
    pub fn below(&self, kind: &TextureKind) -> u32 {
        let mut deepest = 0;
        kind.references(&mut |to| deepest = deepest.max(self.0.get(&to.index()).copied().unwrap_or(1)));
        deepest
    }
}
