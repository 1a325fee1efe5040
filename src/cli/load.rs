//! Scene file → compiled scene, for every subcommand.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use caustica_formats::confined::Confined;
use caustica_formats::diagnostic::{Diagnostic, SourceMap};
use caustica_formats::ir;
use caustica_formats::{Read, ReadOptions, read_scene};
use clap::{Args, ValueEnum};

use super::failure::Failure;
use super::hashing::Hashing;
use super::report;
use crate::integrator::Task;
use crate::scene::compile::{CompileOptions, MAX_PIXELS, compile};
use crate::scene::{Facts, Scene, View};
use crate::session::Plan;
use crate::settings::Settings;

/// Arguments that decide what scene is rendered, and how.
#[derive(Debug, Args)]
pub struct SceneArgs {
    /// Mitsuba scene (.xml, versions 0.4 to 3.x) or pbrt scene (.pbrt, version 4)
    pub scene: Option<PathBuf>,
    /// Value of a scene parameter `$NAME`
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = pair)]
    define: Vec<(String, String)>,
    /// Which sensor, counted from 0 in file order
    #[arg(long, value_name = "N")]
    sensor: Option<usize>,
    /// photonmap (the default, also for scenes that ask for another integrator) or path
    #[arg(long, value_name = "NAME")]
    integrator: Option<String>,
    /// progressive (a new photon map each pass) or classic (one map)
    #[arg(long, value_name = "NAME")]
    mode: Option<String>,
    /// Any setting of `--help-settings`
    #[arg(long, value_name = "KEY=VALUE", value_parser = pair)]
    set: Vec<(String, String)>,
    /// Camera samples a pixel; in progressive mode also photon passes
    #[arg(long, value_name = "N")]
    pub spp: Option<u32>,
    /// The same as --spp
    #[arg(long, value_name = "N", conflicts_with = "spp")]
    pub passes: Option<u32>,
    /// Light paths a pass, for each photon map
    #[arg(long, value_name = "N")]
    photons: Option<String>,
    /// Path segments from camera to lamp, at most; -1 is no limit
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    max_depth: Option<String>,
    /// Random seed
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Size of the full film
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<(u32, u32)>,
    /// Render this part of the film only, in pixels
    #[arg(long, value_name = "X,Y,W,H", value_parser = crop)]
    crop: Option<ir::Crop>,
    /// Reconstruction filter: box, tent, gaussian, mitchell, catmullrom or lanczos
    #[arg(long, value_name = "NAME", value_parser = filter)]
    filter: Option<ir::Filter>,
    /// How spectra become RGB: as mitsuba3 does for every file, as mitsuba06 did, or as the renderer of
    /// the file's own version does
    #[arg(long, value_name = "RULE", value_enum, default_value = "mitsuba3")]
    spectral_to_rgb: SpectralRule,
    /// Render what is not supported as something near, with a warning
    #[arg(long)]
    allow_unsupported: bool,
    /// Also read and search this folder; a scene may read below its own folder only
    #[arg(long, value_name = "DIR")]
    allow_path: Vec<PathBuf>,
    #[arg(skip)]
    longest_side: Option<u32>,
    #[arg(skip)]
    upgrade_v3: bool,
}

/// Whose rule turns spectra into RGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SpectralRule {
    Mitsuba3,
    Mitsuba06,
    File,
}

impl SpectralRule {
    /// `None`: that of the file.
    pub fn rule(self) -> Option<ir::SpectrumRule> {
        match self {
            Self::Mitsuba3 => Some(ir::SpectrumRule::Mitsuba3),
            Self::Mitsuba06 => Some(ir::SpectrumRule::Mitsuba06),
            Self::File => None,
        }
    }
}

pub fn pair(text: &str) -> Result<(String, String), String> {
    text.split_once('=')
        .filter(|(name, _)| !name.is_empty())
        .map(|(n, v)| (n.to_owned(), v.to_owned()))
        .ok_or_else(|| "expected NAME=VALUE".to_owned())
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let wrong = || "expected WIDTHxHEIGHT, such as 640x480".to_owned();
    let (w, h) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
    match (w.parse(), h.parse()) {
        (Ok(w), Ok(h)) if u64::from(w) * u64::from(h) > MAX_PIXELS => {
            Err(format!("a film has {MAX_PIXELS} pixels at most"))
        }
        (Ok(w), Ok(h)) if w > 0 && h > 0 => Ok((w, h)),
        _ => Err(wrong()),
    }
}

