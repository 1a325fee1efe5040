//! The judge of caustica: FLIP and other metrics, comparison of pictures, benchmarks of renderers. It never
//! imports the renderer, so that a mistake there cannot hide here.
//!
//! * [`pixels`]: what is compared. Linear RGB, finite, row 0 at the top.
//! * [`flip`]: perceived difference, LDR-FLIP and HDR-FLIP.
//! * [`compare`]: two files or two folders; thresholds, table, JSON and HTML.
//! * [`viewer`], [`html`]: what HTML pages are made of.
//! * [`mod@bench`]: error against time of whole renderers, and studies of parameters.
#![warn(missing_docs)]

pub mod bench;
pub mod compare;
pub mod flip;
pub mod html;
mod metrics;
pub mod pixels;
pub mod viewer;

pub use metrics::{Errors, errors, main_errors};
