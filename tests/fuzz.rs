//! What counts memory, in a program of its own because the allocator counts.
//!
//! Every input of `tests/fuzz-corpus` goes through the target of `fuzz/` that its folder is named for:
//! no panic, no more memory than stated there, and an end.
#![allow(clippy::unwrap_used)]

#[path = "../fuzz/src/memory.rs"]
mod memory;
#[path = "../fuzz/src/targets.rs"]
mod targets;

use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use caustica::render::Budget;
use caustica::session::{Options, Session};

#[global_allocator]
static MEMORY: memory::Counting = memory::Counting;

/// Far above what the slowest input takes (a hundred milliseconds), on a busy machine too.
const LONGEST: Duration = Duration::from_secs(20);

/// Held by each test: memory is counted for the whole process.
static MEMORY_COUNTED: Mutex<()> = Mutex::new(());

#[test]
fn the_corpus_is_harmless() {
    let _alone = MEMORY_COUNTED.lock().unwrap();
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz-corpus");
    for target in targets::TARGETS {
        // What a target of text to picture does begins as the reader's does.
        let folders = [target.name, target.name.trim_start_matches("render_")];
        let mut inputs = Vec::new();
        for folder in folders {
            let Ok(entries) = std::fs::read_dir(corpus.join(folder)) else { continue };
            inputs.extend(entries.map(|entry| entry.unwrap().path()));
        }
        inputs.sort();
        inputs.dedup();
        assert!(!inputs.is_empty(), "no corpus for {}", target.name);
        for input in inputs {
            let bytes = std::fs::read(&input).unwrap();
            let begun = Instant::now();
            targets::run(target.name, &bytes);
            assert!(begun.elapsed() < LONGEST, "{}: {:?}", input.display(), begun.elapsed());
        }
    }
}

/// Inputs of the corpus with bytes changed, cut out, doubled and swapped, two or three at once.
#[test]
fn mutations_of_the_corpus_are_harmless() {
    use proptest::prelude::*;
    use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
    let _alone = MEMORY_COUNTED.lock().unwrap();
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz-corpus");
    for target in targets::TARGETS {
        let Ok(entries) = std::fs::read_dir(corpus.join(target.name)) else { continue };
        let mut files: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
        files.sort();
        let seeds: Vec<Vec<u8>> = files.iter().map(|file| std::fs::read(file).unwrap()).collect();
        let change = (any::<prop::sample::Index>(), any::<prop::sample::Index>(), 0u8..5, any::<u8>());
        let mutation = (any::<prop::sample::Index>(), proptest::collection::vec(change, 1..4));
        let config = Config { cases: 150, failure_persistence: None, ..Config::default() };
        let rng = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
        let outcome = TestRunner::new_with_rng(config, rng).run(&mutation, |(seed, changes)| {
            let mut bytes = seed.get(&seeds).clone();
            for (at, other, kind, value) in changes {
                if bytes.is_empty() {
                    break;
                }
                let (i, j) = (at.index(bytes.len()), other.index(bytes.len()));
                let (low, high) = (i.min(j), i.max(j));
                match kind {
                    0 => bytes[i] = value,
                    1 => bytes[i] ^= 1 << (value % 8),
                    2 => drop(bytes.drain(low..high)),
                    3 => bytes.extend_from_within(low..high),
                    _ => bytes.swap(i, j),
                }
            }
            bytes.truncate(1 << 16);
            targets::run(target.name, &bytes);
            Ok(())
        });
        assert!(outcome.is_ok(), "{}: {}", target.name, outcome.unwrap_err());
    }
}

/// What a render is said to need beforehand, it holds at its peak: no more, and not much less. The estimate
/// decides whether a render is refused.
#[test]
fn photons_take_the_memory_that_was_told() {
    let _alone = MEMORY_COUNTED.lock().unwrap();
    let settings = [("photons", "stored:1000000"), ("radius", "0.05")];
    let options = Options {
        size: Some([16, 16]),
        settings: settings.map(|(name, value)| (name.to_owned(), value.to_owned())).to_vec(),
        ..Options::default()
    };
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell-diffuse.xml");
    let session = Session::open(scene, &options).unwrap();
    let told = session.memory();
    let mut stored = 0;
    let held = memory::most_held(|| {
        stored = session.render(Budget::passes(1), &mut |_| {}).statistics.photons_stored;
    });
    let expected = (told.film + told.photons.iter().sum::<u128>()) as usize;
    assert!(stored > 900_000, "{stored}");
    assert!(held <= expected && held * 3 > expected * 2, "{held} bytes held, {expected} told");
    // 50 bytes while photons are sorted into columns of their numbers, the grid, and what paths in flight hold.
    let each = held.saturating_sub(told.film as usize) as f64 / stored as f64;
    assert!(each <= 64.0, "{each} bytes a photon");
    println!("{each:.1} bytes a photon");
}
