//! What is said of the media of a scene.

use serde::Serialize;

use crate::math::Color;
use crate::medium::Coefficients;
use crate::scene::{Scene, View};
use crate::spectrum::to_rgb;

/// The media, and where the camera stands.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Media {
    /// The name of the medium around the camera; nothing for vacuum.
    camera: Option<String>,
    media: Vec<MediumLine>,
}

/// One medium.
#[derive(Clone, Debug, Serialize)]
struct MediumLine {
    name: String,
    /// The same everywhere.
    homogeneous: bool,
    emits: bool,
    /// In which directions it scatters.
    phase: String,
    /// Mean way of light between two collisions, by channel; nothing where there are none. Where the medium varies,
    /// that of the mean extinction in its bounding box.
    mean_free_path: [Option<f64>; 3],
    /// Share of light that a collision scatters.
    albedo: [f64; 3],
    /// Mean free path of the densest channel over the radius of the scene.
    of_radius: Option<f64>,
}

impl Media {
    /// Nothing of a scene without media.
    pub fn of(scene: &Scene, view: &View) -> Option<Self> {
        let media: Vec<_> = scene
            .media
            .iter()
            .zip(&scene.medium_names)
            .map(|(medium, name)| {
                let mean = medium.mean();
                let line = MediumLine::new(mean, f64::from(scene.sphere.radius));
                let homogeneous = medium.uniform().is_some();
                let phase = medium.phase().describe();
                MediumLine { name: name.clone(), homogeneous, emits: medium.emits(), phase, ..line }
            })
            .collect();
        let camera = view.medium.map(|m| scene.medium_names[m.0 as usize].clone());
        (!media.is_empty()).then_some(Self { camera, media })
    }

    /// Lines of the text.
    pub fn rows(&self, row: &mut dyn FnMut(&str, String)) {
        row("camera in", self.camera.as_ref().map_or("vacuum".to_owned(), |name| format!("medium {name}")));
        for line in &self.media {
            row(&format!("medium {}", line.name), line.text());
        }
    }
}

impl MediumLine {
    fn new(mean: Coefficients, radius: f64) -> Self {
        let rgb = |c: Color| to_rgb(c).map(f64::from);
        let (extinction, scattered) = (rgb(mean.sigma_t), rgb(mean.sigma_s));
        let shortest = 1.0 / extinction.into_iter().fold(0.0, f64::max);
        Self {
            name: String::new(),
            homogeneous: true,
            emits: false,
            phase: String::new(),
            mean_free_path: extinction.map(|s| (s > 0.0).then_some(1.0 / s)),
            albedo: std::array::from_fn(
                |i| if extinction[i] > 0.0 { scattered[i] / extinction[i] } else { 0.0 },
            ),
            of_radius: shortest.is_finite().then_some(shortest / radius),
        }
    }

    fn text(&self) -> String {
        let path = |p: &Option<f64>| p.map_or("none".to_owned(), |p| format!("{p:.4}"));
        let [a, b, c] = &self.mean_free_path;
        let [x, y, z] = self.albedo;
        let kind = if self.homogeneous { "homogeneous" } else { "varies, in the mean of its box" };
        let emits = if self.emits { ", emits" } else { "" };
        let radii = self.of_radius.map_or(String::new(), |r| format!(" ({r:.3} of the scene's radius)"));
        format!(
            "{kind}{emits}, mean free path {}, {}, {}{radii}, albedo {x:.3}, {y:.3}, {z:.3}, {}",
            path(a),
            path(b),
            path(c),
            self.phase
        )
    }
}
