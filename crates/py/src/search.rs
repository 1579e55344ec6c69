//! `pondhop_core::search`.

use crate::arguments;
use crate::arguments::{Seed, Task};
use crate::effort::{check_limits, watched};
use crate::error::to_python;
use pondhop_core::plan::Violation;
use pondhop_core::search::{Goal, Options, solve};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::time::Instant;

/// Minimise the longest route, then the total, by ruin and recreate.
///
/// What is minimised is time: legs, stops and service. In research instances time is length. The limits of length and energy of
/// the drones are kept, wherever the search finds a plan that keeps them.
///
/// Parameters
/// ----------
/// problem
///     What is to be planned.
/// seed
///     Same seed, iterations and threads: same routes.
/// time_limit_s, iterations
///     Wall time from the problem's coordinates to finished routes, and steps per thread; at least one of them. The search
///     ends with the first that is used up.
/// threads
///     Chains that search side by side and share their best plans.
/// slack
///     How much the longest route may grow, as a share, to shorten the total, within the time a drone can be under way.
/// objective
///     ``"max"``: the longest route, then the total; ``"total"``: the total, within the time a drone can be under way.
/// start
///     Routes to begin with: every pond once, at most one route per drone.
/// progress
///     Called about ten times a second with the longest route so far in seconds, the iterations and the share of the
///     effort used. An exception it raises ends the search and is raised.
///
/// Returns
/// -------
/// routes : list of list of int
///     Pond indices per route in flying order, the depot implied at both ends: at most one route per drone, every pond
///     once.
/// elapsed_s : float
///     Wall time in seconds from the problem's coordinates to finished routes, everything included.
/// iterations : int
///     Steps of the first thread.
/// is_interrupted : bool
///     Whether Ctrl-C ended the search; the routes are the best so far.
///
/// Raises
/// ------
/// InvalidInput
///     If `start` breaks a rule.
/// ValueError
///     If an option has no meaning.
#[pyfunction]
#[pyo3(signature = (problem, *, seed=Seed::of(1), time_limit_s=None, iterations=None, threads=1, slack=0.0, objective="max",
                    start=None, progress=None))]
#[allow(clippy::too_many_arguments, clippy::needless_pass_by_value)]
pub fn search(
    py: Python<'_>,
    problem: Task,
    seed: Seed,
    time_limit_s: Option<f64>,
    iterations: Option<u64>,
    threads: usize,
    slack: f64,
    objective: &str,
    start: Option<&Bound<'_, PyAny>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Vec<Vec<usize>>, f64, u64, bool)> {
    let begin = Instant::now();
    let seed = seed.number()?;
    let goal = match objective {
        "max" => Goal::Max,
        "total" => Goal::Total,
        _ => return Err(PyValueError::new_err(format!("objective is 'max' or 'total', not {objective:?}"))),
    };
    check_effort(time_limit_s, iterations, threads, slack)?;
    let start = start.map(|routes| arguments::routes("start", routes)).transpose()?;
    if let Some(routes) = &start {
        check_start(&problem, routes)?;
    }
    let (outcome, elapsed_s, is_interrupted) = watched(py, begin, time_limit_s, progress, |clock, watch| {
        let options = Options {
            seed,
            max_iterations: iterations,
            clock,
            watch,
            num_threads: threads,
            goal,
            slack,
            start: start.as_deref(),
        };
        solve(&problem.0, &options)
    })?;
    Ok((outcome.routes, elapsed_s, outcome.num_iterations, is_interrupted))
}

fn check_effort(time_limit_s: Option<f64>, iterations: Option<u64>, threads: usize, slack: f64) -> PyResult<()> {
    check_limits(time_limit_s, iterations)?;
    let complaint = if time_limit_s.is_none() && iterations.is_none() {
        "give time_limit_s or iterations"
    } else if !(1..=MAX_THREADS).contains(&threads) {
        "threads is 1 to 1024"
    } else if !(slack.is_finite() && slack >= 0.0) {
        "slack is 0 or more"
    } else {
        return Ok(());
    };
    Err(PyValueError::new_err(complaint))
}

/// Beyond this a mistyped number would exhaust the machine.
const MAX_THREADS: usize = 1024;

fn check_start(problem: &Task, routes: &[Vec<usize>]) -> PyResult<()> {
    let plan = pondhop_core::evaluate::evaluate(&problem.0, routes).map_err(|error| to_python(&error))?;
    let is_limit = |violation: &&Violation| {
        matches!(violation, Violation::TooLong { .. } | Violation::TooSlow { .. } | Violation::TooMuchEnergy { .. })
    };
    match plan.violations.iter().find(|violation| !is_limit(violation)) {
        Some(violation) => Err(PyValueError::new_err(format!("start: {violation}"))),
        None => Ok(()),
    }
}
