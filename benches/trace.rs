//! Photon tracing in the Cornell box. Throughput is stored photons, on one thread.

mod support;

use caustica::photon::trace::{TraceJob, trace};
use caustica::transport::Owner;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

fn tracing(c: &mut Criterion) {
    let scene = support::cornell(256).scene;
    let pool = support::one_thread();
    let mut group = c.benchmark_group("trace");
    for (name, next_event) in [("next_event", true), ("all", false)] {
        let job = TraceJob {
            beams: false,
            all: false,

            glints: false,
            focused: false,
            key: 1,
            paths: 100_000,
            owner: Owner::GlobalMap,
            next_event,
            glossy: 0.2,
            caustic_map: true,
            max_depth: u32::MAX,
        };
        let stored = trace(&scene, &job).photons.len();
        group.throughput(Throughput::Elements(stored as u64)).sample_size(10);
        group.bench_function(name, |b| b.iter_with_large_drop(|| pool.install(|| trace(&scene, &job))));
    }
    group.finish();
}

criterion_group!(benches, tracing);
criterion_main!(benches);
