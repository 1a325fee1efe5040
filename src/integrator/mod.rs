//! What computes a camera sample.
//!
//! The contract: a render is passes 0..n. `begin_pass` makes what all pixels of a pass share (photon
//! maps); `sample` then gives one camera sample of one pixel. Both depend on the scene, the settings
//! and the pass number only, so passes can run anywhere, be resumed, and give the same bytes.

mod direct;
pub mod images;
mod path;
pub mod photon_map;
mod shadows;
mod sight;
mod volpath;

pub use path::PathTracer;
pub use photon_map::PhotonMapper;
pub use volpath::VolumePathTracer;

use self::images::Images;
use crate::film::{Radiance, Rejected};
use crate::math::{Color, Ray, Vec3};
use crate::photon::Gather;
use crate::photon::volume::Found;
use crate::sampling::Sampler;
use crate::scene::{Facts, Scene, View};
use crate::settings::Settings;

/// What to render: a scene, how it is seen and how it is computed.
#[derive(Clone, Copy, Debug)]
pub struct Task<'a> {
    /// The compiled scene.
    pub scene: &'a Scene,
    /// What the scene needs.
    pub facts: &'a Facts,
    /// Camera and film.
    pub view: &'a View,
    /// The integrator and its settings.
    pub settings: &'a Settings,
}

/// Scratch and counters of one thread's share of a pass.
#[derive(Debug, Default)]
pub struct Scratch {
    /// Rays traced.
    pub rays: u64,
    /// Those of them that looked for edges around places where surface maps were read.
    pub edge_rays: u64,
    /// Of photon lookups.
    pub gather: Gather,
    /// Of photons in media.
    pub volume: Found,
    /// Of path tracing.
    pub wave: path::Wave,
    /// Of camera paths that go on behind the first rough surface.
    pub onward: photon_map::Onward,
}

/// Counters of what a pass prepared.
#[derive(Clone, Copy, Debug, Default)]
pub struct PassStats {
    /// Light paths started.
    pub light_paths: u64,
    /// The deadline passed before all light paths were traced.
    pub cut: bool,
    /// Photons stored.
    pub photons: u64,
    /// Rays of light paths.
    pub photon_rays: u64,
    /// Memory of the photon maps.
    pub map_bytes: u64,
    /// Photons that were not finite, and were left out.
    pub rejected: Rejected,
    /// Seconds of tracing photons and of building maps.
    pub trace_seconds: f64,
    /// Of building maps.
    pub build_seconds: f64,
    /// Search radii of the pass, 0 without a map.
    pub radius: f32,
    /// The same for the caustic map.
    pub caustic_radius: f32,
}

/// A camera ray, the numbers of its path, and what came of it.
#[derive(Clone, Copy, Debug)]
pub struct CameraSample {
    /// From the sensor.
    pub ray: Ray,
    /// Random numbers of the path, those of the film position taken.
    pub sampler: Sampler,
    /// Density of other samples that find what lamps with a surface send it through specular surfaces alone, over its own.
    pub rivals: f32,
    /// What the ray brings.
    pub out: Radiance,
    /// Where its indirect light comes from, if samples nearby may share that.
    pub diffuse: Option<DiffusePoint>,
}

impl CameraSample {
    /// Before its path.
    #[inline(always)]
    pub fn new(ray: Ray, sampler: Sampler) -> Self {
        Self { ray, sampler, rivals: 0.0, out: Radiance::default(), diffuse: None }
    }
}

/// A point of a diffuse surface at the end of a camera path.
#[derive(Clone, Copy, Debug)]
pub struct DiffusePoint {
    /// In the world.
    pub p: Vec3,
    /// Unit shading normal on the side that is seen.
    pub n: Vec3,
    /// Segments of the camera path.
    pub depth: u32,
    /// About the distance to what the next pixel sees of the surface.
    pub apart: f32,
    /// What the indirect light of the sample was multiplied by, after the mean over the hemisphere by the cosine.
    pub scale: Color,
}

/// See the module's contract.
pub trait Integrator: Sync {
    /// What all pixels of a pass share.
    type Pass: Sync + Send;

    /// How many pairs of random numbers of a camera path are low-discrepancy points.
    const STRATIFIED_PAIRS: u32;

    /// Search radii of pass 0 (global, caustic), 0 without a map.
    fn first_radii(&self) -> [f32; 2] {
        [0.0; 2]
    }

    /// Camera samples a pixel in each pass.
    fn samples_a_pass(&self) -> u32 {
        1
    }

    /// Whether noisy pixels may take more samples than others once the first passes have told which they are.
    fn follows_noise(&self) -> bool {
        false
    }

    /// Lamps that the camera sees smaller than a pixel, for which pixels take extra samples; `None` where there are none.
    fn images(&self) -> Option<&Images> {
        None
    }

    /// Pixels within which samples of a pass share indirect light, if they do.
    fn sharing(&self, _pass: u32) -> Option<f32> {
        None
    }

    /// Prepares pass `pass`, counted from 0.
    fn begin_pass(&self, pass: u32) -> (Self::Pass, PassStats);

    /// Fills `out` of each sample. What a sample becomes does not depend on those it comes with.
    fn sample(&self, pass: &Self::Pass, samples: &mut [CameraSample], scratch: &mut Scratch);
}
