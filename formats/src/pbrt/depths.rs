//! How deep textures refer to each other.

use std::collections::HashMap;

use crate::ir::{Bsdf, Id, References, ShapeGroup, Texture, TextureKind};

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
    pub fn below(&self, kind: &mut TextureKind) -> u32 {
        let mut deepest = Deepest { depths: self, found: 0 };
        kind.references(&mut deepest);
        deepest.found
    }
}

struct Deepest<'a> {
    depths: &'a Depths,
    found: u32,
}

impl References for Deepest<'_> {
    fn bsdf(&mut self, _: &mut Id<Bsdf>) {}

    fn texture(&mut self, id: &mut Id<Texture>) {
        self.found = self.found.max(self.depths.0.get(&id.index()).copied().unwrap_or(1));
    }

    fn group(&mut self, _: &mut Id<ShapeGroup>) {}
}
