//! Rendering on other threads, while the calling one listens to Python.

use std::ffi::CString;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use caustica::session::{Budget, Error, Lock, Outcome, Progress, Saver, Session, Sums, check_place};
use pyo3::exceptions::{PyKeyboardInterrupt, PyRuntimeWarning};
use pyo3::prelude::*;
use rayon::ThreadPool;

use crate::error::{raised, refused};
use crate::image::Image;
use crate::pool::own_pool;

/// What a render is asked for, beside its settings.
pub struct Request {
    /// The number of passes ends the render, also where a time or an error does.
    pub passes: bool,
    /// Seconds.
    pub time: Option<f64>,
    /// Relative standard error.
    pub target_error: Option<f64>,
    /// `None` is one for each core.
    pub threads: Option<i64>,
    /// Saved after every pass.
    pub checkpoint: Option<PathBuf>,
    /// Goes on from the checkpoint.
    pub resume: bool,
    /// These passes only: the first one and the one after the last.
    pub range: Option<(u32, u32)>,
}

/// How often signals are looked for.
const LISTEN: Duration = Duration::from_millis(50);

/// State after a pass: passes, seconds, relative standard error.
struct Pass(u32, f64, Option<f64>);

/// Both ends of the talk between the render and Python.
struct Talk {
    passes: Sender<Pass>,
    /// Whether the render goes on.
    answers: Mutex<Receiver<()>>,
    /// Whether anyone wants to hear of passes.
    wanted: bool,
}

/// Renders; `on_pass` hears of every pass, and ends the render by returning `False`. An exception of it ends the
/// render and is raised again, but `KeyboardInterrupt`, which only ends it.
pub fn render(
    py: Python<'_>,
    session: Session,
    request: &Request,
    on_pass: Option<&Bound<'_, PyAny>>,
) -> PyResult<Image> {
    let time = request.time.map(|seconds| seconds_asked(py, seconds)).transpose()?;
    if let Some(error) = request.target_error.filter(|error| !(*error > 0.0 && error.is_finite())) {
        return Err(refused(py, "target_error", &error.to_string(), "a positive number, such as 0.01"));
    }
    let limited = time.is_some() || request.target_error.is_some();
    let stop = AtomicBool::new(false);
    let budget = Budget {
        passes: (!limited || request.passes).then_some(session.settings.passes),
        time,
        error: request.target_error,
        interrupt: Some(&stop),
        ..Budget::default()
    };
    let (saver, sums, _lock) = begin(&session, request).map_err(|e| raised(py, &e))?;
    let pool = own_pool(py, request.threads)?;
    let (tell, passes) = channel();
    let (answer, answers) = channel();
    let talk = Talk { passes: tell, answers: Mutex::new(answers), wanted: on_pass.is_some() };
    let (outcome, failed) = std::thread::scope(|scope| {
        let worker = scope.spawn(|| work(&pool, &session, request.range, sums, budget, saver, talk));
        let failed = listen(py, &Mutex::new(passes), &answer, &stop, on_pass);
        (py.detach(|| worker.join()), failed)
    });
    let (outcome, problem) = outcome.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
    failed?;
    if let Some(problem) = problem {
        // The picture is not lost with its checkpoint.
        let text = CString::new(problem.to_string()).unwrap_or_default();
        PyErr::warn(py, &py.get_type::<PyRuntimeWarning>(), &text, 2)?;
    }
    Ok(Image::rendered(session, outcome))
}

fn seconds_asked(py: Python<'_>, seconds: f64) -> PyResult<Duration> {
    let time = Duration::try_from_secs_f64(seconds).ok().filter(|time| !time.is_zero());
    time.ok_or_else(|| refused(py, "time", &seconds.to_string(), "a positive number of seconds"))
}

/// What the render goes on from, and the file it is saved in.
fn begin(session: &Session, request: &Request) -> Result<(Option<Saver>, Sums, Option<Lock>), Error> {
    let none = || Sums::none(session.view.film.pixel_count());
    let Some(path) = &request.checkpoint else { return Ok((None, none(), None)) };
    check_place(path)?;
    let lock = Lock::take(path)?;
    let saver = Saver::new(path.clone(), session);
    let sums = if request.resume { saver.resume()? } else { None };
    Ok((Some(saver), sums.unwrap_or_else(none), lock))
}

fn work(
    pool: &ThreadPool,
    session: &Session,
    range: Option<(u32, u32)>,
    sums: Sums,
    budget: Budget<'_>,
    mut saver: Option<Saver>,
    talk: Talk,
) -> (Outcome, Option<Error>) {
    let mut problem = None;
    let mut after = |progress: &Progress<'_>| {
        if let Some(Err(failure)) = saver.as_mut().map(|s| s.after_pass(progress.pixels, progress.passes)) {
            problem = Some(failure);
        }
        if talk.wanted {
            let error = progress.pixels.relative_error(progress.passes);
            let error = error.is_finite().then_some(error);
            // Nobody hears a render that is being ended by a panic.
            let _ended = talk.passes.send(Pass(progress.passes, progress.elapsed.as_secs_f64(), error));
            let _ended = talk.answers.lock().unwrap_or_else(PoisonError::into_inner).recv();
        }
    };
    let outcome = pool.install(|| match range {
        Some((first, end)) => session.render_range(first..end, budget, &mut after),
        None => session.resume(sums, budget, &mut after),
    });
    if let Some(saver) = &saver
        && outcome.statistics.passes > 0
        && !outcome.statistics.first_pass_cut
    {
        // What could be saved at last need not be told of.
        problem = saver.save(&outcome.pixels, outcome.statistics.passes, true).err();
    }
    (outcome, problem)
}

/// Until the render has ended: hands passes to `on_pass` and looks for signals.
fn listen(
    py: Python<'_>,
    passes: &Mutex<Receiver<Pass>>,
    answer: &Sender<()>,
    stop: &AtomicBool,
    on_pass: Option<&Bound<'_, PyAny>>,
) -> PyResult<()> {
    let mut failed = Ok(());
    loop {
        let heard = py.detach(|| passes.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(LISTEN));
        let (heard, wish) = match heard {
            Ok(pass) => (true, tell(py, pass, on_pass.filter(|_| !stop.load(Ordering::Relaxed)))),
            Err(RecvTimeoutError::Timeout) => (false, Ok(true)),
            Err(RecvTimeoutError::Disconnected) => return failed,
        };
        match wish.and_then(|go_on| py.check_signals().map(|()| go_on)) {
            Ok(true) => {}
            Ok(false) => stop.store(true, Ordering::Relaxed),
            Err(e) => {
                // The first Ctrl-C ends the render, and its picture is the result; a second one is an exception.
                let first = !stop.swap(true, Ordering::Relaxed);
                if failed.is_ok() && !(first && e.is_instance_of::<PyKeyboardInterrupt>(py)) {
                    failed = Err(e);
                }
            }
        }
        if heard {
            // A render that has ended by a panic does not hear it.
            let _ended = answer.send(());
        }
    }
}

/// Whether the render goes on, as `on_pass` has it.
fn tell(py: Python<'_>, pass: Pass, on_pass: Option<&Bound<'_, PyAny>>) -> PyResult<bool> {
    let Some(on_pass) = on_pass else { return Ok(true) };
    let Pass(passes, elapsed, error) = pass;
    let progress = py.import("caustica._image")?.getattr("Progress")?.call1((passes, elapsed, error))?;
    let result = on_pass.call1((progress,))?;
    // Python's own and NumPy's.
    let is_bool = ["bool", "bool_"].contains(&result.get_type().name()?.to_str()?);
    Ok(!is_bool || result.is_truthy()?)
}
