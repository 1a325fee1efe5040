//! `caustica.convert`.

use std::path::PathBuf;

use caustica::session::{Conversion, Error, Options};
use pyo3::prelude::*;

use crate::error::{diagnostics, raised};
use crate::pool::pool;
use crate::scene::spectrum_rule;

/// What is lost, what is written instead, where, and how much light that changes.
type LossRow = (String, String, Option<String>, Option<f64>);

/// Converts a scene; the shapes and files written, the losses, and the warnings.
#[pyfunction]
#[pyo3(signature = (source, target, *, defines, force, lenient, allow_paths, spectral_to_rgb))]
pub fn convert<'py>(
    py: Python<'py>,
    source: PathBuf,
    target: PathBuf,
    defines: Vec<(String, String)>,
    force: bool,
    lenient: bool,
    allow_paths: Vec<PathBuf>,
    spectral_to_rgb: &str,
) -> PyResult<(usize, usize, Vec<LossRow>, Bound<'py, PyAny>)> {
    let rule = spectrum_rule(spectral_to_rgb).map_err(|e| raised(py, &e))?;
    let options = Options { defines, allow_paths, lenient, spectrum_rule: rule, ..Options::default() };
    let pool = pool()?;
    let converted = py.detach(|| {
        pool.install(|| -> Result<_, Error> {
            let conversion = Conversion::read(&source, &options)?;
            let findings = conversion.findings();
            Ok((conversion.write(&target, force, None)?, findings))
        })
    });
    let (converted, findings) = converted.map_err(|e| raised(py, &e))?;
    let losses = converted.losses.into_iter().map(|l| (l.what, l.instead, l.place, l.size)).collect();
    Ok((converted.shapes, converted.files, losses, diagnostics(py, &findings)?))
}