fn crop(text: &str) -> Result<ir::Crop, String> {
    let numbers: Result<Vec<u32>, _> = text.split(',').map(|n| n.trim().parse()).collect();
    match numbers.as_deref() {
        Ok(&[x, y, width, height]) if width > 0 && height > 0 => Ok(ir::Crop { x, y, width, height }),
        _ => Err("expected X,Y,WIDTH,HEIGHT in pixels, such as 0,0,64,64".to_owned()),
    }
}

fn filter(name: &str) -> Result<ir::Filter, String> {
    Ok(match name {
        "box" => ir::Filter::Box { radius: 0.5 },
        "tent" => ir::Filter::Tent { radius: 1.0 },
        "gaussian" => ir::Filter::Gaussian { stddev: 0.5 },
        "mitchell" => ir::Filter::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 },
        "catmullrom" => ir::Filter::CatmullRom,
        "lanczos" => ir::Filter::Lanczos { lobes: 3 },
        _ => return Err("expected box, tent, gaussian, mitchell, catmullrom or lanczos".to_owned()),
    })
}

/// A scene ready to render.
pub struct Loaded {
    pub path: PathBuf,
    /// The film as the scene describes it, for what only matters to output.
    pub film: ir::Film,
    pub scene: Scene,
    pub facts: Facts,
    pub view: View,
    pub settings: Settings,
    pub plan: Plan,
    /// Of every file the scene was read from.
    pub hash: String,
    /// Files the scene was read from, links followed.
    pub inputs: BTreeSet<PathBuf>,
    /// What of the command line decides how those files are read: name and value.
    pub choices: Vec<(String, String)>,
}

/// A scene with what it was made from.
pub struct Inspected {
    pub loaded: Loaded,
    pub ir: ir::Scene,
    /// Of the reader and of the compiler.
    pub warnings: Vec<Diagnostic>,
    pub sources: SourceMap,
}

impl Loaded {
    pub fn task(&self) -> Task<'_> {
        Task { scene: &self.scene, facts: &self.facts, view: &self.view, settings: &self.settings }
    }
}

impl SceneArgs {
    /// The scene at `path` with nothing overridden.
    pub fn plain(
        path: &Path,
        define: &[(String, String)],
        allow_path: &[PathBuf],
        allow_unsupported: bool,
        spectral_to_rgb: SpectralRule,
    ) -> Self {
        Self {
            scene: Some(path.to_path_buf()),
            define: define.to_vec(),
            sensor: None,
            integrator: None,
            mode: None,
            set: Vec::new(),
            spp: None,
            passes: None,
            photons: None,
            max_depth: None,
            seed: None,
            size: None,
            crop: None,
            filter: None,
            spectral_to_rgb,
            allow_unsupported,
            allow_path: allow_path.to_vec(),
            longest_side: None,
            upgrade_v3: true,
        }
    }

    /// With the whole film shrunk until no side is longer than `side` pixels.
    #[must_use]
    pub fn small(self, side: u32) -> Self {
        Self { longest_side: Some(side), ..self }
    }

    /// Reads, compiles and plans. Warnings are printed unless `quiet`.
    pub fn load(&self, quiet: bool) -> Result<Loaded, Failure> {
        Ok(self.load_and_keep(quiet, self.allow_unsupported)?.loaded)
    }

    /// As [`Self::load`], with what was read, and without printing. What is not supported is listed.
    pub fn inspect(&self) -> Result<Inspected, Failure> {
        self.load_and_keep(true, true)
    }

