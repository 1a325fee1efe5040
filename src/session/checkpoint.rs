//! Checkpoints of a render: where they are, what they must agree in, when they are written.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use caustica_formats::files::plain;
use caustica_formats::image::{atomic_replace, atomic_write};

use super::{Error, Session};
use crate::film::{Aov, FilmSize, Filter, Pixels};
use crate::render::{Checkpoint, CheckpointError, Head, Sums};

/// Seconds between flushes to the disk. Between them a checkpoint survives the death of the program,
/// but not that of the machine.
const FLUSH_INTERVAL: Duration = Duration::from_secs(10);

/// The checkpoint file of a render.
#[derive(Debug)]
pub struct Saver {
    /// The file.
    pub path: PathBuf,
    /// But for the number of passes.
    head: Head,
    /// Pixels that a checkpoint must have.
    pixels: usize,
    /// Sums of AOVs that it must have.
    aovs: usize,
    flushed: Instant,
    /// Said once; the render goes on, and so do the attempts, each time of a flush.
    failed: bool,
}

impl Saver {
    /// A checkpoint of `session` at `path`, which need not exist.
    pub fn new(path: PathBuf, session: &Session) -> Self {
        let pixels = session.view.film.pixel_count();
        let aovs = pixels * Aov::numbers_of(&session.view.aovs);
        Self { path, head: head(session), pixels, aovs, flushed: Instant::now(), failed: false }
    }

    /// The checkpoint is one of the passes `first..until` only.
    #[must_use]
    pub fn of_range(mut self, first: u32, until: u32) -> Self {
        (self.head.first, self.head.until) = (first, until);
        self
    }

    /// So many passes are to make the whole render: a merge notices when the last of them are missing.
    #[must_use]
    pub fn of_whole(mut self, passes: u32) -> Self {
        self.head.whole = passes;
        self
    }

    /// The saved sums; `None` when there is no checkpoint yet.
    ///
    /// # Errors
    /// [`Error::Resume`] when the checkpoint cannot be read, is that of another scene, other settings or
    /// another version of the program, or holds other passes.
    pub fn resume(&self) -> Result<Option<Sums>, Error> {
        let problem = |source: CheckpointError| Error::Resume { file: self.path.clone(), source };
        let saved = match Checkpoint::read(&self.path) {
            Err(CheckpointError::Io(e)) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(CheckpointError::Io(e)) => return Err(problem(CheckpointError::Io(plain(e)))),
            read => read.map_err(problem)?,
        };
        saved.head.check(&self.head.identity).map_err(problem)?;
        if saved.pixels.len() != self.pixels {
            return Err(problem(CheckpointError::Invalid("it has another number of pixels")));
        }
        if saved.pixels.numbers_of_aovs() != self.aovs {
            return Err(problem(CheckpointError::Invalid("it has other layers (--layers)")));
        }
        let (held, first, until) = ([saved.head.first, saved.head.end()], self.head.first, self.head.until);
        if held[0] != first || (until > 0 && held[1] > until) {
            let wanted = if until > 0 { format!("{first}..{until}") } else { "those from 0 on".to_owned() };
            return Err(problem(CheckpointError::OtherPasses { held, wanted }));
        }
        Ok(Some(Sums { pixels: saved.pixels, first, passes: saved.head.passes }))
    }

    /// To be called after each pass, so that a killed render loses one at most. A failure is no reason to
    /// end the render: saving is tried again later.
    ///
    /// # Errors
    /// [`Error::Checkpoint`], once for failures in a row.
    pub fn after_pass(&mut self, pixels: &Pixels, passes: u32) -> Result<(), Error> {
        let flush = self.flushed.elapsed() >= FLUSH_INTERVAL;
        if flush {
            self.flushed = Instant::now();
        } else if self.failed {
            return Ok(());
        }
        let saved = self.save(pixels, passes, flush);
        let told = std::mem::replace(&mut self.failed, saved.is_err());
        if told { Ok(()) } else { saved }
    }

    /// Replaces the checkpoint in one step. With `flush` it is on the disk afterwards, and survives the
    /// death of the machine.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] when the file cannot be written; the one before is still there.
    pub fn save(&self, pixels: &Pixels, passes: u32, flush: bool) -> Result<(), Error> {
        let bytes = Checkpoint::encode(&Head { passes, ..self.head.clone() }, pixels);
        let write = if flush { atomic_write(&self.path, &bytes) } else { atomic_replace(&self.path, &bytes) };
        write.map_err(|source| Error::Checkpoint { file: self.path.clone(), source })
    }

    /// OUTPUT.checkpoint, for those who name no other file.
    pub fn default_path(output: &Path) -> PathBuf {
        output.with_extension("checkpoint")
    }
}

/// Of a checkpoint of the session, but for the passes.
pub(super) fn head(session: &Session) -> Head {
    let about = serde_json::to_string(&session.info()).expect("texts and numbers are JSON");
    Head { identity: identity(session), about, ..Head::default() }
}

/// What makes two renders the same render: all but the number of passes.
fn identity(session: &Session) -> Vec<(String, String)> {
    let film = session.view.film;
    let mut rows = vec![
        ("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
        ("scene hash".to_owned(), session.hash.clone()),
        ("film".to_owned(), film_name(film)),
        ("filter".to_owned(), filter_name(&session.view.filter)),
    ];
    rows.extend(session.choices.iter().cloned());
    rows.extend(session.view.aovs.iter().map(|aov| (format!("layer {aov:?}"), "rendered".to_owned())));
    rows.extend(session.settings.values().filter(|(n, _)| *n != "passes").map(|(n, v)| (n.to_owned(), v)));
    rows
}

/// "640×480", or "640×480, of it 64×48 at 0,0".
fn film_name(film: FilmSize) -> String {
    let [x, y, width, height] = film.crop;
    let whole = format!("{}×{}", film.width, film.height);
    if film.crop == FilmSize::full(film.width, film.height).crop {
        return whole;
    }
    format!("{whole}, of it {width}×{height} at {x},{y}")
}

fn filter_name(filter: &Filter) -> String {
    let [x, y] = filter.shapes();
    if x == y { format!("{x:?}") } else { format!("{x:?} × {y:?}") }
}
