//! Work by counts, so that a pilot needs no clock. The unit is a camera ray of a scene without media, about a quarter of
//! a microsecond.

use super::super::{PassStats, Scratch};
use super::volume::PassVolume;

/// Of a photon's ray, of a stored photon, and of a place with irradiance.
const PHOTON_RAY: f64 = 1.2;
const STORED: f64 = 0.6;
const KNOWN_PLACE: f64 = 3.0;

/// Of a lookup and of a photon found by it.
const LOOKUP: f64 = 1.0;
const FOUND: f64 = 0.015;

/// In scenes with media, by the time that seven scenes took of fog, smoke and milk: of a ray of a camera path with its
/// scattering, of a short ray that looks for edges, of a light path's ray, and of a stored photon.
const MEDIA_RAY: f64 = 3.0;
const MEDIA_EDGE_RAY: f64 = 0.3;
const MEDIA_PHOTON_RAY: f64 = 0.7;
const MEDIA_STORED: f64 = 1.0;

/// Of a stored beam, and of finding a photon or a piece of a beam along a camera ray.
const BEAM_STORED: f64 = 3.3;
const POINT_FOUND: f64 = 0.08;
const BEAM_FOUND: f64 = 0.65;

/// Of camera samples.
pub(super) fn of_camera(scratch: &Scratch) -> f64 {
    scratch.rays as f64 + LOOKUP * scratch.gather.lookups as f64 + FOUND * scratch.gather.photons as f64
}

/// Of a map with irradiance at some places.
pub(super) fn of_map(stats: &PassStats, places: usize) -> f64 {
    PHOTON_RAY * stats.photon_rays as f64 + STORED * stats.photons as f64 + KNOWN_PLACE * places as f64
}

/// Of camera samples in a scene with media.
pub(super) fn of_camera_in_media(scratch: &Scratch, volume: Option<&PassVolume>) -> f64 {
    let found = match volume {
        Some(PassVolume::Beams(_)) => BEAM_FOUND,
        Some(PassVolume::Points(_)) | None => POINT_FOUND,
    };
    MEDIA_RAY * (scratch.rays - scratch.edge_rays) as f64
        + MEDIA_EDGE_RAY * scratch.edge_rays as f64
        + LOOKUP * (scratch.gather.lookups + scratch.volume.lookups) as f64
        + FOUND * scratch.gather.photons as f64
        + found * scratch.volume.photons as f64
}

/// Of all maps of a pass in a scene with media.
pub(super) fn of_pass_in_media(stats: &PassStats, volume: Option<&PassVolume>) -> f64 {
    let beams = match volume {
        Some(PassVolume::Beams(map)) => map.len() as u64,
        Some(PassVolume::Points(_)) | None => 0,
    };
    MEDIA_PHOTON_RAY * stats.photon_rays as f64
        + MEDIA_STORED * (stats.photons - beams) as f64
        + BEAM_STORED * beams as f64
}
