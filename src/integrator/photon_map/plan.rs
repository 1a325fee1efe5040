//! Which photon maps a scene needs, and of how many light paths each.

use crate::scene::Facts;
use crate::settings::{Count, Indirect, Lookup, Radius, Settings};

/// Light paths of a map that is left to follow the film, at least.
const LEAST_PATHS: u64 = 1024;

/// The same for a map that is read at the second rough surface: what it costs is shared by many lookups.
const LEAST_GATHERED: u64 = 1 << 16;

/// The same for photons in media: volumes are larger than surfaces.
const LEAST_IN_MEDIA: u64 = 1 << 14;

/// The photon maps of a render; what is not needed is neither traced nor stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// Photons from rough surfaces (or straight from lamps, without next event estimation).
    pub global_map: bool,
    /// Photons through mirrors and glass, in a map of their own.
    pub caustic_map: bool,
    /// The caustic map also has photons on glossy surfaces.
    pub glints: bool,
    /// Photons of the global map that come from specular or glossy surfaces have a radius of their own: such light is
    /// focused, and sharper than what rough surfaces send.
    pub focused: bool,
    /// Light through specular surfaces exists, in whichever map.
    pub caustics: bool,
    /// Light paths a pass; 0 where no map is needed.
    pub global_paths: Count,
    /// The same for the caustic map.
    pub caustic_paths: Count,
    /// Photons or beams in media.
    pub volume_map: bool,
    /// The same for these.
    pub volume_paths: Count,
}

impl Plan {
    /// No maps at all.
    pub const NOTHING: Self = Self {
        global_map: false,
        caustic_map: false,
        glints: false,
        focused: false,
        caustics: false,
        global_paths: Count::Paths(0),
        caustic_paths: Count::Paths(0),
        volume_map: false,
        volume_paths: Count::Paths(0),
    };

    /// For a picture of `pixels` pixels, which automatic path counts follow.
    pub fn new(facts: &Facts, settings: &Settings, pixels: usize) -> Self {
        let (lit, rough) = (facts.lit, facts.as_rough_as(settings.glossy));
        // Segments a path needs at least: lamp–rough–camera is 2, each further surface adds one.
        let deepest = settings.max_depth.0;
        // Glossy lobes are followed like mirrors, and throw caustics as they do.
        let caustics = lit && facts.sharper_than(settings.glossy) && rough && deepest >= 3;
        // What is still to be chosen is counted as final gathering, which takes most light paths.
        let gathered = matches!(settings.indirect, Indirect::Gather | Indirect::Auto);
        let traced = settings.indirect == Indirect::Trace;
        // Without next event estimation the map holds direct light as well, if it is seen directly.
        let least = if settings.nee || gathered { 3 } else { 2 };
        let global_map = lit && rough && deepest >= least && !traced;
        let paths = |wanted: bool, count: Count, automatic: u64| match count {
            _ if !wanted => Count::Paths(0),
            Count::Auto => Count::Paths(automatic.max(LEAST_PATHS)),
            given => given,
        };
        let caustic_map = caustics && settings.caustic_map;
        // Without next event estimation it holds single scattering as well. Path tracing takes all or nothing there.
        let least = if settings.nee { 3 } else { 2 };
        let volume_map = lit && facts.media_scatter && deepest >= least && !traced;
        // Most caustic paths end at the first rough surface, after one ray: four times as many cost the
        // same, and what they show is sharper.
        let pixels = pixels as u64;
        let global = if gathered { (pixels / 4).max(LEAST_GATHERED) } else { pixels / 4 };
        Self {
            global_map,
            caustic_map,
            glints: caustic_map
                && !facts.media
                && facts.roughness.is_some_and(|[least, _]| least < settings.glossy),
            focused: caustic_map
                && !facts.media
                && settings.radius == Radius::Auto
                && settings.lookup == Lookup::Radius,
            caustics,
            global_paths: paths(
                global_map || (caustics && !caustic_map && !traced),
                settings.photons,
                global,
            ),
            caustic_paths: paths(caustic_map, settings.caustic_photons, pixels),
            volume_map,
            volume_paths: paths(volume_map, settings.volume_photons, pixels.max(LEAST_IN_MEDIA)),
        }
    }

    /// Why a map is left out, for people.
    pub fn notes(&self, facts: &Facts, settings: &Settings) -> Vec<String> {
        let mut notes = Vec::new();
        if !facts.sharper_than(settings.glossy) {
            notes.push("no specular surface: no caustic map".to_owned());
        }
        if facts.media && self.global_map {
            notes.push("media: light of surfaces from photons at the first rough surface".to_owned());
        }
        if settings.nee && settings.max_depth.0 == 2 {
            notes.push("max_depth 2 is direct light only: no photon map".to_owned());
        }
        notes
    }
}
