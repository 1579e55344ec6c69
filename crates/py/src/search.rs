//! `pondhop_core::search`.

use crate::arguments;
use crate::error::to_python;
use crate::problem::Problem;
use pondhop_core::effort::Progress;
use pondhop_core::plan::Violation;
use pondhop_core::search::{Goal, Options, solve};
use pyo3::exceptions::{PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Time between two looks at Python's signals and two calls of the progress callback.
const REPORT_INTERVAL: Duration = Duration::from_millis(100);

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
#[pyo3(signature = (problem, *, seed=1, time_limit_s=None, iterations=None, threads=1, slack=0.0, objective="max",
                    start=None, progress=None))]
#[allow(clippy::too_many_arguments, clippy::needless_pass_by_value)]
pub fn search(
    py: Python<'_>,
    problem: &Problem,
    seed: u64,
    time_limit_s: Option<f64>,
    iterations: Option<u64>,
    threads: usize,
    slack: f64,
    objective: &str,
    start: Option<&Bound<'_, PyAny>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Vec<Vec<usize>>, f64, u64, bool)> {
    let begin = Instant::now();
    let goal = match objective {
        "max" => Goal::Max,
        "total" => Goal::Total,
        _ => return Err(PyValueError::new_err(format!("objective is 'max' or 'total', not {objective:?}"))),
    };
    check_effort(time_limit_s, iterations, threads, slack)?;
    let start = start.map(|routes| arguments::routes("start", routes)).transpose()?;
    if let Some(routes) = &start {
        check_start(problem, routes)?;
    }
    let watcher = Watcher::new(progress, begin);
    let clock = move || time_limit_s.map_or(0.0, |limit| begin.elapsed().as_secs_f64() / limit);
    let watch = |report: &Progress| watcher.look(report);
    let options = Options {
        seed,
        max_iterations: iterations,
        clock: time_limit_s.is_some().then_some(&clock),
        watch: Some(&watch),
        num_threads: threads,
        goal,
        slack,
        start: start.as_deref(),
    };
    let (outcome, elapsed) = py.detach(|| (solve(&problem.inner, &options), begin.elapsed()));
    let is_interrupted = watcher.into_outcome()?;
    Ok((outcome.routes, elapsed.as_secs_f64(), outcome.num_iterations, is_interrupted))
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

pub fn check_limits(time_limit_s: Option<f64>, iterations: Option<u64>) -> PyResult<()> {
    if time_limit_s.is_some_and(|limit| limit.is_nan() || limit <= 0.0) || iterations == Some(0) {
        return Err(PyValueError::new_err("time_limit_s and iterations are above 0"));
    }
    Ok(())
}

/// Beyond this a mistyped number would exhaust the machine.
const MAX_THREADS: usize = 1024;

fn check_start(problem: &Problem, routes: &[Vec<usize>]) -> PyResult<()> {
    let plan = pondhop_core::evaluate::evaluate(&problem.inner, routes).map_err(|error| to_python(&error))?;
    let is_limit = |violation: &&Violation| {
        matches!(violation, Violation::TooLong { .. } | Violation::TooSlow { .. } | Violation::TooMuchEnergy { .. })
    };
    match plan.violations.iter().find(|violation| !is_limit(violation)) {
        Some(violation) => Err(PyValueError::new_err(format!("start: {violation}"))),
        None => Ok(()),
    }
}

/// Looks at Python now and then while a planner runs without the GIL.
pub struct Watcher {
    progress: Option<Py<PyAny>>,
    last: Mutex<Instant>,
    /// Whether Ctrl-C ended the search, or what the callback raised.
    outcome: Mutex<PyResult<bool>>,
}

impl Watcher {
    pub fn new(progress: Option<Py<PyAny>>, begin: Instant) -> Self {
        Self { progress, last: Mutex::new(begin), outcome: Mutex::new(Ok(false)) }
    }

    /// Whether Ctrl-C ended the planner, or what the callback raised.
    pub fn into_outcome(self) -> PyResult<bool> {
        self.outcome.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn look(&self, report: &Progress) -> ControlFlow<()> {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if last.elapsed() < REPORT_INTERVAL {
            return ControlFlow::Continue(());
        }
        *last = Instant::now();
        let seen = Python::attach(|py| match py.check_signals() {
            Ok(()) => self.call_back(py, report).map(|()| false),
            Err(error) if error.is_instance_of::<PyKeyboardInterrupt>(py) => Ok(true),
            Err(error) => Err(error),
        });
        if matches!(seen, Ok(false)) {
            return ControlFlow::Continue(());
        }
        *self.outcome.lock().unwrap_or_else(PoisonError::into_inner) = seen;
        ControlFlow::Break(())
    }

    fn call_back(&self, py: Python<'_>, report: &Progress) -> PyResult<()> {
        // Before the first plan there is nothing to tell.
        let Some(progress) = self.progress.as_ref().filter(|_| report.max_route_cost.is_finite()) else {
            return Ok(());
        };
        progress.call1(py, (report.max_route_cost, report.num_iterations, report.share)).map(|_| ())
    }
}
