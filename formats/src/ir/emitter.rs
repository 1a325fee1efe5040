//! Emitters that are not shapes; area lamps are [`super::AreaEmission`].

use serde::{Deserialize, Serialize};

use super::{Color, Id, Origin, Texture, Transform};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Emitter {
    pub name: Option<String>,
    pub origin: Origin,
    pub kind: EmitterKind,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum EmitterKind {
    /// W·sr⁻¹ per channel at `position`.
    Point { position: [f64; 3], intensity: Color },
    /// Along local +Z: 1 up to `beam_width`, then linear in the angle to 0 at `cutoff_angle` (degrees).
    Spot {
        to_world: Transform,
        intensity: Color,
        cutoff_angle: f64,
        beam_width: f64,
        texture: Option<Id<Texture>>,
    },
    /// `direction` of travel; irradiance on a plane perpendicular to it.
    Directional { direction: [f64; 3], irradiance: Color },
    /// The same radiance from everywhere.
    Constant { radiance: Color },
}
