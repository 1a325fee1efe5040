//! `caustica bench SCENE...`: measures every point that is not in the folder yet, then writes tables and the
//! page.

use super::analysis::{Analysis, Measured, SceneResult, Skipped, Stopped};
use super::args::BenchArgs;
use super::config::Config;
use super::error::BenchError;
use super::judge::{Judged, judge, load_sized};
use super::machine::Machine;
use super::noise::Noise;
use super::plan::Costs;
use super::record::{self, Budget, Record};
use super::renderers::{Job, Made, Programs};
use super::{files, markdown, page, process, table};
use crate::compare::{Mask, load};
use crate::pixels::Pixels;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Runs the benchmark; `args` are resolved.
///
/// # Errors
/// A file cannot be read or written, a configuration is unknown, or no render succeeded.
pub fn run(args: &BenchArgs, mut programs: Programs, out: &mut dyn Write) -> Result<(), BenchError> {
    let machine = Machine::here(args.threads);
    files::make_folder(&args.output.join("images"))?;
    let (configs, skipped) = available(args, &mut programs, out)?;
    let wall = "this system does not report the CPU time of other processes: for caustica and pbrt, CPU times are \
                wall times";
    let notes = if process::tells_cpu_time() { Vec::new() } else { vec![wall.to_owned()] };
    let mut analysis = Analysis { machine, scenes: Vec::new(), skipped, notes };
    let mut all = Vec::new();
    let mut truths = Vec::new();
    for (scene, reference) in args.scenes.iter().zip(&args.references) {
        let mut truth = load(reference, None)?.pixels;
        let mask = Mask::beside(reference, &truth)?;
        if let Some(mask) = &mask {
            mask.apply(&mut truth);
        }
        let run =
            SceneRun { args, programs: &programs, scene, reference, truth: &truth, mask: mask.as_ref() };
        let measured = run.measure(&configs, &mut analysis, out)?;
        let name = run.name();
        let (size, budgets) = ([truth.width, truth.height], args.points());
        let names = &args.configs;
        let result =
            SceneResult::new(&name, reference.clone(), size, names, &budgets, &measured, args.target_error);
        let left_out = mask.as_ref().map_or(0, Mask::left_out);
        let noise = Noise::beside(reference, &truth, mask.as_ref())?;
        analysis.scenes.push(SceneResult { left_out, noise, ..result });
        all.extend(measured.records);
        truths.push(truth);
    }
    // Results from before are worth more than an empty page.
    if all.is_empty() {
        return Err(BenchError::Nothing);
    }
    write(&analysis, &all, &truths, &args.output, out)
}

/// The configurations that can be measured here, and those that cannot.
fn available(
    args: &BenchArgs,
    programs: &mut Programs,
    out: &mut dyn Write,
) -> Result<(Vec<Config>, Vec<Skipped>), BenchError> {
    let (mut configs, mut skipped) = (Vec::new(), Vec::new());
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
    Ok((configs, skipped))
}

/// Writes the tables, JSON, CSV and the page.
fn write(
    analysis: &Analysis,
    records: &[Record],
    truths: &[Pixels],
    folder: &Path,
    out: &mut dyn Write,
) -> Result<(), BenchError> {
    table::write(analysis, out)?;
    let json = serde_json::to_vec_pretty(analysis)
        .map_err(|source| BenchError::Json { path: folder.join("bench.json"), source })?;
    files::write(&folder.join("bench.json"), &json)?;
    files::write(&folder.join("bench.csv"), table::csv(records).as_bytes())?;
    files::write(&folder.join("bench.md"), markdown::render(analysis).as_bytes())?;
    let html = page::render(analysis, truths, folder)?;
    files::write(&folder.join("bench.html"), html.as_bytes())?;
    writeln!(out, "\nwrote {}", folder.join("bench.html").display())?;
    Ok(())
}

