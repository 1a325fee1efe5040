//! Every setting of a render: one row per name, with its type, default and words. The scene sets them
//! first, the command line after, both by these names.
//!
//! To add one: a row of [`settings!`] here, and its name with its type in
//! `caustica_formats::ir::INTEGRATOR_SETTINGS`, so that scenes may set it too.

mod choices;
mod numbers;
mod value;

use thiserror::Error;

use crate::math::kernel::KernelKind;

pub use choices::{InMedia, Indirect, IntegratorKind, Lookup, Mode, Roulette};
pub use numbers::{Cap, Count, Limit, Neighbours, Pixels, Radius, Samples};
use value::Value;

/// A setting that could not be set.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SettingError {
    /// No row of [`SETTINGS`] has this name.
    #[error("there is no setting `{name}`; {}", known(.nearest))]
    Unknown {
        /// As it was given.
        name: String,
        /// A name that was probably meant.
        nearest: Option<String>,
    },
    /// The value is none that the setting can have.
    #[error("invalid value `{found}` for setting `{name}`: expected {expected}{}", suggestion(.nearest))]
    Invalid {
        /// The setting.
        name: String,
        /// What its values look like, in words.
        expected: String,
        /// The value that was given.
        found: String,
        /// A value that was probably meant.
        nearest: Option<String>,
    },
}

fn known(nearest: &Option<String>) -> String {
    let list = || "`--help-settings` lists all".to_owned();
    nearest.as_ref().map_or_else(list, |n| format!("did you mean `{n}`?"))
}

fn suggestion(nearest: &Option<String>) -> String {
    nearest.as_ref().map_or_else(String::new, |n| format!("; did you mean `{n}`?"))
}

/// The word that differs from `text` in so many letters at most, if there is one.
fn nearest(text: &str, words: impl Iterator<Item = &'static str>, most: usize) -> Option<String> {
    let distances = words.map(|word| (strsim::damerau_levenshtein(text, word), word));
    distances.min().filter(|(distance, _)| *distance <= most).map(|(_, word)| word.to_owned())
}

/// One row of [`SETTINGS`].
#[derive(Debug)]
pub struct Row {
    /// By which scenes and the command line set it.
    pub name: &'static str,
    /// What its values look like, for people.
    pub expected: &'static str,
    /// What it does.
    pub doc: &'static str,
    set: fn(&mut Settings, &str) -> Result<(), String>,
    get: fn(&Settings) -> String,
    /// Values that are words.
    words: fn() -> Vec<&'static str>,
}

