//! Thresholds, and whether a comparison keeps them.

use crate::metrics::{Bias, Errors, ZTest};
use serde::Serialize;
use std::fmt;

/// Limits of a comparison; `None` is no limit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Thresholds {
    /// Mean LDR-FLIP.
    pub flip: Option<f64>,
    /// Mean HDR-FLIP.
    pub hdr_flip: Option<f64>,
    /// RMSE over all channels.
    pub rmse: Option<f64>,
    pub relmse: Option<f64>,
    /// Largest magnitude of the relative bias over the channels.
    pub bias: Option<f64>,
    /// Whether the z-test must accept.
    pub z_test: bool,
}

/// One limit and the measured value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    pub name: &'static str,
    pub value: f64,
    pub limit: f64,
    /// `value ≤ limit`; for the z-test, whose value is the accepted share, `value ≥ limit`.
    pub holds: bool,
}

impl fmt::Display for Check {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = match (self.holds, self.name == "z-test") {
            (true, false) => "<=",
            (true, true) => ">=",
            (false, false) => ">",
            (false, true) => "<",
        };
        write!(f, "{} {:.6} {sign} {}", self.name, self.value, self.limit)
    }
}

/// The thresholds that do not hold, in one line.
pub fn exceeded(checks: &[Check]) -> String {
    let failed = checks.iter().filter(|check| !check.holds).map(Check::to_string);
    failed.collect::<Vec<_>>().join(", ")
}

impl Thresholds {
    /// Checks every limit that is set, in the order of the fields. `flip` holds the means of LDR-FLIP and
    /// HDR-FLIP. A limit on something that was not computed does not hold.
    pub fn check(
        &self,
        bias: &Bias,
        errors: &Errors,
        flip: (f64, Option<f64>),
        z_test: Option<&ZTest>,
    ) -> Vec<Check> {
        let mut checks: Vec<Check> = [
            ("flip", self.flip, flip.0),
            ("hdr-flip", self.hdr_flip, flip.1.unwrap_or(f64::INFINITY)),
            ("rmse", self.rmse, errors.rmse_all),
            ("relmse", self.relmse, errors.relmse),
            ("bias", self.bias, bias.worst()),
        ]
        .into_iter()
        .filter_map(|(name, limit, value)| {
            limit.map(|limit| Check { name, value, limit, holds: value <= limit })
        })
        .collect();
        if self.z_test {
            let (value, limit) = z_test.map_or((0.0, 1.0), |z| (z.accepted_share, z.required_share));
            checks.push(Check { name: "z-test", value, limit, holds: value >= limit });
        }
        checks
    }
}
