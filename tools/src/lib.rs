//! The judge: image metrics, comparison and reports. Never imports the renderer.
//!
//! * [`pixels`] what is compared: linear RGB, finite, row 0 at the top.
//! * [`metrics`] numbers: bias, RMSE, relMSE, MAPE, PSNR, z-test.
//! * [`flip`] perceived difference: LDR-FLIP and HDR-FLIP.
//! * [`compare`] two files or two folders, thresholds, table and JSON.
//! * [`report`] the HTML page of comparisons.
//! * [`bench`] error against time of whole renderers, and studies of parameters.

pub mod bench;
pub mod compare;
pub mod flip;
pub mod metrics;
pub mod pixels;
pub mod report;
