//! Checkpoints of a render: where they are, what they must agree in, when they are written.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use caustica_formats::image::{atomic_replace, atomic_write};

use super::load::Loaded;
use super::report;
use crate::film::{Filter, Pixels};
use crate::render::{Checkpoint, CheckpointError};

/// Seconds between flushes to the disk. Between them a checkpoint survives the death of the program,
/// but not that of the machine.
const FLUSH_INTERVAL: Duration = Duration::from_secs(10);

/// The checkpoint file of a render.
#[derive(Debug)]
pub struct Saver {
    pub path: PathBuf,
    identity: Vec<(String, String)>,
    /// Pixels that a checkpoint must have.
    pixels: usize,
    flushed: Instant,
    /// Said once; the render goes on, and so do the attempts, each time of a flush.
    failed: bool,
}

impl Saver {
    pub fn new(path: PathBuf, loaded: &Loaded) -> Self {
        let pixels = loaded.view.film.pixel_count();
        Self { path, identity: identity(loaded), pixels, flushed: Instant::now(), failed: false }
    }

    /// The saved sums and their passes; nothing when there is no checkpoint yet.
    pub fn resume(&self) -> Result<Option<(Pixels, u32)>, String> {
        let problem = |e: CheckpointError| format!("cannot resume from `{}`: {e}", self.path.display());
        let saved = match Checkpoint::read(&self.path) {
            Err(CheckpointError::Io(e)) if e.kind() == std::io::ErrorKind::NotFound => {
                let path = self.path.display();
                report::line(&format!("warning: there is no checkpoint `{path}`; beginning with pass 1"));
                return Ok(None);
            }
            read => read.map_err(problem)?,
        };
        saved.check(&self.identity).map_err(problem)?;
        if saved.pixels.len() != self.pixels {
            return Err(problem(CheckpointError::Invalid("it has another number of pixels")));
        }
        Ok(Some((saved.pixels, saved.passes)))
    }

    /// After each pass, so that a killed render loses one at most.
    pub fn after_pass(&mut self, pixels: &Pixels, passes: u32) {
        let flush = self.flushed.elapsed() >= FLUSH_INTERVAL;
        if flush {
            self.flushed = Instant::now();
        } else if self.failed {
            return;
        }
        match self.save(pixels, passes, flush) {
            Ok(()) => self.failed = false,
            Err(problem) => {
                if !self.failed {
                    report::line(&format!("warning: {problem}; rendering goes on, and this is tried again"));
                }
                self.failed = true;
            }
        }
    }

    pub fn save(&self, pixels: &Pixels, passes: u32, flush: bool) -> Result<(), String> {
        let bytes = Checkpoint::encode(&self.identity, passes, pixels);
        let write = if flush { atomic_write(&self.path, &bytes) } else { atomic_replace(&self.path, &bytes) };
        write.map_err(|e| format!("cannot write checkpoint `{}`: {e}", self.path.display()))
    }
}

/// OUTPUT.checkpoint.
pub fn default_path(output: &Path) -> PathBuf {
    output.with_extension("checkpoint")
}

/// What makes two renders the same render: all but the number of passes.
fn identity(loaded: &Loaded) -> Vec<(String, String)> {
    let film = loaded.view.film;
    let mut rows = vec![
        ("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
        ("scene hash".to_owned(), loaded.hash.clone()),
        ("film".to_owned(), format!("{}x{} crop {:?}", film.width, film.height, film.crop)),
        ("filter".to_owned(), filter_name(&loaded.view.filter)),
    ];
    rows.extend(loaded.choices.iter().cloned());
    rows.extend(loaded.settings.values().filter(|(n, _)| *n != "passes").map(|(n, v)| (n.to_owned(), v)));
    rows
}

fn filter_name(filter: &Filter) -> String {
    let [x, y] = filter.shapes();
    if x == y { format!("{x:?}") } else { format!("{x:?} × {y:?}") }
}
