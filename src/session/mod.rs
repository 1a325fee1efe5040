//! The front door: open a scene, describe it, render it, save the picture, go on from a checkpoint.
//!
//! Nothing here prints, parses arguments or ends the process; the command line, tests and benchmarks are a
//! few calls of this module each.
//!
//! - [`Session::open`] reads and compiles a scene with [`Options`]; [`Draft`] does the two in steps, between which the
//!   values of the scene can be changed.
//! - [`Inspection::of`] opens it as well and says what is in it, what rendering it will do ([`Plan`]) and what is
//!   wrong with it.
//! - [`Session::check_memory`] and [`Output::check`] find out what would fail before time is spent.
//! - [`Session::render`] makes passes until a [`Budget`] is used up and calls back after each.
//! - [`Session::picture`] gives pixels; [`Output::write`] puts them into files.
//! - [`Saver`] writes checkpoints; [`Session::resume`] goes on from one.
//! - [`Conversion`] writes a scene in another language.
//! - [`Session::render_range`] makes some of the passes of a render, on another machine perhaps, [`Session::part`] is
//!   what it has to send, and [`Merge`] makes the picture of all parts, which is that of one run to the last bit.

mod beside;
mod checkpoint;
mod convert;
mod describe;
mod draft;
mod error;
mod finding;
mod hashing;
mod inspection;
mod layer_data;
mod layers;
mod lock;
mod media;
mod memory;
mod merge;
mod options;
mod output;
mod parts;
mod passes;
mod picture;
mod place;
mod plan;
pub mod units;

use std::collections::BTreeSet;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use caustica_formats::confined::Confined;
use caustica_formats::diagnostic::{Diagnostic, SourceMap};
use caustica_formats::files::Files;
use caustica_formats::{Failure, Read, ir, read_scene};

use crate::integrator::Task;
use crate::render::{Checkpoint, Head, render};
use crate::scene::compile::{Compiled, compile};
use crate::scene::{Facts, Scene, View};

pub use crate::render::{Budget, Outcome, Progress, Statistics, Stop, Sums};
pub use crate::settings::{SETTINGS, SettingError, Settings};
pub use caustica_formats::diagnostic::nearest;
pub use caustica_formats::ir::{Crop, Filter, SpectrumRule};
pub use checkpoint::Saver;
pub use convert::{Conversion, Converted, Loss};
pub use describe::Description;
pub use draft::{Array, Draft, NumberKind, ValueError};
pub use error::Error;
pub use finding::{Finding, Label, Place};
pub use inspection::Inspection;
pub use layer_data::LayerData;
pub use layers::{Content, KNOWN as KNOWN_LAYERS, LayerError, LayerRequest, Layers};
pub use lock::Lock;
pub use memory::Memory;
pub use merge::{Merge, Merged};
pub use options::Options;
pub use output::Output;
pub use parts::{Parts, files_of_parts};
pub use passes::listed as listed_passes;
pub use picture::{Picture, PictureInfo};
pub use place::check_place;
pub use plan::Plan;

use describe::Contents;
use hashing::Hashing;

/// An opened scene. Its parts are public: tests and tools may look at the compiled scene, and change the
/// view or the settings before they render.
#[derive(Clone, Debug)]
pub struct Session {
    /// What rays meet and what shines.
    pub scene: Arc<Scene>,
    /// What rendering the scene needs.
    pub facts: Facts,
    /// Camera and film.
    pub view: View,
    /// The defaults, changed by the scene, changed by the options.
    pub settings: Settings,
    /// Of an EXR, beside the picture.
    layers: Layers,
    /// The options name them.
    layers_asked: bool,
    path: PathBuf,
    /// The film as the author wrote it, for what only matters to output.
    film: ir::Film,
    contents: Contents,
    findings: Vec<Finding>,
    /// Rendered with excerpts: all, and those about what is rendered.
    warnings: [String; 2],
    hash: String,
    /// Files the scene was read from, links followed.
    inputs: BTreeSet<PathBuf>,
    /// What of the options decides how those files are read.
    choices: Vec<(String, String)>,
}

impl Session {
    /// Reads the scene file at `path` (Mitsuba `.xml`, pbrt `.pbrt`) and what it names, and compiles it.
    ///
    /// # Errors
    /// [`Error::Scene`] with every problem of the scene; [`Error::Setting`] for a setting of the options that
    /// does not exist or does not parse.
    pub fn open(path: impl AsRef<Path>, options: &Options) -> Result<Self, Error> {
        let path = path.as_ref();
        Self::open_in(&Confined::new(path, &options.allow_paths), path, options)
    }

