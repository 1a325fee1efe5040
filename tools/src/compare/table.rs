//! Comparisons as text.

use super::check::Check;
use super::comparison::Comparison;
use super::report::{Action, Update};
use crate::flip::FlipStats;
use std::io::{self, Write};

/// A name or message in one line: line ends and other control characters of a file's name would pass for lines of
/// ours, for commands of a GitHub workflow, or for those of a terminal.
pub fn shown(text: &str) -> String {
    text.replace(char::is_control, "\u{FFFD}")
}

/// Writes one comparison in full.
///
/// # Errors
/// `out` cannot be written.
pub fn write_table(c: &Comparison, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "image      {}", shown(&c.image))?;
    writeln!(out, "reference  {}", shown(&c.reference))?;
    writeln!(out, "size       {} x {}", c.width, c.height)?;
    writeln!(out)?;
    writeln!(out, "{:<12}{:>12}{:>12}{:>12}{:>12}", "", "R", "G", "B", "all")?;
    let mean = |v: [f64; 3]| v.iter().sum::<f64>() / 3.0;
    let b = &c.bias;
    row(out, "mean", b.image_mean, mean(b.image_mean), |v| format!("{v:.6}"))?;
    row(out, "reference", b.reference_mean, mean(b.reference_mean), |v| format!("{v:.6}"))?;
    row(out, "bias", b.absolute, b.absolute_all, |v| format!("{v:+.6}"))?;
    row(out, "bias, rel.", b.relative, b.relative_all, |v| format!("{:+.3} %", 100.0 * v))?;
    row(out, "RMSE", c.errors.rmse, c.errors.rmse_all, |v| format!("{v:.6}"))?;
    writeln!(out)?;
    let e = &c.errors;
    writeln!(
        out,
        "relMSE      {:>12.6}   without the worst 0.1 % of the pixels: {:.6}",
        e.relmse, e.relmse_trimmed
    )?;
    writeln!(out, "MAPE        {:>10.3} %", 100.0 * e.mape)?;
    match e.psnr {
        Some(psnr) => writeln!(out, "PSNR        {psnr:>9.2} dB   peak {}", e.psnr_peak)?,
        None => writeln!(out, "PSNR           (equal)")?,
    }
    writeln!(out)?;
    writeln!(out, "{:<12}{:>12}{:>12}{:>12}{:>12}{:>12}", "FLIP", "mean", "median", "95 %", "99 %", "max")?;
    flip_row(out, "LDR", &c.flip_ldr.stats)?;
    if let Some(hdr) = &c.flip_hdr {
        flip_row(out, "HDR", &hdr.stats)?;
        let x = &hdr.exposures;
        writeln!(
            out,
            "  HDR: {} exposures from {:+.2} to {:+.2} stops, {:?}",
            x.count, x.start, x.stop, hdr.tonemapper
        )?;
    }
    if let Some(z) = &c.z_test {
        writeln!(out)?;
        writeln!(
            out,
            "z-test      {}: {:.4} % of the values accepted, {:.2} % required; smallest p {:.2e}, alpha {:.2e}",
            if z.accepted { "accepted" } else { "REJECTED" },
            100.0 * z.accepted_share,
            100.0 * z.required_share,
            z.min_p,
            z.alpha
        )?;
        writeln!(
            out,
            "            {:.4} % of the pixels within 4.5 sigma; mean z^2 {:.3}",
            100.0 * z.within_4_5_sigma,
            z.mean_z2
        )?;
    }
    for note in &c.notes {
        writeln!(out, "note: {}", shown(note))?;
    }
    if !c.checks.is_empty() {
        writeln!(out)?;
    }
    c.checks.iter().try_for_each(|check| writeln!(out, "{}", check_line(check)))
}

/// Writes one line per comparison, and one per threshold that does not hold.
///
/// # Errors
/// `out` cannot be written.
pub fn write_rows(comparisons: &[Comparison], out: &mut dyn Write) -> io::Result<()> {
    let wide = comparisons.iter().map(|c| c.name.chars().count()).max().unwrap_or(0).max(5);
    writeln!(
        out,
        "{:<wide$}{:>11}{:>11}{:>11}{:>10}{:>10}  z-test",
        "image", "RMSE", "relMSE", "bias", "FLIP", "HDR-FLIP"
    )?;
    for c in comparisons {
        let hdr = c.flip_hdr.as_ref().map_or("-".into(), |h| format!("{:.4}", h.stats.mean));
        let z = c.z_test.as_ref().map_or("-", |z| if z.accepted { "accepted" } else { "rejected" });
        writeln!(
            out,
            "{:<wide$}{:>11.6}{:>11.6}{:>9.3} %{:>10.4}{hdr:>10}  {z}",
            shown(&c.name),
            c.errors.rmse_all,
            c.errors.relmse,
            100.0 * c.bias.relative_all,
            c.flip_ldr.stats.mean,
        )?;
        for check in c.checks.iter().filter(|check| !check.holds) {
            writeln!(out, "  {}", check_line(check))?;
        }
    }
    Ok(())
}

/// Writes one line for each reference that `--update` could replace.
///
/// # Errors
/// `out` cannot be written.
pub fn write_updates(updates: &[Update], out: &mut dyn Write) -> io::Result<()> {
    updates.iter().try_for_each(|u| {
        let (image, reference) = (shown(&u.image), shown(&u.reference));
        match u.action {
            Action::Replaced => {
                let page = shown(u.page.as_deref().unwrap_or_default());
                writeln!(out, "replaced  {reference} by {image}; before and after: {page}")
            }
            Action::Added => writeln!(out, "added     {reference} from {image}"),
            Action::Kept => {
                let reason = shown(u.reason.as_deref().unwrap_or_default());
                writeln!(out, "kept      {reference}: {reason}")
            }
        }
    })
}

/// Whether a threshold holds, and the values.
pub fn check_line(c: &Check) -> String {
    format!("{}  {c}", if c.holds { "holds" } else { "FAILS" })
}

fn row(
    out: &mut dyn Write,
    name: &str,
    v: [f64; 3],
    all: f64,
    show: impl Fn(f64) -> String,
) -> io::Result<()> {
    writeln!(out, "{name:<12}{:>12}{:>12}{:>12}{:>12}", show(v[0]), show(v[1]), show(v[2]), show(all))
}

fn flip_row(out: &mut dyn Write, name: &str, s: &FlipStats) -> io::Result<()> {
    writeln!(
        out,
        "  {name:<10}{:>12.6}{:>12.6}{:>12.6}{:>12.6}{:>12.6}",
        s.mean, s.median, s.p95, s.p99, s.max
    )
}
