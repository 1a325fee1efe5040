//! Density estimates in a million photons of the Cornell box, with about a hundred photons each and in the
//! order of a render's pixels. One thread; throughput is lookups.

mod support;

use caustica::film::Radiance;
use caustica::math::kernel::KernelKind;
use caustica::math::{Color, Vec2, Vec3};
use caustica::photon::{Estimator, Gather, GatherPoint, PhotonMap, Query};
use caustica::sampling::Sampler;
use caustica::scene::Surface;
use caustica::session::Session;
use caustica::settings::Lookup;
use caustica::transport::Vertex;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

const PHOTONS: usize = 1_000_000;
const FOUND: usize = 100;

/// What the camera sees through every pixel, in squares of eight as a render walks them.
fn places(session: &Session) -> Vec<(Surface, Vec3)> {
    let (scene, view) = (&session.scene, &session.view);
    let side = 256;
    let mut out = Vec::new();
    for block in 0..(side / 8) * (side / 8) {
        for within in 0..64 {
            let x = block % (side / 8) * 8 + within % 8;
            let y = block / (side / 8) * 8 + within / 8;
            let film = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / side as f32;
            let ray = view.sensor.ray(film, Sampler::new(0, 0).next_2d());
            if let Some(hit) = scene.geometry.closest(&ray) {
                out.push((scene.surface(&ray, &hit), -ray.d));
            }
        }
    }
    out
}

fn lookup(c: &mut Criterion) {
    let session = support::cornell(256);
    let places = places(&session);
    let scene = session.scene;
    let photons = support::photons(&scene, PHOTONS);
    let queries = |radius: f32| -> Vec<Query> {
        places.iter().map(|(s, _)| Query { p: s.p, n: s.ng, lift: s.lift, radius }).collect()
    };
    // Photons within `radius`, on average over a sample of the places.
    let mean = |map: &PhotonMap, radius: f32| {
        let mut n = 0usize;
        queries(radius).iter().step_by(17).for_each(|q| map.within(q, &mut |_, _| n += 1));
        n as f32 / queries(radius).iter().step_by(17).count() as f32
    };
    let mut radius = 0.02;
    for _ in 0..4 {
        let map = PhotonMap::build(photons.clone(), 2.0 * radius);
        radius *= (FOUND as f32 / mean(&map, radius)).sqrt();
    }
    let map = PhotonMap::build(photons.clone(), 2.0 * radius);
    eprintln!("radius {radius}: {:.1} photons found on average", mean(&map, radius));

    let mut group = c.benchmark_group("lookup");
    group.throughput(Throughput::Elements(places.len() as u64)).sample_size(20);
    let mut estimates = |name: &str, map: &PhotonMap, lookup: Lookup, radius: f32| {
        let estimator = Estimator::new(KernelKind::Epanechnikov, radius, lookup, FOUND as u32, u32::MAX);
        let mut gather = Gather::default();
        group.bench_function(name, |b| {
            b.iter(|| {
                let mut out = Radiance::default();
                for (s, wi) in &places {
                    let vertex = &Vertex::new(&scene, s, *wi);
                    let side = scene.photon_side(s, *wi);
                    let at = GatherPoint { vertex, side, throughput: Color::ONE, max_photon_depth: u32::MAX };
                    estimator.estimate(map, &at, None, &mut gather, &mut out);
                }
                out
            });
        });
    };
    estimates("radius/estimate", &map, Lookup::Radius, radius);
    let nearest = PhotonMap::build_for_nearest(photons, FOUND, 1.0);
    estimates("nearest/estimate", &nearest, Lookup::Nearest, 1.0);
    let fixed = queries(radius);
    group.bench_function("radius/visit", |b| {
        b.iter(|| {
            let mut sum = 0.0;
            fixed.iter().for_each(|q| map.within(q, &mut |_, d2| sum += d2));
            sum
        });
    });
    let wide = queries(1.0);
    group.bench_function("nearest/find", |b| {
        let (mut hint, mut found) = (0.0, Vec::new());
        b.iter(|| {
            wide.iter().for_each(|q| nearest.nearest(q, FOUND, &mut hint, &mut found));
            found.len()
        });
    });
    group.finish();
}

criterion_group!(benches, lookup);
criterion_main!(benches);
