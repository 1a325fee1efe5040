//! How soon the first configuration has the error that others have in the end.

use super::record::Record;
use super::statistics::{Curve, Reach, medians, reach};
use serde::Serialize;

/// A measure of error that is compared: its name, and its value of a record.
pub type Measure = (&'static str, fn(&Record) -> f64);

/// The measures that are compared.
pub const MEASURES: [Measure; 3] = [
    ("relMSE trimmed", |r| r.relmse_trimmed),
    ("relMSE, all pixels", |r| r.relmse),
    ("LDR-FLIP", |r| r.flip),
];

/// The error of one configuration at its largest budget, and when the first one has it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Reached {
    pub measure: &'static str,
    pub error: f64,
    /// CPU time of the first configuration; `None` if it was not measured.
    pub reach: Option<Reach>,
}

/// One configuration beside the first.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Beside {
    pub config: String,
    /// CPU time of its largest budget.
    pub cpu_seconds: f64,
    /// In the order of [`MEASURES`].
    pub reached: Vec<Reached>,
}

impl Beside {
    /// From the records of both; `None` if there are none of `config`.
    pub fn new(config: &str, records: &[Record], first: &[Record]) -> Option<Self> {
        let reached = MEASURES.map(|(measure, of)| {
            let (cpu_seconds, error) = *medians(&curve(records, of)).last()?;
            let reach = reach(&medians(&curve(first, of)), error);
            Some((cpu_seconds, Reached { measure, error, reach }))
        });
        let reached: Vec<(f64, Reached)> = reached.into_iter().collect::<Option<_>>()?;
        Some(Self {
            config: config.to_owned(),
            cpu_seconds: reached.first()?.0,
            reached: reached.into_iter().map(|(_, reached)| reached).collect(),
        })
    }
}

/// A measure against CPU time, budget by budget.
pub fn curve(records: &[Record], of: fn(&Record) -> f64) -> Curve {
    let mut budgets = Vec::new();
    for record in records {
        if !budgets.contains(&record.budget) {
            budgets.push(record.budget);
        }
    }
    let points = |budget| records.iter().filter(move |r| r.budget == budget).map(|r| (r.cpu_seconds, of(r)));
    budgets.into_iter().map(|budget| points(budget).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::super::record::tests::record;
    use super::*;

    /// RMSE `scale / √t`, so that relMSE is `scale² / t`; wall time is twice the CPU time. The third seed is an
    /// outlier.
    fn records(config: &str, scale: f64) -> Vec<Record> {
        let seeds = [(0, 1.0), (1, 1.0), (2, 50.0)];
        let of = |t: f64| seeds.map(|(seed, by)| record(config, t, seed, t, by * scale / t.sqrt()));
        [1.0, 4.0, 16.0].into_iter().flat_map(of).collect()
    }

    #[test]
    fn power_laws_give_the_times_by_hand() {
        let ours = records("a", 1.0);
        let seconds = |scale: f64| {
            let beside = Beside::new("b", &records("b", scale), &ours).unwrap();
            assert_eq!(beside.cpu_seconds, 16.0);
            assert!(
                (beside.reached[1].error - scale * scale / 16.0).abs() < 1e-12,
                "the median of the seeds"
            );
            beside.reached.iter().map(|r| r.reach.unwrap()).collect::<Vec<_>>()
        };
        // The error of b after 16 s is that of a after 16 / scale².
        for found in seconds(2.0) {
            assert!(matches!(found, Reach::At(t) if (t - 4.0).abs() < 1e-9), "{found:?}");
        }
        for found in seconds(0.5) {
            assert!(matches!(found, Reach::About(t) if (t - 64.0).abs() < 1e-9), "{found:?}");
        }
        assert_eq!(seconds(8.0), [Reach::Before(1.0); 3]);
    }

    #[test]
    fn without_measurements_there_is_no_time() {
        assert_eq!(Beside::new("b", &[], &records("a", 1.0)), None);
        let alone = Beside::new("b", &records("b", 1.0), &[]).unwrap();
        assert!(alone.reached.iter().all(|r| r.reach.is_none()));
    }
}
