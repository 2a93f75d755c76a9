//! Pictures in files, and their differences. Arrays have the shape (height, width, 4), RGBA.

use std::path::PathBuf;

use marraztu_core::base::image::{Picture, Size};
use marraztu_io::{self as io, PICTURE_FORMATS};
use marraztu_lab::error;
use marraztu_lab::flip::difference;
use numpy::{PyArray1, PyArray3, PyArrayMethods, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors::Failure;
use crate::threads::work;

/// An array of pixels.
pub(crate) type Pixels<'py> = PyReadonlyArray3<'py, u8>;

/// Loads NumPy before work that ends in arrays. Ctrl+C during the work would interrupt loading it
/// afterwards, and the conversion to an array panics then.
pub(crate) fn load_numpy(py: Python<'_>) -> PyResult<()> {
    py.import("numpy")?;
    py.check_signals()?;
    drop(PyArray1::from_vec(py, vec![0_u8]));
    Ok(())
}

/// Returns the pixels of a picture as an array, without copying them.
pub(crate) fn array(py: Python<'_>, picture: Picture) -> PyResult<Bound<'_, PyArray3<u8>>> {
    let Size { width, height } = picture.size();
    let bytes = picture.into_pixels().into_flattened();
    PyArray1::from_vec(py, bytes).reshape([height, width, 4])
}

/// Copies an array of pixels.
pub(crate) fn picture(pixels: &Pixels<'_>) -> Result<Picture, Failure> {
    let invalid = || Failure::value("pixels need the shape (height, width, 4), not empty");
    let [height, width, 4] = *pixels.shape() else { return Err(invalid()) };
    let (pixels, _) = pixels.as_slice().map_err(Failure::value)?.as_chunks::<4>();
    let picture = Picture::from_pixels(Size::new(width, height), pixels.to_vec());
    picture.filter(|picture| picture.size().area() > 0).ok_or_else(invalid)
}

/// Loads a picture.
#[pyfunction]
pub(crate) fn load_picture(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyArray3<u8>>> {
    load_numpy(py)?;
    let picture = work(py, 1, |_| Ok(io::load_picture(&path)?))?;
    array(py, picture)
}

/// Saves a picture in the format of the path's extension.
#[pyfunction]
pub(crate) fn save_picture(py: Python<'_>, path: PathBuf, pixels: Pixels<'_>) -> PyResult<()> {
    let picture = picture(&pixels)?;
    work(py, 1, |_| {
        io::check_picture_target(&path)?;
        Ok(io::save_picture(&path, &picture)?)
    })
}

/// Encodes a picture as PNG.
#[pyfunction]
pub(crate) fn png<'py>(py: Python<'py>, pixels: Pixels<'py>) -> PyResult<Bound<'py, PyBytes>> {
    let picture = picture(&pixels)?;
    let png = work(py, 1, |_| PICTURE_FORMATS[0].encode(&picture).map_err(Failure::value))?;
    Ok(PyBytes::new(py, &png))
}

/// Returns the perceived difference of two pictures of one size, from 0 to 1.
#[pyfunction]
pub(crate) fn flip(py: Python<'_>, a: Pixels<'_>, b: Pixels<'_>) -> PyResult<f64> {
    let [a, b] = same_size(&a, &b)?;
    work(py, 0, |_| Ok(difference(&a, &b)))
}

/// Returns the difference of two pictures of one size, multiplied by a factor.
#[pyfunction]
pub(crate) fn amplified<'py>(
    py: Python<'py>,
    a: Pixels<'py>,
    b: Pixels<'py>,
    factor: u16,
) -> PyResult<Bound<'py, PyArray3<u8>>> {
    let [a, b] = same_size(&a, &b)?;
    array(py, work(py, 0, |_| Ok(error::amplified(&a, &b, factor)))?)
}

fn same_size(a: &Pixels<'_>, b: &Pixels<'_>) -> Result<[Picture; 2], Failure> {
    let [a, b] = [picture(a)?, picture(b)?];
    if a.size() == b.size() { Ok([a, b]) } else { Err(Failure::value("the sizes differ")) }
}
