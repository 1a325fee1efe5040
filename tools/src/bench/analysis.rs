//! From records to what the tables and pages show.

use super::machine::Machine;
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
    pub bias: Spread,
    pub flip: Spread,
    /// The picture of the first seed, relative to the folder of the run.
    pub image: PathBuf,
}

/// One configuration on one scene.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    pub config: String,
    pub points: Vec<Point>,
    /// RMSE as a power of seconds.
    pub rmse_slope: Option<PowerLaw>,
    pub flip_slope: Option<PowerLaw>,
    /// When it reaches the target error.
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
    /// The RMSE to which times are compared.
    pub target_rmse: Option<f64>,
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
        let curves: Vec<Curve> = rows.iter().map(Row::curve).collect();
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
        Self { scene: scene.to_owned(), reference, size, left_out: 0, target_rmse, rows }
    }
}

impl Row {
    fn new(config: &str, budgets: &[Budget], records: Vec<Record>) -> Self {
        let mut points: Vec<Point> = budgets.iter().filter_map(|b| Point::new(*b, &records)).collect();
        // Where a pass takes longer than two budgets, both give the same picture.
        points.dedup_by(|b, a| matches!(b.budget, Budget::Seconds(_)) && a.passes.median == b.passes.median);
        let law =
            |f: fn(&Record) -> f64| power_law(&records.iter().map(|r| (r.seconds, f(r))).collect::<Vec<_>>());
        Self {
            config: config.to_owned(),
            points,
            rmse_slope: law(|r| r.rmse),
            flip_slope: law(|r| r.flip),
            reach: None,
            ratio: None,
            stopped: Vec::new(),
            records,
        }
    }

    fn curve(&self) -> Curve {
        let of = |p: &Point| {
            self.records.iter().filter(|r| r.budget == p.budget).map(|r| (r.seconds, r.rmse)).collect()
        };
        self.points.iter().map(of).collect()
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
            bias: spread(|r| r.bias),
            flip: spread(|r| r.flip),
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
        let budgets = [1.0, 4.0, 16.0].map(Budget::Seconds);
        let names = ["a".to_owned(), "none".to_owned(), "b".to_owned()];
        let stopped =
            vec![Stopped { config: "none".to_owned(), budget: Budget::Seconds(4.0), seconds: 100.0 }];
        let measured = Measured { records, stopped };
        let result = SceneResult::new("box", PathBuf::new(), [4, 4], &names, &budgets, &measured, None);
        assert_eq!(result.rows[1].title(), "none (4 s: stopped after 100 s)");
        let measured = Measured { stopped: Vec::new(), ..measured };
        let result = SceneResult::new("box", PathBuf::new(), [4, 4], &names, &budgets, &measured, None);
        assert_eq!(result.rows.len(), 2);
        assert_eq!(result.rows[0].ratio, None);
        let ratio = result.rows[1].ratio.unwrap();
        assert!((ratio.value - 4.0).abs() < 1e-6 && !ratio.bound, "{ratio:?}");
        assert!((result.rows[1].rmse_slope.unwrap().slope + 0.5).abs() < 1e-9);
    }

    #[test]
    fn budgets_shorter_than_a_pass_are_one_point() {
        let records: Vec<Record> = [(1.0, 1), (2.0, 1), (8.0, 3)]
            .map(|(budget, passes)| Record { passes, ..record("a", budget, 0, 2.5 * passes as f64, 0.5) })
            .to_vec();
        let measured = Measured { records, ..Measured::default() };
        let budgets = [1.0, 2.0, 8.0].map(Budget::Seconds);
        let names = ["a".to_owned()];
        let result = SceneResult::new("box", PathBuf::new(), [4, 4], &names, &budgets, &measured, None);
        let points: Vec<Budget> = result.rows[0].points.iter().map(|p| p.budget).collect();
        assert_eq!(points, [Budget::Seconds(1.0), Budget::Seconds(8.0)]);
    }
}