    /// [`Session::open`] with files from elsewhere, such as from memory.
    ///
    /// # Errors
    /// As [`Session::open`].
    pub fn open_in(files: &dyn Files, path: &Path, options: &Options) -> Result<Self, Error> {
        // A misspelt setting is found before the scene is read, which may take long.
        options.override_settings(&mut Settings::default())?;
        let files = Hashing::new(files, path);
        let read = read_scene(&files, path, &options.reading())?;
        Self::compiled(read, files, path, options)
    }

    /// Compiles a scene that is in memory already, as if it had been read from `path`.
    ///
    /// # Errors
    /// As [`Session::open`].
    pub fn of(scene: ir::Scene, files: &dyn Files, path: &Path, options: &Options) -> Result<Self, Error> {
        let read = Read { scene, warnings: Vec::new(), sources: SourceMap::default() };
        Self::compiled(read, Hashing::new(files, path), path, options)
    }

    fn compiled(mut read: Read, files: Hashing<'_>, path: &Path, options: &Options) -> Result<Self, Error> {
        options.check(&read.scene)?;
        options.override_film(&mut read.scene);
        let layers = options.layers_of(&read.scene);
        let mut compiled = compile_read(&read, &files, path, options)?;
        let Read { scene, warnings: mut diagnostics, sources } = read;
        let mut settings = compiled.settings;
        options.override_settings(&mut settings)?;
        diagnostics.extend(compiled.warnings);
        let others: Vec<Diagnostic> = diagnostics.iter().filter(|d| !d.unsupported).cloned().collect();
        let film = scene.sensors[options.sensor.unwrap_or(scene.default_sensor)].film.clone();
        let (hash, inputs) = files.finish();
        compiled.view.aovs = layers.aovs();
        Ok(Self {
            scene: Arc::new(compiled.scene),
            facts: compiled.facts,
            view: compiled.view,
            settings,
            layers,
            layers_asked: options.layers.is_some(),
            path: path.to_path_buf(),
            contents: Contents::of(&scene, options.sensor),
            film,
            findings: diagnostics.iter().map(|d| Finding::new(d, &sources)).collect(),
            warnings: [shown(&sources, &diagnostics), shown(&sources, &others)],
            hash,
            inputs,
            choices: options.choices(),
        })
    }

    /// The scene file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The scene file's name without folder and extension.
    pub fn name(&self) -> String {
        self.path.file_stem().map_or_else(|| "scene".to_owned(), |s| s.to_string_lossy().into_owned())
    }

    /// Width and height of what is rendered, in pixels.
    pub fn size(&self) -> [usize; 2] {
        let [_, _, width, height] = self.view.film.crop;
        [width as usize, height as usize]
    }

    /// Hash of the names and contents of all files of the scene.
    pub fn hash(&self) -> &str {
        &self.hash
    }

    /// What reading and compiling had to say, with excerpts of the author's files; may be empty.
    pub fn warnings(&self) -> &str {
        &self.warnings[0]
    }

    /// [`Session::warnings`] without those about what is not rendered, which [`Inspection::describe`] lists.
    pub fn other_warnings(&self) -> &str {
        &self.warnings[1]
    }

    /// What reading and compiling had to say, one by one.
    pub fn findings(&self) -> &[Finding] {
        &self.findings
    }

    /// What an EXR stores beside the picture.
    pub fn layers(&self) -> &Layers {
        &self.layers
    }

    /// Whether the scene's film keeps alpha.
    pub fn wants_alpha(&self) -> bool {
        use ir::PixelFormat::{LuminanceAlpha, Rgba, Xyza};
        matches!(self.film.pixel_format, Rgba | LuminanceAlpha | Xyza)
    }

    /// What a render with the present settings will do.
    pub fn plan(&self) -> Plan {
        Plan::of(self.task())
    }

    /// The same scene with other settings and layers. The compiled scene is shared.
    ///
    /// # Errors
    /// [`Error::Setting`] for a setting that does not exist or does not parse.
    pub fn with(&self, settings: &[(String, String)], layers: Option<Layers>) -> Result<Self, Error> {
        let mut session = self.clone();
        for (name, value) in settings {
            session.settings.set(name, value)?;
        }
        if let Some(layers) = layers {
            session.view.aovs = layers.aovs();
            (session.layers, session.layers_asked) = (layers, true);
        }
        Ok(session)
    }

