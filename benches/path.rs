//! A small path-traced picture of the Cornell box, on one thread. Throughput is camera samples.

mod support;

use caustica::film::Pixels;
use caustica::render::{Budget, render};
use caustica::scene::{Plan, Settings};
use caustica::settings::IntegratorKind;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

fn path(c: &mut Criterion) {
    let (side, passes) = (64u32, 16u32);
    let scene = support::cornell(side);
    let settings = Settings { integrator: IntegratorKind::Path, ..Settings::default() };
    let plan = Plan::new(&scene, &settings);
    let pool = support::one_thread();
    let mut group = c.benchmark_group("path");
    group.throughput(Throughput::Elements(u64::from(side * side * passes))).sample_size(10);
    group.bench_function("cornell", |b| {
        b.iter(|| {
            let budget = Budget { passes: Some(passes), time: None, error: None, interrupt: None };
            let pixels = Pixels::new((side * side) as usize);
            pool.install(|| render(&scene, &plan, &settings, budget, pixels, 0, &mut |_| ()))
        });
    });
    group.finish();
}

criterion_group!(benches, path);
criterion_main!(benches);
