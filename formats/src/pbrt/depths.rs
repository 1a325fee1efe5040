//! How deep textures and materials refer to each other.

use std::collections::HashMap;

use crate::ir::{Part, Reference};

/// Limit on nesting, because most walks over textures and materials are recursive.
pub(super) const MAX_DEPTH: u32 = 256;

/// Nesting depth of textures and materials; 1 where there is no entry.
#[derive(Default)]
pub(super) struct Depths(HashMap<Reference, u32>);

impl Depths {
    pub fn set(&mut self, to: impl Into<Reference>, depth: u32) {
        self.0.insert(to.into(), depth);
    }

    /// The greatest depth among what `part` refers to.
    pub fn below(&self, part: &dyn Part) -> u32 {
        let mut deepest = 0;
        part.references(&mut |to| deepest = deepest.max(self.0.get(&to).copied().unwrap_or(1)));
        deepest
    }
}
