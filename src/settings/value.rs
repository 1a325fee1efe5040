//! How the value of a setting is read from its words.

use super::choices::{Indirect, IntegratorKind, Lookup, Mode, Roulette};
use super::numbers::{Cap, Count, Limit, Neighbours, Radius, Samples};
use crate::math::kernel::KernelKind;

/// Parses with what was wanted as the error.
pub(super) trait Value: Sized {
    fn parse(s: &str) -> Result<Self, String>;
}

macro_rules! value_from_str {
    ($($t:ty),+) => { $(impl Value for $t {
        fn parse(s: &str) -> Result<Self, String> { s.parse() }
    })+ };
}
value_from_str!(
    Indirect,
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
