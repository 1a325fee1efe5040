//! Arrays of the session as NumPy's, and the other way around.

use caustica::session::{Array, NumberKind};
use numpy::{IntoPyArray, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;

/// A NumPy array of the numbers in the precision in which they are kept; a plain number for one of no dimension.
pub fn to_numpy(py: Python<'_>, array: Array) -> PyResult<Bound<'_, PyAny>> {
    if array.shape.is_empty() {
        return array.data[0].into_bound_py_any(py);
    }
    let shape = array.shape;
    Ok(match array.kind {
        NumberKind::Double => array.data.into_pyarray(py).reshape(shape)?.into_any(),
        NumberKind::Single => {
            let data: Vec<f32> = array.data.into_iter().map(|v| v as f32).collect();
            data.into_pyarray(py).reshape(shape)?.into_any()
        }
        NumberKind::Index => {
            let data: Vec<u32> = array.data.into_iter().map(|v| v as u32).collect();
            data.into_pyarray(py).reshape(shape)?.into_any()
        }
    })
}

/// Numbers that were given.
pub fn from_numpy(array: &PyReadonlyArrayDyn<'_, f64>) -> Array {
    let data = array.as_array().iter().copied().collect();
    Array { shape: array.shape().to_vec(), data, kind: NumberKind::Double }
}

/// A picture of shape (height, width) or (height, width, channels).
pub fn picture(
    py: Python<'_>,
    data: Vec<f32>,
    [width, height]: [usize; 2],
    channels: usize,
) -> PyResult<Bound<'_, PyAny>> {
    let array = data.into_pyarray(py);
    Ok(match channels {
        1 => array.reshape([height, width])?.into_any(),
        n => array.reshape([height, width, n])?.into_any(),
    })
}
