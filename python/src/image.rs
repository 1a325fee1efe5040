//! Pictures.

use std::collections::HashMap;
use std::path::PathBuf;

use caustica::session::{Merged, Outcome, Output, Picture, Session, Stop};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::picture;
use crate::error::raised;

/// A picture.
#[derive(Debug)]
#[pyclass(frozen, module = "caustica._native")]
pub struct Image(Source);

/// Where a picture comes from.
#[derive(Debug)]
enum Source {
    Rendered(Box<(Session, Outcome)>),
    Merged(Box<Merged>),
}

#[pymethods]
impl Image {
    fn layers(&self) -> Vec<String> {
        self.picture().layer_names()
    }

    /// A layer of shape (height, width), or with several channels (height, width, channels); `None` where the
    /// picture has no layer of this name.
    fn layer<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        let layer = py.detach(|| self.picture().layer(name));
        layer.map(|layer| picture(py, layer.data, self.picture().size(), layer.channels.len())).transpose()
    }

    fn channels(&self, name: &str) -> Option<Vec<String>> {
        self.picture().layer(name).map(|layer| layer.channels)
    }

    fn rgb<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let data = py.detach(|| self.picture().rgb().flat_map(|rgb| rgb.map(|v| v as f32)).collect());
        picture(py, data, self.picture().size(), 3)
    }

    fn alpha<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        picture(py, self.picture().alpha(), self.picture().size(), 1)
    }

    #[getter]
    fn size(&self) -> [usize; 2] {
        self.picture().size()
    }

    #[getter]
    fn passes(&self) -> u32 {
        self.picture().passes()
    }

    /// Camera samples a pixel, on average.
    #[getter]
    fn samples(&self) -> u64 {
        self.picture().samples()
    }

    /// Relative standard error; `None` where it is not known.
    #[getter]
    fn error(&self) -> Option<f64> {
        Some(self.picture().relative_error()).filter(|error| error.is_finite())
    }

    /// Why the render ended; a merged picture has all its passes, or some are missing.
    #[getter]
    fn stop(&self) -> &'static str {
        match &self.0 {
            Source::Rendered(made) => word(made.1.stop),
            Source::Merged(merged) if merged.missing().is_empty() => "passes",
            Source::Merged(_) => "interrupted",
        }
    }

    /// As JSON; nothing is known of a merged picture's parts.
    fn statistics(&self) -> PyResult<String> {
        match &self.0 {
            Source::Rendered(made) => {
                serde_json::to_string(&made.1.statistics).map_err(|e| PyRuntimeError::new_err(e.to_string()))
            }
            Source::Merged(_) => Ok("{}".to_owned()),
        }
    }

    /// The passes as the bytes of a checkpoint, to be merged with others.
    fn part<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let Source::Rendered(made) = &self.0 else {
            return Err(PyRuntimeError::new_err("a merged picture is no part"));
        };
        let bytes = py.detach(|| made.0.part(&made.1)).map_err(|e| raised(py, &e))?;
        Ok(PyBytes::new(py, &bytes))
    }

    fn metadata(&self) -> HashMap<String, String> {
        self.picture().metadata().into_iter().collect()
    }

    /// Every setting in effect, but for the number of passes: names and values with blanks between them.
    fn settings(&self) -> String {
        self.picture().info().settings.clone()
    }

    /// Writes files as the command line does.
    fn save(&self, py: Python<'_>, files: Vec<PathBuf>, half: bool, exposure: f64) -> PyResult<()> {
        let output = self.output(files, half, exposure);
        let written = py.detach(|| {
            match &self.0 {
                Source::Rendered(made) => output.check(&made.0, &[])?,
                Source::Merged(_) => output.check_merged(false, &[], &[])?,
            }
            let _locks = output.lock(&[])?;
            output.write(&self.picture())
        });
        written.map_err(|e| raised(py, &e))
    }

    /// The bytes of a file with this extension.
    fn encode<'py>(
        &self,
        py: Python<'py>,
        extension: &str,
        half: bool,
        exposure: f64,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let output = self.output(Vec::new(), half, exposure);
        let bytes = py.detach(|| output.encode(&self.picture(), extension));
        Ok(PyBytes::new(py, &bytes.map_err(|e| PyRuntimeError::new_err(e.to_string()))?))
    }
}

impl Image {
    pub fn rendered(session: Session, outcome: Outcome) -> Self {
        Self(Source::Rendered(Box::new((session, outcome))))
    }

    pub fn merged(merged: Merged) -> Self {
        Self(Source::Merged(Box::new(merged)))
    }

    fn picture(&self) -> Picture<'_> {
        match &self.0 {
            Source::Rendered(made) => made.0.picture(&made.1),
            Source::Merged(merged) => merged.picture(),
        }
    }

    fn output(&self, files: Vec<PathBuf>, half: bool, exposure: f64) -> Output {
        let own = Output::of(self.picture().info(), files);
        Output { half, exposure: exposure + own.exposure, ..own }
    }
}

/// Why a render ended, in a word.
fn word(stop: Stop) -> &'static str {
    match stop {
        Stop::Passes => "passes",
        Stop::Time => "time",
        Stop::Error => "error",
        Stop::Interrupted => "interrupted",
    }
}
