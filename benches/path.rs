//! Path tracing a small picture of the Cornell box, on one thread. Throughput is camera samples.

mod support;

use caustica::film::Pixels;
use caustica::integrator::Task;
use caustica::render::{Budget, render};
use caustica::settings::{IntegratorKind, Settings};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

fn path(c: &mut Criterion) {
    let (side, passes) = (64u32, 16u32);
    let compiled = support::cornell(side);
    let settings = Settings { integrator: IntegratorKind::Path, ..Settings::default() };
    let task =
        Task { scene: &compiled.scene, facts: &compiled.facts, view: &compiled.view, settings: &settings };
    let pool = support::one_thread();
    let mut group = c.benchmark_group("path");
    group.throughput(Throughput::Elements(u64::from(side * side * passes))).sample_size(10);
    group.bench_function("cornell", |b| {
        b.iter(|| {
            let budget = Budget { passes: Some(passes), time: None, error: None, interrupt: None };
            let pixels = Pixels::new((side * side) as usize);
            pool.install(|| render(task, budget, pixels, 0, &mut |_| ()))
        });
    });
    group.finish();
}

criterion_group!(benches, path);
criterion_main!(benches);
