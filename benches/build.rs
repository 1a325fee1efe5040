//! Sorting photons into a map, on all threads. Throughput is photons.

mod support;

use caustica::photon::PhotonMap;
use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

fn build(c: &mut Criterion) {
    let scene = support::cornell(256).scene;
    let mut group = c.benchmark_group("build");
    for (count, radius) in [(1_000_000, 0.015f32), (10_000_000, 0.005)] {
        let photons = support::photons(&scene, count);
        group.throughput(Throughput::Elements(photons.len() as u64)).sample_size(10);
        group.bench_with_input(BenchmarkId::from_parameter(count), &photons, |b, photons| {
            let build = |photons| PhotonMap::build(photons, 2.0 * radius);
            b.iter_batched(|| photons.clone(), build, BatchSize::PerIteration);
        });
    }
    group.finish();
}

criterion_group!(benches, build);
criterion_main!(benches);
