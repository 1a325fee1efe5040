//! How the value of a setting is read from its words.

use super::choices::{InMedia, Indirect, IntegratorKind, Lookup, Mode, Roulette};
use super::numbers::{Cap, Count, Limit, Neighbours, Pixels, Radius, Samples};
use crate::math::kernel::KernelKind;

/// Parses with what was expected as the error.
pub(super) trait Value: Sized {
    fn parse(s: &str) -> Result<Self, String>;
    /// Values that are words.
    fn words() -> Vec<&'static str> {
        Vec::new()
    }
}

macro_rules! value_from_str {
    ($($t:ty: $words:expr),+ $(,)?) => { $(impl Value for $t {
        fn parse(s: &str) -> Result<Self, String> { s.parse() }
        fn words() -> Vec<&'static str> { $words }
    })+ };
}
value_from_str!(
    InMedia: Self::NAMES.to_vec(),
    Indirect: Self::NAMES.to_vec(),
    IntegratorKind: Self::NAMES.to_vec(),
    Mode: Self::NAMES.to_vec(),
    Lookup: Self::NAMES.to_vec(),
    Roulette: Self::NAMES.to_vec(),
    Count: vec!["auto"],
    Radius: vec!["auto"],
    Limit: Vec::new(),
    Neighbours: Vec::new(),
    Cap: Vec::new(),
    Samples: vec!["auto"],
    Pixels: vec!["auto"],
    KernelKind: Self::ALL.iter().map(|kernel| kernel.name()).collect(),
);

impl Value for bool {
    fn parse(s: &str) -> Result<Self, String> {
        match s {
            "true" | "on" | "yes" => Ok(true),
            "false" | "off" | "no" => Ok(false),
            _ => Err("true or false".to_owned()),
        }
    }
    fn words() -> Vec<&'static str> {
        vec!["true", "false"]
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
