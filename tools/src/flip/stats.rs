use super::FlipMap;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Summary of a FLIP map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FlipStats {
    /// Mean over all pixels.
    pub mean: f64,
    /// Half of the pixels are at or below.
    pub median: f64,
    /// 95 % of the pixels are at or below.
    pub p95: f64,
    /// 99 % of the pixels are at or below.
    pub p99: f64,
    /// The largest value.
    pub max: f64,
}

impl FlipStats {
    /// The summary of a map; all zeros for an empty one.
    pub fn of(map: &FlipMap) -> Self {
        let n = map.values.len();
        if n == 0 {
            return Self { mean: 0.0, median: 0.0, p95: 0.0, p99: 0.0, max: 0.0 };
        }
        let partial: Vec<f64> =
            map.values.par_chunks(1 << 14).map(|chunk| chunk.iter().map(|v| f64::from(*v)).sum()).collect();
        let mut sorted = map.values.clone();
        let mut at = |share: f64| {
            let i = ((n as f64 * share).ceil() as usize).clamp(1, n) - 1;
            f64::from(*sorted.select_nth_unstable_by(i, f32::total_cmp).1)
        };
        Self {
            mean: partial.iter().sum::<f64>() / n as f64,
            median: at(0.5),
            p95: at(0.95),
            p99: at(0.99),
            max: at(1.0),
        }
    }
}
