//! Measures every point that is not in the folder yet, then writes tables and the page.

use super::analysis::{Analysis, SceneResult, Skipped};
use super::config::Config;
use super::machine::Machine;
use super::record::{self, Budget, Record};
use super::renderers::{Job, Made, Programs};
use super::{BenchArgs, BenchError, page, table};
use crate::compare::{CompareError, CompareOptions, Mask, compare, load};
use crate::pixels::Pixels;
use std::io::Write;
use std::path::{Path, PathBuf};

/// What a record says of a picture.
#[derive(Clone, Copy, Debug)]
pub struct Judged {
    pub rmse: f64,
    pub relmse: f64,
    pub bias: f64,
    pub flip: f64,
}

/// Judges a picture; both have one size, which the caller checks.
pub fn judge(image: &Pixels, reference: &Pixels) -> Judged {
    let options = CompareOptions { hdr: None, ..CompareOptions::default() };
    let c = compare(image, reference, None, &options).comparison;
    Judged {
        rmse: c.errors.rmse_all,
        relmse: c.errors.relmse,
        bias: c.bias.relative_all,
        flip: c.flip_ldr.stats.mean,
    }
}

/// Reads a picture that must have a given size.
pub fn load_sized(path: &Path, reference: &Path, size: [usize; 2]) -> Result<Pixels, BenchError> {
    let pixels = load(path, None)?.pixels;
    if [pixels.width, pixels.height] != size {
        return Err(BenchError::Image(CompareError::Size {
            path: path.to_path_buf(),
            size: [pixels.width, pixels.height],
            reference: reference.to_path_buf(),
            reference_size: size,
        }));
    }
    Ok(pixels)
}

/// A file of the run's folder, written.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), BenchError> {
    caustica_formats::image::atomic_write(path, bytes)
        .map_err(|source| BenchError::Io { path: path.to_path_buf(), source })
}

/// Creates a folder and those above it.
pub fn make_folder(path: &Path) -> Result<(), BenchError> {
    std::fs::create_dir_all(path).map_err(|source| BenchError::Io { path: path.to_path_buf(), source })
}

/// The whole of `caustica bench SCENE...`; `args` are resolved.
pub fn run(args: &BenchArgs, caustica: &Path, out: &mut dyn Write) -> Result<(), BenchError> {
    let machine = Machine::here(args.threads);
    let mut programs = Programs::new(args, caustica);
    make_folder(&args.output.join("images"))?;
    let mut configs = Vec::new();
    let mut skipped = Vec::new();
    for name in &args.configs {
        let config = Config::parse(name)?;
        match programs.missing(&config, out)? {
            None => configs.push(config),
            Some(reason) => {
                writeln!(out, "skipped {name}: {reason}")?;
                skipped.push(Skipped { config: name.clone(), reason });
            }
        }
    }
    let mut analysis = Analysis { machine, scenes: Vec::new(), skipped };
    let mut all = Vec::new();
    let mut pages = Vec::new();
    for (scene, reference) in args.scenes.iter().zip(&args.references) {
        let mut truth = load(reference, None)?.pixels;
        let mask = Mask::beside(reference, &truth)?;
        if let Some(mask) = &mask {
            mask.apply(&mut truth);
        }
        let run =
            SceneRun { args, programs: &programs, scene, reference, truth: &truth, mask: mask.as_ref() };
        let records = run.measure(&configs, &mut analysis.skipped, out)?;
        let name = run.name();
        let (size, budgets) = ([truth.width, truth.height], args.points());
        let names = &args.configs;
        let result =
            SceneResult::new(&name, reference.clone(), size, names, &budgets, &records, args.target_error);
        let left_out = mask.as_ref().map_or(0, Mask::left_out);
        analysis.scenes.push(SceneResult { left_out, ..result });
        all.extend(records);
        pages.push(truth);
    }
    table::write(&analysis, out)?;
    let json = serde_json::to_vec_pretty(&analysis)
        .map_err(|source| BenchError::Json { path: args.output.join("bench.json"), source })?;
    write_file(&args.output.join("bench.json"), &json)?;
    write_file(&args.output.join("bench.csv"), table::csv(&all).as_bytes())?;
    let html = page::render(&analysis, &pages, &args.output)?;
    write_file(&args.output.join("bench.html"), html.as_bytes())?;
    writeln!(out, "\nwrote {}", args.output.join("bench.html").display())?;
    if all.is_empty() { Err(BenchError::Nothing) } else { Ok(()) }
}

