//! `caustica compare`: reads what the arguments name, compares, writes.

use super::args::CompareArgs;
use super::comparison::{CompareOptions, Compared, Comparison, compare};
use super::error::CompareError;
use super::error_map;
use super::files;
use super::load::{Loaded, Opened, open, rgb_of};
use super::mask::Mask;
use super::noise::{self, Known};
use super::page::Page;
use super::pairs::{self, Pair, Pairs};
use super::report::{Extra, Failure, Report, Status};
use super::update::{Accepted, Candidate, kept};
use super::variance::{self, Given, VarianceKind};
use crate::metrics::Noise;
use crate::pixels::Pixels;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Runs `caustica compare` and writes the table or the JSON to `out`. A pair that cannot be compared is part
/// of the output. If `out` cannot be written, the status is [`Status::CouldNotCompare`], unless its reader
/// closed it.
pub fn run(args: &CompareArgs, out: &mut dyn Write) -> Status {
    let began = Instant::now();
    let page = args.html.as_ref().map(|_| Page::default());
    let mut run = Run { args, folder: args.is_folders(), report: Report::default(), page };
    if let Err(error) = run.all() {
        let name = name_of(&args.image);
        run.report.failures.push(Failure::new(&name, &args.image, &args.reference, &error));
    }
    let Run { mut report, page, .. } = run;
    report.status = report.verdict().code();
    files::write_files(args, page.as_ref(), &mut report, began.elapsed());
    match files::print(args, &report, out) {
        // The reader may stop before the end.
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => {
            let _closed = writeln!(io::stderr(), "error: cannot write to stdout: {e}");
            Status::CouldNotCompare
        }
        _ => report.verdict(),
    }
}

/// Compares two pictures as if they were the files that the arguments name.
pub(super) fn compare_opened(args: &CompareArgs, pictures: [Opened; 2]) -> Result<Compared, CompareError> {
    let (image, reference) = (args.image.clone(), args.reference.clone());
    let pair = Pair { name: name_of(&image), image, reference };
    Run { args, folder: false, report: Report::default(), page: None }.opened(&pair, pictures, None)
}

fn name_of(file: &Path) -> String {
    file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned()
}

struct Run<'a> {
    args: &'a CompareArgs,
    folder: bool,
    report: Report,
    page: Option<Page>,
}

