//! `pondhop_core::plan`.

use crate::arguments::{Real, count, shown};
use crate::error::{InvalidInput, to_python};
use crate::values::{hash_of, table};
use numpy::{PyArray1, PyArray2, ToPyArray};
use pondhop_core::error::Faults;
use pondhop_core::plan::Route;
use pondhop_core::problem::VehicleType;
use pyo3::prelude::*;
use pyo3::types::{PyTuple, PyType};
use std::sync::Arc;

/// A rule that a plan breaks: immutable. Its text is a sentence; its fields say the same to a program.
///
/// Parameters
/// ----------
/// kind
///     ``"unserved"``: no route visits the pond; ``"repeated"``: it is visited more than once; ``"too_many_routes"``: there are
///     fewer drones; ``"too_long"``, ``"too_slow"``, ``"too_much_energy"``: a route exceeds the length, duration or energy of a
///     drone.
/// pond
///     Index of the pond; None where the rule is about routes.
/// route
///     Index of the route; None where the rule is about a pond or the number of routes.
/// value
///     How often the pond is visited, how many routes there are, or what the route comes to in metres, seconds or joules; None
///     for ``"unserved"``.
/// limit
///     What `value` may be at most; None for ``"unserved"``.
///
/// Raises
/// ------
/// InvalidInput
///     If there is no such kind, or a field that it needs is missing or one that it has not is given.
#[pyclass(frozen, eq, module = "pondhop")]
#[derive(PartialEq)]
pub struct Violation {
    inner: pondhop_core::plan::Violation,
}

