//! `pondhop_core::effort`: planning for a time, watched by Python.

use pondhop_core::effort::{Clock, Progress, Watch};
use pyo3::exceptions::{PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Time between two looks at Python's signals and two calls of the progress callback.
const REPORT_INTERVAL: Duration = Duration::from_millis(100);

pub fn check_limits(time_limit_s: Option<f64>, iterations: Option<u64>) -> PyResult<()> {
    if time_limit_s.is_some_and(|limit| limit.is_nan() || limit <= 0.0) || iterations == Some(0) {
        return Err(PyValueError::new_err("time_limit_s and iterations are above 0"));
    }
    Ok(())
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
