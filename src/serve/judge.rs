//! How far the picture is from a reference, measured in a thread of its own.

use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use caustica_tools::compare::load;
use caustica_tools::flip::{DEFAULT_PPD, FlipStats, ldr};
use caustica_tools::main_errors;
use caustica_tools::pixels::Pixels;

use super::account::Meter;
use super::live::{Point, Shared};
use super::snapshot::{Snapshot, coded_map};
use super::{EARLY, Error};

/// Passes from a point of the curve to the next, as a factor: some thirty points for ten times the passes.
const STEP: f64 = 1.08;

/// A picture to judge. Work on a render that waits or has ended is free.
#[derive(Debug)]
struct Job {
    snapshot: Arc<Snapshot>,
    free: bool,
}

/// Compares snapshots with the reference.
#[derive(Debug)]
pub struct Judge {
    jobs: SyncSender<Job>,
    /// Passes of the picture that was judged last, and whether there was time for all of it.
    last: (u32, bool),
    shared: Arc<Shared>,
}

/// Reads a reference of this size.
///
/// # Errors
/// When it cannot be read, or has another size.
pub fn reference(path: &Path, [width, height]: [usize; 2]) -> Result<Pixels, Error> {
    let pixels = load(path, None).map_err(|e| Error::Reference(e.to_string()))?.pixels;
    if [pixels.width, pixels.height] == [width, height] {
        return Ok(pixels);
    }
    let (path, w, h) = (path.display(), pixels.width, pixels.height);
    Err(Error::Reference(format!(
        "{path}: it has {w}×{h} pixels, and the picture {width}×{height}; render with `--size {w}x{h}` to compare them"
    )))
}

impl Judge {
    /// Both pictures are brightened by `stops` before FLIP sees them.
    ///
    /// # Errors
    /// When no thread can be started.
    pub fn start(reference: Pixels, stops: f64, shared: Arc<Shared>) -> Result<Self, Error> {
        let (jobs, todo) = sync_channel(1);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let bench = Bench {
            pool: pool.map_err(|e| Error::Thread(e.to_string()))?,
            exposed: exposed(&reference, stops),
            reference,
            stops,
            shared: Arc::clone(&shared),
        };
        let work = move || bench.work(&todo);
        let thread = std::thread::Builder::new().name("judge".to_owned());
        thread.spawn(work).map_err(|e| Error::Thread(e.to_string()))?;
        Ok(Self { jobs, last: (0, false), shared })
    }

    /// Whether a picture of so many passes is to be judged. One that is `there`, since it is shown, costs little.
    pub fn due(&self, passes: u32, there: bool) -> bool {
        let last = self.last.0;
        let shares = if passes >= 2 * last { EARLY } else { 1.0 };
        f64::from(passes) >= STEP * f64::from(last)
            && (there || self.shared.judging[0].affords(self.shared.work.elapsed(), shares))
    }

    /// Whether a picture of so many passes is, or will be, judged in all respects.
    pub fn has_seen(&self, passes: u32) -> bool {
        self.last == (passes, true)
    }

    /// Judges a picture, unless the judge is busy.
    pub fn take(&mut self, snapshot: &Arc<Snapshot>, free: bool) {
        let job = Job { snapshot: Arc::clone(snapshot), free };
        if self.jobs.try_send(job).is_ok() {
            self.last = (snapshot.passes, free);
        }
    }
}

/// What the judge has at hand.
#[derive(Debug)]
struct Bench {
    /// One thread, so that the render keeps the others.
    pool: rayon::ThreadPool,
    reference: Pixels,
    /// The same, brightened.
    exposed: Pixels,
    stops: f64,
    shared: Arc<Shared>,
}

impl Bench {
    fn work(&self, todo: &Receiver<Job>) {
        for (number, Job { snapshot, free }) in (1..).zip(todo) {
            if free {
                self.judge(number, &snapshot, true);
            } else {
                self.pool.install(|| self.judge(number, &snapshot, false));
            }
        }
    }

    fn judge(&self, number: u64, snapshot: &Snapshot, free: bool) {
        let [width, height] = snapshot.size;
        let [errors_account, flip_account] = &self.shared.judging;
        let meter = Meter::start();
        let picture = Pixels { width, height, rgb: snapshot.rgb() };
        let [rmse, relmse] = main_errors(&picture, &self.reference);
        if !free {
            errors_account.pay_piece(meter.elapsed());
        }
        let meter = Meter::start();
        let flip = (free || flip_account.affords(self.shared.work.elapsed(), 1.0)).then(|| {
            let map = ldr(&exposed(&picture, self.stops), &self.exposed, DEFAULT_PPD);
            (FlipStats::of(&map).mean, Arc::new(coded_map(&map, number)))
        });
        if !free && flip.is_some() {
            flip_account.pay_piece(meter.elapsed());
        }
        let point = Point {
            passes: snapshot.passes,
            seconds: snapshot.seconds,
            rmse,
            relmse,
            flip: flip.as_ref().map(|(mean, _)| *mean),
        };
        self.shared.tell(|live| {
            // Judged again while the render waits: now there is time for FLIP.
            live.curve.pop_if(|last| last.passes == point.passes);
            live.curve.push(point);
            if let Some((_, map)) = flip {
                live.flip = Some((number, map));
            }
        });
    }
}

fn exposed(pixels: &Pixels, stops: f64) -> Pixels {
    let factor = stops.exp2() as f32;
    Pixels { rgb: pixels.rgb.iter().map(|p| p.map(|v| v * factor)).collect(), ..*pixels }
}
