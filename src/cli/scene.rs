//! Arguments that decide what scene is rendered, and how.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use caustica_formats::diagnostic::nearest;
use caustica_formats::ir::{Crop, Filter, SpectrumRule};
use clap::parser::ValueSource;
use clap::{ArgAction, ArgMatches, Args, Command, ValueEnum};

use super::failure::Failure;
use super::report;
use super::words::{any_of, offering};
use crate::scene::compile::MAX_PIXELS;
use crate::session::{Error, Inspection, Layers, Options, Session};
use crate::settings::{IntegratorKind, Mode};

/// The option for folders, whose names are relative to the working folder.
const ALLOW_PATH: &str = "allow_path";

/// Scene file, parameters, camera, film and settings, for every subcommand that opens a scene.
#[derive(Debug, Args)]
pub struct SceneArgs {
    /// Mitsuba scene (.xml, versions 0.4 to 3.x) or pbrt scene (.pbrt, .pbrt.gz, versions 3 and 4)
    scene: Option<PathBuf>,
    /// Value of a scene parameter `$NAME`
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = pair)]
    define: Vec<(String, String)>,
    /// Which sensor, counted from 0 in file order
    #[arg(long, value_name = "N", value_parser = from_zero::<usize>, allow_negative_numbers = true)]
    sensor: Option<usize>,
    /// photonmap (the default, also for scenes that ask for another integrator) or path
    #[arg(long, value_name = "NAME", value_parser = any_of(IntegratorKind::NAMES.iter().copied()),
        hide_possible_values = true)]
    integrator: Option<String>,
    /// progressive (a new photon map each pass) or classic (one map)
    #[arg(long, value_name = "NAME", value_parser = any_of(Mode::NAMES.iter().copied()), hide_possible_values = true)]
    mode: Option<String>,
    /// Any setting that `caustica render --help-settings` lists
    #[arg(long, value_name = "NAME=VALUE", value_parser = pair)]
    set: Vec<(String, String)>,
    /// Camera samples a pixel; in progressive mode also photon passes
    #[arg(long, value_name = "N", value_parser = whole, allow_negative_numbers = true)]
    spp: Option<u32>,
    /// The same as --spp
    #[arg(long, value_name = "N", value_parser = whole, conflicts_with = "spp", allow_negative_numbers = true)]
    passes: Option<u32>,
    /// Light paths a pass, for each photon map
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    photons: Option<String>,
    /// Path segments from camera to lamp, at most; -1 is no limit
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    max_depth: Option<String>,
    /// Random seed
    #[arg(long, value_name = "N", value_parser = from_zero::<u64>, allow_negative_numbers = true)]
    seed: Option<u64>,
    /// Size of the full film
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,
    /// Render this part of the film only, in pixels
    #[arg(long, value_name = "X,Y,W,H", value_parser = crop)]
    crop: Option<Crop>,
    #[arg(long, value_name = "NAME", hide_possible_values = true,
        value_parser = offering(filter, Filter::NAMED.iter().map(|row| row.name)),
        help = format!("Reconstruction filter: {}", filter_names()))]
    filter: Option<Filter>,
    /// How spectra become RGB: as mitsuba3 does for every file, as mitsuba06 did, or as the renderer of
    /// the file's own version does
    #[arg(long, value_name = "RULE", value_enum, default_value = "mitsuba3")]
    spectral_to_rgb: SpectralRule,
    /// Use the nearest thing for what is unknown or not supported, with a warning
    #[arg(long, alias = "allow-unsupported")]
    lenient: bool,
    /// Also read and search this folder; a scene may read below its own folder only
    #[arg(long, value_name = "DIR")]
    allow_path: Vec<PathBuf>,
}

/// Whose rule turns spectra into RGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SpectralRule {
    /// Mitsuba 3's.
    Mitsuba3,
    /// Mitsuba 0.6's.
    Mitsuba06,
    /// That of the renderer the file was written for.
    File,
}