    /// For the pass driver and the integrators.
    pub fn task(&self) -> Task<'_> {
        self.task_with(&self.settings)
    }

    /// The same with other settings.
    pub fn task_with<'a>(&'a self, settings: &'a Settings) -> Task<'a> {
        Task { scene: &self.scene, facts: &self.facts, view: &self.view, settings }
    }

    /// Renders passes from the first until the budget is used up, and calls `progress` after each. The
    /// result depends on the scene, the options and the number of passes only, not on threads.
    pub fn render(&self, budget: Budget<'_>, progress: &mut dyn FnMut(&Progress<'_>)) -> Outcome {
        self.resume(Sums::none(self.view.film.pixel_count()), budget, progress)
    }

    /// Goes on after the passes in `sums`, see [`Saver::resume`]. The result is that of one run.
    pub fn resume(&self, sums: Sums, budget: Budget<'_>, progress: &mut dyn FnMut(&Progress<'_>)) -> Outcome {
        render(self.task(), budget, sums, progress)
    }

    /// The picture that a render of this session has made so far.
    pub fn so_far<'a>(&self, progress: &Progress<'a>) -> Picture<'a> {
        let Progress { pixels, statistics, .. } = *progress;
        let passes = [statistics.first_pass, statistics.passes];
        Picture { info: self.info(), pixels, passes, missing: Vec::new() }
    }

    /// Renders the passes of a range, whole ones only. The sums of ranges that make up 0..n, merged in any order, are
    /// those of one run of n passes: [`Session::part`], [`Merge`]. The budget may end it before the end of the range.
    pub fn render_range(
        &self,
        range: Range<u32>,
        budget: Budget<'_>,
        progress: &mut dyn FnMut(&Progress<'_>),
    ) -> Outcome {
        let sums = Sums::none_from(range.start, self.view.film.pixel_count());
        self.resume_range(sums, range.end, budget, progress)
    }

    /// Goes on with a range that ends before pass `end`.
    pub fn resume_range(
        &self,
        sums: Sums,
        end: u32,
        budget: Budget<'_>,
        progress: &mut dyn FnMut(&Progress<'_>),
    ) -> Outcome {
        let count = end.saturating_sub(sums.first);
        let passes = Some(budget.passes.map_or(count, |n| n.min(count)));
        self.resume(sums, Budget { passes, whole: true, ..budget }, progress)
    }

    /// What a render has made, as the bytes of a checkpoint.
    ///
    /// # Errors
    /// [`Error::NotWhole`] when its first pass was cut.
    pub fn part(&self, outcome: &Outcome) -> Result<Vec<u8>, Error> {
        let statistics = &outcome.statistics;
        if statistics.first_pass_cut || statistics.passes == 0 {
            return Err(Error::NotWhole);
        }
        let head = Head { first: statistics.first_pass, passes: statistics.passes, ..checkpoint::head(self) };
        Ok(Checkpoint::encode(&head, &outcome.pixels))
    }

    /// The picture that a render of this session has made.
    pub fn picture<'a>(&self, outcome: &'a Outcome) -> Picture<'a> {
        let Outcome { pixels, statistics, .. } = outcome;
        let passes = [statistics.first_pass, statistics.passes];
        Picture { info: self.info(), pixels, passes, missing: Vec::new() }
    }

    /// What pictures of this session are.
    pub fn info(&self) -> PictureInfo {
        PictureInfo::of(self)
    }
}

/// Whether a scene that was read can be rendered: [`Session::open`] with these options fails where this does.
///
/// # Errors
/// As [`Session::open`].
pub fn check(read: &Read, files: &dyn Files, path: &Path, options: &Options) -> Result<(), Error> {
    compile_read(read, files, path, options).map(|_| ())
}

fn compile_read(read: &Read, files: &dyn Files, path: &Path, options: &Options) -> Result<Compiled, Error> {
    // What was not read from files has places in none.
    let has_places = read.sources.paths().next().is_some();
    let placed = |problems: Vec<Diagnostic>| -> Vec<Diagnostic> {
        problems.into_iter().map(|d| Diagnostic { span: d.span.filter(|_| has_places), ..d }).collect()
    };
    match compile(&read.scene, files, options.compiling(&options.layers_of(&read.scene))) {
        Ok(compiled) => Ok(Compiled { warnings: placed(compiled.warnings), ..compiled }),
        Err(problems) => {
            let all = read.warnings.iter().cloned().chain(placed(problems)).collect();
            Err(Box::new(Failure::new(all, read.sources.clone()).advised(files, path)).into())
        }
    }
}

fn shown(sources: &SourceMap, diagnostics: &[Diagnostic]) -> String {
    sources.render(diagnostics).trim_end().to_owned()
}
