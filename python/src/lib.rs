//! The extension module `caustica._native`: scenes, pictures and comparisons of `caustica::session` for Python.
//! Keyword arguments, defaults and documentation are the package's, in `package/caustica`.

mod arrays;
mod compare;
mod convert;
mod error;
mod image;
mod merge;
mod pool;
mod render;
mod scene;
mod words;

use caustica::session::{SETTINGS, Settings};
use pyo3::prelude::*;

/// Every setting: its name, what its values look like, its default, and what it does.
#[pyfunction]
fn settings() -> Vec<(&'static str, &'static str, String, &'static str)> {
    let defaults = Settings::default();
    let rows = SETTINGS.iter().zip(defaults.values());
    rows.map(|(row, (_, default))| (row.name, row.expected, default, row.doc)).collect()
}

#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("DEFAULT_PPD", caustica_tools::flip::DEFAULT_PPD)?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<image::Image>()?;
    module.add_class::<merge::Merge>()?;
    module.add_function(wrap_pyfunction!(settings, module)?)?;
    module.add_function(wrap_pyfunction!(compare::compare, module)?)?;
    module.add_function(wrap_pyfunction!(convert::convert, module)?)
}
