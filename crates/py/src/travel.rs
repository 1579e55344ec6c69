//! `pondhop_core::travel`.

use crate::arguments::Task;
use numpy::{PyArray2, PyArrayMethods};
use pondhop_core::geometry::Point;
use pondhop_core::travel::{LegKind, leg_duration, leg_length};
use pyo3::prelude::*;

/// Length of the leg between every two places.
///
/// Parameters
/// ----------
/// problem
///     What is to be planned.
///
/// Returns
/// -------
/// numpy.ndarray
///     Metres (unitless in research instances), shape (n + 1, n + 1): row and column 0 are the depot, i + 1 is pond i.
///
/// Raises
/// ------
/// MemoryError
///     If there is no room for the array.
#[pyfunction]
pub fn leg_lengths<'py>(py: Python<'py>, problem: Task) -> PyResult<Bound<'py, PyArray2<f64>>> {
    matrix(py, &problem, |length, _| length)
}

/// Duration of the leg from every place to every other, as `pondhop.evaluate` counts it.
///
/// Parameters
/// ----------
/// problem
///     What is to be planned.
///
/// Returns
/// -------
/// numpy.ndarray
///     Seconds, shape (n + 1, n + 1): row 0 holds the first legs of routes, from the depot, with the take-off; column 0 the
///     last legs, the way home; row i + 1 and column j + 1 the leg from pond i to pond j. 0 on the diagonal. Time on station
///     is not part of a leg.
///
/// Raises
/// ------
/// MemoryError
///     If there is no room for the array.
#[pyfunction]
pub fn leg_durations<'py>(py: Python<'py>, problem: Task) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let vehicle_type = problem.0.vehicle_type();
    matrix(py, &problem, |length, kind| leg_duration(length, kind, &vehicle_type))
}

fn matrix<'py>(
    py: Python<'py>,
    problem: &Task,
    value: impl Fn(f64, LegKind) -> f64,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let visits = problem.0.visits().iter().map(|visit| visit.position);
    let places: Vec<Point> = std::iter::once(problem.0.depot().position).chain(visits).collect();
    // Numpy says what it has no memory for; a vector would end the process.
    let array: Bound<'py, PyArray2<f64>> =
        py.import("numpy")?.call_method1("zeros", ((places.len(), places.len()),))?.extract()?;
    let mut writable = array.readwrite();
    for ((from, to), leg) in writable.as_array_mut().indexed_iter_mut() {
        let kind = match (from, to) {
            (0, _) => LegKind::First,
            (_, 0) => LegKind::Last,
            _ => LegKind::Between,
        };
        if from != to {
            *leg = value(leg_length(places[from], places[to]), kind);
        }
    }
    drop(writable);
    Ok(array)
}
