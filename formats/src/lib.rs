//! Every byte that enters or leaves caustica: scene languages, meshes, images, spectra.
//!
//! ```
//! use std::path::Path;
//!
//! use caustica_formats::files::Memory;
//! use caustica_formats::{ReadOptions, read_scene, write_scene};
//!
//! let xml = "<scene version='3.0.0'><emitter type='constant'/><shape type='sphere'/></scene>";
//! let files = Memory([("scene.xml".into(), xml.as_bytes().to_vec())].into_iter().collect());
//! let read = read_scene(&files, Path::new("scene.xml"), &ReadOptions::default()).expect("a valid scene");
//! assert_eq!(read.scene.shapes.len(), 1);
//! let written = write_scene(&read, &files, Path::new("scene.pbrt")).expect("no asset is missing");
//! assert!(written.text.contains("Shape \"sphere\""));
//! ```
//!
//! Rules (checked by `tests/tidy.rs` and `tests/imports.rs`): `ir` depends on `diagnostic` only; the scene
//! languages never import each other; no two files import each other; nothing here knows of rendering.

#![warn(missing_docs, clippy::missing_errors_doc)]

pub mod confined;
pub mod diagnostic;
mod encoding;
pub mod files;
pub mod fourier;
pub mod image;
pub mod ir;
pub mod language;
pub mod memory;
pub mod mesh;
mod misnamed;
mod missing;
mod mitsuba;
mod outside;
mod pbrt;
pub mod picture;
mod plugin;
mod range;
mod read;
pub mod sky;
pub mod spectrum;
pub mod volume;
mod write;

pub use language::{read_scene, write_scene};
pub use plugin::{Concept, Support};
pub use read::{Failure, Read, ReadOptions};
pub use write::{Asset, Content, Loss, WriteError, Written};