type Fields = (&'static str, Option<usize>, Option<usize>, Option<f64>, Option<f64>);

#[pymethods]
impl Violation {
    #[new]
    #[pyo3(signature = (kind, pond=None, route=None, value=None, limit=None))]
    fn new(
        kind: &Bound<'_, PyAny>,
        pond: Option<&Bound<'_, PyAny>>,
        route: Option<&Bound<'_, PyAny>>,
        value: Option<Real>,
        limit: Option<Real>,
    ) -> PyResult<Self> {
        use pondhop_core::plan::Violation as Kind;
        let mut faults = Faults::default();
        let pond = pond.map(|pond| count(&mut faults, "pond", pond)).transpose()?;
        let route = route.map(|route| count(&mut faults, "route", route)).transpose()?;
        let value = value.map(|value| value.number(&mut faults, "value", 0.0));
        let limit = limit.map(|limit| limit.number(&mut faults, "limit", 0.0));
        faults.into_result(()).map_err(|error| to_python(&error))?;
        let inner = match (kind.extract::<String>().unwrap_or_default().as_str(), pond, route, value, limit) {
            ("unserved", Some(visit), None, None, None) => Kind::Unserved { visit },
            ("repeated", Some(visit), None, Some(times), Some(1.0)) => {
                Kind::Repeated { visit, num_times: times as usize }
            }
            ("too_many_routes", None, None, Some(routes), Some(drones)) => {
                Kind::TooManyRoutes { num_routes: routes as usize, num_available: drones as usize }
            }
            ("too_long", None, Some(route), Some(length), Some(max_length)) => {
                Kind::TooLong { route, length, max_length }
            }
            ("too_slow", None, Some(route), Some(duration), Some(max_duration)) => {
                Kind::TooSlow { route, duration, max_duration }
            }
            ("too_much_energy", None, Some(route), Some(energy), Some(usable_energy)) => {
                Kind::TooMuchEnergy { route, energy, usable_energy }
            }
            _ => {
                let message = "there is no violation of this kind with these fields";
                let action = "take violations from a plan";
                return Err(InvalidInput::new_err((vec![(format!("kind {}", shown(kind)?), message, action)],)));
            }
        };
        Ok(Self { inner })
    }

    /// What rule it is: ``"unserved"``, ``"repeated"``, ``"too_many_routes"``, ``"too_long"``, ``"too_slow"`` or
    /// ``"too_much_energy"``.
    #[getter]
    fn kind(&self) -> &'static str {
        self.fields().0
    }

    /// Index of the pond, or None.
    #[getter]
    fn pond(&self) -> Option<usize> {
        self.fields().1
    }

    /// Index of the route, or None.
    #[getter]
    fn route(&self) -> Option<usize> {
        self.fields().2
    }

    /// What it comes to: times, routes, metres, seconds or joules; or None.
    #[getter]
    fn value(&self) -> Option<f64> {
        self.fields().3
    }

    /// What it may be at most, or None.
    #[getter]
    fn limit(&self) -> Option<f64> {
        self.fields().4
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> (Bound<'py, PyType>, Fields) {
        (slf.get_type(), slf.get().fields())
    }

    fn __hash__(&self) -> u64 {
        let (kind, pond, route, value, limit) = self.fields();
        let numbers = [pond.map(|pond| pond as f64), route.map(|route| route as f64), value, limit];
        hash_of(kind.bytes().map(f64::from).chain(numbers.map(|number| number.unwrap_or(-1.0))))
    }

    fn __str__(&self) -> String {
        self.inner.to_string()
    }

    fn __repr__(&self) -> String {
        let (kind, pond, route, value, limit) = self.fields();
        let counts = [("pond", pond), ("route", route)];
        let counts = counts.into_iter().filter_map(|(name, count)| count.map(|count| format!(", {name}={count}")));
        let numbers = [("value", value), ("limit", limit)].into_iter();
        let numbers = numbers.filter_map(|(name, number)| number.map(|number| format!(", {name}={number:?}")));
        format!("Violation('{kind}'{})", counts.chain(numbers).collect::<String>())
    }
}

impl Violation {
    fn fields(&self) -> Fields {
        use pondhop_core::plan::Violation as Kind;
        match self.inner {
            Kind::Unserved { visit } => ("unserved", Some(visit), None, None, None),
            Kind::Repeated { visit, num_times } => ("repeated", Some(visit), None, Some(num_times as f64), Some(1.0)),
            Kind::TooManyRoutes { num_routes, num_available } => {
                ("too_many_routes", None, None, Some(num_routes as f64), Some(num_available as f64))
            }
            Kind::TooLong { route, length, max_length } => {
                ("too_long", None, Some(route), Some(length), Some(max_length))
            }
            Kind::TooSlow { route, duration, max_duration } => {
                ("too_slow", None, Some(route), Some(duration), Some(max_duration))
            }
            Kind::TooMuchEnergy { route, energy, usable_energy } => {
                ("too_much_energy", None, Some(route), Some(energy), Some(usable_energy))
            }
        }
    }
}

/// Routes with their schedule, as `pondhop.evaluate` recomputes them: immutable. Plans compare by value and can be pickled.
#[pyclass(frozen, eq, module = "pondhop")]
pub struct Plan {
    pub inner: pondhop_core::plan::Plan,
    pub problem: Arc<pondhop_core::problem::Problem>,
}

impl PartialEq for Plan {
    fn eq(&self, other: &Self) -> bool {
        self.inner == other.inner
    }
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

    /// Duration per route in seconds, from the start to the end of the landing, shape (routes,).
    #[getter]
    fn route_durations_s<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.per_route(py, |route| route.duration)
    }

    /// Energy per route in joules, shape (routes,); 0 where nothing is known about it.
    #[getter]
    fn route_energies_j<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.per_route(py, |route| route.energy)
    }

    /// Length of each leg in metres (unitless in research instances), one array of shape (ponds of the route + 1,) per route:
    /// the last leg leads to the depot.
    #[getter]
    fn leg_lengths_m<'py>(&self, py: Python<'py>) -> Vec<Bound<'py, PyArray1<f64>>> {
        self.arrays(py, |route| route.legs().map(|leg| leg.length).collect())
    }

    /// Duration of each leg in seconds, shaped like `leg_lengths_m`: the first with the take-off, the last with the landing.
    #[getter]
    fn leg_durations_s<'py>(&self, py: Python<'py>) -> Vec<Bound<'py, PyArray1<f64>>> {
        self.arrays(py, |route| route.legs().map(|leg| leg.duration).collect())
    }

    /// Energy of each leg in joules, shaped like `leg_lengths_m`: the first with the take-off, the last with the landing.
    #[getter]
    fn leg_energies_j<'py>(&self, py: Python<'py>) -> Vec<Bound<'py, PyArray1<f64>>> {
        self.arrays(py, |route| route.legs().map(|leg| leg.energy).collect())
    }

    /// Seconds after the start of the route of each arrival, one array of shape (ponds of the route,) per route.
    #[getter]
    fn arrivals_s<'py>(&self, py: Python<'py>) -> Vec<Bound<'py, PyArray1<f64>>> {
        self.arrays(py, |route| route.stops.iter().map(|stop| stop.arrival).collect())
    }

    /// Seconds after the start of the route of each departure, one array of shape (ponds of the route,) per route.
    #[getter]
    fn departures_s<'py>(&self, py: Python<'py>) -> Vec<Bound<'py, PyArray1<f64>>> {
        self.arrays(py, |route| route.stops.iter().map(|stop| stop.departure).collect())
    }

    /// Seconds per route and phase, shape (routes, 4): take-off; legs; on station; last leg, with the landing. They add up to
    /// the duration.
    #[getter]
    fn phase_durations_s<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let service = |route: &Route| route.stops.iter().map(|stop| stop.departure - stop.arrival).sum();
        self.phases(py, |drone| drone.takeoff_duration, |leg| leg.duration, service)
    }

    /// Joules per route and phase, shape (routes, 4): take-off; legs; on station; last leg, with the landing. They add up to
    /// the energy.
    #[getter]
    fn phase_energies_j<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let service = |route: &Route| route.stops.iter().map(|stop| stop.service_energy).sum();
        self.phases(py, |drone| drone.energy.takeoff_energy, |leg| leg.energy, service)
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

    /// The broken rules; empty for a feasible plan.
    #[getter]
    fn violations(&self) -> Vec<Violation> {
        self.inner.violations.iter().map(|&inner| Violation { inner }).collect()
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

    /// All numbers of a plan follow from its problem and routes.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let py = slf.py();
        let plan = slf.get();
        let problem = crate::problem::Problem { inner: Arc::clone(&plan.problem) };
        let evaluate = py.import("pondhop")?.getattr("evaluate")?;
        Ok((evaluate, (problem, plan.routes()).into_pyobject(py)?))
    }

    fn __hash__(&self) -> u64 {
        let numbers = self.inner.routes.iter().flat_map(|route| {
            let visits = route.visits().map(|visit| visit as f64);
            visits.chain([route.length, route.duration, route.energy])
        });
        hash_of(numbers)
    }

    fn __repr__(&self) -> String {
        format!(
            "Plan(num_routes={}, max_route_length={:?}, total_length={:?}, makespan_s={:?}, is_feasible={})",
            self.inner.routes.len(),
            self.max_route_length(),
            self.total_length(),
            self.makespan_s(),
            if self.is_feasible() { "True" } else { "False" }
        )
    }
}

