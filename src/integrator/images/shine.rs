//! What the lamps send to a film position through specular surfaces alone.

use super::super::Task;
use super::LONGEST;
use crate::bsdf::Transport;
use crate::math::{Color, Ray};
use crate::sampling::Sampler;
use crate::transport::Vertex;
use crate::transport::walk::{self, Lamps};

/// How often a path follows all ways on instead of choosing one.
const SPLITS: u32 = 8;

/// A camera path so far.
struct Way {
    ray: Ray,
    throughput: Color,
    /// Rays, the next one included.
    depth: u32,
    /// It met a surface.
    seen: bool,
}

/// Radiance of lamps that have a surface, along a camera ray and whatever it becomes in mirrors and glass, by paths of
/// [`LONGEST`] segments at most. Paths split instead of choosing by chance, so that reflections in glass are not missed.
/// Counts rays.
pub fn shine(task: Task<'_>, ray: Ray, sampler: &mut Sampler, rays: &mut u64) -> Color {
    let Task { scene, settings, .. } = task;
    let transparent = settings.hide_emitters && task.view.hidden_lamps_are_transparent;
    let mut light = Color::ZERO;
    let mut splits = SPLITS;
    let mut ways = vec![Way { ray, throughput: Color::ONE, depth: 1, seen: false }];
    while let Some(mut way) = ways.pop() {
        if way.depth > settings.max_depth.0.min(LONGEST) {
            continue;
        }
        *rays += 1;
        let Some(hit) = scene.geometry.closest(&way.ray) else { continue };
        let lamps = if transparent && !way.seen { Lamps::Transparent } else { Lamps::Solid };
        let s = scene.surface(&way.ray, &hit);
        if walk::passes(scene, &mut way.ray, &hit, &s, lamps) {
            ways.push(way);
            continue;
        }
        if way.seen || !settings.hide_emitters {
            light += way.throughput * scene.emitted(&s, -way.ray.d);
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
                    depth: way.depth + segments,
                    seen: true,
                });
            }
        }
    }
    light
}
