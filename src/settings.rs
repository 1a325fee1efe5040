//! Every setting of a render: one row per name, with its type, default and words. The scene sets them
//! first, the command line after, both by these names.
//!
//! To add one: a row of [`settings!`] here, and its name with its type in
//! `caustica_formats::ir::INTEGRATOR_SETTINGS`, so that scenes may set it too.

use std::fmt;
use std::str::FromStr;

use serde::Serialize;
use thiserror::Error;

use crate::math::kernel::KernelKind;

/// A setting that could not be set.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SettingError {
    /// No row of [`SETTINGS`] has this name.
    #[error("there is no setting `{name}`{}", suggestion(.nearest))]
    Unknown {
        /// As it was given.
        name: String,
        /// A name that was probably meant.
        nearest: Option<String>,
    },
    /// The value is none that the setting can have.
    #[error("setting `{name}` wants {wants}, got `{got}`")]
    Invalid {
        /// The setting.
        name: String,
        /// What its values look like, in words.
        wants: String,
        /// The value that was given.
        got: String,
    },
}

fn suggestion(nearest: &Option<String>) -> String {
    nearest.as_ref().map_or_else(String::new, |n| format!("; did you mean `{n}`?"))
}

macro_rules! choice {
    ($(#[$doc:meta])* $name:ident { $($variant:ident = $text:literal),+ $(,)? }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name {
            $(#[doc = concat!("Written `", $text, "`.")] $variant),+
        }

        impl $name {
            /// The words that stand for the choices, in their order.
            pub const NAMES: &'static [&'static str] = &[$($text),+];
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(match self { $(Self::$variant => $text),+ })
            }
        }

        impl FromStr for $name {
            type Err = String;
            fn from_str(s: &str) -> Result<Self, String> {
                match s { $($text => Ok(Self::$variant),)+ _ => Err(format!("one of {}", Self::NAMES.join(", "))) }
            }
        }
    };
}

choice! {
    /// What computes the picture.
    IntegratorKind { PhotonMap = "photonmap", Path = "path" }
}
choice! {
    /// One photon map for all camera samples, or a new one with a smaller radius every pass.
    Mode { Progressive = "progressive", Classic = "classic" }
}
choice! {
    /// Density from all photons within the radius, or from the k nearest within it.
    Lookup { Radius = "radius", Nearest = "nearest" }
}
choice! {
    /// What a camera path does with the share of light that a surface absorbs.
    Roulette { Absorb = "absorb", Retry = "retry", Renormalise = "renormalise" }
}

/// A count of light paths, or of photons to store; `auto` follows the film.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Count {
    /// Follows the size of the picture.
    Auto,
    /// Light paths started per pass.
    Paths(u64),
    /// As many paths as are expected to store this many photons (Mitsuba 0.6's `globalPhotons`).
    Stored(u64),
}

impl fmt::Display for Count {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Paths(n) => write!(f, "{n}"),
            Self::Stored(n) => write!(f, "stored:{n}"),
        }
    }
}

impl FromStr for Count {
    type Err = String;
    fn from_str(s: &str) -> Result<Self, String> {
        let wants = || "a whole number from 1, `stored:NUMBER` or `auto`".to_owned();
        let number = |s: &str| match s.parse::<u64>() {
            Ok(0) => {
                Err("a whole number from 1 (integrator `path` needs no photons), `stored:NUMBER` or `auto`"
                    .to_owned())
            }
            Ok(n) => Ok(n),
            // 1e6 and 2.5e5 are how people write photon counts.
            Err(_) => match s.parse::<f64>() {
                Ok(x) if (1.0..1e18).contains(&x) && x.fract() == 0.0 => Ok(x as u64),
                _ => Err(wants()),
            },
        };
        match s {
            "auto" => Ok(Self::Auto),
            _ => match s.strip_prefix("stored:") {
                Some(n) => number(n).map(Self::Stored),
                None => number(s).map(Self::Paths),
            },
        }
    }
}

/// A search radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Radius {
    /// From the photon density of the first pass.
    Auto,
    /// In scene units.
    Absolute(f32),
    /// Times the radius of the scene's bounding sphere (Mitsuba 0.6's lookup radii); written `0.05R`.
    Relative(f32),
}

impl fmt::Display for Radius {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Absolute(r) => write!(f, "{r}"),
            Self::Relative(r) => write!(f, "{r}R"),
        }
    }
}

