//! `pondhop_core::effort`: planning for a time, watched by Python.

use crate::arguments::{Real, Whole, shown};
use pondhop_core::effort::{Clock, Progress, Watch};
use pondhop_core::error::Faults;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Time between two looks at Python's signals and two calls of the progress callback.
const REPORT_INTERVAL: Duration = Duration::from_millis(100);

/// A time limit and a number of iterations, as they were given.
pub fn limits(
    faults: &mut Faults,
    time_limit_s: Option<Real>,
    iterations: Option<Whole>,
) -> (Option<f64>, Option<u64>) {
    let seconds = time_limit_s.map(|limit| {
        let seconds = limit.number(faults, "time_limit_s", 1.0);
        if seconds.is_nan() || seconds <= 0.0 {
            faults.add("time_limit_s", format!("it is {seconds}"), "give seconds above 0, or leave it out");
        }
        seconds
    });
    let action = "give a whole number from 1 to 2^64 - 1, or leave it out";
    (seconds, iterations.map(|number| number.number(faults, "iterations", &(1..=u64::MAX), action)))
}

/// What is called with the progress, if anything.
pub fn callback(faults: &mut Faults, progress: Option<&Bound<'_, PyAny>>) -> PyResult<Option<Py<PyAny>>> {
    let Some(progress) = progress else { return Ok(None) };
    if !progress.is_callable() {
        let action =
            "give a function of the longest route, the iterations and the share of the effort, or leave it out";
        faults.add("progress", format!("it is {}", shown(progress)?), action);
    }
    Ok(Some(progress.clone().unbind()))
}

/// Plans without the GIL. Returns what was planned, the seconds since `begin`, and whether Ctrl-C ended the planner; an error is
/// what the callback raised.
pub fn watched<T: Send>(
    py: Python<'_>,
    begin: Instant,
    time_limit_s: Option<f64>,
    progress: Option<Py<PyAny>>,
    plan: impl FnOnce(Option<Clock<'_>>, Option<Watch<'_>>) -> T + Send,
) -> PyResult<(T, f64, bool)> {
    let watcher = Watcher::new(progress, begin);
    let clock = move || time_limit_s.map_or(0.0, |limit| begin.elapsed().as_secs_f64() / limit);
    let watch = |report: &Progress| watcher.look(report);
    let (planned, elapsed) = py.detach(|| {
        let planned = plan(time_limit_s.is_some().then_some(&clock), Some(&watch));
        (planned, begin.elapsed())
    });
    Ok((planned, elapsed.as_secs_f64(), watcher.into_outcome()?))
}

/// Looks at Python now and then while a planner runs without the GIL.
struct Watcher {
    progress: Option<Py<PyAny>>,
    last: Mutex<Instant>,
    /// Whether Ctrl-C ended the search, or what the callback raised.
    outcome: Mutex<PyResult<bool>>,
}

impl Watcher {
    fn new(progress: Option<Py<PyAny>>, begin: Instant) -> Self {
        Self { progress, last: Mutex::new(begin), outcome: Mutex::new(Ok(false)) }
    }

    /// Whether Ctrl-C ended the planner, or what the callback raised.
    fn into_outcome(self) -> PyResult<bool> {
        self.outcome.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    fn look(&self, report: &Progress) -> ControlFlow<()> {
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
