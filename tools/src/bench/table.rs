//! Results as text for the terminal, and as CSV.

use super::analysis::{Analysis, Point, Row, SceneResult};
use super::reach::MEASURES;
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
        if let Some(noise) = scene.noise {
            writeln!(out, "{noise}")?;
        }
        let wide = scene.rows.iter().map(|r| r.config.chars().count()).max().unwrap_or(0).max(13);
        write_points(scene, wide, out)?;
        if let Some(error) = scene.target_rmse {
            writeln!(
                out,
                "\nCPU time to RMSE {error:.5} (ratio to the first, with its 95 % interval over seeds)"
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
        write_reach(scene, wide, out)?;
    }
    for note in &analysis.notes {
        writeln!(out, "\nnote: {note}")?;
    }
    for s in &analysis.skipped {
        writeln!(out, "\nskipped {}: {}", s.config, s.reason)?;
    }
    Ok(())
}

fn write_points(scene: &SceneResult, wide: usize, out: &mut dyn Write) -> io::Result<()> {
    write!(out, "{:<wide$}{:>11}", "configuration", "budget")?;
    for (name, width) in COLUMNS {
        write!(out, "{name:>width$}")?;
    }
    writeln!(out)?;
    for row in &scene.rows {
        for p in &row.points {
            write!(out, "{:<wide$}{:>11}", row.config, p.budget.to_string())?;
            for ((_, width), value) in COLUMNS.iter().zip(cells(p)) {
                write!(out, "{value:>width$}")?;
            }
            writeln!(out)?;
        }
        for stopped in &row.stopped {
            writeln!(out, "{:<wide$}{:>11}   {stopped}", row.config, stopped.budget.to_string())?;
        }
    }
    Ok(())
}

fn write_reach(scene: &SceneResult, wide: usize, out: &mut dyn Write) -> io::Result<()> {
    let (Some(first), false) = (scene.rows.first(), scene.reach.is_empty()) else { return Ok(()) };
    writeln!(
        out,
        "\nCPU time after which {} has the error that another configuration has at its largest budget",
        first.config
    )?;
    write!(out, "{:<wide$}{:>11}", "configuration", "CPU s")?;
    for (measure, _) in MEASURES {
        write!(out, "{measure:>20}")?;
    }
    writeln!(out)?;
    for beside in &scene.reach {
        write!(out, "{:<wide$}{:>11.2}", beside.config, beside.cpu_seconds)?;
        for reached in &beside.reached {
            write!(out, "{:>20}", reach(reached.reach))?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// Names of the columns that show a point, and their widths in a terminal.
pub const COLUMNS: [(&str, usize); 11] = [
    ("CPU s", 9),
    ("wall s", 9),
    ("MB", 7),
    ("passes", 8),
    ("RMSE", 10),
    ("±", 9),
    ("relMSE", 11),
    ("trimmed", 11),
    ("LDR-FLIP", 10),
    ("HDR-FLIP", 10),
    ("bias %", 9),
];

/// A point in these columns.
pub fn cells(p: &Point) -> [String; 11] {
    [
        format!("{:.2}", p.cpu_seconds.median),
        format!("{:.2}", p.seconds.median),
        p.peak_memory_bytes.map_or_else(|| "–".to_owned(), |b| format!("{:.0}", b as f64 / 1e6)),
        format!("{:.0}", p.passes.median),
        format!("{:.5}", p.rmse.median),
        format!("{:.5}", (p.rmse.high - p.rmse.low) / 2.0),
        format!("{:.3e}", p.relmse.median),
        format!("{:.3e}", p.relmse_trimmed.median),
        format!("{:.4}", p.flip.median),
        format!("{:.4}", p.hdr_flip.median),
        format!("{:+.3}", 100.0 * p.bias.median),
    ]
}

/// A time like "3.20 s"; "< 1.00 s" if the smallest budget is already better, "≈ 20.00 s" where it is extrapolated,
/// "> 8.00 s" where it cannot be.
pub fn reach(reach: Option<Reach>) -> String {
    match reach {
        Some(Reach::At(t)) => format!("{t:.2} s"),
        Some(Reach::About(t)) => format!("≈ {t:.2} s"),
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

/// A slope like "RMSE ~ t^-0.48 ± 0.02, at the end -0.45": of all budgets, and between the two largest.
pub fn slope(row: &Row) -> String {
    row.rmse_slope.map_or_else(String::new, |law| {
        let error = law.slope_error.map_or_else(String::new, |e| format!(" ± {e:.2}"));
        let last = row.last_rmse_slope.map_or_else(String::new, |slope| format!(", at the end {slope:.2}"));
        format!("RMSE ~ t^{:.2}{error}{last}", law.slope)
    })
}

/// A header and one line per record; fields with commas or quotes are quoted (RFC 4180).
pub fn csv(records: &[Record]) -> String {
    let mut out = String::from(
        "scene,config,budget,unit,seed,seconds,cpu_seconds,peak_memory_bytes,passes,rmse,relmse,relmse_trimmed,bias,flip,\
         hdr_flip,image\n",
    );
    for r in records {
        let (budget, unit) = match r.budget {
            Budget::CpuSeconds(s) => (s.to_string(), "cpu_seconds"),
            Budget::Passes(n) => (n.to_string(), "passes"),
        };
        let memory = r.peak_memory_bytes.map_or_else(String::new, |b| b.to_string());
        // Writing to a String does not fail.
        let _never = writeln!(
            out,
            "{},{},{budget},{unit},{},{},{},{memory},{},{},{},{},{},{},{},{}",
            field(&r.scene),
            field(&r.config),
            r.seed,
            r.seconds,
            r.cpu_seconds,
            r.passes,
            r.rmse,
            r.relmse,
            r.relmse_trimmed,
            r.bias,
            r.flip,
            r.hdr_flip,
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
        assert_eq!(lines[0].split(',').count(), 16);
        assert_eq!(
            lines[1],
            "\"the \"\"box\"\"\",\"caustica:alpha=0.5,nee=false\",2,cpu_seconds,7,4.5,2.25,1048576,8,0.5,0.25,0.125,0,0.25,0.5,a.exr"
        );
    }

    #[test]
    fn bounds_are_marked() {
        assert_eq!(reach(Some(Reach::Before(1.0))), "< 1.00 s");
        assert_eq!(reach(Some(Reach::About(64.0))), "≈ 64.00 s");
        let r = Ratio { value: 2.0, low: 1.5, high: 3.0, bound: true };
        assert_eq!(ratio(Some(r)), "2.00 (1.50 to 3.00) bound");
    }
}