impl FromStr for Radius {
    type Err = String;
    fn from_str(s: &str) -> Result<Self, String> {
        let positive = |s: &str| match s.parse::<f32>() {
            Ok(r) if r > 0.0 && r.is_finite() => Ok(r),
            _ => Err("a positive length, `NUMBERR` (times the scene's radius) or `auto`".to_owned()),
        };
        match s {
            "auto" => Ok(Self::Auto),
            _ => match s.strip_suffix('R') {
                Some(n) => positive(n).map(Self::Relative),
                None => positive(s).map(Self::Absolute),
            },
        }
    }
}

/// A depth or count where −1 means no limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Limit(pub u32);

impl Limit {
    /// Without limit.
    pub const NONE: Self = Self(u32::MAX);
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if *self == Self::NONE { f.write_str("-1") } else { write!(f, "{}", self.0) }
    }
}

impl FromStr for Limit {
    type Err = String;
    fn from_str(s: &str) -> Result<Self, String> {
        match s.parse::<i64>() {
            Ok(-1) => Ok(Self::NONE),
            Ok(n) => u32::try_from(n).map(Self).map_err(|_| Self::wants()),
            Err(_) => Err(Self::wants()),
        }
    }
}

impl Limit {
    fn wants() -> String {
        "a whole number from 0, or -1 for no limit".to_owned()
    }
}

/// How many nearest photons an estimate is made of, from 2 on. The k-th bounds the disc and is not counted:
/// k − 1 photons over its area are the unbiased density, and of one photon alone nothing would be left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Neighbours(pub u32);

impl fmt::Display for Neighbours {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl FromStr for Neighbours {
    type Err = String;
    fn from_str(s: &str) -> Result<Self, String> {
        match s.parse() {
            Ok(n @ 2..) => Ok(Self(n)),
            _ => {
                Err("a whole number from 2 (the farthest photon bounds the disc and is not counted)"
                    .to_owned())
            }
        }
    }
}

/// Most photons of an estimate: as [`Neighbours`], or no limit, written -1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cap(pub u32);

impl Cap {
    /// Without limit.
    pub const NONE: Self = Self(u32::MAX);
}

impl fmt::Display for Cap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if *self == Self::NONE { f.write_str("-1") } else { self.0.fmt(f) }
    }
}

impl FromStr for Cap {
    type Err = String;
    fn from_str(s: &str) -> Result<Self, String> {
        match s {
            "-1" => Ok(Self::NONE),
            _ => s
                .parse::<Neighbours>()
                .map(|n| Self(n.0))
                .map_err(|wants| format!("{wants}, or -1 for no limit")),
        }
    }
}

/// Camera samples a pixel in one pass; `None` follows the size of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Samples(pub Option<u32>);

impl fmt::Display for Samples {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Some(n) => write!(f, "{n}"),
            None => f.write_str("auto"),
        }
    }
}

impl FromStr for Samples {
    type Err = String;
    fn from_str(s: &str) -> Result<Self, String> {
        match s {
            "auto" => Ok(Self(None)),
            _ => match s.parse() {
                Ok(n @ 1..=4096) => Ok(Self(Some(n))),
                _ => Err("a whole number from 1 to 4096, or `auto`".to_owned()),
            },
        }
    }
}

/// Parses with what was wanted as the error.
trait Value: Sized {
    fn parse(s: &str) -> Result<Self, String>;
}

macro_rules! value_from_str {
    ($($t:ty),+) => { $(impl Value for $t {
        fn parse(s: &str) -> Result<Self, String> { s.parse() }
    })+ };
}
value_from_str!(
    IntegratorKind,
    Mode,
    Lookup,
    Roulette,
    Count,
    Radius,
    Limit,
    Neighbours,
    Cap,
    Samples,
    KernelKind
);

impl Value for bool {
    fn parse(s: &str) -> Result<Self, String> {
        match s {
            "true" | "on" | "yes" => Ok(true),
            "false" | "off" | "no" => Ok(false),
            _ => Err("true or false".to_owned()),
        }
    }
}

impl Value for u32 {
    fn parse(s: &str) -> Result<Self, String> {
        s.parse().ok().filter(|&n| n > 0).ok_or_else(|| "a whole number from 1".to_owned())
    }
}

impl Value for u64 {
    fn parse(s: &str) -> Result<Self, String> {
        s.parse().map_err(|_| "a whole number from 0".to_owned())
    }
}

impl Value for f32 {
    fn parse(s: &str) -> Result<Self, String> {
        s.parse()
            .ok()
            .filter(|a: &f32| *a > 0.0 && *a < 1.0)
            .ok_or_else(|| "a number between 0 and 1".to_owned())
    }
}

/// One row of [`SETTINGS`].
#[derive(Debug)]
pub struct Row {
    /// By which scenes and the command line set it.
    pub name: &'static str,
    /// What its values look like, for people.
    pub wants: &'static str,
    /// What it does.
    pub doc: &'static str,
    set: fn(&mut Settings, &str) -> Result<(), String>,
    get: fn(&Settings) -> String,
}

