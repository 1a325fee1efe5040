//! Pictures from parts that were rendered elsewhere.

use std::path::Path;
use std::sync::{Mutex, PoisonError};

use caustica::session;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::error::raised;
use crate::image::Image;

/// Adds up parts of one render, in any order.
#[derive(Debug)]
#[pyclass(frozen, module = "caustica._native")]
pub struct Merge(Mutex<Option<session::Merge>>);

#[pymethods]
impl Merge {
    #[new]
    fn new() -> Self {
        Self(Mutex::new(Some(session::Merge::new())))
    }

    /// Adds a part, which errors call `name`.
    fn add(&self, py: Python<'_>, name: &str, part: &[u8]) -> PyResult<()> {
        let mut merge = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        merge.as_mut().ok_or_else(finished)?.add(Path::new(name), part).map_err(|e| raised(py, &e))
    }

    /// The picture of all parts.
    fn finish(&self, py: Python<'_>, passes: u32, allow_missing: bool) -> PyResult<Image> {
        let merge = self.0.lock().unwrap_or_else(PoisonError::into_inner).take().ok_or_else(finished)?;
        let merged = py.detach(|| merge.finish(Some(passes), allow_missing));
        merged.map(Image::merged).map_err(|e| raised(py, &e))
    }
}

fn finished() -> PyErr {
    PyRuntimeError::new_err("the picture is finished")
}
