//! `caustica.compare`.

use std::path::PathBuf;

use caustica_tools::compare::{CompareArgs, Picture, judge};
use caustica_tools::pixels::Pixels;
use numpy::{PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::picture;
use crate::error::exception;
use crate::pool::pool;

/// A picture.
#[derive(FromPyObject)]
pub enum Given<'py> {
    /// The bytes of a file.
    Bytes(Bound<'py, PyBytes>),
    /// Radiance, of shape (height, width, 3).
    Pixels(PyReadonlyArray3<'py, f32>),
}

/// Compares two pictures, `None` for the file of that name: the numbers as JSON, and the FLIP map of shape (height, width).
#[pyfunction]
#[pyo3(signature = (image_name, image, reference_name, reference, *, layer, reference_layer, mask, variance, spp,
    reference_spp, exposure, ppd, psnr_peak, hdr))]
pub fn compare<'py>(
    py: Python<'py>,
    image_name: PathBuf,
    image: Option<Given<'py>>,
    reference_name: PathBuf,
    reference: Option<Given<'py>>,
    layer: Option<String>,
    reference_layer: Option<String>,
    mask: Option<PathBuf>,
    variance: Option<PathBuf>,
    spp: Option<f64>,
    reference_spp: Option<f64>,
    exposure: f64,
    ppd: f64,
    psnr_peak: f64,
    hdr: bool,
) -> PyResult<(String, Bound<'py, PyAny>)> {
    let args = CompareArgs {
        layer,
        reference_layer,
        mask,
        variance,
        spp,
        reference_spp,
        exposure,
        ppd,
        psnr_peak,
        no_hdr: !hdr,
        ..CompareArgs::new(image_name, reference_name)
    };
    let (image, reference) = (given(image), given(reference));
    let pool = pool()?;
    let judged = py.detach(|| pool.install(|| judge(&args, image, reference)));
    let judged = judged.map_err(|e| exception(py, "Error", e.to_string(), &[], None))?;
    let size = [judged.flip.width, judged.flip.height];
    Ok((judged.json, picture(py, judged.flip.values, size, 1)?))
}

fn given(picture: Option<Given<'_>>) -> Picture {
    match picture {
        None => Picture::File,
        Some(Given::Bytes(bytes)) => Picture::Bytes(bytes.as_bytes().to_vec()),
        Some(Given::Pixels(array)) => Picture::Pixels(pixels(&array)),
    }
}

fn pixels(array: &PyReadonlyArray3<'_, f32>) -> Pixels {
    let (height, width) = (array.shape()[0], array.shape()[1]);
    let view = array.as_array();
    Pixels::from_fn(width, height, |x, y| std::array::from_fn(|c| view[[y, x, c]]))
}
