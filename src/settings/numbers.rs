//! Settings that are a number, or a word such as `auto` in its place.

use std::fmt;
use std::str::FromStr;

use serde::Serialize;

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
        let expected = || "a whole number from 1, `stored:NUMBER` or `auto`".to_owned();
        let number = |s: &str| match s.parse::<u64>() {
            Ok(0) => {
                Err("a whole number from 1 (integrator `path` needs no photons), `stored:NUMBER` or `auto`"
                    .to_owned())
            }
            Ok(n) => Ok(n),
            // 1e6 and 2.5e5 are how people write photon counts.
            Err(_) => match s.parse::<f64>() {
                Ok(x) if (1.0..1e18).contains(&x) && x.fract() == 0.0 => Ok(x as u64),
                _ => Err(expected()),
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
        let expected = "a positive length, a share of the scene's radius such as `0.0125R`, or `auto`";
        let positive = |s: &str| match s.parse::<f32>() {
            Ok(r) if r > 0.0 && r.is_finite() => Ok(r),
            _ => Err(expected.to_owned()),
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

    fn expected() -> String {
        "a whole number from 0, or -1 for no limit".to_owned()
    }
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
            Ok(n) => u32::try_from(n).map(Self).map_err(|_| Self::expected()),
            Err(_) => Err(Self::expected()),
        }
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
                .map_err(|expected| format!("{expected}, or -1 for no limit")),
        }
    }
}

/// A number within limits, or `auto`, which is `None`.
macro_rules! or_auto {
    ($(#[$about:meta])* $name:ident($number:ty), $limits:expr, $expected:literal) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name(pub Option<$number>);

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                match self.0 {
                    Some(n) => n.fmt(f),
                    None => f.write_str("auto"),
                }
            }
        }

        impl FromStr for $name {
            type Err = String;
            fn from_str(s: &str) -> Result<Self, String> {
                match s.parse::<$number>() {
                    Ok(n) if $limits.contains(&n) => Ok(Self(Some(n))),
                    Err(_) if s == "auto" => Ok(Self(None)),
                    _ => Err(concat!($expected, ", or `auto`").to_owned()),
                }
            }
        }
    };
}

or_auto! {
    /// Camera samples a pixel in one pass; `None` follows the size of the picture.
    Samples(u32), (1..=4096), "a whole number from 1 to 4096"
}

or_auto! {
    /// A length in pixels; `None` is found out.
    Pixels(f32), (0.0..=64.0), "a number from 0 to 64"
}
