//! What a scene needs, decided once before rendering.

use std::fmt;

use serde::Serialize;

use super::Scene;
use crate::emitter::Emitter;
use crate::settings::{Count, IntegratorKind, Settings};

/// The parts of the renderer that this scene and these settings use; nothing else is paid for.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plan {
    /// Photons from rough surfaces (or straight from lamps, without next event estimation).
    pub global_map: bool,
    /// Photons through mirrors and glass, in a map of their own.
    pub caustic_map: bool,
    /// Light through specular surfaces exists, in whichever map.
    pub caustics: bool,
    /// Scattered rays also look for lamps: pays where lamps are large, as the sky is.
    pub direct_mis: bool,
    /// Shadow rays look through masks and index-matched boundaries.
    pub transparent_shadows: bool,
    /// Light passes through some surfaces.
    pub transmission: bool,
    /// A number decides which lamp is sampled; with one there is nothing to decide.
    pub many_lamps: bool,
    /// A number decides which lobe of a material scatters; all are plain diffuse otherwise.
    pub many_lobes: bool,
    pub environment: bool,
    pub textured: bool,
    pub instances: bool,
    /// Light paths a pass; 0 where no map is needed.
    pub global_paths: Count,
    pub caustic_paths: Count,
    /// Why something is left out, for people.
    pub notes: Vec<String>,
}

impl Plan {
    pub fn new(scene: &Scene, settings: &Settings) -> Self {
        let mut notes = Vec::new();
        let natures = || scene.materials.iter().map(|m| m.nature());
        let lit = !scene.emitters.is_empty();
        if !lit {
            notes.push("no emitter: the picture is black".to_owned());
        }
        // Glossy lobes are followed like mirrors, and throw caustics as they do.
        let glossy = |[min, _]: [f32; 2]| min < settings.glossy;
        let specular = natures().any(|n| n.delta || n.smooth.is_some_and(glossy));
        let rough = natures().any(|n| n.smooth.is_some_and(|[_, max]| max >= settings.glossy));
        let photons = settings.integrator == IntegratorKind::PhotonMap;
        // Segments a path needs at least: lamp–rough–camera is 2, each further surface adds one.
        let deepest = settings.max_depth.0;
        let caustics = photons && lit && specular && rough && deepest >= 3;
        let global_map = photons && lit && rough && deepest >= if settings.nee { 3 } else { 2 };
        if photons && !specular {
            notes.push("no specular surface: no caustic map".to_owned());
        }
        if photons && settings.nee && deepest == 2 {
            notes.push("max_depth 2 is direct light only: no photon map".to_owned());
        }
        let environment = !scene.environments.is_empty();
        let large_lamp = scene.emitters.iter().any(|e| match e {
            Emitter::Area(a) => a.area() > 0.02 * scene.sphere.radius * scene.sphere.radius,
            _ => false,
        });
        // Caustic paths end at the first rough surface, mostly after one ray: four times as many cost as
        // much, and what they show is sharper.
        let pixels = scene.film.pixel_count() as u64;
        let paths = |wanted: bool, count: Count, automatic: u64| match count {
            _ if !wanted => Count::Paths(0),
            Count::Auto => Count::Paths(automatic.max(1024)),
            given => given,
        };
        let caustic_map = caustics && settings.caustic_map;
        Self {
            global_map,
            caustic_map,
            caustics,
            direct_mis: environment || large_lamp,
            transparent_shadows: scene.materials.iter().any(|m| m.passes_shadow_rays()),
            transmission: natures().any(|n| n.transmits),
            many_lamps: scene.emitters.len() > 1,
            many_lobes: scene.materials.iter().any(|m| m.chooses_lobes()),
            environment,
            textured: !scene.textures.0.is_empty(),
            instances: !scene.geometry.instances.is_empty(),
            global_paths: paths(global_map || (caustics && !caustic_map), settings.photons, pixels / 4),
            caustic_paths: paths(caustic_map, settings.caustic_photons, pixels),
            notes,
        }
    }
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let yes = |b: bool| if b { "yes" } else { "no" };
        let paths = |count: Count| match count {
            Count::Stored(n) => format!("as many light paths a pass as store {n} photons"),
            given => format!("{given} light paths a pass"),
        };
        writeln!(f, "global map           {} ({})", yes(self.global_map), paths(self.global_paths))?;
        writeln!(f, "caustic map          {} ({})", yes(self.caustic_map), paths(self.caustic_paths))?;
        writeln!(f, "scattered lamp rays  {}", yes(self.direct_mis))?;
        writeln!(f, "transparent shadows  {}", yes(self.transparent_shadows))?;
        writeln!(f, "environment          {}", yes(self.environment))?;
        writeln!(f, "textures             {}", yes(self.textured))?;
        write!(f, "instances            {}", yes(self.instances))?;
        self.notes.iter().try_for_each(|n| write!(f, "\nnote: {n}"))
    }
}
