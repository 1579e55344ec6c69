//! `pondhop_core::rounds` and the search for them.

use crate::arguments;
use crate::arguments::{Real, Seed, Whole, Word, checked, shown};
use crate::effort::{callback, limits, watched};
use crate::error::to_python;
use crate::problem::Problem;
use crate::search::MAX_THREADS;
use crate::values::table;
use numpy::PyArray2;
use pondhop_core::error::Faults;
use pondhop_core::geometry::Point;
use pondhop_core::rounds::{Fleet, RoundVisit, Rounding, TimeWindow, evaluate_held_round as judge, makespan_bound};
use pondhop_core::search::{Goal, Options, solve_round};
use pondhop_core::travel::Air;
use pyo3::prelude::*;
use std::sync::Arc;
use std::time::Instant;

/// Trips of each drone, each the visits in flying order.
type Routes = Vec<Vec<Vec<usize>>>;

/// What is to be flown in one round, by drones that may fly several trips: validated, immutable.
///
/// Parameters
/// ----------
/// problem
///     Depot, places, services and drones; its limits of length, time and energy are those of one trip.
/// windows
///     For each visit the pairs ``(earliest, latest)`` in seconds between which its service may begin; none: at any time.
/// releases_s, loads, priorities
///     Per visit, shape (n,): the time before which no trip with it takes off, what it takes of a trip's capacity, 0 everywhere
///     if not given; and what it is worth beside others where not all can be made, 1 everywhere if not given.
/// capacity
///     The load that one trip may take.
/// shift_s
///     When the first drone may take off, and when all must be back for good.
/// takeoff_interval_s
///     How much later each drone may take off than the one before it.
/// turnaround_s
///     Time at the depot between two trips of a drone; if not given, each flies one trip.
/// num_pads
///     How many drones the depot can turn round at once; if not given, all.
/// wind_m_s
///     Velocity of the wind towards east and north.
/// max_airspeed_m_s
///     The fastest that drones fly through the air.
/// drag_power_w_per_m3_s3
///     What the third power of the airspeed adds to the power of flight.
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
    #[pyo3(signature = (problem, *, windows=None, releases_s=None, loads=None, priorities=None,
                        capacity=Real::of(f64::INFINITY), shift_s=(0.0, f64::INFINITY), takeoff_interval_s=Real::of(0.0),
                        turnaround_s=None, num_pads=None, wind_m_s=(0.0, 0.0), max_airspeed_m_s=Real::of(f64::INFINITY),
                        drag_power_w_per_m3_s3=Real::of(0.0), rounding=Word::default()))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        problem: &Problem,
        windows: Option<&Bound<'_, PyAny>>,
        releases_s: Option<&Bound<'_, PyAny>>,
        loads: Option<&Bound<'_, PyAny>>,
        priorities: Option<&Bound<'_, PyAny>>,
        capacity: Real,
        shift_s: (f64, f64),
        takeoff_interval_s: Real,
        turnaround_s: Option<Real>,
        num_pads: Option<Whole>,
        wind_m_s: (f64, f64),
        max_airspeed_m_s: Real,
        drag_power_w_per_m3_s3: Real,
        rounding: Word<'_>,
    ) -> PyResult<Self> {
        let mut faults = Faults::default();
        let problem = &problem.inner;
        let num_visits = Some(problem.num_visits());
        let mut values = |name, given| arguments::values(&mut faults, name, given, num_visits);
        let releases = values("releases_s", releases_s)?;
        let loads = values("loads", loads)?;
        let priorities = values("priorities", priorities)?;
        let windows = windows_of(&mut faults, windows, problem.num_visits())?;
        let at = |values: &[f64], index: usize, default: f64| values.get(index).copied().unwrap_or(default);
        let visits = problem.visits().iter().zip(windows).enumerate().map(|(index, (&visit, windows))| RoundVisit {
            visit,
            windows,
            release: at(&releases, index, 0.0),
            load: at(&loads, index, 0.0),
            priority: at(&priorities, index, 1.0),
        });
        let air = Air {
            wind: Point::new(wind_m_s.0, wind_m_s.1),
            max_airspeed: max_airspeed_m_s.number(&mut faults, "max_airspeed_m_s", f64::INFINITY),
            drag_power: drag_power_w_per_m3_s3.number(&mut faults, "drag_power_w_per_m3_s3", 0.0),
        };
        let num_pads = num_pads
            .map(|num_pads| num_pads.number(&mut faults, "num_pads", &(1..=u64::from(u32::MAX)), "give 1 or more"));
        let num_pads = num_pads.and_then(|num_pads| usize::try_from(num_pads).ok()).unwrap_or(usize::MAX);
        let fleet = Fleet {
            vehicle_type: problem.vehicle_type(),
            layers: problem.layers().to_vec(),
            air,
            capacity: capacity.number(&mut faults, "capacity", 1.0),
            shift: TimeWindow { earliest: shift_s.0, latest: shift_s.1 },
            takeoff_interval: takeoff_interval_s.number(&mut faults, "takeoff_interval_s", 0.0),
            turnaround: turnaround_s.map(|turnaround| turnaround.number(&mut faults, "turnaround_s", 0.0)),
            num_pads,
        };
        let rounding =
            rounding.meaning(&mut faults, "rounding", &[("exact", Rounding::Exact), ("dimacs", Rounding::Dimacs)])?;
        let depot = problem.depot().position;
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

/// Plan the trips of a round by ruin and recreate, so that the last drone lands early, or what all fly takes little time. Where
/// not all visits can be made, those of most priority are.
///
/// Parameters
/// ----------
/// problem
///     What is to be flown.
/// seed
///     Same seed and iterations: same routes.
/// time_limit_s, iterations
///     Wall time and steps; at least one of them.
/// threads
///     Chains that search side by side.
/// objective
///     ``"max"``: the last landing; ``"total"``: the time that all drones fly.
/// progress
///     Called about ten times a second with the last landing or the time flown so far, the iterations and the share of the effort used.
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
#[pyo3(signature = (problem, *, seed=Seed::of(1), time_limit_s=None, iterations=None, threads=Whole::of(1), objective=Word::default(), progress=None))]
#[allow(clippy::too_many_arguments)]
pub fn search_round(
    py: Python<'_>,
    problem: &Round,
    seed: Seed,
    time_limit_s: Option<Real>,
    iterations: Option<Whole>,
    threads: Whole,
    objective: Word<'_>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Routes, f64, u64, bool)> {
    let begin = Instant::now();
    let mut faults = Faults::default();
    let seed = seed.number(&mut faults);
    let (time_limit_s, iterations) = limits(&mut faults, time_limit_s, iterations);
    if time_limit_s.is_none() && iterations.is_none() {
        faults.add("time_limit_s", "there is no limit to the effort", "give time_limit_s or iterations");
    }
    let action = format!("give the cores there are, 1 to {MAX_THREADS}");
    let num_threads = threads.number(&mut faults, "threads", &(1..=MAX_THREADS), &action) as usize;
    let goal = objective.meaning(&mut faults, "objective", &[("max", Goal::Max), ("total", Goal::Total)])?;
    let progress = callback(&mut faults, progress)?;
    checked(faults, ())?;
    let round = Arc::clone(&problem.inner);
    let (outcome, elapsed_s, is_interrupted) = watched(py, begin, time_limit_s, progress, move |clock, watch| {
        let options =
            Options { seed, max_iterations: iterations, clock, watch, num_threads, goal, ..Options::default() };
        solve_round(&round, &options)
    })?;
    Ok((outcome.routes, elapsed_s, outcome.num_iterations, is_interrupted))
}

/// What a drone flies between two stays at the depot.
#[pyclass(frozen, module = "pondhop._core")]
pub struct Trip {
    inner: pondhop_core::rounds::Trip,
}

#[pymethods]
impl Trip {
    /// The visits in flying order.
    #[getter]
    fn visits(&self) -> Vec<usize> {
        self.inner.stops.iter().map(|stop| stop.visit).collect()
    }

    /// When it takes off, in seconds.
    #[getter]
    fn departure_s(&self) -> f64 {
        self.inner.departure
    }

    /// When it lands, in seconds.
    #[getter]
    fn arrival_s(&self) -> f64 {
        self.inner.arrival
    }

    /// When the drone is ready for its next trip, in seconds; the landing, if there is none.
    #[getter]
    fn ready_s(&self) -> f64 {
        self.inner.ready
    }

    /// Length from depot to depot, in metres.
    #[getter]
    fn length_m(&self) -> f64 {
        self.inner.length
    }

    /// What it takes from the battery, in joules.
    #[getter]
    fn energy_j(&self) -> f64 {
        self.inner.energy
    }

    /// For each visit when the drone arrives, begins and leaves, in seconds, shape (n, 3).
    #[getter]
    fn times_s<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        table(py, self.inner.stops.iter().flat_map(|stop| [stop.arrival, stop.start, stop.departure]), 3)
    }

    /// For each leg, the way home last, metres, seconds and joules, shape (n + 1, 3).
    #[getter]
    fn legs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let legs = self.inner.stops.iter().map(|stop| stop.leg).chain([self.inner.last_leg]);
        table(py, legs.flat_map(|leg| [leg.length, leg.duration, leg.energy]), 3)
    }

    /// For each visit what the trip has taken from the battery when the drone leaves, and what the way home from there takes, in
    /// joules, shape (n, 2).
    #[getter]
    fn energies_j<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        table(py, self.inner.stops.iter().flat_map(|stop| [stop.energy_used, stop.energy_home]), 2)
    }
}

