//! How a scene is looked at.

use crate::film::{Aov, FilmSize, Filter, Response};
use crate::math::Vec2;
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

impl View {
    /// The film position, in [0, 1]² of the whole film, of a position in [0, 1]² of the part that is rendered.
    pub fn place_in_crop(&self, at: Vec2) -> Vec2 {
        let [x0, y0, w, h] = self.film.crop.map(|v| v as f32);
        Vec2::new(x0 + at.x * w, y0 + at.y * h) / self.film.size()
    }
}
