//! Rays through the Cornell box and through a million triangles, on one thread. Throughput is rays.

mod support;

use std::hint::black_box;

use caustica::math::{Ray, Vec2};
use caustica::sampling::{Sampler, warp};
use caustica::session::Session;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

const SIDE: u32 = 256;

/// Camera rays, one cosine-distributed ray from each point they meet, and one towards a lamp.
fn families(session: &Session) -> [Vec<Ray>; 3] {
    let (scene, view) = (&session.scene, &session.view);
    let (mut primary, mut diffuse, mut shadow) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..SIDE * SIDE {
        let mut sampler = Sampler::new(7, i);
        let film = Vec2::new((i % SIDE) as f32 + 0.5, (i / SIDE) as f32 + 0.5) / SIDE as f32;
        let ray = view.sensor.ray(film, sampler.next_2d());
        primary.push(ray);
        let Some(hit) = scene.geometry.closest(&ray) else { continue };
        let s = scene.surface(&ray, &hit);
        diffuse.push(s.leave(s.frame.to_world(warp::cosine_hemisphere(sampler.next_2d()))));
        if let Some(light) = scene.sample_direct(s.p, sampler.next_1d(), sampler.next_2d())
            && let Some(target) = light.target
        {
            let o = s.origin(light.dir);
            shadow.push(Ray { o, d: target - o, tmax: 1.0 });
        }
    }
    [primary, diffuse, shadow]
}

fn rays(c: &mut Criterion) {
    for (name, session) in [("cornell", support::cornell(SIDE)), ("hills", support::hills())] {
        let [primary, diffuse, shadow] = families(&session);
        let scene = session.scene;
        let mut group = c.benchmark_group(format!("rays/{name}"));
        for (kind, rays) in [("primary", &primary), ("diffuse", &diffuse)] {
            group.throughput(Throughput::Elements(rays.len() as u64)).sample_size(20);
            group.bench_function(kind, |b| {
                b.iter(|| rays.iter().filter(|r| scene.geometry.closest(black_box(r)).is_some()).count());
            });
        }
        group.throughput(Throughput::Elements(shadow.len() as u64)).sample_size(20);
        group.bench_function("shadow", |b| {
            b.iter(|| shadow.iter().filter(|r| scene.geometry.occluded(black_box(r))).count());
        });
        group.finish();
    }
}

criterion_group!(benches, rays);
criterion_main!(benches);