/// One scene of a run.
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

    /// Fingerprint of everything but configuration, budget and seed that decides a record.
    fn identity(&self) -> Result<String, BenchError> {
        let (scene, reference) = (files::read(self.scene)?, files::read(self.reference)?);
        // The first word stands for how times are measured.
        let rest = format!("CPU {:?} {:?} {:?}", self.args.max_depth, self.args.threads, self.mask);
        Ok(record::fingerprint([scene.as_slice(), &reference, rest.as_bytes()]))
    }

    /// The records of all points, from the folder or measured now. After a failure, the rest of a
    /// configuration is skipped; after a render that took too long, the same and longer ones.
    fn measure(
        &self,
        configs: &[Config],
        analysis: &mut Analysis,
        out: &mut dyn Write,
    ) -> Result<Measured, BenchError> {
        let (name, identity) = (self.name(), self.identity()?);
        let log = self.args.output.join("points.jsonl");
        let mut known = record::read(&log)?;
        known.retain(|r| r.scene == name && r.identity == identity);
        let Measured { mut records, mut stopped } = Measured::default();
        let mut failed: Vec<&str> = Vec::new();
        let mut plans: Vec<Plan> = configs.iter().map(|config| Plan::new(config, &known)).collect();
        for (seed, budget, index) in self.points(configs.len()) {
            let (config, plan) = (&configs[index], &mut plans[index]);
            let point = (name.as_str(), config.name.as_str(), budget, seed, identity.as_str());
            let done = known.iter().find(|r| r.same_point(point));
            let too_long = stopped.iter().any(|s: &Stopped| s.config == config.name && s.budget <= budget);
            if done.is_none() && (too_long || failed.contains(&config.name.as_str())) {
                continue;
            }
            let measured = match done {
                Some(r)
                    if records.iter().any(|other| repeats(other, &r.config, r.budget, seed, r.passes)) =>
                {
                    Ok(None)
                }
                Some(r) => Ok(Some((r.clone(), None))),
                None => self.point(config, plan, (budget, seed, &identity), &records),
            };
            match measured {
                // Budgets that are too short for another pass would give the same picture.
                Ok(None) => {}
                Ok(Some((record, note))) => {
                    if let Some(note) = note.filter(|note| !analysis.notes.contains(note)) {
                        analysis.notes.push(note);
                    }
                    if done.is_none() {
                        writeln!(out, "{name} {}", progress(&record))?;
                        out.flush()?;
                        record::append(&log, &record)?;
                    }
                    records.push(record);
                }
                Err(BenchError::Stopped { command, seconds }) => {
                    writeln!(
                        out,
                        "{name} {} {budget} seed {seed}: stopped after {seconds} s: {command}",
                        config.name
                    )?;
                    out.flush()?;
                    stopped.push(Stopped { config: config.name.clone(), budget, seconds });
                }
                Err(e @ (BenchError::Render { .. } | BenchError::Start { .. })) => {
                    writeln!(out, "{name} {}: {e}", config.name)?;
                    failed.push(&config.name);
                    let config = format!("{} on {name}", config.name);
                    analysis.skipped.push(Skipped { config, reason: e.to_string() });
                }
                Err(other) => return Err(other),
            }
        }
        Ok(Measured { records, stopped })
    }

    /// All points in the order in which they are measured, with the index of the configuration: seeds outermost and
    /// configurations innermost, so that a load on the machine that comes and goes affects all of them alike.
    fn points(&self, configs: usize) -> Vec<(u64, Budget, usize)> {
        let budgets = self.args.points();
        let of_seed = |seed| budgets.iter().flat_map(move |b| (0..configs).map(move |c| (seed, *b, c)));
        (0..self.args.seeds.unwrap_or(SEEDS)).flat_map(of_seed).collect()
    }

    /// The passes for a budget, from renders that are made to know the cost.
    fn passes(&self, config: &Config, budget: Budget, plan: &mut Plan) -> Result<u32, BenchError> {
        let seconds = match budget {
            Budget::Passes(passes) => return Ok(passes),
            Budget::CpuSeconds(seconds) => seconds,
        };
        if let Some((_, passes)) = plan.passes.iter().find(|(planned, _)| *planned == budget) {
            return Ok(*passes);
        }
        let image = self.args.output.join("images").join("trial.exr");
        loop {
            if let Some(passes) = plan.costs.passes(seconds) {
                plan.passes.push((budget, passes));
                return Ok(passes);
            }
            let passes = plan.costs.next(seconds);
            let job = Job { scene: self.scene, size: self.size(), passes, seed: TRIAL_SEED, image: &image };
            plan.costs.add(u64::from(passes), self.programs.render(config, &job)?.cpu_seconds);
        }
    }

    fn size(&self) -> [usize; 2] {
        [self.truth.width, self.truth.height]
    }

    /// Renders and judges a point; `None` if one of the records has as many passes.
    fn point(
        &self,
        config: &Config,
        plan: &mut Plan,
        (budget, seed, identity): (Budget, u64, &str),
        records: &[Record],
    ) -> Result<Option<(Record, Option<String>)>, BenchError> {
        let passes = self.passes(config, budget, plan)?;
        let label = record::fingerprint([
            self.name().as_bytes(),
            config.name.as_bytes(),
            budget.to_string().as_bytes(),
            identity.as_bytes(),
        ]);
        let image = PathBuf::from("images").join(format!("{label}-{seed}.exr"));
        if records.iter().any(|r| repeats(r, &config.name, budget, seed, u64::from(passes))) {
            return Ok(None);
        }
        let path = self.args.output.join(&image);
        let job = Job { scene: self.scene, size: self.size(), passes, seed, image: &path };
        let Made { seconds, cpu_seconds, peak_memory_bytes, passes, note } =
            self.programs.render(config, &job)?;
        plan.costs.add(passes, cpu_seconds);
        let mut pixels = load_sized(&path, self.reference, self.size())?;
        if let Some(mask) = self.mask {
            mask.apply(&mut pixels);
        }
        let Judged { rmse, relmse, relmse_trimmed, bias, flip, hdr_flip } = judge(&pixels, self.truth);
        let record = Record {
            scene: self.name(),
            config: config.name.clone(),
            budget,
            seed,
            identity: identity.to_owned(),
            seconds,
            cpu_seconds: cpu_seconds.max(LEAST_CPU_SECONDS),
            peak_memory_bytes,
            passes,
            rmse,
            relmse,
            relmse_trimmed,
            bias,
            flip,
            hdr_flip,
            image,
        };
        Ok(Some((record, note)))
    }
}