macro_rules! settings {
    ($($field:ident: $type:ty = $default:expr, $wants:literal, $doc:literal;)+) => {
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
            wants: $wants,
            doc: $doc,
            set: |s, text| { s.$field = <$type as Value>::parse(text)?; Ok(()) },
            get: |s| s.$field.to_string(),
        }),+];
    };
}

settings! {
    integrator: IntegratorKind = IntegratorKind::PhotonMap, "photonmap or path", "what computes the picture";
    mode: Mode = Mode::Progressive, "progressive or classic", "a new photon map each pass with shrinking radius, or one map for all passes";
    passes: u32 = 4, "a whole number from 1", "camera samples a pixel; in progressive mode also photon passes";
    camera_samples: Samples = Samples(None), "a count or auto", "photon mapping: camera samples a pixel in each pass; auto is 1, but more for pictures below 16384 pixels";
    max_depth: Limit = Limit::NONE, "a whole number or -1", "path segments from camera to lamp: 1 is emission seen directly, 2 adds direct light";
    rr_depth: u32 = 5, "a whole number from 1", "path segments before Russian roulette may end a camera path";
    hide_emitters: bool = false, "true or false", "lamps and environment are not seen directly";
    nee: bool = true, "true or false", "direct light by next event estimation rather than from first photon hits";
    photons: Count = Count::Auto, "a count, stored:COUNT or auto", "light paths a pass for the global map; auto is a quarter of the pixels";
    caustic_photons: Count = Count::Auto, "a count, stored:COUNT or auto", "light paths a pass for the caustic map; auto is the number of pixels";
    lookup: Lookup = Lookup::Radius, "radius or nearest", "density from all photons within the radius, or from the nearest ones";
    neighbours: Neighbours = Neighbours(100), "a whole number from 2", "photons of a global estimate when lookup=nearest; the farthest only bounds the disc";
    caustic_neighbours: Neighbours = Neighbours(100), "a whole number from 2", "photons of a caustic estimate when lookup=nearest";
    caustic_cap: Cap = Cap::NONE, "a whole number from 2, or -1", "most caustic photons of one estimate: the nearest are kept";
    radius: Radius = Radius::Auto, "a length, NUMBERR or auto", "global search radius (of the first pass when progressive)";
    caustic_radius: Radius = Radius::Auto, "a length, NUMBERR or auto", "caustic search radius (of the first pass when progressive)";
    alpha: f32 = 0.7, "a number between 0 and 1", "radius reduction: share of new photons kept, global map";
    caustic_alpha: f32 = 0.7, "a number between 0 and 1", "radius reduction of the caustic map";
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
    /// [`SettingError::Unknown`] with the nearest name, [`SettingError::Invalid`] with what was wanted.
    pub fn set(&mut self, name: &str, value: &str) -> Result<(), SettingError> {
        let Some(row) = SETTINGS.iter().find(|r| r.name == name) else {
            let nearest = SETTINGS
                .iter()
                .map(|r| (strsim::damerau_levenshtein(name, r.name), r.name))
                .min()
                .filter(|(d, _)| *d <= 3)
                .map(|(_, n)| n.to_owned());
            return Err(SettingError::Unknown { name: name.to_owned(), nearest });
        };
        (row.set)(self, value.trim()).map_err(|wants| SettingError::Invalid {
            name: name.to_owned(),
            wants,
            got: value.to_owned(),
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
    fn mistakes_are_named_with_what_was_wanted() {
        let mut s = Settings::default();
        assert_eq!(
            s.set("kernal", "cone").unwrap_err().to_string(),
            "there is no setting `kernal`; did you mean `kernel`?"
        );
        assert_eq!(
            s.set("alpha", "2").unwrap_err().to_string(),
            "setting `alpha` wants a number between 0 and 1, got `2`"
        );
        let one = "a whole number from 2 (the farthest photon bounds the disc and is not counted)";
        for (name, value, wants) in [
            ("neighbours", "1", one.to_owned()),
            ("caustic_neighbours", "0", one.to_owned()),
            ("caustic_cap", "1", format!("{one}, or -1 for no limit")),
        ] {
            let message = format!("setting `{name}` wants {wants}, got `{value}`");
            assert_eq!(s.set(name, value).unwrap_err().to_string(), message);
        }
        s.set("radius", "0.05R").unwrap();
        assert_eq!(s.radius, Radius::Relative(0.05));
        s.set("photons", "2.5e5").unwrap();
        assert_eq!(s.photons, Count::Paths(250_000));
    }
}
