//! `caustica compare`: reads what the arguments name, compares, writes.

use super::args::CompareArgs;
use super::comparison::{Compared, Comparison, compare};
use super::error::CompareError;
use super::error_map;
use super::load::{Loaded, load};
use super::mask::Mask;
use super::page::Page;
use super::pairs::{self, Pair};
use super::report::{Failure, Report, Status};
use super::table::{write_rows, write_table};
use crate::metrics::{Variance, VarianceKind};
use crate::pixels::Pixels;
use caustica_formats::image::atomic_write;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Runs `caustica compare` and writes the table or the JSON to `out`. A pair that cannot be compared is part
/// of the output. If `out` cannot be written, the status is [`Status::CouldNotCompare`], unless its reader
/// closed it.
pub fn run(args: &CompareArgs, out: &mut dyn Write) -> Status {
    let mut report = Report::default();
    let mut page = args.html.as_ref().map(|_| Page::default());
    let folder = args.image.is_dir() && args.reference.is_dir();
    if let Err(error) = compare_all(args, folder, &mut report, page.as_mut()) {
        report.failures.push(Failure::new(&args.image, &args.reference, &error));
    }
    let mut status = if !report.failures.is_empty() {
        Status::CouldNotCompare
    } else if report.comparisons.iter().all(|c| c.holds) {
        Status::Holds
    } else {
        Status::FallsShort
    };
    report.status = status.code();
    let mut write = |path: &Path, bytes: &[u8], report: &mut Report| {
        if let Err(source) = atomic_write(path, bytes) {
            let error = CompareError::Io { path: path.to_path_buf(), source };
            report.failures.push(Failure::new(&args.image, &args.reference, &error));
            status = Status::CouldNotCompare;
            report.status = status.code();
        }
    };
    if let (Some(page), Some(path)) = (page, &args.html) {
        let page = page.render(&report);
        write(path, page.as_bytes(), &mut report);
    }
    if let Some(Some(path)) = &args.json {
        let json = to_json(&report);
        write(path, json.as_bytes(), &mut report);
    }
    match write_report(args, folder, &report, out) {
        // The reader may stop before the end.
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => {
            let _closed = writeln!(io::stderr(), "error: cannot write to stdout: {e}");
            Status::CouldNotCompare
        }
        _ => status,
    }
}

fn to_json(report: &Report) -> String {
    serde_json::to_string_pretty(report).expect("a report holds only numbers and strings")
}

fn compare_all(
    args: &CompareArgs,
    folder: bool,
    report: &mut Report,
    mut page: Option<&mut Page>,
) -> Result<(), CompareError> {
    let pairs = match (args.image.is_dir(), args.reference.is_dir()) {
        (true, true) => pairs::in_folders(&args.image, &args.reference)?,
        (false, false) => pairs::Pairs { pairs: vec![named(args)], ..Default::default() },
        (true, false) => {
            let (folder, file) = (args.image.clone(), args.reference.clone());
            return Err(CompareError::FolderAgainstFile { folder, file });
        }
        (false, true) => {
            let (folder, file) = (args.reference.clone(), args.image.clone());
            return Err(CompareError::FolderAgainstFile { folder, file });
        }
    };
    if pairs.pairs.is_empty() && pairs.missing.is_empty() {
        return Err(CompareError::NoReferences { folder: args.reference.clone() });
    }
    for pair in &pairs.pairs {
        match compare_pair(args, folder, pair, page.as_deref_mut()) {
            Ok(comparison) => report.comparisons.push(comparison),
            Err(error) => report.failures.push(Failure::new(&pair.image, &pair.reference, &error)),
        }
    }
    for reference in pairs.missing {
        let error = CompareError::NoImage { folder: args.image.clone(), reference: reference.clone() };
        report.failures.push(Failure::new(&args.image, &reference, &error));
    }
    report.unmatched = pairs.extra.iter().map(|p| p.display().to_string()).collect();
    Ok(())
}

fn named(args: &CompareArgs) -> Pair {
    let name = args.image.file_name().unwrap_or(args.image.as_os_str()).to_string_lossy().into_owned();
    Pair { name, image: args.image.clone(), reference: args.reference.clone() }
}

fn compare_pair(
    args: &CompareArgs,
    folder: bool,
    pair: &Pair,
    page: Option<&mut Page>,
) -> Result<Comparison, CompareError> {
    let image = load(&pair.image, args.layer.as_deref())?;
    let reference = load(&pair.reference, args.reference_layer.as_deref().or(args.layer.as_deref()))?;
    Ok(compare_loaded(args, folder, pair, image, reference, page)?.comparison)
}

