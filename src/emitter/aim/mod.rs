//! Where light paths are sent: from which lamp, from which of its places, and along which directions.

mod starts;
mod targets;

pub use starts::{PathFound, Start, Starts};
pub use targets::{EmissionBounds, Entry, EntrySegment, Targets};

use std::fmt;

use serde::Serialize;

use super::SceneSphere;
use crate::sampling::Discrete;

/// How light paths of a map start. Without any part of it, lamps are chosen by their power and emit as they do.
#[derive(Clone, Debug)]
pub struct Aim {
    /// Where light from infinity enters.
    pub entrances: Option<Targets>,
    /// Where lamps in the scene send their light.
    pub headings: Option<Targets>,
    /// How the numbers are chosen that lamps make emission of.
    pub starts: Option<Starts>,
    /// Share of the paths that leave photons where the map is read.
    pub landing: f32,
    /// Time that a path takes, over that of a path without headings and learned starts.
    pub cost: f32,
}

/// What an aim does, for people.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Aimed {
    /// Share of the light paths that leave photons where the map is read.
    pub landing: f32,
    /// Lamps by number that get many more paths than by their power, and how many times as many; the first few.
    pub lamps: Vec<(usize, f32)>,
    /// How many lamps get more.
    pub more: usize,
    /// How many lamps there are.
    pub of: usize,
}

/// Lamps that get this many times as many paths as by their power are reported, so many of them.
const FAVOURED: f32 = 1.5;
const REPORTED: usize = 4;

impl fmt::Display for Aimed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.1} % of light paths leave photons where they are seen", 100.0 * self.landing)?;
        if self.of > 1 && self.more > 0 {
            write!(f, "; {} of {} lamps get more paths:", self.more, self.of)?;
            let lamps = self.lamps.iter().map(|(lamp, times)| format!(" lamp {lamp} {times:.1} times"));
            write!(f, "{}", lamps.collect::<Vec<_>>().join(","))?;
        }
        Ok(())
    }
}

impl Aim {
    /// What it does to lamps that are otherwise chosen by `power`.
    pub fn aimed(&self, power: &Discrete) -> Aimed {
        let mut lamps = self.starts.as_ref().map_or_else(Vec::new, |starts| starts.times(power));
        lamps.retain(|&(_, times)| times >= FAVOURED);
        lamps.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let more = lamps.len();
        lamps.truncate(REPORTED);
        Aimed { landing: self.landing, lamps, more, of: power.len() }
    }

    /// The scene as emitters need to know it.
    pub fn bounds(&self, sphere: SceneSphere) -> EmissionBounds<'_> {
        EmissionBounds { sphere, entrances: self.entrances.as_ref(), headings: self.headings.as_ref() }
    }
}
