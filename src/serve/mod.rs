//! The live view of a render: a page in the browser, and viewers that speak tev's protocol.
//!
//! [`View::after_pass`] is called after each pass. If somebody looks and the share of the processor allows it, it takes a
//! snapshot of the sums while the render waits; encoding, sending and judging are done by other threads. Viewers take
//! what is newest when they are ready for it: nothing queues up for one that is slow. Pausing a render is staying in
//! [`View::after_pass`].
//!
//! This room knows the renderer by [`crate::session`] only.

mod account;
mod gate;
mod http;
mod judge;
mod live;
mod page;
mod routes;
mod server;
mod snapshot;
mod tev;

use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use serde_json::json;
use thiserror::Error as ThisError;

use crate::session::{Budget, Outcome, Picture, Progress, Session, Stop};
use account::{Account, Work};
use judge::Judge;
use live::{Phase, Shared};
use routes::Routes;
use server::Server;
use snapshot::{Shown, Snapshot, coded_picture};
use tev::Display;

/// Shares of the processor time of the render: of snapshots with encoding and sending, of errors against the reference,
/// and of FLIP. With what is not counted, such as waking threads, they stay below 2 %.
const PICTURES: f64 = 0.008;
const ERRORS: f64 = 0.001;
const FLIP: f64 = 0.004;

/// So many shares are there for a picture of twice the passes of the one before, so that the first ones come
/// early.
const EARLY: f64 = 1.6;

/// Nanoseconds a pixel of these, as long as they are not measured.
const PICTURE_COST: u64 = 50;
const ERROR_COST: u64 = 50;
const FLIP_COST: u64 = 1200;

/// Snapshots come at most this often.
const INTERVAL: Duration = Duration::from_millis(100);

/// Pages hear of passes at least this often, as long as there are any, pictures or not.
const TICK: Duration = Duration::from_millis(500);

/// How often a render that is paused looks whether it has been interrupted.
const GLANCE: Duration = Duration::from_millis(100);

/// How long the end of a render waits for open pages to take what they want, and for other viewers.
const FAREWELL: Duration = Duration::from_secs(5);

/// Why a view could not be opened.
#[derive(Debug, ThisError)]
pub enum Error {
    /// The address of the page cannot be used.
    #[error("cannot serve a page on {0}: {1}")]
    Bind(SocketAddr, std::io::Error),
    /// The reference cannot be used.
    #[error("{0}")]
    Reference(String),
    /// There are too many threads.
    #[error("cannot start a thread: {0}")]
    Thread(String),
}

/// What to show, and to whom.
#[derive(Clone, Debug)]
pub struct Options {
    /// Where to serve the page, if anywhere; port 0 stands for one that is free.
    pub page: Option<SocketAddr>,
    /// Host and port of a viewer that speaks tev's protocol.
    pub display: Option<String>,
    /// A picture to compare with.
    pub reference: Option<PathBuf>,
    /// Stops of exposure at first.
    pub exposure: f64,
    /// Is set to end the render.
    pub interrupt: Arc<AtomicBool>,
    /// Says what is wrong with a viewer.
    pub warn: fn(&str),
}

/// Shows a render while it goes on.
#[derive(Debug)]
pub struct View {
    shared: Arc<Shared>,
    server: Option<Server>,
    judge: Option<Judge>,
    taken: Option<Instant>,
}

impl View {
    /// Opens the view of a render that will use this budget.
    ///
    /// # Errors
    /// When the page cannot be served, or the reference is of no use.
    pub fn start(options: &Options, session: &Session, budget: &Budget<'_>) -> Result<Self, Error> {
        let size = session.size();
        let pixels = (size[0] * size[1]) as u64;
        let account = |share: f64, cost: u64| {
            let guess = Duration::from_nanos(cost.saturating_mul(pixels));
            Account::new(share, guess)
        };
        let shared = Arc::new(Shared::new(
            Shown::all(session),
            Arc::clone(&options.interrupt),
            Work::start(rayon::current_num_threads()),
            account(PICTURES, PICTURE_COST),
            [account(ERRORS, ERROR_COST), account(FLIP, FLIP_COST)],
        ));
        let reference = options.reference.as_deref().map(|path| judge::reference(path, size)).transpose()?;
        let server = match options.page {
            Some(bind) => {
                let page = page::page(&info(options, session, budget, &shared.layers));
                let coded = reference.as_ref().map(|r| Arc::new(coded_picture(r.width, &r.rgb)));
                let theirs = Arc::clone(&shared);
                let server = Server::start(bind, |bound| Routes::new(bound, page, coded, theirs));
                Some(server.map_err(|e| Error::Bind(bind, e))?)
            }
            None => None,
        };
        shared.lock().set_clock(Duration::ZERO);
        if let Some(address) = &options.display {
            shared.lock().wanted = shared.layers.iter().map(Shown::is_light).collect();
            let absolute = |path: &PathBuf| std::fs::canonicalize(path).ok();
            Display {
                address: address.clone(),
                name: format!("{} (caustica)", session.name()),
                size,
                reference: options.reference.as_ref().and_then(absolute),
                shared: Arc::clone(&shared),
                warn: options.warn,
            }
            .start()?;
        }
        let judge = reference.map(|r| Judge::start(r, options.exposure, Arc::clone(&shared))).transpose()?;
        Ok(Self { shared, server, judge, taken: None })
    }

