//! The threads that load and render.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::PyErr;
use pyo3::exceptions::PyRuntimeError;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// By their number of threads; 0 is one for each core.
type Pools = HashMap<usize, Arc<ThreadPool>>;

/// The pools of this process, with its number: a fork has none of the threads.
static POOLS: Mutex<Option<(u32, Pools)>> = Mutex::new(None);

/// The pool with so many threads.
pub fn pool(threads: Option<usize>) -> Result<Arc<ThreadPool>, PyErr> {
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    if let Some(other) = pools.take_if(|(owner, _)| *owner != process) {
        // To end those threads would be to wait for them.
        std::mem::forget(other);
    }
    let (_, pools) = pools.get_or_insert_with(|| (process, HashMap::new()));
    let count = threads.unwrap_or(0);
    if let Some(pool) = pools.get(&count) {
        return Ok(Arc::clone(pool));
    }
    let pool = ThreadPoolBuilder::new().num_threads(count).build();
    let pool = Arc::new(pool.map_err(|e| PyRuntimeError::new_err(e.to_string()))?);
    pools.insert(count, Arc::clone(&pool));
    Ok(pool)
}