struct SceneRun<'a> {
    args: &'a BenchArgs,
    programs: &'a Programs,
    scene: &'a Path,
    reference: &'a Path,
    truth: &'a Pixels,
    /// Which pixels count.
    mask: Option<&'a Mask>,
}

impl SceneRun<'_> {
    fn name(&self) -> String {
        self.scene.file_stem().map_or_else(|| "scene".to_owned(), |s| s.to_string_lossy().into_owned())
    }

    /// Everything besides configuration, budget and seed that decides a record.
    fn identity(&self) -> Result<String, BenchError> {
        let read =
            |p: &Path| std::fs::read(p).map_err(|source| BenchError::Io { path: p.to_path_buf(), source });
        let (scene, reference) = (read(self.scene)?, read(self.reference)?);
        let rest = format!("{:?} {:?} {:?}", self.args.max_depth, self.args.threads, self.mask);
        Ok(record::fingerprint([scene.as_slice(), &reference, rest.as_bytes()]))
    }

    /// Records of all points, from the folder or made now. A renderer that fails is skipped from there on.
    fn measure(
        &self,
        configs: &[Config],
        skipped: &mut Vec<Skipped>,
        out: &mut dyn Write,
    ) -> Result<Vec<Record>, BenchError> {
        let (name, identity) = (self.name(), self.identity()?);
        let log = self.args.output.join("points.jsonl");
        let known = record::read(&log)?;
        let mut records = Vec::new();
        let mut failed: Vec<&str> = Vec::new();
        // Seeds outermost and configurations innermost: a load that comes and goes meets them all alike.
        for seed in 0..self.args.seeds {
            for budget in self.args.points() {
                for config in configs {
                    let point = (name.as_str(), config.name.as_str(), budget, seed, identity.as_str());
                    if let Some(done) = known.iter().find(|r| r.same_point(point)) {
                        records.push(done.clone());
                        continue;
                    }
                    if failed.contains(&config.name.as_str()) {
                        continue;
                    }
                    match self.point(config, budget, seed, &identity) {
                        Ok(record) => {
                            writeln!(
                                out,
                                "{name} {} {budget} seed {seed}: {:.2} s, RMSE {:.5}, FLIP {:.4}",
                                config.name, record.seconds, record.rmse, record.flip
                            )?;
                            out.flush()?;
                            record::append(&log, &record)?;
                            records.push(record);
                        }
                        Err(e @ (BenchError::Render { .. } | BenchError::Start { .. })) => {
                            writeln!(out, "{name} {}: {e}", config.name)?;
                            failed.push(&config.name);
                            skipped.push(Skipped {
                                config: format!("{} on {name}", config.name),
                                reason: e.to_string(),
                            });
                        }
                        Err(other) => return Err(other),
                    }
                }
            }
        }
        Ok(records)
    }

    fn point(
        &self,
        config: &Config,
        budget: Budget,
        seed: u64,
        identity: &str,
    ) -> Result<Record, BenchError> {
        let size = [self.truth.width, self.truth.height];
        let label = record::fingerprint([
            self.name().as_bytes(),
            config.name.as_bytes(),
            budget.to_string().as_bytes(),
            identity.as_bytes(),
        ]);
        let image = PathBuf::from("images").join(format!("{label}-{seed}.exr"));
        let path = self.args.output.join(&image);
        let job = Job { scene: self.scene, size, budget, seed, image: &path };
        let Made { seconds, cpu_seconds, peak_memory_bytes, passes } = self.programs.render(config, &job)?;
        let mut pixels = load_sized(&path, self.reference, size)?;
        if let Some(mask) = self.mask {
            mask.apply(&mut pixels);
        }
        let Judged { rmse, relmse, bias, flip } = judge(&pixels, self.truth);
        Ok(Record {
            scene: self.name(),
            config: config.name.clone(),
            budget,
            seed,
            identity: identity.to_owned(),
            seconds,
            cpu_seconds,
            peak_memory_bytes,
            passes,
            rmse,
            relmse,
            bias,
            flip,
            image,
        })
    }
}