    /// Where the page is, with its token.
    pub fn address(&self) -> Option<&str> {
        self.server.as_ref().map(Server::address)
    }

    /// Nanoseconds of pauses, for [`Budget::idle`].
    pub fn idle(&self) -> Arc<AtomicU64> {
        Arc::clone(&self.shared.idle)
    }

    /// To be called after each pass. Stays here while the render is paused. `save` writes the files of the render and
    /// says what it wrote, or what is wrong.
    pub fn after_pass(
        &mut self,
        session: &Session,
        progress: &Progress<'_>,
        save: &mut dyn FnMut() -> String,
    ) {
        let elapsed = progress.elapsed;
        {
            let mut live = self.shared.lock();
            live.set_clock(elapsed);
            live.statistics = progress.statistics.clone();
        }
        self.show(session, progress);
        if self.shared.lock().silent(TICK) {
            self.shared.tell(|_| {});
        }
        let mut paused: Option<Instant> = None;
        loop {
            let wishes = self.shared.lock().wishes;
            if wishes.save {
                self.save(save);
                continue;
            }
            if !wishes.pause || self.shared.interrupted() {
                break;
            }
            if paused.is_none() {
                paused = Some(Instant::now());
                self.shared.tell(|live| live.phase = Phase::Paused);
            }
            self.show(session, progress);
            let live = self.shared.lock();
            let wanted = live.wanted.clone();
            let _woken = self
                .shared
                .wait(live, GLANCE, |live| !live.wishes.pause || live.wishes.save || live.wanted != wanted);
        }
        if let Some(begun) = paused {
            let time = u64::try_from(begun.elapsed().as_nanos()).unwrap_or(u64::MAX);
            self.shared.idle.fetch_add(time, Ordering::Relaxed);
            self.shared.tell(|live| {
                live.phase = Phase::Rendering;
                live.set_clock(elapsed);
            });
        }
    }

    fn save(&self, save: &mut dyn FnMut() -> String) {
        let text = save();
        self.shared.tell(|live| {
            live.wishes.save = false;
            live.saved = (live.saved.0 + 1, text);
        });
    }

    /// Takes a snapshot for those who look and for the judge, if it is due. While the render is paused, it always is
    /// when there is something new.
    fn show(&mut self, session: &Session, progress: &Progress<'_>) {
        let passes = progress.passes;
        let free = self.shared.lock().phase == Phase::Paused;
        let shows = self.shows(progress, free);
        let judges = match &self.judge {
            Some(judge) if free => !judge.has_seen(passes),
            Some(judge) => judge.due(passes, shows),
            None => false,
        };
        if !shows && !judges {
            return;
        }
        let (mut wanted, last, estimated) = {
            let live = self.shared.lock();
            (live.wanted.clone(), live.snapshot.as_ref().map_or(0, |s| s.number), live.error)
        };
        if !shows {
            // The judge looks at the picture only.
            wanted.iter_mut().skip(1).for_each(|wanted| *wanted = false);
        }
        let before = self.shared.work.elapsed();
        let stamp = (last + 1, passes, progress.elapsed.as_secs_f64());
        let picture = session.so_far(progress);
        let snapshot = Arc::new(Snapshot::of(&picture, &self.shared.layers, &wanted, stamp));
        if shows {
            let known = estimated.is_some_and(|(_, at)| at == passes) || passes < 2;
            let error =
                if known { estimated } else { Some((progress.pixels.relative_error(passes), passes)) };
            self.publish(&snapshot, |live| live.error = error);
        }
        // All threads of the render have worked on it.
        let cost = self.shared.work.elapsed().saturating_sub(before);
        if !free && shows {
            self.shared.pictures.pay_piece(cost);
        } else if !free {
            self.shared.judging[0].pay(cost);
        }
        if let Some(judge) = self.judge.as_mut().filter(|_| judges) {
            judge.take(&snapshot, free);
        }
    }

