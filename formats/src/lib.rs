//! Every byte that enters or leaves caustica: scene languages, meshes, images, spectra.
//!
//! Invariants (checked by `tests/tidy.rs`): `ir` depends on `diagnostic` only; the scene
//! languages never import each other; nothing here knows of rendering.

#![warn(missing_docs, clippy::missing_errors_doc)]

pub mod confined;
pub mod diagnostic;
mod encoding;
pub mod files;
pub mod image;
pub mod ir;
pub mod language;
pub mod memory;
pub mod mesh;
mod missing;
mod mitsuba;
mod pbrt;
mod plugin;
mod read;
pub mod spectrum;
mod write;

pub use language::{read_scene, write_scene};
pub use plugin::{Concept, Support};
pub use read::{Failure, Read, ReadOptions};
pub use write::{Asset, Content, Loss, WriteError, Written};
