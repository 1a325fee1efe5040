//! What may be asked for when a scene is opened.

use std::path::PathBuf;

use caustica_formats::ReadOptions;
use caustica_formats::ir::{self, Crop, Filter, SpectrumRule};

use super::{Error, Layers};
use crate::scene::compile::CompileOptions;
use crate::settings::Settings;

/// How to open a scene. The default changes nothing in the scene and converts spectra as Mitsuba 3 does.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Values of scene parameters (`$NAME`): name and value.
    pub defines: Vec<(String, String)>,
    /// Folders that the scene may also read from, and that are searched for its files. Without them it may
    /// read below its own folder only.
    pub allow_paths: Vec<PathBuf>,
    /// Which sensor, counted from 0 in file order; `None` is the scene's default.
    pub sensor: Option<usize>,
    /// Width and height of the full film in pixels. Removes the scene's crop.
    pub size: Option<[u32; 2]>,
    /// Shrinks the whole film until no side is longer than this many pixels. Removes the scene's crop.
    pub longest_side: Option<u32>,
    /// Part of the film to render.
    pub crop: Option<Crop>,
    /// Reconstruction filter.
    pub filter: Option<Filter>,
    /// Whose conversion of spectra to RGB; `None` is that of the file's own version.
    pub spectrum_rule: Option<SpectrumRule>,
    /// Replace what cannot be rendered by something near, with a warning.
    pub lenient: bool,
    /// Names and values from [`SETTINGS`](crate::settings::SETTINGS), applied in order after the scene's own.
    pub settings: Vec<(String, String)>,
    /// What an EXR stores beside the picture; `None`: the parts of the picture, and what the scene asks for.
    pub layers: Option<Layers>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            defines: Vec::new(),
            allow_paths: Vec::new(),
            sensor: None,
            size: None,
            longest_side: None,
            crop: None,
            filter: None,
            spectrum_rule: Some(SpectrumRule::Mitsuba3),
            lenient: false,
            settings: Vec::new(),
            layers: None,
        }
    }
}

impl Options {
    pub(super) fn reading(&self) -> ReadOptions {
        ReadOptions { defines: self.defines.clone(), lenient: self.lenient, search: self.allow_paths.clone() }
    }

    /// `layers` are those that will be stored.
    pub(super) fn compiling(&self, layers: &Layers) -> CompileOptions {
        CompileOptions {
            sensor: self.sensor,
            lenient: self.lenient,
            spectrum_rule: self.spectrum_rule,
            keep_uvs: layers.need_uvs(),
        }
    }

    /// The layers asked for, or what is stored where none are.
    pub(super) fn layers_of(&self, scene: &ir::Scene) -> Layers {
        let film = scene.sensors.get(self.sensor.unwrap_or(scene.default_sensor)).map(|sensor| &sensor.film);
        self.layers.clone().unwrap_or_else(|| Layers::of(scene, film))
    }

    /// Makes sure that the scene has what is asked for.
    pub(super) fn check(&self, scene: &ir::Scene) -> Result<(), Error> {
        let count = scene.sensors.len();
        if let Some(asked) = self.sensor.filter(|asked| count > 0 && *asked >= count) {
            return Err(Error::NoSensor { asked, count });
        }
        let sensor = scene.sensors.get(self.sensor.unwrap_or(scene.default_sensor));
        if let (Some(crop), Some(sensor)) = (self.crop, sensor) {
            let [width, height] = self.size.unwrap_or([sensor.film.width, sensor.film.height]);
            let fits = |from: u32, n: u32, full: u32| from.checked_add(n).is_some_and(|end| end <= full);
            if !(fits(crop.x, crop.width, width) && fits(crop.y, crop.height, height)) {
                return Err(Error::OutsideFilm { crop, film: [width, height] });
            }
        }
        Ok(())
    }

    /// Changes the film of the chosen sensor.
    pub(super) fn override_film(&self, scene: &mut ir::Scene) {
        let index = self.sensor.unwrap_or(scene.default_sensor);
        let Some(sensor) = scene.sensors.get_mut(index) else { return };
        let film = &mut sensor.film;
        if let Some([width, height]) = self.size {
            (film.width, film.height, film.crop) = (width, height, None);
        }
        let longest = film.width.max(film.height);
        if let Some(side) = self.longest_side.filter(|side| *side < longest) {
            let shrunk = |n: u32| ((u64::from(n) * u64::from(side) / u64::from(longest)) as u32).max(1);
            (film.width, film.height, film.crop) = (shrunk(film.width), shrunk(film.height), None);
        }
        film.crop = self.crop.or(film.crop);
        film.filter = self.filter.unwrap_or(film.filter);
    }

    pub(super) fn override_settings(&self, settings: &mut Settings) -> Result<(), Error> {
        for (name, value) in &self.settings {
            settings.set(name, value)?;
        }
        Ok(())
    }

    /// What of this decides how the scene's files are read, by name: the same files read otherwise are
    /// another scene.
    pub(super) fn choices(&self) -> Vec<(String, String)> {
        let defined: Vec<String> = self.defines.iter().map(|(n, v)| format!("{n}={v}")).collect();
        let rule = match self.spectrum_rule {
            Some(rule) => format!("{rule:?}"),
            None => "File".to_owned(),
        };
        vec![
            ("definitions (-D)".to_owned(), defined.join(" ")),
            ("sensor".to_owned(), self.sensor.map_or_else(|| "default".to_owned(), |n| n.to_string())),
            ("spectral-to-rgb".to_owned(), rule),
            ("lenient".to_owned(), self.lenient.to_string()),
        ]
    }
}