    /// Whether those who look get a snapshot now. The first one comes after the first pass in any case.
    fn shows(&self, progress: &Progress<'_>, free: bool) -> bool {
        let live = self.shared.lock();
        let Some(old) = live.snapshot.as_ref() else { return live.watched() };
        let lacks = old.passes != progress.passes
            || (0..live.wanted.len()).any(|layer| live.wanted[layer] && !old.has(layer));
        if !live.watched() || !lacks || free {
            return lacks && live.watched();
        }
        let shares = if progress.passes >= 2 * old.passes { EARLY } else { 1.0 };
        self.taken.is_none_or(|taken| taken.elapsed() >= INTERVAL)
            && self.shared.pictures.affords(self.shared.work.elapsed(), shares)
    }

    fn publish(&mut self, snapshot: &Arc<Snapshot>, more: impl FnOnce(&mut live::Live)) {
        self.taken = Some(Instant::now());
        self.shared.tell(|live| {
            live.snapshot = Some(Arc::clone(snapshot));
            more(live);
        });
    }

    /// To be called when the render has ended and its files are written; `said` is what became of them. Open pages get
    /// the last picture with all layers, within some seconds.
    pub fn finish(mut self, session: &Session, outcome: &Outcome, said: &str) {
        let statistics = outcome.statistics.clone();
        let elapsed = Duration::try_from_secs_f64(statistics.seconds).unwrap_or_default();
        let error = (statistics.passes > 1)
            .then(|| (outcome.pixels.relative_error(statistics.passes), statistics.passes));
        if statistics.passes > 0 && self.shared.lock().watched() {
            self.show_last(&session.picture(outcome), statistics.passes, statistics.seconds);
        }
        self.shared.tell(|live| {
            live.set_clock(elapsed);
            live.phase = Phase::Ended;
            live.reason = Some(reason(outcome.stop));
            live.error = error;
            live.statistics = statistics;
            live.wishes.save = false;
            live.saved = (live.saved.0 + 1, said.to_owned());
        });
        let give_up = Instant::now() + FAREWELL;
        let settled = |live: &live::Live| !live.unfinished() && !live.display;
        while Instant::now() < give_up {
            // Pages that are closed are found to be gone by the time only.
            if self.shared.wait(self.shared.lock(), GLANCE, settled).1 {
                break;
            }
        }
    }

    /// The picture of all passes, and what the judge says of it.
    fn show_last(&mut self, picture: &Picture<'_>, passes: u32, seconds: f64) {
        let (mut wanted, last) = {
            let live = self.shared.lock();
            (live.wanted.clone(), live.snapshot.as_ref().map_or(0, |s| s.number))
        };
        wanted.iter_mut().zip(&self.shared.layers).for_each(|(wanted, layer)| *wanted |= layer.is_light());
        let stamp = (last + 1, passes, seconds);
        let snapshot = Arc::new(Snapshot::of(picture, &self.shared.layers, &wanted, stamp));
        self.publish(&snapshot, |_| {});
        if let Some(judge) = &mut self.judge {
            let give_up = Instant::now() + FAREWELL;
            while !judge.has_seen(passes) && Instant::now() < give_up {
                judge.take(&snapshot, true);
                std::thread::sleep(Duration::from_millis(5));
            }
            let live = self.shared.lock();
            let judged = |live: &live::Live| {
                live.curve.last().is_some_and(|point| point.passes == passes && point.flip.is_some())
            };
            drop(self.shared.wait(live, FAREWELL, judged));
        }
    }
}

/// Why a render has ended, in words for the page.
fn reason(stop: Stop) -> &'static str {
    match stop {
        Stop::Passes => "all passes are done",
        Stop::Time => "the time is up",
        Stop::Error => "the target error is reached",
        Stop::Interrupted => "stopped",
    }
}

/// What the page knows from the beginning.
fn info(options: &Options, session: &Session, budget: &Budget<'_>, layers: &[Shown]) -> serde_json::Value {
    json!({
        "scene": session.path().display().to_string(),
        "size": session.size(),
        "layers": layers.iter().map(|layer| &layer.name).collect::<Vec<_>>(),
        "reference": options.reference.as_ref().map(|path| path.display().to_string()),
        "exposure": options.exposure,
        "passes": budget.passes,
        "seconds": budget.time.map(|time| time.as_secs_f64()),
        "target": budget.error,
        "version": env!("CARGO_PKG_VERSION"),
    })
}
