//! caustica: photon mapping for Mitsuba and pbrt scenes.
//!
//! Code map, upwards: `math`, `sampling` ← `spectrum` ← `shape`, `texture`, `accel` ← `bsdf`, `emitter`, `sensor`,
//! `film` ← `scene` ← `transport` ← `photon` ← `integrator` ← `render` ← `cli`. Imports point downwards only;
//! `tests/tidy.rs` checks it. The renderer knows no file format: `scene::compile` (and `cli`) alone read
//! the scene representation of `caustica-formats`.

pub mod accel;
pub mod bsdf;
pub mod cli;
pub mod emitter;
pub mod film;
pub mod integrator;
pub mod math;
pub mod photon;
pub mod render;
pub mod sampling;
pub mod scene;
pub mod sensor;
pub mod session;
pub mod settings;
pub mod shape;
pub mod spectrum;
pub mod texture;
pub mod transport;
