//! IR → [`Scene`]. Everything that can fail fails here, with the place in the author's file; all
//! problems are listed at once.

mod alpha;
mod analytic;
mod attributes;
mod coats;
mod emitters;
mod integrator;
mod interfaces;
mod lamp_sight;
mod lamps;
mod light_image;
mod materials;
mod media;
mod partial;
mod principled;
mod sensor;
mod shapes;
mod textures;

use std::fmt::Display;

use caustica_formats::diagnostic::{Diagnostic, Severity};
use caustica_formats::files::Files;
use caustica_formats::ir;
use caustica_formats::spectrum::to_linear_rgb;

use super::lamps::emitter_distributions;
use super::{Facts, LampMedium, Scene, View};
use crate::math::Color;
use crate::settings::Settings;
use crate::spectrum::rgb;

pub use sensor::MAX_PIXELS;

/// How to compile.
#[derive(Clone, Copy, Debug, Default)]
pub struct CompileOptions {
    /// Which sensor; `None` is the scene's default.
    pub sensor: Option<usize>,
    /// Replace what cannot be rendered by something near, with a warning.
    pub lenient: bool,
    /// Whose conversion of spectra to RGB; `None` is that of the file's own version.
    pub spectrum_rule: Option<ir::SpectrumRule>,
    /// Keep texture coordinates that no texture needs.
    pub keep_uvs: bool,
}

/// A compiled scene, how it is seen, and what to say about it.
#[derive(Debug)]
pub struct Compiled {
    /// What rays meet and what shines.
    pub scene: Scene,
    /// What rendering the scene needs.
    pub facts: Facts,
    /// The camera and the film.
    pub view: View,
    /// The defaults with what the scene asks for.
    pub settings: Settings,
    /// In the order in which they were found.
    pub warnings: Vec<Diagnostic>,
}

/// Collects problems while the scene is put together.
struct Compiler<'a> {
    ir: &'a ir::Scene,
    files: &'a dyn Files,
    options: CompileOptions,
    diagnostics: Vec<Diagnostic>,
    textures: textures::TextureTable,
    materials: materials::MaterialTable,
    media: media::MediumTable,
    /// The author's coordinates of the compiled scene's (0, 0, 0).
    origin: [f64; 3],
}

impl Compiler<'_> {
    fn error(&mut self, message: impl Into<String>, origin: ir::Origin) {
        self.diagnostics.push(Diagnostic::error(message, origin.0));
    }

    fn warn(&mut self, message: impl Into<String>, origin: ir::Origin) {
        self.diagnostics.push(Diagnostic::warning(message, origin.0));
    }

    /// An error about something known that has no substitute.
    fn refuse(&mut self, what: impl Display, origin: ir::Origin) {
        let problem = Diagnostic::error(format!("{what} is not supported"), origin.0);
        self.diagnostics.push(problem.unsupported());
    }

    /// An error, or with `--lenient` a warning that names the substitute.
    fn unsupported(&mut self, what: &str, substitute: &str, origin: ir::Origin) {
        let problem = if self.options.lenient {
            Diagnostic::warning(format!("{what} is not supported yet; {substitute} instead"), origin.0)
        } else {
            Diagnostic::error(format!("{what} is not supported yet"), origin.0)
                .help(format!("--lenient renders {substitute} instead"))
        };
        self.diagnostics.push(problem.unsupported());
    }

    fn color(&mut self, color: &ir::Color, slot: ir::ColorSlot, origin: ir::Origin) -> Color {
        // The rules differ in spectra only; what range a plain RGB may have is the file's own matter.
        let spectral = !matches!(color, ir::Color::Gray(_) | ir::Color::Rgb(_) | ir::Color::Srgb(_));
        let rule = self.options.spectrum_rule.filter(|_| spectral).unwrap_or(self.ir.spectrum_rule);
        match to_linear_rgb(color, slot, rule) {
            Ok(c) => rgb(c.map(|v| v as f32)),
            Err(e) => {
                self.error(e.to_string(), origin);
                Color::ZERO
            }
        }
    }
}

/// Compiles a scene for rendering.
///
/// # Errors
/// Every problem found: missing or broken meshes and textures, unsupported features, no sensor.
pub fn compile(
    ir: &ir::Scene,
    files: &dyn Files,
    options: CompileOptions,
) -> Result<Compiled, Vec<Diagnostic>> {
    let masked = alpha::into_masks(ir);
    let ir = masked.as_ref();
    let mut b = Compiler {
        ir,
        files,
        options,
        diagnostics: Vec::new(),
        textures: textures::TextureTable::default(),
        materials: materials::MaterialTable::default(),
        media: media::MediumTable::default(),
        origin: [0.0; 3],
    };
    let sensor = sensor::choose(&mut b);
    let camera = sensor.map(|s| s.to_world.point([0.0; 3]));
    let shapes = rayon::scope(|scope| {
        let meshes = shapes::load_meshes(ir, files);
        let meshes = shapes::settle_origin(&mut b, meshes, camera);
        // Textures that lie in space count from the origin.
        shapes::build_materials(&mut b);
        let pictures = b.wanted_pictures();
        scope.spawn(move |_| textures::decode_all(&pictures, ir, files));
        shapes::build(&mut b, &meshes)
    });
    let mut emitters = shapes.emitters;
    let mut lamp_media = vec![LampMedium::One(None); emitters.len()];
    let environments = emitters::build(&mut b, shapes.origin, &mut emitters, &mut lamp_media);
    let medium = sensor.and_then(|s| b.medium(s.medium));
    let camera = sensor.map(|s| (sensor::build(&mut b, s, shapes.origin), sensor::response(&s.film)));
    let settings = integrator::settings(&mut b);
    b.settle();
    let failed = b.diagnostics.iter().any(|d| d.severity == Severity::Error);
    let Some(((sensor, film, filter), response)) = camera.filter(|_| !failed) else {
        return Err(b.diagnostics);
    };
    let textures = b.textures.finish();
    let (direct, emission) = emitter_distributions(&emitters, &textures, &shapes.sphere);
    let (media, medium_names) = b.media.finish();
    let panes_pass = !media.is_empty() && ir::panes_pass_in_media(ir);
    let passage = u32::from(!ir::has_passages(ir) || ir::passages_count(ir));
    let mut scene = Scene {
        geometry: shapes.geometry,
        shapes: shapes.records,
        materials: b.materials.finish(),
        textures,
        panes_pass,
        passage,
        media,
        medium_names,
        lamp_media,
        emitters,
        emission,
        direct,
        environments,
        sphere: shapes.sphere,
        origin: shapes.origin,
        numbers: shapes.numbers,
    };
    let hidden_lamps_are_transparent = ir.hide_emitters == ir::HideEmitters::Surface;
    let view =
        View { sensor, medium, film, filter, response, hidden_lamps_are_transparent, aovs: Vec::new() };
    let facts = Facts::of(&scene);
    // In media, shadow rays pass through boundaries that would hide everything here.
    if scene.direct.few() && !facts.media {
        let shares = lamp_sight::shares(&scene, &view);
        scene.direct.set_arriving(shares);
    }
    if facts.media {
        b.diagnostics.extend(media::check(ir, &scene, &view));
        scene.place_lamps(view.sensor.position, view.medium);
    }
    Ok(Compiled { scene, facts, view, settings, warnings: b.diagnostics })
}
