//! `pondhop_core::evaluate`.

use crate::arguments;
use crate::arguments::Task;
use crate::error::to_python;
use crate::plan::Plan;
use pyo3::prelude::*;

/// Recompute everything about a plan from bare routes: lengths, schedule, energy, violations.
///
/// Parameters
/// ----------
/// problem
///     What was to be planned.
/// routes
///     Pond indices per route in flying order, the depot implied at both ends. Empty routes are dropped.
///
/// Returns
/// -------
/// Plan
///     With a `Violation` for every rule the routes break.
///
/// Raises
/// ------
/// InvalidInput
///     If a route names a pond that does not exist.
#[pyfunction]
pub fn evaluate(py: Python<'_>, problem: Task, routes: &Bound<'_, PyAny>) -> PyResult<Plan> {
    let routes = arguments::routes("routes", routes)?;
    py.detach(|| pondhop_core::evaluate::evaluate(&problem.0, &routes))
        .map(|inner| Plan::new(&problem.0, inner))
        .map_err(|error| to_python(&error))
}
