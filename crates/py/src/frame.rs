//! `pondhop_core::frame`.

use crate::arguments::points;
use crate::error::to_python;
use crate::values::{hash_of, table};
use numpy::PyArray2;
use pondhop_core::error::Faults;
use pondhop_core::geometry::Point;
use pyo3::prelude::*;
use pyo3::types::PyType;

/// A metric frame around a place on the globe: x east and y north of the origin, in metres.
///
/// A transverse Mercator projection of WGS84 with scale 1 at the origin; lengths are right to 2e-6 within 10 km.
///
/// Parameters
/// ----------
/// longitude_deg, latitude_deg
///     The origin.
#[pyclass(frozen, eq, module = "pondhop")]
#[derive(PartialEq)]
pub struct LocalFrame {
    inner: pondhop_core::frame::LocalFrame,
}

#[pymethods]
impl LocalFrame {
    #[new]
    fn new(longitude_deg: f64, latitude_deg: f64) -> Self {
        Self { inner: pondhop_core::frame::LocalFrame::new(longitude_deg, latitude_deg) }
    }

    /// Longitude and latitude of the origin in degrees.
    #[getter]
    fn origin_deg(&self) -> (f64, f64) {
        self.inner.origin_deg()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> (Bound<'py, PyType>, (f64, f64)) {
        (slf.get_type(), slf.get().origin_deg())
    }

    fn __hash__(&self) -> u64 {
        hash_of(<[f64; 2]>::from(self.origin_deg()))
    }

    fn __repr__(&self) -> String {
        let (longitude_deg, latitude_deg) = self.origin_deg();
        format!("LocalFrame(longitude_deg={longitude_deg:?}, latitude_deg={latitude_deg:?})")
    }

    /// Metres east and north, shape (n, 2), of longitudes and latitudes in degrees, shape (n, 2), of any real type.
    ///
    /// Raises
    /// ------
    /// InvalidInput
    ///     If the array has another shape or type.
    fn to_local<'py>(&self, py: Python<'py>, lonlat_deg: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let places = places("lonlat_deg", lonlat_deg)?;
        let local = places.iter().map(|place| self.inner.to_local(place.x, place.y));
        table(py, local.flat_map(|point| [point.x, point.y]), 2)
    }

    /// Longitudes and latitudes in degrees, shape (n, 2), of metres east and north, shape (n, 2), of any real type.
    ///
    /// Raises
    /// ------
    /// InvalidInput
    ///     If the array has another shape or type.
    fn to_geographic<'py>(&self, py: Python<'py>, local_m: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let places = places("local_m", local_m)?;
        let geographic = places.iter().map(|&place| self.inner.to_geographic(place));
        table(py, geographic.flat_map(|(longitude_deg, latitude_deg)| [longitude_deg, latitude_deg]), 2)
    }
}

fn places(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<Point>> {
    let mut faults = Faults::default();
    let places = points(&mut faults, name, value)?;
    faults.into_result(()).map_err(|error| to_python(&error))?;
    Ok(places.unwrap_or_default())
}
