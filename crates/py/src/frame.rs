//! `pondhop_core::frame`.

use crate::problem::points;
use numpy::{PyArray2, PyReadonlyArray2};
use pondhop_core::geometry::Point;
use pyo3::prelude::*;

/// A metric frame around a place on the globe: x east and y north of the origin, in metres.
///
/// A transverse Mercator projection of WGS84 with scale 1 at the origin; lengths are right to 2e-6 within 10 km.
///
/// Parameters
/// ----------
/// longitude_deg, latitude_deg
///     The origin.
#[pyclass(frozen, module = "pondhop")]
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

    /// Metres east and north, shape (n, 2), of longitudes and latitudes in degrees, shape (n, 2).
    fn to_local<'py>(
        &self,
        py: Python<'py>,
        lonlat_deg: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let local = |place: &Point| {
            let point = self.inner.to_local(place.x, place.y);
            vec![point.x, point.y]
        };
        Ok(PyArray2::from_vec2(py, &points(&lonlat_deg)?.iter().map(local).collect::<Vec<_>>())?)
    }

    /// Longitudes and latitudes in degrees, shape (n, 2), of metres east and north, shape (n, 2).
    fn to_geographic<'py>(
        &self,
        py: Python<'py>,
        local_m: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let geographic = |point: &Point| {
            let (longitude_deg, latitude_deg) = self.inner.to_geographic(*point);
            vec![longitude_deg, latitude_deg]
        };
        Ok(PyArray2::from_vec2(py, &points(&local_m)?.iter().map(geographic).collect::<Vec<_>>())?)
    }
}
