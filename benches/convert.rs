//! Writing scenes of more and more shapes, each with a material that the language cannot express, in both languages.
//! Throughput is bytes of the scene that is converted: it must not fall with their number.

use std::fmt::Write;
use std::path::Path;

use caustica_formats::files::Memory;
use caustica_formats::{Read, ReadOptions, read_scene, write_scene};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

/// A pbrt scene of so many meshes of 64 vertices.
fn scene(shapes: usize) -> (Memory, Read) {
    let mut text = String::from("WorldBegin\nLightSource \"infinite\"\n");
    for shape in 0..shapes {
        let _ = writeln!(
            text,
            "Material \"coateddiffuse\" \"float roughness\" {}",
            0.1 + 0.8 / (shape + 1) as f64
        );
        text.push_str("Shape \"trianglemesh\" \"point3 P\" [");
        for vertex in 0..64 {
            let _ = write!(text, " {} {} {}", vertex % 8, vertex / 8, (shape * vertex) % 11);
        }
        text.push_str("] \"integer indices\" [");
        for corner in 0..55 {
            let _ = write!(text, " {corner} {} {}", corner + 1, corner + 9);
        }
        text.push_str("]\n");
    }
    let files = Memory([("s.pbrt".into(), text.into_bytes())].into());
    let read = read_scene(&files, Path::new("s.pbrt"), &ReadOptions::default()).expect("a valid scene");
    (files, read)
}

fn convert(c: &mut Criterion) {
    let mut group = c.benchmark_group("convert");
    for shapes in [250, 1000, 4000] {
        let (files, read) = scene(shapes);
        let bytes = files.0.values().map(Vec::len).sum::<usize>();
        group.throughput(Throughput::Bytes(bytes as u64)).sample_size(10);
        for target in ["made.xml", "made.pbrt"] {
            group.bench_with_input(BenchmarkId::new(target, shapes), &read, |b, read| {
                // The lines of the file are counted anew.
                b.iter_batched(
                    || read.clone(),
                    |read| write_scene(&read, &files, Path::new(target)).expect("it can be written"),
                    criterion::BatchSize::LargeInput,
                );
            });
        }
    }
    group.finish();
}

criterion_group!(benches, convert);
criterion_main!(benches);
