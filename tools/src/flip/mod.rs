//! FLIP: how different two images look to a person who flips between them, from 0 (equal) to 1.
//!
//! LDR: Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images".
//! HDR: Andersson et al. 2021, "Visualizing Errors in Rendered High Dynamic Range Images".
//! Symbols (`q_c`, `p_c`, `p_t`, `q_f`, `w`) are those of the 2020 paper.

mod color;
mod exposure;
mod filter;
mod kernel;
mod magma;
mod map;
mod stats;
mod tile;

pub use exposure::{Exposures, Tonemapper};
pub use magma::magma;
pub use map::{FlipMap, HdrFlipMap, hdr, ldr};
pub use stats::FlipStats;

/// Pixels per degree of a screen of 3840 pixels that is 0.7 m wide and seen from 0.7 m: `3840 · π / 180`.
pub const DEFAULT_PPD: f64 = 67.020_643_276_582_26;
