//! `pondhop_core::territory`.

use crate::arguments::{Real, Seed, Task, Whole, checked};
use crate::effort::{callback, limits, watched};
use pondhop_core::error::Faults;
use pondhop_core::territory::{Options, plan};
use pyo3::prelude::*;
use std::time::Instant;

/// Plan balanced routes, each in a territory of its own: the convex hulls of their ponds do not touch.
///
/// Parameters
/// ----------
/// problem
///     What is to be planned.
/// seed
///     Of all random choices. Without a time limit, the same seed gives the same routes.
/// time_limit_s, iterations
///     Wall time in seconds, and steps, above 0; the planner ends with the first that is used up. Without both a fixed
///     number of steps per pond: about 20 ms at 700 ponds.
/// progress
///     Called about ten times a second, as by `search`.
///
/// Returns
/// -------
/// routes : list of list of int
///     Pond indices per route in flying order, the depot implied at both ends: at most one route per drone, every pond
///     once. Ponds in one place are on one route.
/// elapsed_s : float
///     Wall time in seconds from the problem's coordinates to finished routes, everything included.
/// is_interrupted : bool
///     Whether Ctrl-C ended the planner; the routes are the best so far.
///
/// Raises
/// ------
/// InvalidInput
///     With every argument that has no meaning.
#[pyfunction]
#[pyo3(signature = (problem, *, seed=Seed::of(1), time_limit_s=None, iterations=None, progress=None))]
pub fn territory(
    py: Python<'_>,
    problem: Task,
    seed: Seed,
    time_limit_s: Option<Real>,
    iterations: Option<Whole>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Vec<Vec<usize>>, f64, bool)> {
    let begin = Instant::now();
    let mut faults = Faults::default();
    let seed = seed.number(&mut faults);
    let (time_limit_s, iterations) = limits(&mut faults, time_limit_s, iterations);
    let progress = callback(&mut faults, progress)?;
    checked(faults, ())?;
    watched(py, begin, time_limit_s, progress, |clock, watch| {
        plan(&problem.0, &Options { seed, max_iterations: iterations, clock, watch })
    })
}
