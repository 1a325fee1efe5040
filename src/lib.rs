//! caustica: photon mapping for Mitsuba and pbrt scenes.
//!
//! [`session`] is the front door: it opens a scene, says what is in it, renders it and saves the picture.
//! A small Cornell box, and the colours that its walls throw:
//!
//! ```
//! use caustica::render::Budget;
//! use caustica::session::{Options, Session};
//!
//! let options = Options { size: Some([32, 32]), ..Options::default() };
//! let session = Session::open("scenes/cornell-diffuse.xml", &options)?;
//! assert!(session.plan().global_map);
//!
//! let outcome = session.render(Budget::passes(2), &mut |pass| println!("{} passes done", pass.passes));
//! let picture = session.picture(&outcome);
//! let (left, right) = (picture.pixel(1, 16), picture.pixel(30, 16));
//! // Red, green and blue, linear: the left wall is red, the right one green.
//! assert!(left[0] > left[1] && right[1] > right[0]);
//! # Ok::<(), caustica::session::Error>(())
//! ```
//!
//! `session::Output` writes pictures to files and `session::Saver` writes checkpoints.
//!
//! Code map, upwards: `math` ← `sampling` ← `spectrum` ← `shape`, `texture`, `accel` ← `bsdf`, `medium`, `emitter`,
//! `sensor`, `film` ← `settings` ← `scene` ← `transport` ← `photon` ← `integrator` ← `render` ← `session` ← `serve` ← `cli`. Imports
//! point downwards only; `tests/tidy.rs` checks it. The renderer knows no file format: `scene::compile` and
//! `session` (and `cli`, for arguments) alone read the scene representation of `caustica-formats`.

#![warn(missing_docs, clippy::missing_errors_doc)]

pub mod accel;
pub mod bsdf;
pub mod cli;
pub mod emitter;
pub mod film;
pub mod integrator;
pub mod math;
pub mod medium;
pub mod photon;
pub mod render;
pub mod sampling;
pub mod scene;
pub mod sensor;
pub mod serve;
pub mod session;
pub mod settings;
pub mod shape;
pub mod spectrum;
pub mod texture;
pub mod transport;
