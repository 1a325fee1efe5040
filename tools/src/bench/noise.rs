//! The noise of a reference: the error that a picture without any has.

use super::error::BenchError;
use crate::compare::{Mask, VarianceKind, load, variance_beside};
use crate::metrics::errors;
use crate::pixels::Pixels;
use serde::Serialize;
use std::fmt;
use std::path::Path;

/// Expected errors of a picture without error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Noise {
    pub rmse: f64,
    pub relmse: f64,
}

impl Noise {
    /// From the variance of the mean in the file beside a reference; `None` if there is none. The mask is already
    /// applied to `truth`.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn beside(reference: &Path, truth: &Pixels, mask: Option<&Mask>) -> Result<Option<Self>, BenchError> {
        let Some((path, VarianceKind::OfMean)) = variance_beside(reference) else { return Ok(None) };
        let mut variance = load(&path, None)?.pixels;
        if !variance.same_size(truth) {
            return Ok(None);
        }
        if let Some(mask) = mask {
            mask.apply(&mut variance);
        }
        // A picture that is one standard deviation away everywhere has the expected squared error.
        let away = |x: usize, y: usize| {
            let (mean, variance) = (truth.at(x, y), variance.at(x, y));
            std::array::from_fn(|c| mean[c] + variance[c].max(0.0).sqrt())
        };
        let found = errors(&Pixels::from_fn(truth.width, truth.height, away), truth, 1.0);
        Ok(Some(Self { rmse: found.rmse_all, relmse: found.relmse }))
    }
}

impl fmt::Display for Noise {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "noise of the reference: RMSE {:.5}, relMSE {:.2e}", self.rmse, self.relmse)
    }
}
