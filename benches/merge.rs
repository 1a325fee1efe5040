//! Adding parts of a render of the Cornell box to their sum, one after another. Throughput is bytes of parts.

mod support;

use std::hint::black_box;
use std::path::Path;

use caustica::render::{Budget, Checkpoint, Head};
use caustica::session::Merge;
use caustica::settings::IntegratorKind;
use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};

fn merge(c: &mut Criterion) {
    let passes = 4;
    let mut session = support::cornell(512);
    session.settings.integrator = IntegratorKind::Path;
    let outcome = session.render_range(0..passes, Budget::default(), &mut |_| ());
    let bytes = session.part(&outcome).expect("its passes are whole");
    let Checkpoint { head, pixels } = Checkpoint::decode(&bytes).expect("just written");
    let mut group = c.benchmark_group("merge");
    group.throughput(Throughput::Bytes(bytes.len() as u64)).sample_size(10);
    let mut sum = Merge::new();
    let mut first = 0;
    // The same passes under other numbers.
    let mut part = || {
        first += passes;
        (first, Checkpoint::encode(&Head { first, ..head.clone() }, &pixels))
    };
    group.bench_function("part", |b| {
        b.iter_batched(
            &mut part,
            |(first, bytes)| black_box(&mut sum).add(Path::new(&first.to_string()), &bytes).expect("a part"),
            BatchSize::PerIteration,
        );
    });
    group.finish();
}

criterion_group!(benches, merge);
criterion_main!(benches);
