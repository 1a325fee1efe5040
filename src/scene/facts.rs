//! What a scene needs of the renderer. Nothing here depends on settings: each integrator derives its own
//! plan from these facts and its settings.

use super::Scene;
use crate::bsdf::Nature;
use crate::emitter::Emitter;
use crate::medium::Medium;

/// Facts of a compiled scene, gathered once.
#[derive(Clone, Debug, PartialEq)]
pub struct Facts {
    /// There is an emitter, or a medium that emits. Without one the picture is black.
    pub lit: bool,
    /// More than one emitter: a random number decides which one is sampled.
    pub many_lamps: bool,
    /// The sky shines, or an area lamp larger than 2 % of the squared scene radius: worth looking for with
    /// scattered rays as well as by next event estimation.
    pub large_lamps: bool,
    /// A material has a perfectly specular lobe.
    pub specular: bool,
    /// Least and greatest roughness α of all lobes that are not perfectly specular; a diffuse lobe counts
    /// as the roughest. `None` without such lobes.
    pub roughness: Option<[f32; 2]>,
    /// A material has several lobes: a random number decides which one scatters.
    pub many_lobes: bool,
    /// Light passes through some surfaces.
    pub transmission: bool,
    /// Shadow rays look through masks and index-matched boundaries.
    pub transparent_shadows: bool,
    /// Something fills a part of space. Without media, nothing about them is ever computed.
    pub media: bool,
    /// Some of it scatters light.
    pub media_scatter: bool,
    /// Some of it shines.
    pub media_emit: bool,
    /// Light comes from infinity.
    pub environment: bool,
    /// There are textures.
    pub textured: bool,
    /// Groups are placed by instances.
    pub instances: bool,
}

impl Facts {
    /// Looks at every material and emitter of `scene`.
    pub fn of(scene: &Scene) -> Self {
        let natures = || scene.materials.iter().map(|m| m.nature());
        let large = |e: &Emitter| e.visible_area() > 0.02 * scene.sphere.radius * scene.sphere.radius;
        let environment = !scene.environments.is_empty();
        let widened = |a: [f32; 2], b: [f32; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        Self {
            lit: !scene.emitters.is_empty() || scene.media.iter().any(|m| m.emits()),
            many_lamps: scene.emitters.len() > 1,
            large_lamps: environment || scene.emitters.iter().any(large),
            specular: natures().any(|n| n.delta),
            roughness: natures().filter_map(|n| n.smooth).reduce(widened),
            many_lobes: scene.materials.iter().any(|m| m.chooses_lobes()),
            transmission: natures().any(|n| n.transmits),
            transparent_shadows: scene.materials.iter().any(|m| m.passes_shadow_rays()),
            media: !scene.media.is_empty(),
            media_scatter: scene.media.iter().any(Medium::scatters),
            media_emit: scene.media.iter().any(Medium::emits),
            environment,
            textured: !scene.textures.0.is_empty(),
            instances: !scene.geometry.instances.is_empty(),
        }
    }

    /// A lobe reflects or refracts like a mirror or is smoother than roughness `glossy`: it throws caustics.
    pub fn sharper_than(&self, glossy: f32) -> bool {
        Nature { delta: self.specular, smooth: self.roughness, ..Nature::default() }.sharper_than(glossy)
    }

    /// A lobe is at least as rough as `glossy`: photons can be stored there.
    pub fn as_rough_as(&self, glossy: f32) -> bool {
        self.roughness.is_some_and(|[_, greatest]| greatest >= glossy)
    }
}