/// A rule that a plan of a round breaks.
#[pyclass(frozen, module = "pondhop._core")]
pub struct RoundViolation {
    inner: pondhop_core::rounds::RoundViolation,
}

/// Kind, visit, route, trip, value and limit of a violation.
type Broken = (&'static str, Option<usize>, Option<usize>, Option<usize>, Option<f64>, Option<f64>);

impl RoundViolation {
    fn fields(&self) -> Broken {
        use pondhop_core::rounds::RoundViolation as Kind;
        match self.inner {
            Kind::Unserved { visit } => ("unserved", Some(visit), None, None, None, None),
            Kind::Repeated { visit, num_times } => {
                ("repeated", Some(visit), None, None, Some(num_times as f64), Some(1.0))
            }
            Kind::TooManyRoutes { num_routes, num_drones } => {
                ("too_many_routes", None, None, None, Some(num_routes as f64), Some(num_drones as f64))
            }
            Kind::TooManyTrips { route, num_trips } => {
                ("too_many_trips", None, Some(route), None, Some(num_trips as f64), Some(1.0))
            }
            Kind::OverCapacity { route, trip, load, capacity } => {
                ("too_many_samples", None, Some(route), Some(trip), Some(load), Some(capacity))
            }
            Kind::Late { visit, by } => ("late", Some(visit), None, None, Some(by), None),
            Kind::TooSlow { route, trip, duration, max_duration } => {
                ("too_slow", None, Some(route), Some(trip), Some(duration), Some(max_duration))
            }
            Kind::TooLong { route, trip, length, max_length } => {
                ("too_long", None, Some(route), Some(trip), Some(length), Some(max_length))
            }
            Kind::TooMuchEnergy { route, trip, energy, usable_energy } => {
                ("too_much_energy", None, Some(route), Some(trip), Some(energy), Some(usable_energy))
            }
            Kind::NoWayHome { route, trip, visit, by } => {
                ("no_way_home", Some(visit), Some(route), Some(trip), Some(by), None)
            }
            Kind::ShiftOver { route, by } => ("after_the_end", None, Some(route), None, Some(by), None),
        }
    }
}

#[pymethods]
impl RoundViolation {
    /// What rule it is; docs/reference/json.md lists them.
    #[getter]
    fn kind(&self) -> &'static str {
        self.fields().0
    }

    /// Index of the visit, or None.
    #[getter]
    fn visit(&self) -> Option<usize> {
        self.fields().1
    }

    /// Index of the drone, or None.
    #[getter]
    fn route(&self) -> Option<usize> {
        self.fields().2
    }

    /// Index of the trip of that drone, or None.
    #[getter]
    fn trip(&self) -> Option<usize> {
        self.fields().3
    }

    /// What it comes to, or by how much it is too much: times, trips, metres, seconds or joules; or None.
    #[getter]
    fn value(&self) -> Option<f64> {
        self.fields().4
    }

    /// What it may be at most, or None.
    #[getter]
    fn limit(&self) -> Option<f64> {
        self.fields().5
    }

    fn __str__(&self) -> String {
        self.inner.to_string()
    }
}

