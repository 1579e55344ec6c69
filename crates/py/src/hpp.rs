//! `pondhop_core::hpp`.

use crate::arguments::{Seed, Task};
use numpy::PyArray2;
use pyo3::prelude::*;
use std::time::Instant;

/// Plan with HPP, the paper's planner: k-means, then back and forth over the hull of each cluster.
///
/// Parameters
/// ----------
/// problem
///     What is to be planned. HPP looks at places only: no limit, service duration or speed changes its plan, but a way home
///     of the drones' own decides which way round a route is flown.
/// seed
///     Starts the clustering.
///
/// Returns
/// -------
/// routes : list of list of int
///     Pond indices per route in flying order, the depot implied at both ends: at most one route per drone, every pond
///     once.
/// elapsed_s : float
///     Wall time in seconds from the problem's coordinates to finished routes, everything included.
#[pyfunction]
#[pyo3(signature = (problem, *, seed=Seed::of(1)))]
pub fn hpp(py: Python<'_>, problem: Task, seed: Seed) -> PyResult<(Vec<Vec<usize>>, f64)> {
    let seed = seed.checked()?;
    Ok(py.detach(|| {
        let start = Instant::now();
        let routes = pondhop_core::hpp::plan(&problem.0, seed);
        (routes, start.elapsed().as_secs_f64())
    }))
}

/// What HPP did with each cluster, for the paper's figure 2.
///
/// Parameters
/// ----------
/// problem, seed
///     As for `hpp`, whose routes these are.
///
/// Returns
/// -------
/// list of tuple
///     Per route: the pond indices in flying order; the pond indices at the corners of the cluster's convex hull,
///     counter-clockwise; the corners of the back-and-forth path the route follows, shape (corners, 2), without the depot.
#[pyfunction]
#[pyo3(signature = (problem, *, seed=Seed::of(1)))]
#[allow(clippy::type_complexity)]
pub fn hpp_clusters<'py>(
    py: Python<'py>,
    problem: Task,
    seed: Seed,
) -> PyResult<Vec<(Vec<usize>, Vec<usize>, Bound<'py, PyArray2<f64>>)>> {
    let seed = seed.checked()?;
    let plan = py.detach(|| pondhop_core::hpp::plan_clusters(&problem.0, seed));
    plan.clusters
        .into_iter()
        .map(|cluster| {
            let rows: Vec<Vec<f64>> = cluster.path.iter().map(|corner| vec![corner.x, corner.y]).collect();
            Ok((cluster.route, cluster.hull, PyArray2::from_vec2(py, &rows)?))
        })
        .collect()
}