impl SpectralRule {
    /// `None`: that of the file.
    pub fn rule(self) -> Option<SpectrumRule> {
        match self {
            Self::Mitsuba3 => Some(SpectrumRule::Mitsuba3),
            Self::Mitsuba06 => Some(SpectrumRule::Mitsuba06),
            Self::File => None,
        }
    }
}

/// NAME=VALUE.
///
/// # Errors
/// What was expected, in words.
pub fn pair(text: &str) -> Result<(String, String), String> {
    text.split_once('=')
        .filter(|(name, _)| !name.is_empty())
        .map(|(n, v)| (n.to_owned(), v.to_owned()))
        .ok_or_else(|| "expected NAME=VALUE, such as alpha=0.7".to_owned())
}

/// A whole number from 1; 1e3 is one.
///
/// # Errors
/// What was expected, in words.
pub fn whole(text: &str) -> Result<u32, String> {
    let value = text.parse::<f64>().map_err(|_| "expected a whole number from 1".to_owned())?;
    if value > f64::from(u32::MAX) {
        return Err(format!("too large: at most {}", u32::MAX));
    }
    let n = value as u32;
    if n >= 1 && f64::from(n) == value { Ok(n) } else { Err("expected a whole number from 1".to_owned()) }
}

fn from_zero<T: FromStr>(text: &str) -> Result<T, String> {
    text.parse().map_err(|_| "expected a whole number from 0".to_owned())
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let wrong = || "expected WIDTHxHEIGHT, such as 640x480".to_owned();
    let (w, h) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
    match (w.parse::<u32>(), h.parse::<u32>()) {
        (Ok(w), Ok(h)) if u64::from(w) * u64::from(h) > MAX_PIXELS => {
            Err(format!("a film has {MAX_PIXELS} pixels at most"))
        }
        (Ok(w), Ok(h)) if w > 0 && h > 0 => Ok([w, h]),
        _ => Err(wrong()),
    }
}

fn crop(text: &str) -> Result<Crop, String> {
    let numbers: Result<Vec<u32>, _> = text.split(',').map(|n| n.trim().parse()).collect();
    match numbers.as_deref() {
        Ok(&[x, y, width, height]) if width > 0 && height > 0 => Ok(Crop { x, y, width, height }),
        _ => Err("expected X,Y,WIDTH,HEIGHT in pixels, such as 0,0,64,64".to_owned()),
    }
}

fn filter(name: &str) -> Result<Filter, String> {
    Filter::named(name).ok_or_else(|| {
        let near = nearest(name, Filter::NAMED.iter().map(|row| row.name));
        let hint = near.map_or(String::new(), |near| format!("; did you mean `{near}`?"));
        format!("expected {}{hint}", filter_names())
    })
}

/// "box, tent or lanczos".
fn filter_names() -> String {
    let names: Vec<&str> = Filter::NAMED.iter().map(|row| row.name).collect();
    match names.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} or {last}", others.join(", ")),
        _ => names.concat(),
    }
}

impl SceneArgs {
    /// The passes asked for, if any.
    pub fn passes(&self) -> Option<u32> {
        self.spp.or(self.passes)
    }

    /// The options among `matches` that were given, but for the scene itself, as another program can be given them in
    /// any folder.
    pub fn given(matches: &ArgMatches) -> Vec<String> {
        let mut options = Vec::new();
        for argument in Self::augment_args(Command::new("scene")).get_arguments() {
            let id = argument.get_id().as_str();
            let name = match (argument.get_long(), argument.get_short()) {
                (Some(long), _) => format!("--{long}="),
                (None, Some(short)) => format!("-{short}"),
                (None, None) => continue,
            };
            if matches.value_source(id) != Some(ValueSource::CommandLine) {
                continue;
            }
            if matches!(argument.get_action(), ArgAction::SetTrue) {
                options.push(name.trim_end_matches('=').to_owned());
                continue;
            }
            for value in matches.get_raw(id).into_iter().flatten() {
                let folder = (id == ALLOW_PATH).then(|| std::path::absolute(value).ok()).flatten();
                let value = folder.as_ref().map_or(value, |folder| folder.as_os_str());
                options.push(format!("{name}{}", value.to_string_lossy()));
            }
        }
        options
    }

