//! What is said of a scene: as it was read, as it was compiled, and what rendering it will do.

use std::collections::BTreeMap;
use std::fmt::{self, Debug, Write};
use std::path::Path;

use caustica_formats::ir;
use serde::Serialize;

use super::media::Media;
use super::units::{count, megabytes};
use super::{Finding, Plan, Session};
use crate::scene::Scene;

/// All that is said of a scene. Serialises to the JSON of `inspect --json`, prints as its text. What could not be
/// found out because of an error is absent.
#[derive(Clone, Debug, Serialize)]
pub struct Description<'a> {
    scene: String,
    /// Whether `render` takes the scene.
    renders: bool,
    diagnostics: &'a [Finding],
    /// Of all its files.
    hash: Option<&'a str>,
    read: Option<&'a Contents>,
    statistics: Option<Statistics>,
    #[serde(skip_serializing_if = "Option::is_none")]
    media: Option<Media>,
    plan: Option<Plan>,
    settings: Option<BTreeMap<&'static str, String>>,
}

/// What the file says, before anything is made of it: how many of each kind.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Contents {
    film: Option<[u32; 2]>,
    crop: Option<ir::Crop>,
    integrator: Option<String>,
    sensors: usize,
    shapes: Kinds,
    groups: usize,
    materials: Kinds,
    textures: Kinds,
    emitters: Kinds,
    area_lamps: usize,
}

type Kinds = BTreeMap<String, usize>;

/// What the scene became.
#[derive(Clone, Debug, Serialize)]
struct Statistics {
    shapes: usize,
    primitives: usize,
    instances: usize,
    materials: usize,
    textures: usize,
    texture_bytes: usize,
    emitters: usize,
    /// Watts, by channel.
    emitted_power: [f64; 3],
    middle: [f64; 3],
    radius: f64,
    acceleration_bytes: usize,
}

impl Statistics {
    fn of(scene: &Scene) -> Self {
        let levels = std::iter::once(&scene.geometry.world).chain(&scene.geometry.groups);
        let center = scene.sphere.center;
        Self {
            shapes: scene.shapes.len(),
            primitives: levels.map(|level| level.primitives).sum(),
            instances: scene.geometry.instances.len(),
            materials: scene.materials.len(),
            textures: scene.textures.0.len(),
            texture_bytes: scene.textures.bytes(),
            emitters: scene.emitters.len(),
            emitted_power: crate::spectrum::to_rgb(scene.power()).map(f64::from),
            // The scene's coordinates begin at its origin.
            middle: std::array::from_fn(|i| scene.origin[i] + f64::from(center[i])),
            radius: f64::from(scene.sphere.radius),
            acceleration_bytes: scene.geometry.bytes(),
        }
    }
}

impl<'a> Description<'a> {
    /// Of the scene at `path` with what was found; without a session of what its files say.
    pub(super) fn of(
        path: &Path,
        renders: bool,
        diagnostics: &'a [Finding],
        session: Option<&'a Session>,
        contents: Option<&'a Contents>,
    ) -> Self {
        Self {
            scene: path.display().to_string(),
            renders,
            diagnostics,
            hash: session.map(Session::hash),
            read: session.map(|session| &session.contents).or(contents),
            statistics: session.map(|session| Statistics::of(&session.scene)),
            media: session.and_then(|session| Media::of(&session.scene, &session.view)),
            plan: session.map(Session::plan),
            settings: session.map(|session| session.settings.values().collect()),
        }
    }

    fn text(&self) -> String {
        let mut out = String::new();
        let mut row = |name: &str, value: String| out.push_str(&format!("{name:<20} {value}\n"));
        row("scene", self.scene.clone());
        if let Some(read) = self.read {
            read.rows(&mut row);
        }
        if let Some(made) = &self.statistics {
            made.rows(&mut row);
        }
        if let Some(media) = &self.media {
            media.rows(&mut row);
        }
        if let Some(plan) = &self.plan {
            out.push_str(&format!("\nplan\n{plan}\n"));
        }
        if let Some(settings) = &self.settings {
            out.push_str("\nsettings\n");
            settings.iter().for_each(|(name, value)| out.push_str(&format!("  {name:<18} {value}\n")));
        }
        let mut list = |title: &str, wanted: &dyn Fn(&Finding) -> bool, none: &str| {
            let lines: Vec<String> =
                self.diagnostics.iter().filter(|f| wanted(f)).map(Finding::line).collect();
            if !lines.is_empty() || !none.is_empty() {
                out.push_str(&format!("\n{title}\n"));
                out.push_str(if lines.is_empty() { none } else { "" });
                lines.iter().for_each(|line| out.push_str(&format!("  {line}\n")));
            }
        };
        let none = if self.renders { "  nothing: all of the scene is rendered\n" } else { "" };
        list("not supported", &|f| f.unsupported, none);
        list("errors", &|f| f.is_error() && !f.unsupported, "");
        if !self.renders {
            out.push_str("\nthis scene is refused\n");
        }
        out.trim_end().to_owned()
    }
}

