//! Shadow rays from surfaces and from media.

use super::{VolumePathTracer, Walk};
use crate::bsdf::{Event, Range};
use crate::emitter::DirectSample;
use crate::film::Layer;
use crate::integrator::direct::{Candidate, power_heuristic};
use crate::integrator::{CameraSample, Scratch};
use crate::math::{Color, Vec2, Vec3};
use crate::medium::{Carried, MediumId, Phase};
use crate::transport::media::Way;
use crate::transport::{Vertex, ray_to};

/// A path where it scatters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scattering {
    pub medium: Option<MediumId>,
    pub carried: Carried,
    /// Where the light belongs.
    pub layer: Layer,
    /// Share of it that is counted here.
    pub share: f32,
}

impl VolumePathTracer<'_> {
    /// The lamp's light that the phase function sends to `wi`.
    pub(super) fn light_medium(
        &self,
        at: &Scattering,
        phase: &Phase,
        p: Vec3,
        wi: Vec3,
        (pick, u): (f32, Vec2),
        sample: &mut CameraSample,
        scratch: &mut Scratch,
    ) {
        if at.share <= 0.0 || !at.carried.alive() {
            return;
        }
        let Some(light) = self.scene.sample_direct(p, pick, u) else { return };
        let f = Color::splat(phase.eval(p, wi, light.dir));
        let pdf = phase.pdf(p, wi, light.dir);
        let way = Way { ray: ray_to(p, &light), gap: 0.0, medium: at.medium };
        self.connect(at, f, pdf, &way, &light, sample, scratch);
    }

    /// The lamp's light that a surface scatters: of rough and of glossy lobes apart, for the layers.
    pub(super) fn light_surface(
        &self,
        walk: &Walk,
        vertex: &Vertex<'_>,
        sample: &mut CameraSample,
        scratch: &mut Scratch,
    ) {
        let lobes = [(Range::rough(self.glossy), Event::Smooth), (Range::glossy(self.glossy), Event::Glossy)];
        let mut carried = walk.carried;
        carried.reach = 1.0;
        for (range, event) in lobes {
            let present = vertex.closure.has_smooth(vertex.wi, range);
            if !present && event != Event::Smooth {
                continue;
            }
            let (pick, u) = self.lamp_numbers(&mut sample.sampler);
            if !present {
                continue;
            }
            let chosen = Candidate::choose(self.scene, vertex, range, true, (pick, u));
            let Some(Candidate { light, f, pdf }) = chosen else { continue };
            let layer = walk.class.after_camera_event(event).layer();
            let at = Scattering { medium: walk.medium, carried, layer, share: 1.0 };
            let way = Way::from_surface(self.scene, vertex.surface, walk.medium, &light);
            self.connect(&at, f, pdf, &way, &light, sample, scratch);
        }
    }

    /// Adds `f` times what arrives of the light, weighed against a scattered ray of density `pdf` that comes as far.
    fn connect(
        &self,
        at: &Scattering,
        f: Color,
        pdf: f32,
        way: &Way,
        light: &DirectSample,
        sample: &mut CameraSample,
        scratch: &mut Scratch,
    ) {
        if f.max_element() <= 0.0 {
            return;
        }
        let passage = way.passage(self.scene, light, &mut sample.sampler, &mut scratch.rays);
        if passage.left.max_element() <= 0.0 {
            return;
        }
        let weight = if light.pdf > 0.0 {
            power_heuristic(light.pdf, pdf * at.carried.probability(passage.density))
        } else {
            1.0
        };
        let value = at.carried.weight * f * light.value * passage.left;
        sample.out.add(at.layer, value * (weight * at.share));
    }
}