macro_rules! settings {
    ($($field:ident: $type:ty = $default:expr, $expected:literal, $doc:literal;)+) => {
        /// How to render. Field order is that of `--help-settings`.
        #[derive(Clone, Debug, PartialEq)]
        pub struct Settings { $(#[doc = $doc] pub $field: $type),+ }

        impl Default for Settings {
            fn default() -> Self {
                Self { $($field: $default),+ }
            }
        }

        /// All settings.
        pub const SETTINGS: &[Row] = &[$(Row {
            name: stringify!($field),
            expected: $expected,
            doc: $doc,
            set: |s, text| { s.$field = <$type as Value>::parse(text)?; Ok(()) },
            get: |s| s.$field.to_string(),
            words: <$type as Value>::words,
        }),+];
    };
}

settings! {
    integrator: IntegratorKind = IntegratorKind::PhotonMap, "photonmap or path", "what computes the picture";
    mode: Mode = Mode::Progressive, "progressive or classic", "a new photon map each pass with shrinking radius, or one map for all passes";
    passes: u32 = 4, "a whole number from 1", "camera samples a pixel; in progressive mode also photon passes";
    camera_samples: Samples = Samples(None), "a count or auto", "photon mapping: camera samples a pixel in each pass; auto is 1 (4 where indirect is not density), but more for pictures below 16384 pixels, and as measured with indirect=auto; with auto, pixels that are noisy in the first passes take up to 8 times as many in later ones";
    max_depth: Limit = Limit::NONE, "a whole number or -1", "path segments from camera to lamp: 1 is emission seen directly, 2 adds direct light";
    rr_depth: u32 = 5, "a whole number from 1", "path segments before Russian roulette may end a camera path";
    hide_emitters: bool = false, "true or false", "lamps and environment are not seen directly";
    nee: bool = true, "true or false", "direct light by next event estimation rather than from first photon hits";
    indirect: Indirect = Indirect::Auto, "auto, density, gather or trace", "indirect light by photon density at the first rough surface, at the second, or by path tracing; auto measures which is best; in scenes with media density, or trace where nothing is specular or glossy";
    gather_rays: Samples = Samples(None), "a count or auto", "directions in which each camera path looks for indirect light with indirect=gather";
    gather_radius: Pixels = Pixels(None), "a number of pixels or auto", "with indirect=gather or trace: how far camera samples on diffuse surfaces share the indirect light that they find, in the first pass; 0: each keeps its own";
    photons: Count = Count::Auto, "a count, stored:COUNT or auto", "light paths a pass for the global map; auto is a quarter of the pixels (at least 65536 with indirect=gather)";
    caustic_photons: Count = Count::Auto, "a count, stored:COUNT or auto", "light paths a pass for the caustic map; auto is the number of pixels";
    volume_photons: Count = Count::Auto, "a count, stored:COUNT or auto", "light paths a pass that leave photons in media; auto is the number of pixels, at least 65536";
    lookup: Lookup = Lookup::Radius, "radius or nearest", "density from all photons within the radius, or from the nearest ones";
    neighbours: Neighbours = Neighbours(100), "a whole number from 2", "photons of a global estimate when lookup=nearest; the farthest only bounds the disc";
    caustic_neighbours: Neighbours = Neighbours(100), "a whole number from 2", "photons of a caustic estimate when lookup=nearest";
    caustic_cap: Cap = Cap::NONE, "a whole number from 2, or -1", "most caustic photons of one estimate: the nearest are kept";
    radius: Radius = Radius::Auto, "a length, a share of the scene's radius such as 0.0125R, or auto", "global search radius (of the first pass when progressive)";
    caustic_radius: Radius = Radius::Auto, "a length, a share of the scene's radius such as 0.0125R, or auto", "caustic search radius (of the first pass when progressive)";
    volume_radius: Radius = Radius::Auto, "a length, a share of the scene's radius such as 0.0125R, or auto", "search radius across camera rays in media (of the first pass when progressive)";
    volume_neighbours: u32 = 50, "a whole number from 1", "photons that volume_radius=auto lets a camera ray find; a tenth as many beams";
    alpha: f32 = 0.7, "a number between 0 and 1", "radius reduction: share of new photons kept, global map";
    caustic_alpha: f32 = 0.6, "a number between 0 and 1", "radius reduction of the caustic map";
    volume_alpha: f32 = 0.7, "a number between 0 and 1", "radius reduction in media";
    beams: InMedia = InMedia::Auto, "auto, points or beams", "light in media from photons at collisions, or from the ways between them; auto measures which is better (with mode=classic: beams where few photons collide)";
    kernel: KernelKind = KernelKind::Epanechnikov, "a kernel's name", "weight of a photon by its distance, global map";
    caustic_kernel: KernelKind = KernelKind::Epanechnikov, "a kernel's name", "the same for the caustic map";
    caustic_map: bool = true, "true or false", "caustic photons in a map of their own";
    glossy: f32 = 0.2, "a number between 0 and 1", "roughness (α) below which a reflection is followed like a mirror's instead of read from photons";
    boundary: bool = true, "true or false", "correct the density near edges for the missing part of the disc";
    roulette: Roulette = Roulette::Renormalise, "absorb, retry or renormalise", "what camera paths do with absorption at specular and mixed surfaces";
    seed: u64 = 0, "a whole number from 0", "random seed";
}

impl Settings {
    /// Sets one by name, to a value in the words of the command line.
    ///
    /// # Errors
    /// [`SettingError::Unknown`] with the nearest name, [`SettingError::Invalid`] with what was expected.
    pub fn set(&mut self, name: &str, value: &str) -> Result<(), SettingError> {
        let Some(row) = SETTINGS.iter().find(|r| r.name == name) else {
            let nearest = nearest(name, SETTINGS.iter().map(|row| row.name), 3);
            return Err(SettingError::Unknown { name: name.to_owned(), nearest });
        };
        let value = value.trim();
        (row.set)(self, value).map_err(|expected| SettingError::Invalid {
            name: name.to_owned(),
            expected,
            found: value.to_owned(),
            nearest: nearest(&value.to_ascii_lowercase(), (row.words)().into_iter(), value.len() / 3),
        })
    }

    /// All names with their present values.
    pub fn values(&self) -> impl Iterator<Item = (&'static str, String)> {
        SETTINGS.iter().map(|r| (r.name, (r.get)(self)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_setting_reads_back_what_it_prints() {
        let settings = Settings::default();
        let mut copy = Settings { passes: 77, seed: 5, ..Settings::default() };
        for (name, value) in settings.values() {
            copy.set(name, &value).unwrap();
        }
        assert_eq!(copy, settings);
    }

    #[test]
    fn mistakes_are_named_with_what_was_expected() {
        let mut s = Settings::default();
        assert_eq!(
            s.set("kernal", "cone").unwrap_err().to_string(),
            "there is no setting `kernal`; did you mean `kernel`?"
        );
        assert_eq!(
            s.set("nosuchname", "1").unwrap_err().to_string(),
            "there is no setting `nosuchname`; `--help-settings` lists all"
        );
        assert_eq!(
            s.set("alpha", "2").unwrap_err().to_string(),
            "invalid value `2` for setting `alpha`: expected a number between 0 and 1"
        );
        assert_eq!(
            s.set("lookup", "nearst").unwrap_err().to_string(),
            "invalid value `nearst` for setting `lookup`: expected one of radius, nearest; did you mean `nearest`?"
        );
        assert!(s.set("nee", "flase").unwrap_err().to_string().ends_with("did you mean `false`?"));
        assert!(s.set("radius", "Auto").unwrap_err().to_string().ends_with("did you mean `auto`?"));
        let one = "a whole number from 2 (the farthest photon bounds the disc and is not counted)";
        for (name, value, expected) in [
            ("neighbours", "1", one.to_owned()),
            ("caustic_neighbours", "0", one.to_owned()),
            ("caustic_cap", "1", format!("{one}, or -1 for no limit")),
        ] {
            let message = format!("invalid value `{value}` for setting `{name}`: expected {expected}");
            assert_eq!(s.set(name, value).unwrap_err().to_string(), message);
        }
        s.set("radius", "0.05R").unwrap();
        assert_eq!(s.radius, Radius::Relative(0.05));
        s.set("photons", "2.5e5").unwrap();
        assert_eq!(s.photons, Count::Paths(250_000));
    }
}
