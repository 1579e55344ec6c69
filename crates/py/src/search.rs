//! `pondhop_core::search`.

use crate::arguments;
use crate::arguments::{Real, Seed, Task, Whole, Word, checked};
use crate::effort::{callback, limits, watched};
use crate::error::to_python;
use pondhop_core::error::Faults;
use pondhop_core::plan::Violation;
use pondhop_core::search::{Goal, Options, solve};
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
///     With every argument that has no meaning, or if `start` breaks a rule other than a limit.
#[pyfunction]
#[pyo3(signature = (problem, *, seed=Seed::of(1), time_limit_s=None, iterations=None, threads=Whole::of(1),
                    slack=Real::of(0.0), objective=Word::default(),
                    start=None, progress=None))]
#[allow(clippy::too_many_arguments, clippy::needless_pass_by_value)]
pub fn search(
    py: Python<'_>,
    problem: Task,
    seed: Seed,
    time_limit_s: Option<Real>,
    iterations: Option<Whole>,
    threads: Whole,
    slack: Real,
    objective: Word<'_>,
    start: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Vec<Vec<usize>>, f64, u64, bool)> {
    let begin = Instant::now();
    let mut faults = Faults::default();
    let seed = seed.number(&mut faults);
    let (time_limit_s, iterations) = limits(&mut faults, time_limit_s, iterations);
    if time_limit_s.is_none() && iterations.is_none() {
        faults.add("time_limit_s", "there is no limit to the effort", "give time_limit_s or iterations");
    }
    let action = format!("give the cores there are, 1 to {MAX_THREADS}");
    let num_threads = threads.number(&mut faults, "threads", &(1..=MAX_THREADS), &action) as usize;
    let slack = slack.number(&mut faults, "slack", 0.0);
    if !(slack.is_finite() && slack >= 0.0) {
        faults.add("slack", format!("it is {slack}"), "give a share, 0 or more, as in 0.015");
    }
    let goals = [("max", Goal::Max), ("total", Goal::Total)];
    let goal = objective.meaning(&mut faults, "objective", &goals)?;
    let progress = callback(&mut faults, progress)?;
    checked(faults, ())?;
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
            num_threads,
            goal,
            slack,
            start: start.as_deref(),
        };
        solve(&problem.0, &options)
    })?;
    Ok((outcome.routes, elapsed_s, outcome.num_iterations, is_interrupted))
}

/// Beyond this a mistyped number would exhaust the machine.
pub const MAX_THREADS: u64 = 1024;

fn check_start(problem: &Task, routes: &[Vec<usize>]) -> PyResult<()> {
    let plan = pondhop_core::evaluate::evaluate(&problem.0, routes).map_err(|error| to_python(&error))?;
    let is_limit = |violation: &&Violation| {
        matches!(violation, Violation::TooLong { .. } | Violation::TooSlow { .. } | Violation::TooMuchEnergy { .. })
    };
    let mut faults = Faults::default();
    for violation in plan.violations.iter().filter(|violation| !is_limit(violation)) {
        faults.add("start", violation.to_string(), "give a plan that only time or length limits may break");
    }
    checked(faults, ())
}
