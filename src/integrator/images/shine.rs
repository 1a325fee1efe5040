//! What the lamps send to a film position through specular surfaces alone.

use super::super::Task;
use super::{LONGEST, RAREST};
use crate::bsdf::Transport;
use crate::math::{Color, Ray};
use crate::sampling::Sampler;
use crate::spectrum::luminance;
use crate::transport::Vertex;
use crate::transport::walk::{self, Lamps};

/// How often a path follows all ways on instead of choosing one.
const SPLITS: u32 = 8;

/// A camera path so far.
struct Way {
    ray: Ray,
    throughput: Color,
    /// About how many paths of so many take it that choose one way at each surface.
    chance: f32,
    /// Rays, the next one included.
    depth: u32,
    /// It met a surface.
    seen: bool,
}

/// What a camera ray sees of lamps.
#[derive(Clone, Copy, Debug)]
pub struct Shine {
    /// Radiance.
    pub light: Color,
    /// Mean square of its luminance by paths that choose one way at each surface.
    pub square: f32,
    /// Least chance of a way.
    pub rarest: f32,
    /// That were traced.
    pub rays: u64,
}

/// What lamps that have a surface send along a camera ray and whatever it becomes in mirrors and glass, by paths of
/// [`LONGEST`] segments at most and a chance of [`RAREST`] at least. Paths split instead of choosing by chance, so that
/// reflections in glass are not missed. Light is multiplied by what `factor` makes of the chance of its way.
pub fn shine(task: Task<'_>, ray: Ray, sampler: &mut Sampler, factor: impl Fn(f32) -> f32) -> Shine {
    let Task { scene, settings, .. } = task;
    let transparent = settings.hide_emitters && task.view.hidden_lamps_are_transparent;
    let mut all = Shine { light: Color::ZERO, square: 0.0, rarest: 1.0, rays: 0 };
    let mut splits = SPLITS;
    let mut ways = vec![Way { ray, throughput: Color::ONE, chance: 1.0, depth: 1, seen: false }];
    while let Some(mut way) = ways.pop() {
        if way.depth > settings.max_depth.0.min(LONGEST) || way.chance < RAREST {
            continue;
        }
        all.rays += 1;
        all.rarest = all.rarest.min(way.chance);
        let Some(hit) = scene.geometry.closest(&way.ray) else { continue };
        let lamps = if transparent && !way.seen { Lamps::Transparent } else { Lamps::Solid };
        let s = scene.surface(&way.ray, &hit);
        if walk::passes(scene, &mut way.ray, &hit, &s, lamps) {
            ways.push(way);
            continue;
        }
        if way.seen || !settings.hide_emitters {
            let light = way.throughput * scene.emitted(&s, -way.ray.d) * factor(way.chance);
            all.light += light;
            let luminance = luminance(light);
            all.square += luminance * luminance / way.chance;
        }
        let vertex = Vertex::new(scene, &s, -way.ray.d);
        let through = vertex.closure.transparency();
        let deltas = vertex.closure.deltas(vertex.wi, Transport::Radiance);
        let straight = (through > 0.0).then_some((-vertex.wi, Color::splat(through), through, scene.passage));
        let solid = 1.0 - through;
        let lobes = deltas.iter().map(|l| (l.wo, l.weight * solid, l.power() * solid, 1));
        let on: Vec<_> = straight.into_iter().chain(lobes).filter(|(_, _, share, _)| *share > 0.0).collect();
        let total: f32 = on.iter().map(|(_, _, share, _)| share).sum();
        let mut pick = sampler.random() * total;
        let split = on.len() < 2 || splits > 0;
        splits -= u32::from(split && on.len() > 1);
        for (wo, weight, share, segments) in on {
            let chosen = split || (0.0..share).contains(&pick);
            pick -= share;
            if chosen {
                let throughput = way.throughput * weight * if split { 1.0 } else { total / share };
                ways.push(Way {
                    ray: s.leave(s.frame.to_world(wo)),
                    throughput,
                    chance: way.chance * share,
                    depth: way.depth + segments,
                    seen: true,
                });
            }
        }
    }
    all
}