/// A plan of a round, recomputed from bare routes by `evaluate_round`.
#[pyclass(frozen, module = "pondhop._core")]
pub struct RoundPlan {
    inner: pondhop_core::rounds::RoundPlan,
}

#[pymethods]
impl RoundPlan {
    /// The trips of each drone; none of one that does not fly.
    #[getter]
    fn trips(&self) -> Vec<Vec<Trip>> {
        let trip = |trip: &pondhop_core::rounds::Trip| Trip { inner: trip.clone() };
        self.inner.routes.iter().map(|trips| trips.iter().map(trip).collect()).collect()
    }

    /// The visits of the trips of each drone in flying order.
    #[getter]
    fn routes(&self) -> Routes {
        let visits = |trip: &pondhop_core::rounds::Trip| trip.stops.iter().map(|stop| stop.visit).collect();
        self.inner.routes.iter().map(|trips| trips.iter().map(visits).collect()).collect()
    }

    /// The sum of the lengths of all trips.
    #[getter]
    fn total_length(&self) -> f64 {
        self.inner.total_length()
    }

    /// What all trips take from their batteries, in joules.
    #[getter]
    fn total_energy_j(&self) -> f64 {
        self.inner.total_energy()
    }

    /// When the last drone lands, in seconds.
    #[getter]
    fn makespan_s(&self) -> f64 {
        self.inner.makespan()
    }

