use super::Comparison;
use serde::Serialize;

/// Limits that a comparison must keep; none is no limit.
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
    /// The z-test must accept.
    pub z_test: bool,
}

/// One limit and what was measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    pub name: &'static str,
    pub value: f64,
    pub limit: f64,
    /// `value ≤ limit`; for the z-test, whose value is the accepted share, `≥`.
    pub holds: bool,
}

impl Thresholds {
    /// Every limit that is set, in the order of the fields. A z-test that could not be made and a
    /// HDR-FLIP that was not asked for do not hold.
    pub fn check(&self, c: &Comparison) -> Vec<Check> {
        let hdr = c.flip_hdr.as_ref().map_or(f64::INFINITY, |h| h.stats.mean);
        let mut checks: Vec<Check> = [
            ("flip", self.flip, c.flip_ldr.stats.mean),
            ("hdr-flip", self.hdr_flip, hdr),
            ("rmse", self.rmse, c.errors.rmse_all),
            ("relmse", self.relmse, c.errors.relmse),
            ("bias", self.bias, c.bias.worst()),
        ]
        .into_iter()
        .filter_map(|(name, limit, value)| {
            limit.map(|limit| Check { name, value, limit, holds: value <= limit })
        })
        .collect();
        if self.z_test {
            let (value, limit) =
                c.z_test.as_ref().map_or((0.0, 1.0), |z| (z.accepted_share, z.required_share));
            checks.push(Check { name: "z-test", value, limit, holds: value >= limit });
        }
        checks
    }
}
