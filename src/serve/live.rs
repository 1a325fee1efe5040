//! What the render, its viewers and the judge tell each other.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use serde::Serialize;

use super::account::{Account, Work};
use super::snapshot::{Shown, Snapshot};
use crate::session::Statistics;

/// A page that has not asked for news this long is closed.
const GONE: Duration = Duration::from_secs(3);

/// Pages that are remembered, at most.
const PAGES: usize = 256;

/// What the render is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Phase {
    #[default]
    Rendering,
    Paused,
    Ended,
}

/// What people have asked for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wishes {
    /// To wait after the running pass.
    pub pause: bool,
    /// To write the files after the running pass.
    pub save: bool,
    /// To end now.
    pub stop: bool,
}

/// How far a picture is from the reference.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Point {
    pub passes: u32,
    pub seconds: f64,
    pub rmse: f64,
    pub relmse: f64,
    /// Mean; `None` where there was no time for it.
    pub flip: Option<f64>,
}

/// An open page.
#[derive(Debug)]
struct Page {
    seen: Instant,
    /// Requests that wait for news.
    waiting: u32,
    /// It has all that it wants of a render that has ended.
    done: bool,
}

/// See the module. [`Shared::lock`] gives access.
#[derive(Debug, Default)]
pub struct Live {
    /// Of all this: another one when there is news.
    pub version: u64,
    pub phase: Phase,
    pub wishes: Wishes,
    pub snapshot: Option<Arc<Snapshot>>,
    /// Which layers the next one will have.
    pub wanted: Vec<bool>,
    /// Of the last pass.
    pub statistics: Statistics,
    /// Relative standard error of the picture, and the passes after which it was estimated.
    pub error: Option<(f64, u32)>,
    /// Against the reference.
    pub curve: Vec<Point>,
    /// FLIP against the reference in the form for the page, by number.
    pub flip: Option<(u64, Arc<Vec<u8>>)>,
    /// What was saved last, or why it could not be, by number.
    pub saved: (u64, String),
    /// When the last pass was done, and the time of the render then.
    clock: Option<(Instant, Duration)>,
    pages: HashMap<u64, Page>,
    /// A viewer that speaks tev's protocol is there.
    pub display: bool,
    /// When there was news last.
    told: Option<Instant>,
    /// Why the render has ended.
    pub reason: Option<&'static str>,
}

impl Live {
    /// Time of the render so far, without pauses.
    pub fn elapsed(&self) -> Duration {
        match (self.clock, self.phase) {
            (Some((at, elapsed)), Phase::Rendering) => elapsed + at.elapsed(),
            (Some((_, elapsed)), _) => elapsed,
            (None, _) => Duration::ZERO,
        }
    }

    /// Whether there has been no news for this long.
    pub fn silent(&self, time: Duration) -> bool {
        self.told.is_none_or(|told| told.elapsed() >= time)
    }

    /// The render begins, a pass was done at this time of the render, or a pause is over.
    pub fn set_clock(&mut self, elapsed: Duration) {
        self.clock = Some((Instant::now(), elapsed));
    }

    /// Whether somebody looks.
    pub fn watched(&self) -> bool {
        self.display || self.pages.values().any(Page::open)
    }

    /// Whether an open page still wants something.
    pub fn unfinished(&self) -> bool {
        self.pages.values().any(|page| page.open() && !page.done)
    }

    /// A page has asked for news, and waits or no longer waits for them.
    pub fn meet(&mut self, id: u64, waits: bool) {
        if self.pages.len() >= PAGES && !self.pages.contains_key(&id) {
            self.pages.retain(|_, page| page.open());
            if self.pages.len() >= PAGES {
                return;
            }
        }
        let now = Instant::now();
        let page = self.pages.entry(id).or_insert(Page { seen: now, waiting: 0, done: false });
        page.seen = now;
        page.waiting = if waits { page.waiting + 1 } else { page.waiting.saturating_sub(1) };
    }

    /// A page has all that it wants.
    pub fn part(&mut self, id: u64) {
        if let Some(page) = self.pages.get_mut(&id) {
            page.done = true;
        }
    }
}

impl Page {
    fn open(&self) -> bool {
        self.waiting > 0 || self.seen.elapsed() < GONE
    }
}

/// What all threads of the view hold.
#[derive(Debug)]
pub struct Shared {
    /// What can be looked at.
    pub layers: Vec<Shown>,
    live: Mutex<Live>,
    news: Condvar,
    /// Ends the render.
    pub interrupt: Arc<AtomicBool>,
    /// Nanoseconds of pauses.
    pub idle: Arc<AtomicU64>,
    /// What the render takes.
    pub work: Work,
    /// Snapshots, and sending them.
    pub pictures: Account,
    /// Errors against the reference, and FLIP.
    pub judging: [Account; 2],
}

impl Shared {
    pub fn new(
        layers: Vec<Shown>,
        interrupt: Arc<AtomicBool>,
        work: Work,
        pictures: Account,
        judging: [Account; 2],
    ) -> Self {
        let wanted = layers.iter().map(Shown::is_picture).collect();
        let live = Mutex::new(Live { wanted, ..Live::default() });
        Self { layers, live, news: Condvar::new(), interrupt, idle: Arc::default(), work, pictures, judging }
    }

    pub fn lock(&self) -> MutexGuard<'_, Live> {
        self.live.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes something, and wakes everyone who waits for news.
    pub fn tell<T>(&self, change: impl FnOnce(&mut Live) -> T) -> T {
        let mut live = self.lock();
        let result = change(&mut live);
        live.version += 1;
        live.told = Some(Instant::now());
        self.news.notify_all();
        result
    }

    /// Waits until `there` holds or the time is over; says whether it holds.
    pub fn wait<'a>(
        &'a self,
        live: MutexGuard<'a, Live>,
        time: Duration,
        there: impl Fn(&Live) -> bool,
    ) -> (MutexGuard<'a, Live>, bool) {
        let waited = self.news.wait_timeout_while(live, time, |live| !there(live));
        let (live, timeout) = waited.unwrap_or_else(PoisonError::into_inner);
        (live, !timeout.timed_out())
    }

    /// Whether the render is to end.
    pub fn interrupted(&self) -> bool {
        self.interrupt.load(Ordering::Acquire)
    }

    /// Processor time spent on viewers so far.
    pub fn spent(&self) -> Duration {
        self.pictures.spent() + self.judging.iter().map(Account::spent).sum::<Duration>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_are_there_while_they_wait_and_a_little_longer() {
        let mut live = Live::default();
        assert!(!live.watched());
        live.meet(7, true);
        live.meet(7, true);
        live.meet(7, false);
        let long_ago = Instant::now().checked_sub(2 * GONE).unwrap();
        live.pages.get_mut(&7).unwrap().seen = long_ago;
        assert!(live.watched(), "one request still waits");
        live.meet(7, false);
        assert!(live.watched() && live.unfinished());
        live.part(7);
        assert!(live.watched() && !live.unfinished());
        live.pages.get_mut(&7).unwrap().seen = long_ago;
        assert!(!live.watched());
    }

    #[test]
    fn strangers_cannot_fill_the_memory() {
        let mut live = Live::default();
        (0..10_000).for_each(|id| live.meet(id, true));
        assert_eq!(live.pages.len(), PAGES);
    }
}
