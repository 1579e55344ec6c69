//! `pondhop_core::evaluate`.

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
#[allow(clippy::needless_pass_by_value)]
pub fn evaluate(py: Python<'_>, problem: &Problem, routes: Vec<Vec<usize>>) -> PyResult<Plan> {
    py.detach(|| pondhop_core::evaluate::evaluate(&problem.inner, &routes))
        .map(|inner| Plan::new(&problem.inner, inner))
        .map_err(|error| to_python(&error))
}
