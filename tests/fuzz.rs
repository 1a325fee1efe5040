//! Every input of `tests/fuzz-corpus` goes through the target of `fuzz/` that its folder is named for:
//! no panic, no more memory than stated there, and an end. In a program of its own, because the
//! allocator counts.
#![allow(clippy::unwrap_used)]

#[path = "../fuzz/src/memory.rs"]
mod memory;
#[path = "../fuzz/src/targets.rs"]
mod targets;

use std::path::Path;
use std::time::{Duration, Instant};

#[global_allocator]
static MEMORY: memory::Counting = memory::Counting;

/// Far above what the slowest input takes (a hundred milliseconds), on a busy machine too.
const LONGEST: Duration = Duration::from_secs(20);

// One test: memory is counted for the whole process.
#[test]
fn the_corpus_is_harmless() {
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
