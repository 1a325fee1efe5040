//! How a scene is looked at.

use crate::film::{Aov, FilmSize, Filter, Response};
use crate::medium::MediumId;
use crate::sensor::Sensor;

/// A camera with its film, beside the [`Scene`](super::Scene) it looks at: another view of the same
/// scene needs nothing else compiled.
#[derive(Clone, Debug)]
pub struct View {
    /// Maps film positions to rays, in the coordinates of the scene.
    pub sensor: Sensor,
    /// What the camera stands in; `None` is vacuum.
    pub medium: Option<MediumId>,
    /// Size of the picture and the part of it that is rendered.
    pub film: FilmSize,
    /// Reconstruction filter, drawn from by importance sampling.
    pub filter: Filter,
    /// From radiance to what the film stores.
    pub response: Response,
    /// Camera rays pass through hidden lamps (`hide_emitters` of Mitsuba 3.7 and later) instead of
    /// ending at a surface that does not shine (before 3.7).
    pub hidden_lamps_are_transparent: bool,
    /// Pictures of the surfaces in sight that are made beside that of light, each once.
    pub aovs: Vec<Aov>,
}