/// Renders of each point, where the command line does not say.
const SEEDS: u64 = 3;
/// Half a tick of the clock that tells CPU time: shorter times are reported as 0, which has no logarithm.
const LEAST_CPU_SECONDS: f64 = 0.005;
/// The seed of renders that are made only to know the cost.
const TRIAL_SEED: u64 = 1 << 20;

/// What is known of the cost of a configuration, and the passes of each budget: the same for all seeds.
struct Plan {
    costs: Costs,
    passes: Vec<(Budget, u32)>,
}

impl Plan {
    fn new(config: &Config, known: &[Record]) -> Self {
        let mut plan = Self { costs: Costs::default(), passes: Vec::new() };
        for record in known.iter().filter(|r| r.config == config.name) {
            plan.costs.add(record.passes, record.cpu_seconds);
            plan.passes.push((record.budget, u32::try_from(record.passes).unwrap_or(u32::MAX)));
        }
        plan
    }
}

/// Whether a record is of another CPU time which the same passes come nearest to: it would be the same picture.
fn repeats(record: &Record, config: &str, budget: Budget, seed: u64, passes: u64) -> bool {
    let timed = |budget| matches!(budget, Budget::CpuSeconds(_));
    (record.config.as_str(), record.seed, record.passes) == (config, seed, passes)
        && record.budget != budget
        && timed(record.budget)
        && timed(budget)
}

/// A record in a line.
fn progress(r: &Record) -> String {
    format!(
        "{} {} seed {}: {:.2} CPU s, {:.2} s, RMSE {:.5}, FLIP {:.4}",
        r.config, r.budget, r.seed, r.cpu_seconds, r.seconds, r.rmse, r.flip
    )
}
