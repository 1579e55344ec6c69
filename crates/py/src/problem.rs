//! `pondhop_core::problem`.

use crate::error::to_python;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, ToPyArray};
use pondhop_core::geometry::Point;
use pondhop_core::problem::{Depot, VehicleType, Visit};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// A depot, the ponds to visit and a fleet of equal drones: validated, immutable.
///
/// Parameters
/// ----------
/// depot
///     Position of the depot, shape (2,): metres, or unitless in research instances.
/// ponds
///     Positions of the ponds, shape (n, 2), n >= 1.
/// num_drones
///     How many drones there are; a plan has at most that many routes.
/// service_durations_s
///     Time on station per pond in seconds, shape (n,); 0 everywhere if not given.
/// speed_m_s
///     Ground speed.
/// leg_stop_s
///     What stopping and starting adds to every leg.
/// max_length_m, max_duration_s
///     Longest route in metres and in seconds that a drone can fly.
///
/// Raises
/// ------
/// InvalidInput
///     With every fault of the input: its place, what is wrong, what to do.
/// ValueError
///     If an array has the wrong shape.
#[pyclass(frozen, module = "pondhop")]
pub struct Problem {
    pub inner: pondhop_core::problem::Problem,
}

#[pymethods]
impl Problem {
    #[new]
    #[pyo3(signature = (depot, ponds, num_drones, *, service_durations_s=None, speed_m_s=1.0, leg_stop_s=0.0,
                        max_length_m=f64::INFINITY, max_duration_s=f64::INFINITY))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        depot: [f64; 2],
        ponds: PyReadonlyArray2<'_, f64>,
        num_drones: usize,
        service_durations_s: Option<PyReadonlyArray1<'_, f64>>,
        speed_m_s: f64,
        leg_stop_s: f64,
        max_length_m: f64,
        max_duration_s: f64,
    ) -> PyResult<Self> {
        let positions = points(&ponds)?;
        let durations = match &service_durations_s {
            Some(array) => array.as_array().to_vec(),
            None => vec![0.0; positions.len()],
        };
        if durations.len() != positions.len() {
            let message = format!("service_durations_s has {} values for {} ponds", durations.len(), positions.len());
            return Err(PyValueError::new_err(message));
        }
        let visits = positions
            .iter()
            .zip(durations)
            .map(|(&position, service_duration)| Visit { position, service_duration })
            .collect();
        let vehicle_type = VehicleType {
            num_available: num_drones,
            speed: speed_m_s,
            leg_stop_duration: leg_stop_s,
            max_length: max_length_m,
            max_duration: max_duration_s,
        };
        let depot = Depot { position: Point::new(depot[0], depot[1]) };
        let inner =
            pondhop_core::problem::Problem::new(depot, visits, vehicle_type).map_err(|error| to_python(&error))?;
        Ok(Self { inner })
    }

    /// Position of the depot, shape (2,).
    #[getter]
    fn depot<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let position = self.inner.depot().position;
        [position.x, position.y].to_pyarray(py)
    }

    /// Positions of the ponds, shape (n, 2).
    #[getter]
    fn ponds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows: Vec<Vec<f64>> =
            self.inner.visits().iter().map(|visit| vec![visit.position.x, visit.position.y]).collect();
        Ok(PyArray2::from_vec2(py, &rows)?)
    }

    /// Number of ponds.
    #[getter]
    fn num_ponds(&self) -> usize {
        self.inner.num_visits()
    }

    /// Number of drones.
    #[getter]
    fn num_drones(&self) -> usize {
        self.inner.vehicle_type().num_available
    }

    /// Time on station per pond in seconds, shape (n,).
    #[getter]
    fn service_durations_s<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.inner.visits().iter().map(|visit| visit.service_duration).collect::<Vec<f64>>().to_pyarray(py)
    }

    /// Ground speed in metres per second.
    #[getter]
    fn speed_m_s(&self) -> f64 {
        self.inner.vehicle_type().speed
    }

    /// What stopping and starting adds to every leg, in seconds.
    #[getter]
    fn leg_stop_s(&self) -> f64 {
        self.inner.vehicle_type().leg_stop_duration
    }

    /// Longest route in metres that a drone can fly; infinite where nothing limits it.
    #[getter]
    fn max_length_m(&self) -> f64 {
        self.inner.vehicle_type().max_length
    }

    /// Longest route in seconds that a drone can fly; infinite where nothing limits it.
    #[getter]
    fn max_duration_s(&self) -> f64 {
        self.inner.vehicle_type().max_duration
    }

    fn __repr__(&self) -> String {
        format!("Problem(num_ponds={}, num_drones={})", self.num_ponds(), self.num_drones())
    }
}

/// The rows of an array of shape (n, 2).
pub fn points(array: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<Point>> {
    let view = array.as_array();
    if view.ncols() != 2 {
        let message = format!("positions have shape (n, 2), not ({}, {})", view.nrows(), view.ncols());
        return Err(PyValueError::new_err(message));
    }
    Ok(view.rows().into_iter().map(|row| Point::new(row[0], row[1])).collect())
}
