//! Path tracing a small picture of the Cornell box, on one thread. Throughput is camera samples.

mod support;

use caustica::render::Budget;
use caustica::settings::IntegratorKind;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

fn path(c: &mut Criterion) {
    let (side, passes) = (64u32, 16u32);
    let mut session = support::cornell(side);
    session.settings.integrator = IntegratorKind::Path;
    let pool = support::one_thread();
    let mut group = c.benchmark_group("path");
    group.throughput(Throughput::Elements(u64::from(side * side * passes))).sample_size(10);
    group.bench_function("cornell", |b| {
        b.iter(|| pool.install(|| session.render(Budget::passes(passes), &mut |_| ())));
    });
    group.finish();
}

criterion_group!(benches, path);
criterion_main!(benches);
