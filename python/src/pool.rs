//! The threads that load and render.

use std::sync::{Arc, Mutex, PoisonError};

use pyo3::exceptions::PyRuntimeError;
use pyo3::{PyErr, Python};
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::refused;

/// The pool of this process, with its number: a fork has none of the threads.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// More would only wait for each other.
const MOST: usize = 1024;

/// A pool with a thread for each core, for work that does not call Python.
pub fn pool() -> Result<Arc<ThreadPool>, PyErr> {
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    if let Some(other) = pool.take_if(|(owner, _)| *owner != process) {
        // To end those threads would be to wait for them.
        std::mem::forget(other);
    }
    if let Some((_, pool)) = pool.as_ref() {
        return Ok(Arc::clone(pool));
    }
    let made = Arc::new(build(0)?);
    *pool = Some((process, Arc::clone(&made)));
    Ok(made)
}

/// A pool of its own for a render: while Python hears of a pass, one of its threads waits, and Python may load,
/// compare or render something meanwhile.
pub fn own_pool(py: Python<'_>, threads: Option<i64>) -> Result<ThreadPool, PyErr> {
    let Some(asked) = threads else { return build(0) };
    match usize::try_from(asked) {
        Ok(threads) if (1..=MOST).contains(&threads) => build(threads),
        _ => Err(refused(py, "threads", &asked.to_string(), &format!("a whole number from 1 to {MOST}"))),
    }
}

/// 0 is one thread for each core.
fn build(threads: usize) -> Result<ThreadPool, PyErr> {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|e| PyRuntimeError::new_err(e.to_string()))
}
