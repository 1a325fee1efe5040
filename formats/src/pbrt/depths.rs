//! How deep textures refer to each other.

use std::collections::HashMap;

use crate::ir::{Part, TextureKind};

/// Everything that walks along textures calls itself.
pub(super) const MAX_DEPTH: u32 = 256;

/// How many textures stand below each other, by the index of the uppermost. One where nothing is said.
#[derive(Default)]
pub(super) struct Depths(HashMap<usize, u32>);

impl Depths {
    pub fn set(&mut self, texture: usize, depth: u32) {
        self.0.insert(texture, depth);
    }

    /// Of what the texture refers to.
    pub fn below(&self, kind: &TextureKind) -> u32 {
        let mut deepest = 0;
        kind.references(&mut |to| deepest = deepest.max(self.0.get(&to.index()).copied().unwrap_or(1)));
        deepest
    }
}
