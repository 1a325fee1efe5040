//! Photons and beams in a medium: building their maps on all threads, and finding them along segments through a cube,
//! about a hundred each, on one thread. Half lie evenly, half in a cone towards a focus. Throughput is photons, beams,
//! or segments.

use caustica::math::Vec3;
use caustica::photon::volume::{Beam, BeamMap, PointMap, Segment, VolumePhoton};
use caustica::sampling::CounterRng;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

const PHOTONS: usize = 1_000_000;
const BEAMS: usize = 100_000;
const SEGMENTS: usize = 4096;

/// Radii with which segments find a hundred on average.
const RADIUS: f32 = 0.0056;
const BEAM_RADIUS: f32 = 0.0005;

/// A place in the unit cube and a direction there.
fn way(rng: &mut CounterRng) -> (Vec3, Vec3) {
    let focus = Vec3::new(0.5, 0.5, 0.2);
    let mut float = || rng.next_f32();
    let even = float() < 0.5;
    let p = Vec3::new(float(), float(), float());
    if even {
        let d = Vec3::new(float(), float(), float()) - 0.5;
        return (p, d.normalize_or(Vec3::X));
    }
    let across = Vec3::new(float() - 0.5, float() - 0.5, 0.0) * 0.6;
    let d = -(Vec3::Z + across);
    (focus - d * (p.z * p.z * 0.8), d.normalize())
}

fn segments() -> Vec<Segment> {
    let at = |i: usize| i as f32 / 63.0;
    let eye = Vec3::new(0.5, -1.5, 0.5);
    let to = |i: usize| Vec3::new(at(i % 64), 0.0, at(i / 64)) - eye;
    (0..SEGMENTS).map(|i| Segment::new(eye + to(i), to(i).normalize(), 1.0)).collect()
}

fn volume(c: &mut Criterion) {
    let mut rng = CounterRng::new(1, 0);
    let mut ways = |n: usize| (0..n).map(|_| way(&mut rng)).collect::<Vec<_>>();
    let flux = caustica::math::Color::ONE;
    let photons: Vec<VolumePhoton> = ways(PHOTONS)
        .into_iter()
        .map(|(p, d)| VolumePhoton { p, flux, wi: -d, medium: 0, depth: 1 })
        .collect();
    let beams: Vec<Beam> =
        ways(BEAMS).into_iter().map(|(o, d)| Beam { o, d, length: 0.5, flux, medium: 0, depth: 1 }).collect();
    let segments = segments();
    let mut group = c.benchmark_group("volume");
    group.sample_size(10);
    group.throughput(Throughput::Elements(PHOTONS as u64));
    group.bench_function("points/build", |b| b.iter_with_large_drop(|| PointMap::build(&photons, RADIUS)));
    group.throughput(Throughput::Elements(BEAMS as u64));
    group.bench_function("beams/build", |b| b.iter_with_large_drop(|| BeamMap::build(&beams, BEAM_RADIUS)));
    let (points, lines) = (PointMap::build(&photons, RADIUS), BeamMap::build(&beams, BEAM_RADIUS));
    eprintln!("{} bytes a photon, {} a beam", points.bytes() / PHOTONS, lines.bytes() / BEAMS);
    group.throughput(Throughput::Elements(SEGMENTS as u64));
    let (mut near, mut crossings) = (Vec::new(), Vec::new());
    group.bench_function("points/along", |b| {
        b.iter(|| {
            let count = |s| {
                points.along(s, &mut near);
                near.len()
            };
            segments.iter().map(count).sum::<usize>()
        });
    });
    group.bench_function("beams/along", |b| {
        b.iter(|| {
            let count = |s| {
                lines.along(s, &mut crossings);
                crossings.len()
            };
            segments.iter().map(count).sum::<usize>()
        });
    });
    group.finish();
}

criterion_group!(benches, volume);
criterion_main!(benches);
