//! `pondhop_core::plan`.

use numpy::{PyArray1, ToPyArray};
use pyo3::prelude::*;

/// Routes with their schedule, as `pondhop.evaluate` recomputes them: immutable.
#[pyclass(frozen, module = "pondhop")]
pub struct Plan {
    pub inner: pondhop_core::plan::Plan,
}

#[pymethods]
impl Plan {
    /// Pond indices per route in flying order, the depot implied at both ends.
    #[getter]
    fn routes(&self) -> Vec<Vec<usize>> {
        self.inner.routes.iter().map(|route| route.visits().collect()).collect()
    }

    /// Length per route in metres (unitless in research instances), shape (routes,).
    #[getter]
    fn route_lengths<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.per_route(py, |route| route.length)
    }

    /// Duration per route in seconds, shape (routes,).
    #[getter]
    fn route_durations_s<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.per_route(py, |route| route.duration)
    }

    /// Seconds after take-off of each arrival, one array of shape (ponds of the route,) per route.
    #[getter]
    fn arrivals_s<'py>(&self, py: Python<'py>) -> Vec<Bound<'py, PyArray1<f64>>> {
        self.per_stop(py, |stop| stop.arrival)
    }

    /// Seconds after take-off of each departure, one array of shape (ponds of the route,) per route.
    #[getter]
    fn departures_s<'py>(&self, py: Python<'py>) -> Vec<Bound<'py, PyArray1<f64>>> {
        self.per_stop(py, |stop| stop.departure)
    }

    /// The longest route in metres (unitless in research instances): the paper's metric.
    #[getter]
    fn max_route_length(&self) -> f64 {
        self.inner.max_route_length()
    }

    /// The sum of all route lengths.
    #[getter]
    fn total_length(&self) -> f64 {
        self.inner.total_length()
    }

    /// The longest route in seconds.
    #[getter]
    fn makespan_s(&self) -> f64 {
        self.inner.makespan()
    }

    /// One sentence per broken rule; empty for a feasible plan.
    #[getter]
    fn violations(&self) -> Vec<String> {
        self.inner.violations.iter().map(ToString::to_string).collect()
    }

    /// Indices of the ponds that no route visits.
    #[getter]
    fn unserved(&self) -> Vec<usize> {
        self.inner.unserved()
    }

    /// Whether no rule is broken.
    #[getter]
    fn is_feasible(&self) -> bool {
        self.inner.is_feasible()
    }

    fn __repr__(&self) -> String {
        format!(
            "Plan(num_routes={}, max_route_length={}, total_length={}, is_feasible={})",
            self.inner.routes.len(),
            self.max_route_length(),
            self.total_length(),
            if self.is_feasible() { "True" } else { "False" }
        )
    }
}

impl Plan {
    fn per_route<'py>(
        &self,
        py: Python<'py>,
        value: fn(&pondhop_core::plan::Route) -> f64,
    ) -> Bound<'py, PyArray1<f64>> {
        self.inner.routes.iter().map(value).collect::<Vec<f64>>().to_pyarray(py)
    }

    fn per_stop<'py>(
        &self,
        py: Python<'py>,
        value: fn(&pondhop_core::plan::Stop) -> f64,
    ) -> Vec<Bound<'py, PyArray1<f64>>> {
        let of_route =
            |route: &pondhop_core::plan::Route| route.stops.iter().map(value).collect::<Vec<f64>>().to_pyarray(py);
        self.inner.routes.iter().map(of_route).collect()
    }
}
