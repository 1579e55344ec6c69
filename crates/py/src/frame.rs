//! `pondhop_core::frame`.

use crate::arguments::{Real, points};
use crate::error::to_python;
use crate::values::{hash_of, table};
use numpy::PyArray2;
use pondhop_core::error::Faults;
use pondhop_core::geometry::Point;
use pyo3::prelude::*;
use pyo3::types::PyType;

const MAX_LONGITUDE_DEG: f64 = 360.0;
const MAX_LATITUDE_DEG: f64 = 90.0;

/// A metric frame around a place on the globe: x east and y north of the origin, in metres.
///
/// A transverse Mercator projection of WGS84 with scale 1 at the origin; lengths are right to 2e-6 within 10 km.
///
/// Parameters
/// ----------
/// longitude_deg, latitude_deg
///     The origin: longitudes of -360 to 360, for places across the 180th meridian; latitudes of -90 to 90.
///
/// Raises
/// ------
/// InvalidInput
///     With each of them that is no such number.
#[pyclass(frozen, eq, module = "pondhop")]
#[derive(PartialEq)]
pub struct LocalFrame {
    inner: pondhop_core::frame::LocalFrame,
}

#[pymethods]
impl LocalFrame {
    #[new]
    fn new(longitude_deg: Real, latitude_deg: Real) -> PyResult<Self> {
        let mut faults = Faults::default();
        let longitude = degrees(&mut faults, "longitude_deg", longitude_deg, MAX_LONGITUDE_DEG);
        let latitude = degrees(&mut faults, "latitude_deg", latitude_deg, MAX_LATITUDE_DEG);
        let inner = pondhop_core::frame::LocalFrame::new(longitude, latitude);
        faults.into_result(Self { inner }).map_err(|error| to_python(&error))
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

fn degrees(faults: &mut Faults, name: &str, value: Real, most: f64) -> f64 {
    let degrees = value.number(faults, name, 0.0);
    if !(-most..=most).contains(&degrees) {
        faults.add(name, format!("it is {degrees}"), &format!("give degrees of -{most} to {most}"));
        return 0.0;
    }
    degrees
}

fn places(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<Point>> {
    let mut faults = Faults::default();
    let places = points(&mut faults, name, value)?;
    faults.into_result(()).map_err(|error| to_python(&error))?;
    Ok(places.unwrap_or_default())
}
