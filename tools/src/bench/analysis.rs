//! From records to what the tables and pages show.

use super::machine::Machine;
use super::noise::Noise;
use super::reach::{Beside, curve};
use super::record::{Budget, Record};
use super::statistics::{
    Curve, PowerLaw, Ratio, Reach, Spread, common_error, medians, power_law, time_ratio, time_to_error,
};
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// All seeds of one budget.
#[derive(Clone, Debug, Serialize)]
pub struct Point {
    pub budget: Budget,
    pub seeds: usize,
    pub seconds: Spread,
    pub cpu_seconds: Spread,
    pub peak_memory_bytes: Option<u64>,
    pub passes: Spread,
    pub rmse: Spread,
    pub relmse: Spread,
    pub relmse_trimmed: Spread,
    pub bias: Spread,
    pub flip: Spread,
    pub hdr_flip: Spread,
    /// The picture of the first seed, relative to the folder of the run.
    pub image: PathBuf,
}

/// One configuration on one scene.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    pub config: String,
    pub points: Vec<Point>,
    /// RMSE as a power of CPU seconds.
    pub rmse_slope: Option<PowerLaw>,
    /// The same between the two largest budgets: nearer to 0 where the error stops falling.
    pub last_rmse_slope: Option<f64>,
    pub flip_slope: Option<PowerLaw>,
    /// CPU time after which it has the target error.
    pub reach: Option<Reach>,
    /// That time divided by the first configuration's.
    pub ratio: Option<Ratio>,
    /// Renders that took too long.
    pub stopped: Vec<Stopped>,
    #[serde(skip)]
    pub records: Vec<Record>,
}

/// All configurations on one scene.
#[derive(Clone, Debug, Serialize)]
pub struct SceneResult {
    pub scene: String,
    pub reference: PathBuf,
    pub size: [usize; 2],
    /// Number of pixels that the reference's mask leaves out.
    pub left_out: usize,
    /// Of the reference, if a file beside it tells; every error includes it.
    pub noise: Option<Noise>,
    /// The RMSE to which times are compared.
    pub target_rmse: Option<f64>,
    /// When the first configuration has the error that each other one has at its largest budget.
    pub reach: Vec<Beside>,
    pub rows: Vec<Row>,
}

/// A configuration that was not measured, and why.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Skipped {
    pub config: String,
    pub reason: String,
}

/// A render that was stopped.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stopped {
    #[serde(skip)]
    pub config: String,
    pub budget: Budget,
    /// When a process of it was stopped.
    pub seconds: f64,
}

impl fmt::Display for Stopped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "stopped after {} s", self.seconds)
    }
}

/// What a scene was measured to.
#[derive(Clone, Debug, Default)]
pub struct Measured {
    pub records: Vec<Record>,
    pub stopped: Vec<Stopped>,
}

/// Everything a run found.
#[derive(Clone, Debug, Serialize)]
pub struct Analysis {
    pub machine: Machine,
    pub scenes: Vec<SceneResult>,
    pub skipped: Vec<Skipped>,
    /// In what renders were made otherwise than asked.
    pub notes: Vec<String>,
}

impl SceneResult {
    /// Rows are in the order of `configs`. Ratios are to the first one that has records.
    pub fn new(
        scene: &str,
        reference: PathBuf,
        size: [usize; 2],
        configs: &[String],
        budgets: &[Budget],
        Measured { records, stopped }: &Measured,
        target: Option<f64>,
    ) -> Self {
        let of = |config: &String| -> Vec<Record> {
            records.iter().filter(|r| r.config == *config).cloned().collect()
        };
        let mut rows: Vec<Row> = configs.iter().map(|c| Row::new(c, budgets, of(c))).collect();
        for row in &mut rows {
            row.stopped = stopped.iter().filter(|s| s.config == row.config).cloned().collect();
        }
        rows.retain(|row| !row.points.is_empty() || !row.stopped.is_empty());
        let curves: Vec<Curve> = rows.iter().map(|row| curve(&row.records, |r| r.rmse)).collect();
        let measured = curves.iter().filter(|curve| !curve.is_empty());
        let target_rmse = target.or_else(|| common_error(&measured.map(medians).collect::<Vec<_>>()));
        if let Some(error) = target_rmse {
            for (row, curve) in rows.iter_mut().zip(&curves) {
                row.reach = time_to_error(&medians(curve), error);
                row.ratio = curves.first().and_then(|base| time_ratio(curve, base, error));
            }
            // Against itself the ratio is 1 without an interval.
            if let Some(first) = rows.first_mut() {
                first.ratio = None;
            }
        }
        let reach = rows.split_first().map_or_else(Vec::new, |(first, others)| {
            others.iter().filter_map(|row| Beside::new(&row.config, &row.records, &first.records)).collect()
        });
        Self { scene: scene.to_owned(), reference, size, left_out: 0, noise: None, target_rmse, reach, rows }
    }
}

