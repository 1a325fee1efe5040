//! What a render will need, against what the machine has: said before anything is allocated.

use caustica_formats::memory::available;

use super::load::Loaded;
use super::report::megabytes;
use crate::film::STRIDE;
use crate::integrator::PhotonMapper;
use crate::settings::{Count, IntegratorKind};

/// Bytes a pixel: the sums twice (a cut pass is taken back), and a checkpoint or a picture with all
/// its layers being written.
const PIXEL: u128 = 3 * 8 * (STRIDE as u128 + 1);
/// Bytes of a photon while its map is built: as traced in its chunk and joined, 52 each, then sorted, 40.
const PHOTON: u128 = 144;
/// Bytes of the results of a chunk of 2048 light paths that store nothing.
const CHUNK: u128 = 64;

/// Fails with the name of the setting that wants more memory than there is.
pub fn check(loaded: &Loaded) -> Result<(), String> {
    within(loaded, available())
}

fn within(loaded: &Loaded, memory: u128) -> Result<(), String> {
    let [_, _, width, height] = loaded.view.film.crop;
    refuse(
        &format!("a film of {width} × {height} pixels (--size, --crop)"),
        u128::from(width) * u128::from(height) * PIXEL,
        memory,
    )?;
    if loaded.settings.integrator == IntegratorKind::Path {
        return Ok(());
    }
    let settings = &loaded.settings;
    // What no pilot is needed for comes first: it might not fit either.
    let counts = [("photons", settings.photons), ("caustic_photons", settings.caustic_photons)];
    for (name, count) in counts {
        let bytes = match count {
            Count::Paths(n) => u128::from(n) / 2048 * CHUNK,
            Count::Auto | Count::Stored(_) => 0,
        };
        refuse(&format!("setting `{name}` = {count}"), bytes, memory)?;
    }
    let photons = PhotonMapper::expected_photons(loaded.task());
    for ((name, count), photons) in counts.into_iter().zip(photons) {
        refuse(&format!("setting `{name}` = {count}"), u128::from(photons) * PHOTON, memory)?;
    }
    Ok(())
}

fn refuse(what: &str, bytes: u128, memory: u128) -> Result<(), String> {
    if bytes <= memory {
        return Ok(());
    }
    let shown = |n: u128| megabytes(u64::try_from(n).unwrap_or(u64::MAX));
    Err(format!("{what} needs about {} of memory; {} are free", shown(bytes), shown(memory)))
}
