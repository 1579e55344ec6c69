//! `pondhop_core::bound`.

use crate::arguments::Task;
use pyo3::prelude::*;

/// Bound the longest route of every plan from below.
///
/// Returns
/// -------
/// float
///     A length in the unit of the problem: no plan has a shorter longest route. Durations and limits are not considered.
///
/// References
/// ----------
/// docs/explanation/bounds.md; Held and Karp, The traveling-salesman problem and minimum spanning trees, 1970 and 1971.
#[pyfunction]
pub fn lower_bound(py: Python<'_>, problem: Task) -> f64 {
    py.detach(|| pondhop_core::bound::lower_bound(&problem.0))
}

/// Bound the makespan of every plan from below.
///
/// Returns
/// -------
/// float
///     Seconds: every plan has a route that takes as long, with take-off, legs, stops, time on station and way home. Limits are
///     not considered. Equal to `lower_bound` in research instances.
///
/// References
/// ----------
/// docs/explanation/bounds.md.
#[pyfunction]
pub fn lower_bound_of_makespan(py: Python<'_>, problem: Task) -> f64 {
    py.detach(|| pondhop_core::bound::lower_bound_of_makespan(&problem.0))
}

/// Bound the total length of every plan from below.
///
/// Returns
/// -------
/// float
///     A length in the unit of the problem, whatever the number of drones. Durations and limits are not considered.
#[pyfunction]
pub fn lower_bound_of_total(py: Python<'_>, problem: Task) -> f64 {
    py.detach(|| pondhop_core::bound::lower_bound_of_total(&problem.0))
}