    /// Whether nothing is wrong with it.
    #[getter]
    fn is_feasible(&self) -> bool {
        self.inner.is_feasible()
    }

    /// What is wrong with it.
    #[getter]
    fn violations(&self) -> Vec<RoundViolation> {
        self.inner.violations.iter().map(|&inner| RoundViolation { inner }).collect()
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
/// holds_s
///     For each drone by how many seconds each of its trips is held back at least; none, if not given.
///
/// Raises
/// ------
/// InvalidInput
///     If a trip names a visit that does not exist, or the routes are no lists of lists of whole numbers.
#[pyfunction]
#[pyo3(signature = (problem, routes, holds_s=None))]
pub fn evaluate_round(
    problem: &Round,
    routes: &Bound<'_, PyAny>,
    holds_s: Option<Vec<Vec<f64>>>,
) -> PyResult<RoundPlan> {
    let holds = holds_s.unwrap_or_default();
    let Ok(trips) = routes.extract::<Routes>() else {
        let mut faults = Faults::default();
        faults.add(
            "routes",
            format!("it is {}", shown(routes)?),
            "give for each drone a list of trips, lists of visits",
        );
        return checked(faults, Routes::new()).and_then(|none| judged(problem, &none, &holds));
    };
    judged(problem, &trips, &holds)
}

/// How early the last drone of a round can land at best: no plan that makes all visits has its last landing earlier.
///
/// Parameters
/// ----------
/// problem
///     What is to be flown.
///
/// Returns
/// -------
/// float
///     In seconds; infinite if no plan makes all visits.
#[pyfunction]
pub fn round_bound(py: Python<'_>, problem: &Round) -> f64 {
    let round = Arc::clone(&problem.inner);
    py.detach(move || makespan_bound(&round))
}

fn judged(round: &Round, trips: &[Vec<Vec<usize>>], holds: &[Vec<f64>]) -> PyResult<RoundPlan> {
    judge(&round.inner, trips, holds).map(|inner| RoundPlan { inner }).map_err(|error| to_python(&error))
}