impl fmt::Display for Description<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text())
    }
}

impl Contents {
    /// With the film of a sensor by its number, or that of the scene's default.
    pub(super) fn of(scene: &ir::Scene, sensor: Option<usize>) -> Self {
        let film = scene.sensors.get(sensor.unwrap_or(scene.default_sensor)).map(|sensor| &sensor.film);
        let in_groups = || scene.groups.iter().flat_map(|(_, group)| &group.shapes);
        let shapes = || scene.shapes.iter().chain(in_groups());
        Self {
            film: film.map(|film| [film.width, film.height]),
            crop: film.and_then(|film| film.crop),
            integrator: scene.integrator.as_ref().map(|i| i.plugin.clone()),
            sensors: scene.sensors.len(),
            shapes: kinds(shapes().map(|shape| &shape.kind)),
            groups: scene.groups.len(),
            materials: kinds(scene.bsdfs.iter().map(|(_, bsdf)| &bsdf.kind)),
            textures: kinds(scene.textures.iter().map(|(_, texture)| &texture.kind)),
            emitters: kinds(scene.emitters.iter().map(|emitter| &emitter.kind)),
            area_lamps: shapes().filter(|shape| shape.emission.is_some()).count(),
        }
    }

    fn rows(&self, row: &mut dyn FnMut(&str, String)) {
        if let Some([w, h]) = self.film {
            let crop = self.crop.map(|c| format!(", of it {}×{} at {}, {}", c.width, c.height, c.x, c.y));
            row("film", format!("{w}×{h}{}", crop.unwrap_or_default()));
        }
        row("asked for", self.integrator.clone().unwrap_or_else(|| "no integrator".to_owned()));
        row("sensors", self.sensors.to_string());
        row("shapes", listed(&self.shapes));
        row("groups", self.groups.to_string());
        row("materials", listed(&self.materials));
        row("textures", listed(&self.textures));
        let mut emitters = self.emitters.clone();
        if self.area_lamps > 0 {
            emitters.insert("Area".to_owned(), self.area_lamps);
        }
        row("emitters", listed(&emitters));
    }
}

impl Statistics {
    fn rows(&self, row: &mut dyn FnMut(&str, String)) {
        row("\nprimitives", count(self.primitives as f64));
        row("instances", self.instances.to_string());
        row("textures loaded", format!("{} ({})", self.textures, megabytes(self.texture_bytes as u64)));
        let [red, green, blue] = self.emitted_power;
        row("emitted power", format!("{red:.4}, {green:.4}, {blue:.4} W"));
        let [x, y, z] = self.middle;
        row("middle, radius", format!("({x:.4}, {y:.4}, {z:.4}), {:.4}", self.radius));
        row("acceleration", megabytes(self.acceleration_bytes as u64));
    }
}

/// How many there are of each variant.
fn kinds<'a, T: Debug + 'a>(items: impl Iterator<Item = &'a T>) -> Kinds {
    let mut kinds = Kinds::new();
    for item in items {
        let mut name = FirstWord(String::new());
        // Ends with an error at the end of the name, before a mesh is printed.
        let _stopped = write!(name, "{item:?}");
        *kinds.entry(name.0).or_default() += 1;
    }
    kinds
}

/// The name of a variant, of what `Debug` prints.
struct FirstWord(String);

impl Write for FirstWord {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let word: String = text.chars().take_while(|c| c.is_alphanumeric()).collect();
        self.0.push_str(&word);
        if word.len() == text.len() { Ok(()) } else { Err(fmt::Error) }
    }
}

/// "3: 2 Mesh, 1 Sphere".
fn listed(kinds: &Kinds) -> String {
    let all: usize = kinds.values().sum();
    let each: Vec<String> = kinds.iter().map(|(name, n)| format!("{n} {name}")).collect();
    if each.is_empty() { "0".to_owned() } else { format!("{all}: {}", each.join(", ")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variants_are_counted_by_their_names() {
        let emitters = [
            ir::EmitterKind::Point { position: [0.0; 3], intensity: ir::Color::Gray(1.0) },
            ir::EmitterKind::Constant { radiance: ir::Color::Gray(1.0) },
            ir::EmitterKind::Point { position: [1.0; 3], intensity: ir::Color::Gray(2.0) },
        ];
        assert_eq!(listed(&kinds(emitters.iter())), "3: 1 Constant, 2 Point");
        assert_eq!(listed(&kinds([ir::ShapeKind::Cube].iter())), "1: 1 Cube");
        assert_eq!(listed(&Kinds::new()), "0");
    }
}
