//! Every byte that enters or leaves caustica: scene languages, meshes, images, spectra.
//!
//! Invariants (checked by `tests/tidy.rs`): `ir` depends on `diagnostic` only; the scene
//! languages never import each other; nothing here knows of rendering.

pub mod confined;
pub mod diagnostic;
mod encoding;
pub mod files;
pub mod image;
pub mod ir;
pub mod memory;
pub mod mesh;
mod missing;
pub mod mitsuba;
pub mod pbrt;
mod read;
pub mod spectrum;
pub mod support;
mod write;

pub use read::{Failure, Read, ReadOptions, read_scene};
pub use write::{Asset, Content, Loss, WriteError, Written, write_scene};
