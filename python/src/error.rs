//! Errors of the session as exceptions of the package.

use caustica::session::{Error, Finding, SettingError, ValueError};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::words::in_python;

/// An exception of `caustica._errors`, with diagnostics and a suggestion.
pub fn exception(
    py: Python<'_>,
    class: &str,
    message: String,
    findings: &[Finding],
    suggestion: Option<&str>,
) -> PyErr {
    let make = || -> PyResult<Bound<'_, PyAny>> {
        let class = py.import("caustica._errors")?.getattr(class)?;
        class.call1((message, diagnostics(py, findings)?, suggestion))
    };
    make().map_or_else(|problem| problem, PyErr::from_value)
}

/// An error of the session.
pub fn raised(py: Python<'_>, error: &Error) -> PyErr {
    let (class, suggestion) = match error {
        Error::Scene(_) => ("SceneError", None),
        Error::Setting(SettingError::Unknown { nearest, .. } | SettingError::Invalid { nearest, .. }) => {
            ("SettingError", nearest.as_deref())
        }
        Error::Layers(_) | Error::NoSensor { .. } | Error::OutsideFilm { .. } => ("SettingError", None),
        Error::Value(ValueError::Unknown { nearest, .. }) => ("UnknownNameError", nearest.as_deref()),
        Error::Value(_) => ("ArrayError", None),
        _ => ("Error", None),
    };
    let findings = error.findings();
    let message = in_python(&error.to_string());
    let help = findings.iter().filter(|f| f.is_error()).find_map(|f| f.help.first());
    exception(py, class, message, &findings, suggestion.or(help.map(|help| in_python(help)).as_deref()))
}

/// A `SettingError` about an argument that cannot have this value.
pub fn refused(py: Python<'_>, argument: &str, found: &str, expected: &str) -> PyErr {
    let message = format!("invalid value `{found}` for `{argument}`: expected {expected}");
    exception(py, "SettingError", message, &[], None)
}

/// A list of `Diagnostic` objects.
pub fn diagnostics<'py>(py: Python<'py>, findings: &[Finding]) -> PyResult<Bound<'py, PyAny>> {
    let class = py.import("caustica._errors")?.getattr("Diagnostic")?;
    let made = findings.iter().map(|finding| {
        let place = &finding.place;
        let related: Vec<_> = finding
            .labels
            .iter()
            .map(|label| (&label.message, &label.place.file, label.place.line, label.place.column))
            .collect();
        class.call1((
            finding.severity,
            in_python(&finding.message),
            &place.file,
            place.line,
            place.column,
            &finding.source,
            finding.help.iter().map(|help| in_python(help)).collect::<Vec<_>>(),
            related,
            finding.unsupported,
        ))
    });
    PyList::new(py, made.collect::<PyResult<Vec<_>>>()?)?.into_bound_py_any(py)
}
