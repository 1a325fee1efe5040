//! What a render will do, for people and for machines.

use std::fmt;

use serde::Serialize;

use crate::integrator::Task;
use crate::integrator::images;
use crate::integrator::photon_map::{self, Decided};
use crate::settings::{Count, IntegratorKind};

/// The parts of the renderer that a scene and its settings use; nothing else is paid for. Printed by
/// `inspect` and `render -v`.
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
    /// A random number decides which lamp is sampled.
    pub many_lamps: bool,
    /// A random number decides which lobe of a material scatters.
    pub many_lobes: bool,
    /// Light comes from infinity.
    pub environment: bool,
    /// There are textures.
    pub textured: bool,
    /// Groups are placed by instances.
    pub instances: bool,
    /// Light paths a pass; 0 where no map is needed.
    pub global_paths: Count,
    /// The same for the caustic map.
    pub caustic_paths: Count,
    /// How indirect light is computed where a pilot has measured it.
    pub indirect: Option<photon_map::Choice>,
    /// Pixels that see the border of a lamp, or a lamp smaller than themselves, and take extra samples.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lamp_pixels: Option<u64>,
    /// What light leaves in media, where they scatter it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub volume: Option<photon_map::VolumeChoice>,
    /// Why something is left out.
    pub notes: Vec<String>,
}

impl Plan {
    /// Of a task. Runs the pilot that decides how indirect light is computed, if the settings leave it open.
    pub fn of(task: Task<'_>) -> Self {
        let (facts, settings) = (task.facts, task.settings);
        let mut notes = Vec::new();
        if !facts.lit {
            notes.push("no emitter: the picture is black".to_owned());
        }
        let nothing = Decided { plan: photon_map::Plan::NOTHING, indirect: None, volume: None };
        let photons = settings.integrator == IntegratorKind::PhotonMap && !facts.media_emit;
        let images = photons.then(|| images::search(task)).flatten();
        let Decided { plan: maps, indirect, volume } = match settings.integrator {
            IntegratorKind::Path => nothing,
            IntegratorKind::PhotonMap if facts.media_emit => {
                notes.push("media that shine leave no photons: path tracing".to_owned());
                nothing
            }
            IntegratorKind::PhotonMap => {
                let decided = photon_map::decided(task);
                notes.extend(decided.plan.notes(facts, settings));
                decided
            }
        };
        Self {
            global_map: maps.global_map,
            caustic_map: maps.caustic_map,
            caustics: maps.caustics,
            direct_mis: facts.large_lamps,
            transparent_shadows: facts.transparent_shadows,
            transmission: facts.transmission,
            many_lamps: facts.many_lamps,
            many_lobes: facts.many_lobes,
            environment: facts.environment,
            textured: facts.textured,
            instances: facts.instances,
            global_paths: maps.global_paths,
            caustic_paths: maps.caustic_paths,
            indirect,
            lamp_pixels: images.map(|images| images.pixels()),
            volume,
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
        if let Some(choice) = &self.indirect {
            write!(f, "\nindirect light       {choice}")?;
            for (name, aim) in ["global aim", "caustic aim"].into_iter().zip(&choice.aims) {
                if let Some(aim) = aim {
                    write!(f, "\n{name:<20} {aim}")?;
                }
            }
        }
        if let Some(pixels) = self.lamp_pixels {
            write!(
                f,
                "\nlamps seen           with a border, or smaller than a pixel, in {pixels} pixels, which take extra samples"
            )?;
        }
        if let Some(choice) = &self.volume {
            write!(f, "\nlight in media       {choice}")?;
        }
        self.notes.iter().try_for_each(|n| write!(f, "\nnote: {n}"))
    }
}
