//! `pondhop_core::territory`.

use crate::problem::Problem;
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
/// time_limit_s
///     Wall time in seconds, above 0; None for a fixed effort per pond: about 20 ms at 700 ponds.
///
/// Returns
/// -------
/// routes : list of list of int
///     Pond indices per route in flying order, the depot implied at both ends: at most one route per drone, every pond
///     once. Where ponds share a place, hulls may share that place.
/// elapsed_s : float
///     Wall time in seconds from the problem's coordinates to finished routes, everything included.
#[pyfunction]
#[pyo3(signature = (problem, *, seed=1, time_limit_s=None))]
pub fn territory(py: Python<'_>, problem: &Problem, seed: u64, time_limit_s: Option<f64>) -> (Vec<Vec<usize>>, f64) {
    py.detach(|| {
        let start = Instant::now();
        let share = |limit_s: f64| move || start.elapsed().as_secs_f64() / limit_s;
        let clock = time_limit_s.map(share);
        let routes = match &clock {
            Some(clock) => pondhop_core::territory::plan(&problem.inner, seed, Some(clock)),
            None => pondhop_core::territory::plan(&problem.inner, seed, None),
        };
        (routes, start.elapsed().as_secs_f64())
    })
}
