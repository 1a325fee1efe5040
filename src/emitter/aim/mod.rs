//! Where light paths are sent: from which lamp, from which of its places, and along which directions.

mod starts;
mod targets;

pub use starts::{PathFound, Start, Starts};
pub use targets::{EmissionBounds, Entry, EntrySegment, Targets};

use super::SceneSphere;

/// How light paths of a map start. Without any part of it, lamps are chosen by their power and emit as they do.
#[derive(Clone, Debug)]
pub struct Aim {
    /// Where light from infinity enters.
    pub entrances: Option<Targets>,
    /// Where lamps in the scene send their light.
    pub headings: Option<Targets>,
    /// How the numbers are chosen that lamps make emission of.
    pub starts: Option<Starts>,
    /// Time that a path takes, over that of a path without headings and learned starts.
    pub cost: f32,
}

impl Aim {
    /// The scene as emitters need to know it.
    pub fn bounds(&self, sphere: SceneSphere) -> EmissionBounds<'_> {
        EmissionBounds { sphere, entrances: self.entrances.as_ref(), headings: self.headings.as_ref() }
    }
}