impl Run<'_> {
    fn all(&mut self) -> Result<(), CompareError> {
        let args = self.args;
        let pairs = self.pairs()?;
        let accepted = args.update.as_ref().map(|names| {
            let compared = pairs.pairs.iter().map(|pair| &pair.name);
            let lone = pairs.missing.iter().chain(&pairs.extra).map(|(name, _)| name);
            let known: Vec<&str> = compared.chain(lone).map(String::as_str).collect();
            Accepted::new(names.as_deref(), &known)
        });
        let accepted = accepted.transpose()?;
        let nothing = pairs.pairs.is_empty() && pairs.missing.is_empty();
        if nothing && (accepted.is_none() || pairs.extra.is_empty()) {
            return Err(CompareError::NoReferences { folder: args.reference.clone() });
        }
        for pair in &pairs.pairs {
            let began = Instant::now();
            let result = self.pair(pair, accepted.as_ref());
            let seconds = began.elapsed().as_secs_f64();
            match result {
                Ok(comparison) => self.report.comparisons.push(Comparison { seconds, ..comparison }),
                Err(error) => {
                    let failure = Failure::new(&pair.name, &pair.image, &pair.reference, &error);
                    self.report.failures.push(Failure { seconds, ..failure });
                    let kept = || kept(&pair.name, &pair.image, &pair.reference);
                    self.report.updates.extend(accepted.as_ref().map(|_| kept()));
                }
            }
        }
        for (name, reference) in pairs.missing {
            let error = CompareError::NoImage { folder: args.image.clone(), reference: reference.clone() };
            self.report.failures.push(Failure::new(&name, &args.image, &reference, &error));
        }
        pairs.extra.iter().for_each(|(name, image)| self.extra(name, image, accepted.as_ref()));
        Ok(())
    }

    fn pairs(&self) -> Result<Pairs, CompareError> {
        let args = self.args;
        let against = |folder: &PathBuf, file: &PathBuf| CompareError::FolderAgainstFile {
            folder: folder.clone(),
            file: file.clone(),
        };
        match (args.image.is_dir(), args.reference.is_dir()) {
            (true, true) => pairs::in_folders(&args.image, &args.reference),
            (true, false) => Err(against(&args.image, &args.reference)),
            (false, true) => Err(against(&args.reference, &args.image)),
            (false, false) => {
                let (image, reference) = (args.image.clone(), args.reference.clone());
                let pair = Pair { name: name_of(&image), image, reference };
                Ok(Pairs { pairs: vec![pair], ..Pairs::default() })
            }
        }
    }

    /// An image without a reference: said, or made a reference.
    fn extra(&mut self, name: &str, image: &Path, accepted: Option<&Accepted>) {
        let reference = self.args.reference.join(image.strip_prefix(&self.args.image).unwrap_or(image));
        let add = |accepted: &Accepted| {
            let opened = open(image)?;
            rgb_of(&opened.image, image, self.args.layer.as_deref())?;
            accepted.add(name, image, &opened.bytes, &reference)
        };
        match accepted.map_or(Ok(None), add) {
            Ok(Some(update)) => self.report.updates.push(update),
            Ok(None) => {
                let image = image.display().to_string();
                self.report.unmatched.push(Extra { name: name.to_owned(), image });
            }
            Err(error) => self.report.failures.push(Failure::new(name, image, &reference, &error)),
        }
    }

    fn pair(&mut self, pair: &Pair, accepted: Option<&Accepted>) -> Result<Comparison, CompareError> {
        let files = [open(&pair.image)?, open(&pair.reference)?];
        Ok(self.opened(pair, files, accepted)?.comparison)
    }

    /// Compares the files of a pair.
    fn opened(
        &mut self,
        pair: &Pair,
        [image_file, reference_file]: [Opened; 2],
        accepted: Option<&Accepted>,
    ) -> Result<Compared, CompareError> {
        let args = self.args;
        let layer = args.layer.as_deref();
        let reference_layer = args.reference_layer.as_deref().or(layer);
        let mut image = rgb_of(&image_file.image, &pair.image, layer)?;
        let mut reference = rgb_of(&reference_file.image, &pair.reference, reference_layer)?;
        same_size(&image.pixels, &pair.image, &reference.pixels, &pair.reference)?;
        let mut notes = Vec::new();
        let options = self.options(&image, &reference, &mut notes);
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
        let noise = self.noise(pair, &image_file, &reference_file, &mut notes)?;
        let mut compared = compare(&image.pixels, &reference.pixels, noise.as_ref(), &options);
        compared.comparison.name = pair.name.clone();
        compared.comparison.image = pair.image.display().to_string();
        compared.comparison.reference = pair.reference.display().to_string();
        compared.comparison.notes = notes;
        if let Some(path) = &args.error_map {
            error_map::write(&map_path(path, self.folder, &pair.name), &compared.ldr)?;
        }
        if let Some(accepted) = accepted {
            let candidate = Candidate {
                pair,
                bytes: &image_file.bytes,
                image: &image.pixels,
                reference: &reference.pixels,
                compared: &compared,
            };
            let update = accepted.replace(&candidate, &args.update_pages)?;
            self.report.updates.push(update);
        }
        if let Some(page) = &mut self.page {
            page.add(&compared, &image.pixels, &reference.pixels);
        }
        Ok(compared)
    }

    fn options(&self, image: &Loaded, reference: &Loaded, notes: &mut Vec<String>) -> CompareOptions {
        let mut options = self.args.options();
        let both = image.display && reference.display;
        if both && options.thresholds.hdr_flip.is_none() && options.hdr.is_some() {
            options.hdr = None;
            notes.push("no HDR-FLIP: both pictures hold display values".into());
        } else if image.display != reference.display {
            notes.push("one picture holds radiance, the other display values from 0 to 1".into());
        }
        options
    }

    /// What is known of the noise of both pictures. If too little is known for a z-test there is a note, or an error
    /// if the test was asked for.
    fn noise(
        &self,
        pair: &Pair,
        image: &Opened,
        reference: &Opened,
        notes: &mut Vec<String>,
    ) -> Result<Option<Noise>, CompareError> {
        let args = self.args;
        let kind = args.variance_of.map(VarianceKind::from);
        let found = || {
            let given = |file| Given { file, kind };
            // The layers tell the noise of the whole picture only.
            let whole = [args.layer.is_none(), args.layer.is_none() && args.reference_layer.is_none()];
            let of_image =
                variance::find(&pair.image, &image.image, given(args.image_variance.as_deref()), whole[0])?;
            let of_reference =
                variance::find(&pair.reference, &reference.image, given(args.variance.as_deref()), whole[1])?;
            Ok([of_image, of_reference])
        };
        let [of_image, of_reference] = match found() {
            // Layers that say nothing do no harm where no test was asked for.
            Err(error @ CompareError::NotVariance { .. }) if !args.z_test => {
                notes.push(format!("no z-test: {error}"));
                return Ok(None);
            }
            found => found?,
        };
        let image = Known { variance: of_image, samples: args.spp.or_else(|| variance::samples(image)) };
        let samples = args.reference_spp.or_else(|| variance::samples(reference));
        let reference = Known { variance: of_reference, samples };
        let Some(difference) = noise::of_difference(&image, &reference) else {
            let source = image.variance.or(reference.variance);
            let error = source.map_or_else(
                || CompareError::NoVariance { reference: pair.reference.clone(), image: pair.image.clone() },
                |source| CompareError::NoSamples { from: source.from },
            );
            return match error {
                error if args.z_test => Err(error),
                CompareError::NoVariance { .. } => Ok(None),
                error => {
                    notes.push(format!("no z-test: {error}"));
                    Ok(None)
                }
            };
        };
        // Nobody expects an image of unknown noise to agree with its reference to within the reference's.
        if difference.image_is_exact && !args.z_test {
            notes.push("no z-test: nothing is known of the noise of the image; --spp and --reference-spp, the samples a pixel of both pictures, or a variance of its own would tell it".into());
            return Ok(None);
        }
        notes.push(difference.note);
        Ok(Some(difference.noise))
    }
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
