//! Pictures.

use std::collections::HashMap;
use std::path::PathBuf;

use caustica::session::{Outcome, Output, Picture, Session};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::picture;
use crate::error::raised;
use crate::render::word;

/// What a render has made.
#[derive(Debug)]
#[pyclass(frozen, module = "caustica._native")]
pub struct Image {
    session: Session,
    outcome: Outcome,
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

    fn channels(&self, name: &str) -> Option<Vec<&'static str>> {
        self.picture().layer(name).map(|layer| layer.channels.to_vec())
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
        self.outcome.statistics.passes
    }

    /// Camera samples a pixel.
    #[getter]
    fn samples(&self) -> f64 {
        f64::from(self.outcome.statistics.passes) * f64::from(self.outcome.pixels.samples_a_pass)
    }

    /// Relative standard error; `None` where it is not known.
    #[getter]
    fn error(&self) -> Option<f64> {
        let error = self.outcome.pixels.relative_error(self.outcome.statistics.passes);
        error.is_finite().then_some(error)
    }

    #[getter]
    fn stop(&self) -> &'static str {
        word(self.outcome.stop)
    }

    /// As JSON.
    fn statistics(&self) -> PyResult<String> {
        serde_json::to_string(&self.outcome.statistics).map_err(|e| PyRuntimeError::new_err(e.to_string()))
    }

    fn metadata(&self) -> HashMap<String, String> {
        self.picture().metadata().into_iter().collect()
    }

    fn settings(&self) -> Vec<(&'static str, String)> {
        self.session.settings.values().collect()
    }

    /// Writes files as the command line does.
    fn save(&self, py: Python<'_>, files: Vec<PathBuf>, half: bool, exposure: f64) -> PyResult<()> {
        let output = self.output(files, half, exposure);
        let written = py.detach(|| {
            output.check(&self.session, &[])?;
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
    pub fn new(session: Session, outcome: Outcome) -> Self {
        Self { session, outcome }
    }

    fn picture(&self) -> Picture<'_> {
        self.session.picture(&self.outcome)
    }

    fn output(&self, files: Vec<PathBuf>, half: bool, exposure: f64) -> Output {
        let own = Output::new(&self.session, files);
        Output { half, exposure: exposure + own.exposure, ..own }
    }
}
