//! `pondhop_core::evaluate`.

use crate::arguments;
use crate::error::to_python;
use crate::plan::Plan;
use crate::problem::Problem;
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
pub fn evaluate(py: Python<'_>, problem: &Problem, routes: &Bound<'_, PyAny>) -> PyResult<Plan> {
    let routes = arguments::routes("routes", routes)?;
    py.detach(|| pondhop_core::evaluate::evaluate(&problem.inner, &routes))
        .map(|inner| Plan::new(&problem.inner, inner))
        .map_err(|error| to_python(&error))
}