/// As the files of `pair`, which messages and notes name.
pub(super) fn compare_loaded(
    args: &CompareArgs,
    folder: bool,
    pair: &Pair,
    mut image: Loaded,
    mut reference: Loaded,
    page: Option<&mut Page>,
) -> Result<Compared, CompareError> {
    same_size(&image.pixels, &pair.image, &reference.pixels, &pair.reference)?;
    let mut options = args.options();
    let mut notes = Vec::new();
    if image.display && reference.display && options.thresholds.hdr_flip.is_none() && options.hdr.is_some() {
        options.hdr = None;
        notes.push("no HDR-FLIP: both pictures hold display values".into());
    } else if image.display != reference.display {
        notes.push("one picture holds radiance, the other display values from 0 to 1".into());
    }
    let mask = match &args.mask {
        Some(path) => Some(Mask::read(path, &pair.reference, &reference.pixels)?),
        None => Mask::beside(&pair.reference, &reference.pixels)?,
    };
    if let Some(mask) = mask {
        mask.apply(&mut image.pixels);
        mask.apply(&mut reference.pixels);
        let (left_out, all) = (mask.left_out(), image.pixels.rgb.len());
        notes.push(format!("{left_out} of {all} pixels are masked out: they are black in both pictures"));
    }
    let variance = load_variance(args, pair, &image.pixels, &mut notes)?;
    let variance = variance.as_ref().map(|(pixels, kind)| Variance { pixels, kind: *kind });
    let mut compared = compare(&image.pixels, &reference.pixels, variance, &options);
    compared.comparison.name = pair.name.clone();
    compared.comparison.image = pair.image.display().to_string();
    compared.comparison.reference = pair.reference.display().to_string();
    compared.comparison.notes = notes;
    if let Some(path) = &args.error_map {
        error_map::write(&map_path(path, folder, &pair.name), &compared.ldr)?;
    }
    if let Some(page) = page {
        page.add(&compared, &image.pixels, &reference.pixels);
    }
    Ok(compared)
}

/// The file of a pair's error map: the path itself, or `folder/name.png`.
fn map_path(path: &Path, folder: bool, name: &str) -> PathBuf {
    if folder { path.join(format!("{name}.png")) } else { path.to_path_buf() }
}

fn same_size(image: &Pixels, path: &Path, other: &Pixels, other_path: &Path) -> Result<(), CompareError> {
    if image.same_size(other) {
        return Ok(());
    }
    Err(CompareError::Size {
        path: path.to_path_buf(),
        size: [image.width, image.height],
        reference: other_path.to_path_buf(),
        reference_size: [other.width, other.height],
    })
}

/// The variance image that was given, or found beside the reference. Without a usable one there is a note, or
/// an error if the z-test was asked for.
fn load_variance(
    args: &CompareArgs,
    pair: &Pair,
    image: &Pixels,
    notes: &mut Vec<String>,
) -> Result<Option<(Pixels, VarianceKind)>, CompareError> {
    let given = args.variance.as_ref().map(|path| (path.clone(), pairs::variance_kind(path)));
    let Some((path, kind)) = given.or_else(|| pairs::variance_beside(&pair.reference)) else {
        if args.z_test {
            return Err(CompareError::NoVariance { reference: pair.reference.clone() });
        }
        return Ok(None);
    };
    let kind = args.variance_of.map_or(kind, VarianceKind::from);
    if kind == VarianceKind::OfSample && args.spp.is_none() {
        let error = CompareError::NoSamples { path };
        if args.z_test {
            return Err(error);
        }
        notes.push(format!("no z-test: {error}"));
        return Ok(None);
    }
    if kind == VarianceKind::OfMean && (args.spp.is_none() || args.reference_spp.is_none()) {
        if !args.z_test {
            notes.push(
                "no z-test: it needs --spp and --reference-spp, the samples a pixel of both pictures".into(),
            );
            return Ok(None);
        }
        notes.push(
            "the z-test takes the image as free of noise: --spp and --reference-spp are not given".into(),
        );
    }
    let variance = load(&path, None)?.pixels;
    same_size(image, &pair.image, &variance, &path)?;
    Ok(Some((variance, kind)))
}

fn write_report(args: &CompareArgs, folder: bool, report: &Report, out: &mut dyn Write) -> io::Result<()> {
    if args.json == Some(None) {
        return writeln!(out, "{}", to_json(report));
    }
    if folder {
        write_rows(&report.comparisons, out)?;
    } else {
        report.comparisons.iter().try_for_each(|c| write_table(c, out))?;
    }
    for failure in &report.failures {
        writeln!(out, "could not compare: {}", failure.error)?;
    }
    for image in &report.unmatched {
        writeln!(out, "no reference for {image}")?;
    }
    Ok(())
}