    /// Reads and compiles the scene, whose picture gets these `layers` where they were asked for. Warnings are printed
    /// unless `quiet`.
    ///
    /// # Errors
    /// When no scene is named, or it cannot be opened.
    pub fn open(&self, quiet: bool, layers: Option<Layers>) -> Result<Session, Failure> {
        self.said_once()?;
        let options = Options { layers, ..self.options() };
        let session = Session::open(self.path()?, &options).map_err(|error| match error {
            Error::Scene(failure) if quiet => Error::Scene(Box::new(failure.errors_only())),
            error => error,
        })?;
        if !quiet && !session.warnings().is_empty() {
            report::line(session.warnings());
        }
        Ok(session)
    }

    /// As [`Self::open`], without printing; a scene that cannot be rendered is looked at all the same.
    ///
    /// # Errors
    /// When no scene is named, or what was asked for is wrong.
    pub fn inspect(&self) -> Result<Inspection, Failure> {
        self.said_once()?;
        Ok(Inspection::of(self.path()?, &self.options())?)
    }

    fn path(&self) -> Result<&Path, Failure> {
        let none = "no scene was given: name a Mitsuba .xml or a pbrt .pbrt file";
        self.scene.as_deref().ok_or_else(|| Failure::Usage(none.to_owned()))
    }

    /// Settings that have options of their own.
    fn settings(&self) -> Vec<(&'static str, String)> {
        let passes = self.passes().map(|n| n.to_string());
        let seed = self.seed.map(|n| n.to_string());
        let rows = [
            ("integrator", &self.integrator),
            ("mode", &self.mode),
            ("passes", &passes),
            ("photons", &self.photons),
            ("caustic_photons", &self.photons),
            ("max_depth", &self.max_depth),
            ("seed", &seed),
        ];
        rows.into_iter().filter_map(|(name, value)| Some((name, value.clone()?))).collect()
    }

    /// Makes sure that no option and no `--set` say different things of one setting. `--photons` is for both maps, of which
    /// the caustic one may be set apart.
    fn said_once(&self) -> Result<(), Failure> {
        let twice = self.settings().into_iter().find_map(|(name, value)| {
            let other = self.set.iter().find(|(set, other)| set == name && *other != value)?;
            (name != "caustic_photons").then(|| (name, value, other.1.clone()))
        });
        twice.map_or(Ok(()), |(name, value, other)| {
            let option = if name == "passes" && self.spp.is_some() {
                "spp".to_owned()
            } else {
                name.replace('_', "-")
            };
            Err(Failure::Usage(format!(
                "`--{option} {value}` and `--set {name}={other}` are of one setting; leave out one of them"
            )))
        })
    }

    fn options(&self) -> Options {
        let rows = self.settings().into_iter().map(|(name, value)| (name.to_owned(), value));
        Options {
            defines: self.define.clone(),
            allow_paths: self.allow_path.clone(),
            sensor: self.sensor,
            size: self.size,
            longest_side: None,
            crop: self.crop,
            filter: self.filter,
            spectrum_rule: self.spectral_to_rgb.rule(),
            lenient: self.lenient,
            settings: rows.chain(self.set.iter().cloned()).collect(),
            layers: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_named_filter_is_accepted_and_listed() {
        for row in Filter::NAMED {
            assert_eq!(filter(row.name), Ok(row.default));
        }
        assert_eq!(
            filter("sinc"),
            Err("expected box, tent, gaussian, mitchell, catmullrom or lanczos".to_owned())
        );
        assert!(filter("gausian").unwrap_err().ends_with("; did you mean `gaussian`?"));
    }
}
