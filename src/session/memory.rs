//! What a render will need, against what the machine has: said before anything is allocated.

use caustica_formats::memory::available;

use super::{Error, Session};
use crate::film::{Aov, BinnedSums, STRIDE, WAITING_BYTES};
use crate::integrator::PhotonMapper;
use crate::photon::Stored;
use crate::photon::volume::VolumePhoton;
use crate::render::{NOISE_BYTES, SHARED_BYTES};
use crate::settings::{Count, Indirect, IntegratorKind, Pixels};

/// Bytes a pixel for each of its sums: the sum, what the running pass adds to it, and a checkpoint or a picture with all
/// its layers being written.
const SUM: usize = BinnedSums::BYTES + size_of::<f64>() + BinnedSums::PACKED;

/// Bytes of a photon while its map is built: as it was traced, its key in the sort and its place in the order, cells of
/// the grid, and the columns of one part.
const PHOTON: usize = Stored::BYTES + size_of::<u64>() + 4 * size_of::<u32>() + 3 * size_of::<f32>();

/// The same in a medium, with its box in the tree and the tree.
const VOLUME_PHOTON: usize = 3 * size_of::<VolumePhoton>();

/// Bytes that a render is expected to hold at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Memory {
    /// Sums, what it takes to save them, the light that samples share, and the noise of pixels.
    pub film: u128,
    /// Photons of the global and of the caustic map while they are traced and sorted. 0 where they are too
    /// few to be worth a pilot.
    pub photons: [u128; 2],
}

impl Session {
    /// Estimates what a render needs. Traces a pilot where a setting asks for many light paths.
    pub fn memory(&self) -> Memory {
        let photons = match self.settings.integrator {
            IntegratorKind::Path => [0; 2],
            IntegratorKind::PhotonMap => {
                PhotonMapper::expected_photons(self.task()).map(|n| u128::from(n) * PHOTON as u128)
            }
        };
        Memory { film: self.film_memory(), photons }
    }

    fn film_memory(&self) -> u128 {
        let [_, _, width, height] = self.view.film.crop;
        let pixels = u128::from(width) * u128::from(height);
        let film = pixels * (SUM * (STRIDE + 1 + Aov::numbers_of(&self.view.aovs))) as u128;
        let shared = if self.may_share() { pixels * SHARED_BYTES as u128 } else { 0 };
        let noise = if self.may_follow_noise() { pixels * NOISE_BYTES as u128 } else { 0 };
        film + film.min(WAITING_BYTES as u128) + shared + noise
    }

    /// Whether pixels may take as many samples as their noise asks for.
    fn may_follow_noise(&self) -> bool {
        self.settings.integrator == IntegratorKind::PhotonMap && self.settings.camera_samples.0.is_none()
    }

    /// Whether samples could share light: before a pilot has chosen, where no setting is against it.
    fn may_share(&self) -> bool {
        let s = &self.settings;
        s.integrator == IntegratorKind::PhotonMap
            && s.indirect != Indirect::Density
            && s.gather_radius != Pixels(Some(0.0))
            && !self.facts.media
    }

    /// Refuses a render that would not fit into the memory that is free now.
    ///
    /// # Errors
    /// [`Error::Memory`] with the setting that wants more than there is.
    pub fn check_memory(&self) -> Result<(), Error> {
        let free = available();
        let [_, _, width, height] = self.view.film.crop;
        let film = format!("a film of {width} × {height} pixels (--size, --crop)");
        refuse(film, self.film_memory(), free)?;
        if self.settings.integrator == IntegratorKind::Path {
            return Ok(());
        }
        let named = |name: &str, count: Count| format!("setting `{name}` = {count}");
        let s = &self.settings;
        if let (true, Count::Paths(n)) = (self.facts.media, s.volume_photons) {
            // One collision a path: most leave more.
            refuse(named("volume_photons", s.volume_photons), u128::from(n) * VOLUME_PHOTON as u128, free)?;
        }
        let counts = [("photons", s.photons), ("caustic_photons", s.caustic_photons)];
        for ((name, count), needed) in counts.into_iter().zip(self.memory().photons) {
            refuse(named(name, count), needed, free)?;
        }
        Ok(())
    }
}

fn refuse(what: String, needed: u128, free: u128) -> Result<(), Error> {
    if needed <= free { Ok(()) } else { Err(Error::Memory { what, needed, free }) }
}
