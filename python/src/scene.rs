//! Scenes.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use caustica::session::{
    Crop, Draft, Error, Filter, Inspection, Layers, Options, Session, SettingError, SpectrumRule, nearest,
};
use numpy::PyReadonlyArrayDyn;
use pyo3::prelude::*;

use crate::arrays::{from_numpy, to_numpy};
use crate::error::{diagnostics, raised};
use crate::image::Image;
use crate::pool::pool;
use crate::render::{Request, render};

/// A scene, and what it was compiled to since it was changed last.
#[derive(Debug)]
#[pyclass(frozen, module = "caustica._native")]
pub struct Scene {
    draft: Mutex<Draft>,
    /// Without and with texture coordinates that only layers need.
    compiled: Mutex<[Option<Arc<Session>>; 2]>,
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (path, *, defines, sensor, size, crop, filter, lenient, allow_paths, spectral_to_rgb))]
    fn new(
        py: Python<'_>,
        path: PathBuf,
        defines: Vec<(String, String)>,
        sensor: Option<usize>,
        size: Option<[u32; 2]>,
        crop: Option<[u32; 4]>,
        filter: Option<&str>,
        lenient: bool,
        allow_paths: Vec<PathBuf>,
        spectral_to_rgb: &str,
    ) -> PyResult<Self> {
        let options = Options {
            defines,
            allow_paths,
            sensor,
            size,
            crop: crop.map(|[x, y, width, height]| Crop { x, y, width, height }),
            filter: filter.map(filter_named).transpose().map_err(|e| raised(py, &e))?,
            spectrum_rule: spectrum_rule(spectral_to_rgb).map_err(|e| raised(py, &e))?,
            lenient,
            ..Options::default()
        };
        let pool = pool()?;
        let opened = py.detach(|| {
            pool.install(|| {
                let draft = Draft::open(&path, &options)?;
                let session = draft.compile(None)?;
                Ok((draft, session))
            })
        });
        let (draft, session) = opened.map_err(|e| raised(py, &e))?;
        let compiled = Mutex::new([Some(Arc::new(session)), None]);
        Ok(Self { draft: Mutex::new(draft), compiled })
    }

    fn keys(&self, py: Python<'_>) -> Vec<String> {
        py.detach(|| self.draft().keys())
    }

    fn get<'py>(&self, py: Python<'py>, key: &str) -> PyResult<Bound<'py, PyAny>> {
        let array = py.detach(|| self.draft().get(key)).map_err(|e| raised(py, &e.into()))?;
        to_numpy(py, array)
    }

    fn set(&self, py: Python<'_>, key: &str, value: PyReadonlyArrayDyn<'_, f64>) -> PyResult<()> {
        let array = from_numpy(&value);
        py.detach(|| {
            let mut draft = self.draft();
            *self.compiled.lock().unwrap_or_else(PoisonError::into_inner) = [None, None];
            draft.set(key, array)
        })
        .map_err(|e| raised(py, &e.into()))
    }

    /// What `caustica inspect` prints.
    fn describe(&self, py: Python<'_>) -> PyResult<String> {
        let session = self.session(py, None)?;
        let session = session.as_ref().clone();
        let pool = pool()?;
        Ok(py.detach(|| pool.install(|| Inspection::of_session(session).describe().to_string())))
    }

    /// What `caustica inspect --json` prints.
    fn inspect(&self, py: Python<'_>) -> PyResult<String> {
        let session = self.session(py, None)?.as_ref().clone();
        let pool = pool()?;
        let json =
            py.detach(|| pool.install(|| serde_json::to_string(&Inspection::of_session(session).describe())));
        json.map_err(|e| pyo3::exceptions::PyRuntimeError::new_err(e.to_string()))
    }

    /// Warnings about the scene, as `Diagnostic` objects.
    fn diagnostics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        diagnostics(py, self.session(py, None)?.findings())
    }

    /// Width and height of the picture in pixels.
    #[getter]
    fn size(&self, py: Python<'_>) -> PyResult<[u32; 2]> {
        let [_, _, width, height] = self.session(py, None)?.view.film.crop;
        Ok([width, height])
    }

    /// Settings as the scene asks for them.
    fn settings(&self, py: Python<'_>) -> PyResult<Vec<(&'static str, String)>> {
        Ok(self.session(py, None)?.settings.values().collect())
    }

    #[pyo3(signature = (*, settings, layers, passes, time, target_error, threads, checkpoint, resume, pass_range,
        on_pass))]
    fn render(
        &self,
        py: Python<'_>,
        settings: Vec<(String, String)>,
        layers: Option<&str>,
        passes: bool,
        time: Option<f64>,
        target_error: Option<f64>,
        threads: Option<i64>,
        checkpoint: Option<PathBuf>,
        resume: bool,
        pass_range: Option<(u32, u32)>,
        on_pass: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Image> {
        let layers: Option<Layers> =
            layers.map(str::parse).transpose().map_err(|e| raised(py, &Error::Layers(e)))?;
        let session = self.session(py, layers.as_ref())?;
        let session = session.with(&settings, layers).map_err(|e| raised(py, &e))?;
        session.check_memory().map_err(|e| raised(py, &e))?;
        let request = Request { passes, time, target_error, threads, checkpoint, resume, range: pass_range };
        render(py, session, &request, on_pass.as_ref())
    }
}

impl Scene {
    fn draft(&self) -> MutexGuard<'_, Draft> {
        self.draft.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The compiled scene, fit for these layers.
    fn session(&self, py: Python<'_>, layers: Option<&Layers>) -> PyResult<Arc<Session>> {
        let uvs = layers.is_some_and(Layers::need_uvs);
        let pool = pool()?;
        let compiled = py.detach(|| {
            let draft = self.draft();
            let mut compiled = self.compiled.lock().unwrap_or_else(PoisonError::into_inner);
            let place = &mut compiled[usize::from(uvs)];
            if let Some(session) = place {
                return Ok(Arc::clone(session));
            }
            let session = pool.install(|| draft.compile(layers.filter(|_| uvs).cloned()))?;
            Ok(Arc::clone(place.insert(Arc::new(session))))
        });
        compiled.map_err(|e: Error| raised(py, &e))
    }
}

fn filter_named(name: &str) -> Result<Filter, Error> {
    let known = || Filter::NAMED.iter().map(|row| row.name);
    Filter::named(name).ok_or_else(|| invalid("filter", name, known()))
}

/// `None` is the rule of the file.
pub fn spectrum_rule(name: &str) -> Result<Option<SpectrumRule>, Error> {
    match name {
        "mitsuba3" => Ok(Some(SpectrumRule::Mitsuba3)),
        "mitsuba06" => Ok(Some(SpectrumRule::Mitsuba06)),
        "file" => Ok(None),
        _ => Err(invalid("spectral_to_rgb", name, ["mitsuba3", "mitsuba06", "file"].into_iter())),
    }
}

fn invalid(name: &str, found: &str, known: impl Iterator<Item = &'static str> + Clone) -> Error {
    let expected = known.clone().collect::<Vec<_>>().join(", ");
    let nearest = nearest(found, known).map(str::to_owned);
    let (name, found) = (name.to_owned(), found.to_owned());
    SettingError::Invalid { name, expected: format!("one of {expected}"), found, nearest }.into()
}
