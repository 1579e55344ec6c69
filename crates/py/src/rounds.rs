//! `pondhop_core::rounds` and the search for them.

use crate::arguments;
use crate::arguments::{Real, Seed, Whole, Word, checked, shown};
use crate::effort::{callback, limits, watched};
use crate::error::to_python;
use pondhop_core::error::Faults;
use pondhop_core::rounds::{Fleet, RoundVisit, Rounding, TimeWindow, evaluate_round as judge};
use pondhop_core::search::{Options, solve_round};
use pyo3::prelude::*;
use std::sync::Arc;
use std::time::Instant;

/// Trips of each drone, each the visits in flying order.
type Routes = Vec<Vec<Vec<usize>>>;

/// A depot, visits with windows, releases and loads, and drones that may fly several trips: validated, immutable.
///
/// Legs are as long as they take: drones fly at unit speed, as in research instances.
///
/// Parameters
/// ----------
/// depot
///     Position of the depot, shape (2,).
/// visits
///     Positions of the visits, shape (n, 2), n >= 1.
/// num_drones
///     How many drones there are.
/// service_durations, loads, releases
///     Per visit, shape (n,): time on station, what it takes of a trip's capacity, and the time before which no trip with it
///     takes off; 0 everywhere if not given.
/// windows
///     For each visit the pairs ``(earliest, latest)`` between which its service may begin; none: at any time.
/// capacity, max_trip_duration
///     The load and the time that one trip may take.
/// shift
///     When drones may take off first, and must be back for good.
/// turnaround
///     Time at the depot between two trips of a drone; if not given, each flies one trip.
/// rounding
///     ``"exact"``, or ``"dimacs"``: legs without all but their first decimal.
///
/// Raises
/// ------
/// InvalidInput
///     With every fault of the input.
#[pyclass(frozen, module = "pondhop._core")]
pub struct Round {
    inner: Arc<pondhop_core::rounds::Round>,
}

#[pymethods]
impl Round {
    #[new]
    #[pyo3(signature = (depot, visits, num_drones, *, service_durations=None, loads=None, releases=None, windows=None,
                        capacity=Real::of(f64::INFINITY), max_trip_duration=Real::of(f64::INFINITY),
                        shift=(0.0, f64::INFINITY), turnaround=None, rounding=Word::default()))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        depot: &Bound<'_, PyAny>,
        visits: &Bound<'_, PyAny>,
        num_drones: &Bound<'_, PyAny>,
        service_durations: Option<&Bound<'_, PyAny>>,
        loads: Option<&Bound<'_, PyAny>>,
        releases: Option<&Bound<'_, PyAny>>,
        windows: Option<&Bound<'_, PyAny>>,
        capacity: Real,
        max_trip_duration: Real,
        shift: (f64, f64),
        turnaround: Option<Real>,
        rounding: Word<'_>,
    ) -> PyResult<Self> {
        let mut faults = Faults::default();
        let depot = arguments::point(&mut faults, "depot", depot)?.unwrap_or_default();
        let positions = arguments::points(&mut faults, "visits", visits)?.unwrap_or_default();
        let num_visits = (!positions.is_empty()).then_some(positions.len());
        let mut values = |name, given| arguments::values(&mut faults, name, given, num_visits);
        let service_durations = values("service_durations", service_durations)?;
        let loads = values("loads", loads)?;
        let releases = values("releases", releases)?;
        let windows = windows_of(&mut faults, windows, positions.len())?;
        let at = |values: &[f64], index: usize| values.get(index).copied().unwrap_or(0.0);
        let visits = positions.into_iter().zip(windows).enumerate().map(|(index, (position, windows))| RoundVisit {
            position,
            service_duration: at(&service_durations, index),
            windows,
            release: at(&releases, index),
            load: at(&loads, index),
        });
        let fleet = Fleet {
            num_drones: arguments::num_drones(&mut faults, num_drones)?,
            capacity: capacity.number(&mut faults, "capacity", 1.0),
            max_trip_duration: max_trip_duration.number(&mut faults, "max_trip_duration", 1.0),
            shift: TimeWindow { earliest: shift.0, latest: shift.1 },
            turnaround: turnaround.map(|turnaround| turnaround.number(&mut faults, "turnaround", 0.0)),
        };
        let rounding =
            rounding.meaning(&mut faults, "rounding", &[("exact", Rounding::Exact), ("dimacs", Rounding::Dimacs)])?;
        let round = pondhop_core::rounds::Round::new(depot, visits.collect(), fleet, rounding);
        let inner = faults.with(round).map_err(|error| to_python(&error))?;
        Ok(Self { inner: Arc::new(inner) })
    }

    /// How many visits there are.
    #[getter]
    fn num_visits(&self) -> usize {
        self.inner.visits().len()
    }
}