    fn load_and_keep(&self, quiet: bool, allow_unsupported: bool) -> Result<Inspected, Failure> {
        let none = "no scene was given: name a Mitsuba .xml or a pbrt-v4 .pbrt file";
        let path = self.scene.clone().ok_or_else(|| Failure::Usage(none.to_owned()))?;
        let disk = Confined::new(&path, &self.allow_path);
        let files = Hashing::new(&disk);
        let options = ReadOptions {
            defines: self.define.clone(),
            allow_unsupported,
            search: self.allow_path.clone(),
            upgrade_v3: self.upgrade_v3,
        };
        let Read { mut scene, mut warnings, sources } =
            read_scene(&files, &path, &options).map_err(|failure| failure.to_string())?;
        let print = |diagnostics: &[Diagnostic]| {
            if !quiet && !diagnostics.is_empty() {
                report::line(sources.render(diagnostics).trim_end());
            }
        };
        print(&warnings);
        self.override_film(&mut scene);
        let compile_options = CompileOptions {
            sensor: self.sensor,
            allow_unsupported,
            spectrum_rule: self.spectral_to_rgb.rule(),
        };
        let built = compile(&scene, &files, compile_options)
            .map_err(|diagnostics| sources.render(&diagnostics).trim_end().to_owned())?;
        print(&built.warnings);
        warnings.extend(built.warnings);
        let mut settings = built.settings;
        self.override_settings(&mut settings).map_err(Failure::Usage)?;
        let plan = Plan::new(&built.facts, &settings, built.view.film.pixel_count());
        let film = scene.sensors[self.sensor.unwrap_or(scene.default_sensor)].film.clone();
        let loaded = Loaded {
            path,
            film,
            scene: built.scene,
            facts: built.facts,
            view: built.view,
            settings,
            plan,
            hash: files.hash(),
            inputs: files.paths(),
            choices: self.choices(),
        };
        Ok(Inspected { loaded, ir: scene, warnings, sources })
    }

    fn choices(&self) -> Vec<(String, String)> {
        let defined: Vec<String> = self.define.iter().map(|(n, v)| format!("{n}={v}")).collect();
        vec![
            ("definitions (-D)".to_owned(), defined.join(" ")),
            ("sensor".to_owned(), self.sensor.map_or_else(|| "default".to_owned(), |n| n.to_string())),
            ("spectral-to-rgb".to_owned(), format!("{:?}", self.spectral_to_rgb)),
            ("allow-unsupported".to_owned(), self.allow_unsupported.to_string()),
        ]
    }

    fn override_film(&self, scene: &mut ir::Scene) {
        let index = self.sensor.unwrap_or(scene.default_sensor);
        let Some(sensor) = scene.sensors.get_mut(index) else { return };
        if let Some((width, height)) = self.size {
            (sensor.film.width, sensor.film.height, sensor.film.crop) = (width, height, None);
        }
        let film = &mut sensor.film;
        let longest = film.width.max(film.height);
        if let Some(side) = self.longest_side.filter(|side| *side < longest) {
            let shrunk = |n: u32| ((u64::from(n) * u64::from(side) / u64::from(longest)) as u32).max(1);
            (film.width, film.height, film.crop) = (shrunk(film.width), shrunk(film.height), None);
        }
        sensor.film.crop = self.crop.or(sensor.film.crop);
        if let Some(filter) = self.filter {
            sensor.film.filter = filter;
        }
    }

    fn override_settings(&self, settings: &mut Settings) -> Result<(), String> {
        let number = |n: Option<u64>| n.map(|n| n.to_string());
        let rows = [
            ("integrator", self.integrator.clone()),
            ("mode", self.mode.clone()),
            ("passes", number(self.spp.or(self.passes).map(u64::from))),
            ("photons", self.photons.clone()),
            ("caustic_photons", self.photons.clone()),
            ("max_depth", self.max_depth.clone()),
            ("seed", number(self.seed)),
        ];
        let rows = rows.iter().filter_map(|(n, v)| v.as_ref().map(|v| (*n, v.as_str())));
        let set = self.set.iter().map(|(n, v)| (n.as_str(), v.as_str()));
        for (name, value) in rows.chain(set) {
            settings.set(name, value).map_err(|e| e.to_string())?;
        }
        Ok(())
    }
}

/// File name of a scene without folder and extension.
pub fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(|| "scene".to_owned(), |s| s.to_string_lossy().into_owned())
}