impl Plan {
    pub fn new(problem: &Arc<pondhop_core::problem::Problem>, inner: pondhop_core::plan::Plan) -> Self {
        Self { inner, problem: Arc::clone(problem) }
    }

    fn per_route<'py>(&self, py: Python<'py>, value: fn(&Route) -> f64) -> Bound<'py, PyArray1<f64>> {
        self.inner.routes.iter().map(value).collect::<Vec<f64>>().to_pyarray(py)
    }

    fn arrays<'py>(&self, py: Python<'py>, values: fn(&Route) -> Vec<f64>) -> Vec<Bound<'py, PyArray1<f64>>> {
        self.inner.routes.iter().map(|route| values(route).to_pyarray(py)).collect()
    }

    fn phases<'py>(
        &self,
        py: Python<'py>,
        takeoff: fn(&VehicleType) -> f64,
        of_leg: fn(&pondhop_core::travel::Leg) -> f64,
        service: fn(&Route) -> f64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = self.inner.routes.iter().enumerate().flat_map(|(index, route)| {
            let takeoff = takeoff(&self.problem.drone_of(index));
            let legs: f64 = route.stops.iter().map(|stop| of_leg(&stop.leg)).sum();
            [takeoff, legs - takeoff, service(route), of_leg(&route.last_leg)]
        });
        table(py, rows, 4)
    }
}
