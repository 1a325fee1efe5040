//! The page of the studies: Markdown, with plots and pictures beside it.

use super::catalogue::{KERNELS, Profile, Study};
use super::measure::Measured;
use super::reference::Check;
use super::{curves, verdict};
use crate::bench::error::BenchError;
use crate::bench::machine::Machine;
use crate::bench::plot::{Plot, Series};
use crate::bench::{files, thumbnail};
use crate::compare::load;
use crate::pixels::Pixels;
use std::fmt::Write as _;
use std::path::Path;

/// A study with its measurements and its reference.
#[derive(Debug)]
pub struct Made {
    pub study: Study,
    pub rows: Vec<Measured>,
    pub truth: Pixels,
    /// RMSE of the reference, from its noise.
    pub noise: f64,
}

/// What the studies of a page share.
#[derive(Debug)]
pub struct Common<'a> {
    pub machine: &'a Machine,
    pub profile: Profile,
    pub checks: &'a [Check],
    pub command: String,
    /// Of all renders in the tables, whenever they were made.
    pub cpu_seconds: f64,
}

/// A part of the error.
type Part = fn(&Measured) -> f64;

/// Longer side of the pictures in pixels.
const SIDE: usize = 160;

/// Writes README.md, plots and pictures to `folder`.
///
/// # Errors
/// A picture cannot be read, or a file cannot be written.
pub fn write(made: &[Made], common: &Common<'_>, folder: &Path) -> Result<(), BenchError> {
    let p = common.profile;
    let mut text = format!(
        "# Studies of photon mapping's parameters\n\nWritten by `{}`, which keeps what an earlier run has \
         rendered (the renders of the tables took {:.1} minutes of processor time). Pictures are {side} × \
         {side} pixels.\n\nMachine: {}\n\n**Reference.** Each scene's reference is {} passes of progressive \
         photon mapping with sampled direct light, in two halves whose difference gives its noise. The \
         document's room has a point lamp, whose caustics no path tracer can find. The renderer is therefore \
         checked against its path tracer in the same room under an area lamp:\n\n",
        common.command,
        common.cpu_seconds / 60.0,
        common.machine.line(),
        p.reference_passes,
        side = p.side
    );
    for c in common.checks {
        line(
            &mut text,
            format_args!(
                "* `{}`, path tracing with {} samples per pixel: the means differ by {:+.2} %, RMSE {:.4} \
                 (including the noise of the path tracer).",
                c.scene,
                c.path_samples,
                100.0 * c.bias,
                c.rmse
            ),
        );
    }
    text += "\n**Columns.** Times are of one render without loading. CPU time is that of all threads; it varies \
             less on a shared machine. RMSE² = bias² + noise²: bias is the root mean square over pixels of \
             (mean over seeds − reference), noise that of the standard deviation over seeds. FLIP is the mean \
             LDR-FLIP.\n";
    for m in made {
        study(m, folder, &mut text)?;
    }
    files::write(&folder.join("README.md"), text.as_bytes())
}

fn line(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    // Writing to a String does not fail.
    let _never = writeln!(text, "{arguments}");
}

fn study(m: &Made, folder: &Path, text: &mut String) -> Result<(), BenchError> {
    let s = &m.study;
    line(text, format_args!("\n## {}\n\n*The document:* {}\n\n{}\n", s.title, s.observation, s.setup));
    line(text, format_args!("{}\n", verdict::sentence(s.name, &m.rows)));
    line(
        text,
        format_args!(
            "| {} | CPU s | wall s | RMSE | bias | noise | mean % | FLIP | black % | seeds \
             |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|",
            s.title.to_lowercase()
        ),
    );
    for r in &m.rows {
        let noise = if r.seeds > 1 { format!("{:.4}", r.noise_rms) } else { "–".to_owned() };
        line(
            text,
            format_args!(
                "| {} | {:.2} | {:.2} | {:.4} | {:.4} | {noise} | {:+.2} | {:.4} | {:.2} | {} |",
                r.label,
                r.cpu_seconds,
                r.seconds,
                r.rmse,
                r.bias_rms,
                100.0 * r.mean_bias,
                r.flip,
                100.0 * r.black,
                r.seeds
            ),
        );
    }
    line(text, format_args!("\nNoise of the reference: RMSE {:.4}.\n", m.noise));
    let name = format!("{}.svg", s.name);
    files::write(&folder.join(&name), plot(m).svg().as_bytes())?;
    line(text, format_args!("![{}]({name})\n", s.title));
    if s.name == "kernels" {
        files::write(&folder.join("kernel-curves.svg"), curves::plot().svg().as_bytes())?;
        line(text, format_args!("![weight curves](kernel-curves.svg)\n"));
    }
    pictures(m, folder, text)
}

/// RMSE, bias and noise over the study's variable; for kernels only the RMSE of each.
fn plot(m: &Made) -> Plot {
    let curve = |name: String, group: &str, f: Part| {
        let mut line: Vec<(f64, f64)> =
            m.rows.iter().filter(|r| r.group == group).map(|r| (r.x, f(r))).collect();
        line.sort_by(|a, b| a.0.total_cmp(&b.0));
        Series { name, line, ..Series::default() }
    };
    let mut groups: Vec<&str> = Vec::new();
    for r in &m.rows {
        if !groups.contains(&r.group.as_str()) {
            groups.push(&r.group);
        }
    }
    let series = if m.study.name == "kernels" {
        KERNELS.iter().map(|k| curve((*k).to_owned(), k, |r| r.rmse)).collect()
    } else {
        let parts: [(&str, Part); 3] =
            [("RMSE", |r| r.rmse), ("bias", |r| r.bias_rms), ("noise", |r| r.noise_rms)];
        let named = |group: &str, part: &str| {
            if groups.len() > 1 { format!("{group}: {part}") } else { part.to_owned() }
        };
        groups.iter().flat_map(|g| parts.map(|(part, f)| curve(named(g, part), g, f))).collect()
    };
    let y = if m.study.name == "kernels" { "RMSE" } else { "radiance" };
    Plot {
        title: m.study.title.to_owned(),
        x: m.study.x.to_owned(),
        y: y.to_owned(),
        log: [m.study.log_x, true],
        series,
    }
}

/// A table of pictures, four per row, the reference first. Kernels are shown at one radius only.
fn pictures(m: &Made, folder: &Path, text: &mut String) -> Result<(), BenchError> {
    let mut cells = vec![("reference".to_owned(), format!("{}-reference.png", m.study.name))];
    files::write(&folder.join(&cells[0].1), &thumbnail::png(&m.truth, SIDE)?)?;
    for (i, r) in m.rows.iter().enumerate() {
        if m.study.name == "kernels" && r.x != 0.1 {
            continue;
        }
        let file = format!("{}-{i}.png", m.study.name);
        files::write(&folder.join(&file), &thumbnail::png(&load(&r.image, None)?.pixels, SIDE)?)?;
        cells.push((r.label.clone(), file));
    }
    for row in cells.chunks(4) {
        let names: Vec<&str> = row.iter().map(|c| c.0.as_str()).collect();
        let images: Vec<String> = row.iter().map(|c| format!("![{}]({})", c.0, c.1)).collect();
        line(
            text,
            format_args!(
                "| {} |\n|{}\n| {} |\n",
                names.join(" | "),
                ":-:|".repeat(row.len()),
                images.join(" | ")
            ),
        );
    }
    Ok(())
}