/// The windows of each visit; none at all where none are given.
fn windows_of(
    faults: &mut Faults,
    value: Option<&Bound<'_, PyAny>>,
    num_visits: usize,
) -> PyResult<Vec<Vec<TimeWindow>>> {
    let Some(value) = value else { return Ok(vec![Vec::new(); num_visits]) };
    let action = "give a list of pairs (earliest, latest) for each visit";
    match value.extract::<Vec<Vec<(f64, f64)>>>() {
        Ok(pairs) if pairs.len() == num_visits => {
            let window = |(earliest, latest)| TimeWindow { earliest, latest };
            Ok(pairs.into_iter().map(|pairs| pairs.into_iter().map(window).collect()).collect())
        }
        Ok(pairs) => {
            faults.add("windows", format!("there are {} lists for {num_visits} visits", pairs.len()), action);
            Ok(vec![Vec::new(); num_visits])
        }
        Err(_) => {
            faults.add("windows", format!("it is {}", shown(value)?), action);
            Ok(vec![Vec::new(); num_visits])
        }
    }
}

/// Minimise the total length of the trips of a round, by ruin and recreate.
///
/// Parameters
/// ----------
/// problem
///     What is to be flown.
/// seed
///     Same seed and iterations: same routes.
/// time_limit_s, iterations
///     Wall time and steps; at least one of them.
/// progress
///     Called about ten times a second with the total length so far, the iterations and the share of the effort used.
///
/// Returns
/// -------
/// routes : list of list of list of int
///     The trips of each drone that flies. What no trip could make is in none.
/// elapsed_s : float
///     Wall time in seconds.
/// iterations : int
///     Steps made.
/// is_interrupted : bool
///     Whether Ctrl-C ended the search; the routes are the best so far.
///
/// Raises
/// ------
/// InvalidInput
///     With every argument that has no meaning.
#[pyfunction]
#[pyo3(signature = (problem, *, seed=Seed::of(1), time_limit_s=None, iterations=None, progress=None))]
pub fn search_round(
    py: Python<'_>,
    problem: &Round,
    seed: Seed,
    time_limit_s: Option<Real>,
    iterations: Option<Whole>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Routes, f64, u64, bool)> {
    let begin = Instant::now();
    let mut faults = Faults::default();
    let seed = seed.number(&mut faults);
    let (time_limit_s, iterations) = limits(&mut faults, time_limit_s, iterations);
    if time_limit_s.is_none() && iterations.is_none() {
        faults.add("time_limit_s", "there is no limit to the effort", "give time_limit_s or iterations");
    }
    let progress = callback(&mut faults, progress)?;
    checked(faults, ())?;
    let round = Arc::clone(&problem.inner);
    let (outcome, elapsed_s, is_interrupted) = watched(py, begin, time_limit_s, progress, move |clock, watch| {
        solve_round(&round, &Options { seed, max_iterations: iterations, clock, watch, ..Options::default() })
    })?;
    Ok((outcome.routes, elapsed_s, outcome.num_iterations, is_interrupted))
}

/// A plan of a round, recomputed from bare routes by `evaluate_round`.
#[pyclass(frozen, module = "pondhop._core")]
pub struct RoundPlan {
    inner: pondhop_core::rounds::RoundPlan,
}

#[pymethods]
impl RoundPlan {
    /// The trips of each drone, each the visits in flying order.
    #[getter]
    fn routes(&self) -> Routes {
        let visits = |trip: &pondhop_core::rounds::Trip| trip.stops.iter().map(|stop| stop.visit).collect();
        self.inner.routes.iter().map(|trips| trips.iter().map(visits).collect()).collect()
    }

    /// Take-off and landing of each trip.
    #[getter]
    fn trip_times(&self) -> Vec<Vec<(f64, f64)>> {
        let times =
            |trips: &Vec<pondhop_core::rounds::Trip>| trips.iter().map(|trip| (trip.departure, trip.arrival)).collect();
        self.inner.routes.iter().map(times).collect()
    }

    /// The sum of the lengths of all trips.
    #[getter]
    fn total_length(&self) -> f64 {
        self.inner.total_length()
    }

    /// When the last drone lands.
    #[getter]
    fn makespan(&self) -> f64 {
        self.inner.makespan()
    }

    /// Whether nothing is wrong with it.
    #[getter]
    fn is_feasible(&self) -> bool {
        self.inner.is_feasible()
    }

    /// What is wrong with it, a sentence each.
    #[getter]
    fn violations(&self) -> Vec<String> {
        self.inner.violations.iter().map(ToString::to_string).collect()
    }
}

/// Recompute everything about a plan of a round from bare routes: lengths, times, violations.
///
/// Parameters
/// ----------
/// round
///     What was to be flown.
/// routes
///     For each drone its trips, each the visits in flying order.
///
/// Raises
/// ------
/// InvalidInput
///     If a trip names a visit that does not exist, or the routes are no lists of lists of whole numbers.
#[pyfunction]
pub fn evaluate_round(problem: &Round, routes: &Bound<'_, PyAny>) -> PyResult<RoundPlan> {
    let Ok(trips) = routes.extract::<Routes>() else {
        let mut faults = Faults::default();
        faults.add(
            "routes",
            format!("it is {}", shown(routes)?),
            "give for each drone a list of trips, lists of visits",
        );
        return checked(faults, Routes::new()).and_then(|none| judged(problem, &none));
    };
    judged(problem, &trips)
}

fn judged(round: &Round, trips: &[Vec<Vec<usize>>]) -> PyResult<RoundPlan> {
    judge(&round.inner, trips).map(|inner| RoundPlan { inner }).map_err(|error| to_python(&error))
}
