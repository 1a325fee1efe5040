//! Results as text for the terminal, and as CSV.

use super::analysis::{Analysis, Row};
use super::record::{Budget, Record};
use super::statistics::{Ratio, Reach};
use std::fmt::Write as _;
use std::io::{self, Write};

/// Writes the machine and the tables of every scene.
///
/// # Errors
/// `out` cannot be written.
pub fn write(analysis: &Analysis, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "machine: {}", analysis.machine.line())?;
    for scene in &analysis.scenes {
        writeln!(
            out,
            "\n{} ({} x {}), reference {}",
            scene.scene,
            scene.size[0],
            scene.size[1],
            scene.reference.display()
        )?;
        let wide = scene.rows.iter().map(|r| r.config.chars().count()).max().unwrap_or(0).max(13);
        writeln!(
            out,
            "{:<wide$}{:>11}{:>9}{:>9}{:>9}{:>9}{:>11}{:>9}{:>11}{:>10}{:>9}",
            "configuration",
            "budget",
            "wall s",
            "CPU s",
            "MB",
            "passes",
            "RMSE",
            "+-",
            "relMSE",
            "bias %",
            "FLIP"
        )?;
        for row in &scene.rows {
            for p in &row.points {
                writeln!(
                    out,
                    "{:<wide$}{:>11}{:>9.2}{:>9.2}{:>9}{:>9.0}{:>11.5}{:>9.5}{:>11.6}{:>+10.3}{:>9.4}",
                    row.config,
                    p.budget.to_string(),
                    p.seconds.median,
                    p.cpu_seconds.median,
                    p.peak_memory_bytes.map_or_else(|| "-".to_owned(), |b| format!("{:.0}", b as f64 / 1e6)),
                    p.passes.median,
                    p.rmse.median,
                    (p.rmse.high - p.rmse.low) / 2.0,
                    p.relmse.median,
                    100.0 * p.bias.median,
                    p.flip.median,
                )?;
            }
            for stopped in &row.stopped {
                writeln!(out, "{:<wide$}{:>11}   {stopped}", row.config, stopped.budget.to_string())?;
            }
        }
        if let Some(error) = scene.target_rmse {
            writeln!(
                out,
                "\ntime to RMSE {error:.5} (ratio to the first, with its 95 % interval over seeds)"
            )?;
            for row in &scene.rows {
                writeln!(
                    out,
                    "{:<wide$}{:>12}  {:<28}{}",
                    row.config,
                    reach(row.reach),
                    ratio(row.ratio),
                    slope(row)
                )?;
            }
        }
    }
    for note in &analysis.notes {
        writeln!(out, "\nnote: {note}")?;
    }
    for s in &analysis.skipped {
        writeln!(out, "\nskipped {}: {}", s.config, s.reason)?;
    }
    Ok(())
}

/// A time like "3.20 s", "< 1.00 s" or "> 8.00 s".
pub fn reach(reach: Option<Reach>) -> String {
    match reach {
        Some(Reach::At(t)) => format!("{t:.2} s"),
        Some(Reach::Before(t)) => format!("< {t:.2} s"),
        Some(Reach::After(t)) => format!("> {t:.2} s"),
        None => "-".to_owned(),
    }
}

/// A ratio like "4.10 (3.80 to 4.50)"; bounds are marked.
pub fn ratio(ratio: Option<Ratio>) -> String {
    match ratio {
        Some(r) => {
            let sign = if r.bound { " bound" } else { "" };
            format!("{:.2} ({:.2} to {:.2}){sign}", r.value, r.low, r.high)
        }
        None => "1".to_owned(),
    }
}

/// A slope like "RMSE ~ t^-0.48 ± 0.02".
pub fn slope(row: &Row) -> String {
    row.rmse_slope.map_or_else(String::new, |law| {
        let error = law.slope_error.map_or_else(String::new, |e| format!(" ± {e:.2}"));
        format!("RMSE ~ t^{:.2}{error}", law.slope)
    })
}

/// A header and one line per record; fields with commas or quotes are quoted (RFC 4180).
pub fn csv(records: &[Record]) -> String {
    let mut out = String::from(
        "scene,config,budget,unit,seed,seconds,cpu_seconds,peak_memory_bytes,passes,rmse,relmse,bias,flip,image\n",
    );
    for r in records {
        let (budget, unit) = match r.budget {
            Budget::Seconds(s) => (s.to_string(), "seconds"),
            Budget::Passes(n) => (n.to_string(), "passes"),
        };
        let memory = r.peak_memory_bytes.map_or_else(String::new, |b| b.to_string());
        // Writing to a String does not fail.
        let _never = writeln!(
            out,
            "{},{},{budget},{unit},{},{},{},{memory},{},{},{},{},{},{}",
            field(&r.scene),
            field(&r.config),
            r.seed,
            r.seconds,
            r.cpu_seconds,
            r.passes,
            r.rmse,
            r.relmse,
            r.bias,
            r.flip,
            field(&r.image.display().to_string())
        );
    }
    out
}

fn field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::super::record::tests::record;
    use super::*;

    #[test]
    fn csv_quotes_what_holds_commas() {
        let mut r = record("caustica:alpha=0.5,nee=false", 2.0, 7, 2.25, 0.5);
        r.scene = "the \"box\"".to_owned();
        let text = csv(&[r]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 2);
        assert_eq!(lines[0].split(',').count(), 14);
        assert_eq!(
            lines[1],
            "\"the \"\"box\"\"\",\"caustica:alpha=0.5,nee=false\",2,seconds,7,2.25,4.5,1048576,8,0.5,0.25,0,0.25,a.exr"
        );
    }

    #[test]
    fn bounds_are_marked() {
        assert_eq!(reach(Some(Reach::Before(1.0))), "< 1.00 s");
        let r = Ratio { value: 2.0, low: 1.5, high: 3.0, bound: true };
        assert_eq!(ratio(Some(r)), "2.00 (1.50 to 3.00) bound");
    }
}