impl Row {
    fn new(config: &str, budgets: &[Budget], records: Vec<Record>) -> Self {
        let points: Vec<Point> = budgets.iter().filter_map(|b| Point::new(*b, &records)).collect();
        let law = |f: fn(&Record) -> f64| {
            power_law(&records.iter().map(|r| (r.cpu_seconds, f(r))).collect::<Vec<_>>())
        };
        let medians = medians(&curve(&records, |r| r.rmse));
        let last = medians.len().checked_sub(2).and_then(|start| power_law(&medians[start..]));
        Self {
            config: config.to_owned(),
            points,
            rmse_slope: law(|r| r.rmse),
            last_rmse_slope: last.map(|law| law.slope),
            flip_slope: law(|r| r.flip),
            reach: None,
            ratio: None,
            stopped: Vec::new(),
            records,
        }
    }

    /// The configuration, and what it did not do.
    pub fn title(&self) -> String {
        match self.stopped.first() {
            Some(stopped) => format!("{} ({}: {stopped})", self.config, stopped.budget),
            None => self.config.clone(),
        }
    }
}

impl Point {
    fn new(budget: Budget, records: &[Record]) -> Option<Self> {
        let here: Vec<&Record> = records.iter().filter(|r| r.budget == budget).collect();
        let first = here.first()?;
        let spread = |f: fn(&Record) -> f64| Spread::of(&here.iter().map(|r| f(r)).collect::<Vec<_>>());
        Some(Self {
            budget,
            seeds: here.len(),
            seconds: spread(|r| r.seconds),
            cpu_seconds: spread(|r| r.cpu_seconds),
            peak_memory_bytes: here.iter().filter_map(|r| r.peak_memory_bytes).max(),
            passes: spread(|r| r.passes as f64),
            rmse: spread(|r| r.rmse),
            relmse: spread(|r| r.relmse),
            relmse_trimmed: spread(|r| r.relmse_trimmed),
            bias: spread(|r| r.bias),
            flip: spread(|r| r.flip),
            hdr_flip: spread(|r| r.hdr_flip),
            image: first.image.clone(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::record::tests::record;
    use super::*;

    #[test]
    fn ratios_are_to_the_first_configuration() {
        let mut records = Vec::new();
        for seed in 0..3 {
            for t in [1.0, 4.0, 16.0] {
                records.push(record("a", t, seed, t, t.powf(-0.5)));
                records.push(record("b", t, seed, t, 2.0 * t.powf(-0.5)));
            }
        }
        let budgets = [1.0, 4.0, 16.0].map(Budget::CpuSeconds);
        let names = ["a".to_owned(), "none".to_owned(), "b".to_owned()];
        let stopped =
            vec![Stopped { config: "none".to_owned(), budget: Budget::CpuSeconds(4.0), seconds: 100.0 }];
        let measured = Measured { records, stopped };
        let result = SceneResult::new("box", PathBuf::new(), [4, 4], &names, &budgets, &measured, None);
        assert_eq!(result.rows[1].title(), "none (4 CPU s: stopped after 100 s)");
        let measured = Measured { stopped: Vec::new(), ..measured };
        let result = SceneResult::new("box", PathBuf::new(), [4, 4], &names, &budgets, &measured, None);
        assert_eq!(result.rows.len(), 2);
        assert_eq!(result.rows[0].ratio, None);
        let ratio = result.rows[1].ratio.unwrap();
        assert!((ratio.value - 4.0).abs() < 1e-6 && !ratio.bound, "{ratio:?}");
        assert!((result.rows[1].rmse_slope.unwrap().slope + 0.5).abs() < 1e-9);
        assert!((result.rows[1].last_rmse_slope.unwrap() + 0.5).abs() < 1e-9);
        // The error of b after 16 s is that of a after 4.
        let [beside] = result.reach.as_slice() else { panic!("{:?}", result.reach) };
        assert!(
            matches!(beside.reached[1].reach, Some(Reach::At(t)) if (t - 4.0).abs() < 1e-9),
            "{beside:?}"
        );
    }
}
