//! Shadow rays from surfaces and from media.

use super::{VolumePathTracer, Walk};
use crate::bsdf::{Event, Range};
use crate::emitter::DirectSample;
use crate::film::Layer;
use crate::integrator::direct::{AtSurface, Candidate, Receiver, power_heuristic};
use crate::integrator::{CameraSample, Scratch};
use crate::math::{Color, Vec2, Vec3};
use crate::medium::{Carried, MediumId, Phase};
use crate::transport::Vertex;
use crate::transport::media::Way;

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

/// A place in a medium that light of a path comes from along `wi`.
struct InMedium<'a> {
    phase: &'a Phase,
    p: Vec3,
    wi: Vec3,
}

impl Receiver for InMedium<'_> {
    fn place(&self) -> Vec3 {
        self.p
    }

    fn receive(&self, light: &DirectSample) -> Option<(Color, f32)> {
        let f = self.phase.eval(self.p, self.wi, light.dir);
        (f > 0.0).then(|| (Color::splat(f), self.phase.pdf(self.p, self.wi, light.dir)))
    }
}

impl VolumePathTracer<'_> {
    /// The lamp's light that the phase function sends to `wi`.
    pub(super) fn light_medium(
        &self,
        at: &Scattering,
        phase: &Phase,
        p: Vec3,
        wi: Vec3,
        numbers: (f32, Vec2),
        sample: &mut CameraSample,
        scratch: &mut Scratch,
    ) {
        if at.share <= 0.0 || !at.carried.alive() {
            return;
        }
        let receiver = InMedium { phase, p, wi };
        let Some(chosen) = Candidate::choose(self.scene, &receiver, numbers) else { return };
        let way = Way { ray: chosen.light.ray_from(p), gap: 0.0, medium: at.medium };
        self.connect(at, &chosen, &way, sample, scratch);
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
            let receiver = AtSurface { vertex, lobes: range, mis: true };
            let Some(chosen) = Candidate::choose(self.scene, &receiver, (pick, u)) else { continue };
            let layer = walk.class.after_camera_event(event).layer();
            let at = Scattering { medium: walk.medium, carried, layer, share: 1.0 };
            let way = Way::from_surface(self.scene, vertex.surface, walk.medium, &chosen.light);
            self.connect(&at, &chosen, &way, sample, scratch);
        }
    }

    /// Adds what arrives of the light, weighed against a scattered ray that comes as far.
    fn connect(
        &self,
        at: &Scattering,
        Candidate { light, f, pdf }: &Candidate,
        way: &Way,
        sample: &mut CameraSample,
        scratch: &mut Scratch,
    ) {
        let passage = way.passage(self.scene, light, &mut sample.sampler, &mut scratch.rays);
        if passage.left.max_element() <= 0.0 {
            return;
        }
        let weight = if light.pdf > 0.0 {
            power_heuristic(light.pdf, pdf * at.carried.probability(passage.density))
        } else {
            1.0
        };
        let value = at.carried.weight * *f * light.value * passage.left;
        sample.out.add(at.layer, value * (weight * at.share));
    }
}
