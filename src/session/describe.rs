//! What is said of a scene: as it was read, as it was compiled, and what rendering it will do.

use std::collections::BTreeMap;
use std::fmt::{self, Debug, Write};

use caustica_formats::diagnostic::{Diagnostic, SourceMap};
use caustica_formats::ir;
use serde::Serialize;

use super::units::{count, megabytes};
use super::{Plan, Session};

/// All that is said of a scene.
/// Serialises to the JSON of `inspect --json`, prints as its text.
#[derive(Clone, Debug, Serialize)]
pub struct Description<'a> {
    scene: String,
    /// Of all its files.
    hash: &'a str,
    read: &'a Contents,
    statistics: Statistics,
    plan: Plan,
    settings: BTreeMap<&'static str, String>,
    unsupported: Vec<&'a Finding>,
    warnings: Vec<&'a Finding>,
}

/// What the file says, before anything is made of it: how many of each kind.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Contents {
    film: [u32; 2],
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

/// A problem that does not keep the scene from being opened.
#[derive(Clone, Debug, Serialize)]
pub struct Finding {
    /// FILE:LINE:COLUMN.
    pub place: Option<String>,
    /// What it is about.
    pub message: String,
    /// What to do about it.
    pub help: Vec<String>,
    /// Something is left out of the picture or replaced.
    #[serde(skip)]
    pub unsupported: bool,
}

impl Finding {
    pub(super) fn new(d: &Diagnostic, sources: &SourceMap) -> Self {
        Self {
            place: d.span.map(|span| sources.location(span)),
            message: d.message.clone(),
            help: d.help.clone(),
            unsupported: d.unsupported,
        }
    }
}

impl<'a> Description<'a> {
    pub(super) fn of(session: &'a Session) -> Self {
        let scene = &session.scene;
        let levels = std::iter::once(&scene.geometry.world).chain(&scene.geometry.groups);
        let (unsupported, warnings) = session.findings.iter().partition(|f| f.unsupported);
        Self {
            scene: session.path.display().to_string(),
            hash: &session.hash,
            read: &session.contents,
            statistics: Statistics {
                shapes: scene.shapes.len(),
                primitives: levels.map(|level| level.primitives).sum(),
                instances: scene.geometry.instances.len(),
                materials: scene.materials.len(),
                textures: scene.textures.0.len(),
                texture_bytes: scene.textures.bytes(),
                emitters: scene.emitters.len(),
                emitted_power: crate::spectrum::to_rgb(scene.power()).map(f64::from),
                middle: scene.origin,
                radius: f64::from(scene.sphere.radius),
                acceleration_bytes: scene.geometry.bytes(),
            },
            plan: session.plan(),
            settings: session.settings.values().collect(),
            unsupported,
            warnings,
        }
    }

    fn text(&self) -> String {
        let (read, made) = (&self.read, &self.statistics);
        let mut out = String::new();
        let mut row = |name: &str, value: String| out.push_str(&format!("{name:<20} {value}\n"));
        let [w, h] = read.film;
        row("scene", self.scene.clone());
        let crop = read.crop.map(|c| format!(", of it {}×{} at {}, {}", c.width, c.height, c.x, c.y));
        row("film", format!("{w}×{h}{}", crop.unwrap_or_default()));
        row("integrator", read.integrator.clone().unwrap_or_else(|| "none asked for".to_owned()));
        row("sensors", read.sensors.to_string());
        row("shapes", listed(&read.shapes));
        row("groups", read.groups.to_string());
        row("materials", listed(&read.materials));
        row("textures", listed(&read.textures));
        row("emitters", listed(&read.emitters));
        row("area lamps", read.area_lamps.to_string());
        row("\nprimitives", count(made.primitives as f64));
        row("instances", made.instances.to_string());
        row("textures loaded", format!("{} ({})", made.textures, megabytes(made.texture_bytes as u64)));
        let [red, green, blue] = made.emitted_power;
        row("emitted power", format!("{red:.4}, {green:.4}, {blue:.4} W"));
        let [x, y, z] = made.middle;
        row("middle, radius", format!("({x:.4}, {y:.4}, {z:.4}), {:.4}", made.radius));
        row("acceleration", megabytes(made.acceleration_bytes as u64));
        out.push_str(&format!("\nplan\n{}\n\nsettings\n", self.plan));
        for (name, value) in &self.settings {
            out.push_str(&format!("  {name:<18} {value}\n"));
        }
        out.push_str("\nnot supported\n");
        for &Finding { place, message, .. } in &self.unsupported {
            out.push_str(&format!(
                "  {}{message}\n",
                place.as_ref().map_or(String::new(), |p| format!("{p}: "))
            ));
        }
        if self.unsupported.is_empty() {
            out.push_str("  nothing: all of the scene is rendered\n");
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
    pub(super) fn of(scene: &ir::Scene, film: &ir::Film) -> Self {
        let in_groups = || scene.groups.iter().flat_map(|(_, group)| &group.shapes);
        let shapes = || scene.shapes.iter().chain(in_groups());
        Self {
            film: [film.width, film.height],
            crop: film.crop,
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
