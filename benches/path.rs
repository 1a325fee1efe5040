//! Path tracing small pictures of the Cornell box and of smoke in a grid, on one thread. Throughput is camera samples.

mod support;

use caustica::render::Budget;
use caustica::settings::IntegratorKind;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

fn path(c: &mut Criterion) {
    let (side, passes) = (64u32, 16u32);
    let pool = support::one_thread();
    let mut group = c.benchmark_group("path");
    group.throughput(Throughput::Elements(u64::from(side * side * passes))).sample_size(10);
    for (name, mut session) in [("cornell", support::cornell(side)), ("smoke", support::smoke(side))] {
        session.settings.integrator = IntegratorKind::Path;
        group.bench_function(name, |b| {
            b.iter(|| pool.install(|| session.render(Budget::passes(passes), &mut |_| ())));
        });
    }
    group.finish();
}

criterion_group!(benches, path);
criterion_main!(benches);
