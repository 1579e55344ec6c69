//! The one truth about a plan of a round: everything recomputed from the round and bare routes.
//!
//! It flies every trip twice: forward as early as it can, for arrivals, and backward from its landing, for the latest take-off
//! that lands as early. No code is shared with the search beyond what a leg is ([`Round::leg`]). O(n) for n visits with a
//! bounded number of windows, O(n^2) for trips that must wait on the ground to be short enough.

use super::plan::{RoundPlan, RoundStop, RoundViolation, Trip};
use super::round::{Round, RoundVisit};
use crate::error::{Faults, InvalidInput};

/// How late something may be by rounding, relative to the time it is late at.
const TOLERANCE: f64 = 1e-9;

/// Flies `routes` (for each drone its trips, each the visits in flying order) and reports schedule and violations. Empty
/// trips and routes are dropped. A visit that comes too late for all its windows is served at once, and is a violation.
///
/// # Errors
/// [`InvalidInput`] if a trip names a visit that does not exist.
pub fn evaluate_round(round: &Round, routes: &[Vec<Vec<usize>>]) -> Result<RoundPlan, InvalidInput> {
    check_indices(round, routes)?;
    let mut violations = Vec::new();
    let mut flown: Vec<Vec<Trip>> = Vec::new();
    for trips in routes {
        let trips: Vec<&Vec<usize>> = trips.iter().filter(|trip| !trip.is_empty()).collect();
        if !trips.is_empty() {
            let route = flown.len();
            flown.push(fly_route(round, route, &trips, &mut violations));
        }
    }
    let mut all = count_violations(round, &flown);
    all.extend(violations);
    Ok(RoundPlan { routes: flown, violations: all })
}

fn check_indices(round: &Round, routes: &[Vec<Vec<usize>>]) -> Result<(), InvalidInput> {
    let mut faults = Faults::default();
    let num_visits = round.visits().len();
    for (route, trips) in routes.iter().enumerate() {
        for (trip, visits) in trips.iter().enumerate() {
            for (place, &visit) in visits.iter().enumerate() {
                if visit >= num_visits {
                    let action = format!("give an index of 0 to {}", num_visits - 1);
                    faults.add(
                        format!("routes[{route}][{trip}][{place}]"),
                        format!("there is no visit {visit}"),
                        &action,
                    );
                }
            }
        }
    }
    faults.into_result(())
}

fn fly_route(round: &Round, route: usize, trips: &[&Vec<usize>], violations: &mut Vec<RoundViolation>) -> Vec<Trip> {
    let fleet = round.fleet();
    if fleet.turnaround.is_none() && trips.len() > 1 {
        violations.push(RoundViolation::TooManyTrips { route, num_trips: trips.len() });
    }
    let mut ready = fleet.shift.earliest;
    let mut flown = Vec::with_capacity(trips.len());
    for (index, visits) in trips.iter().enumerate() {
        let trip = fly_trip(round, visits, ready, violations);
        let duration = trip.arrival - trip.departure;
        if is_over(trip.load, fleet.capacity) {
            let (load, capacity) = (trip.load, fleet.capacity);
            violations.push(RoundViolation::OverCapacity { route, trip: index, load, capacity });
        }
        if is_over(duration, fleet.max_trip_duration) {
            let max_duration = fleet.max_trip_duration;
            violations.push(RoundViolation::TooSlow { route, trip: index, duration, max_duration });
        }
        ready = trip.arrival + fleet.turnaround.unwrap_or(0.0);
        flown.push(trip);
    }
    let arrival = flown[flown.len() - 1].arrival;
    if is_over(arrival, fleet.shift.latest) {
        violations.push(RoundViolation::ShiftOver { route, by: arrival - fleet.shift.latest });
    }
    flown
}

fn is_over(value: f64, limit: f64) -> bool {
    value > limit + TOLERANCE * limit.abs().max(1.0)
}

/// The trip that lands first; if that takes longer than a trip may, the first that does not, because a take-off that waits for
/// later windows may spend less time in the air.
fn fly_trip(round: &Round, visits: &[usize], ready: f64, violations: &mut Vec<RoundViolation>) -> Trip {
    let take_off = visits.iter().map(|&visit| round.visits()[visit].release).fold(ready, f64::max);
    let (trip, late) = fly_from(round, visits, take_off);
    let is_short = |trip: &Trip| !is_over(trip.arrival - trip.departure, round.fleet().max_trip_duration);
    if late.is_empty() && !is_short(&trip) {
        let mut later = later_departures(round, visits, take_off).into_iter().map(|time| fly_from(round, visits, time));
        if let Some((shorter, _)) = later.find(|(trip, late)| late.is_empty() && is_short(trip)) {
            return shorter;
        }
    }
    violations.extend(late);
    trip
}

/// Take-offs by which some service begins when its window begins or ends, in rising order: between them nothing is gained.
fn later_departures(round: &Round, visits: &[usize], take_off: f64) -> Vec<f64> {
    let (mut position, mut way) = (round.depot(), 0.0);
    let mut departures = Vec::new();
    for &index in visits {
        let visit = &round.visits()[index];
        way += round.leg(position, visit.position);
        let times = visit.windows.iter().flat_map(|window| [window.earliest - way, window.latest - way]);
        departures.extend(times.filter(|&time| time > take_off && time.is_finite()));
        (position, way) = (visit.position, way + visit.service_duration);
    }
    departures.sort_by(f64::total_cmp);
    departures
}

/// A trip that takes off then or later and lands as early as it can, and what comes too late in it.
fn fly_from(round: &Round, visits: &[usize], take_off: f64) -> (Trip, Vec<RoundViolation>) {
    let (mut position, mut clock) = (round.depot(), take_off);
    let (mut length, mut load) = (0.0, 0.0);
    let (mut stops, mut late) = (Vec::with_capacity(visits.len()), Vec::new());
    for &index in visits {
        let visit = &round.visits()[index];
        let leg = round.leg(position, visit.position);
        let arrival = clock + leg;
        let start = match first_start(visit, arrival) {
            Ok(start) => start,
            Err(by) => {
                late.push(RoundViolation::Late { visit: index, by });
                arrival
            }
        };
        clock = start + visit.service_duration;
        (position, length, load) = (visit.position, length + leg, load + visit.load);
        stops.push(RoundStop { visit: index, arrival, start, departure: clock });
    }
    let last_leg = round.leg(position, round.depot());
    let arrival = clock + last_leg;
    let departure = waits_at_depot(round, &mut stops, take_off);
    (Trip { stops, departure, arrival, length: length + last_leg, load }, late)
}

/// When the service of a drone that arrives then begins; or by how much it is too late.
fn first_start(visit: &RoundVisit, arrival: f64) -> Result<f64, f64> {
    let open = |latest: f64| !is_over(arrival, latest);
    let starts = visit.windows.iter().filter(|window| open(window.latest)).map(|window| window.earliest.max(arrival));
    let first = starts.fold(f64::INFINITY, f64::min);
    if visit.windows.is_empty() {
        return Ok(arrival);
    }
    let last = visit.windows.iter().map(|window| window.latest).fold(f64::NEG_INFINITY, f64::max);
    if first.is_finite() { Ok(first) } else { Err(arrival - last) }
}

/// Turns what a trip waits in the air into time at the depot, as far as it lands no later: returns the latest take-off.
/// Services move with it, within the windows in which they are.
fn waits_at_depot(round: &Round, stops: &mut [RoundStop], take_off: f64) -> f64 {
    // The least wait of all places behind which nothing would come later.
    let mut slack = f64::INFINITY;
    let mut moved = 0.0;
    for stop in &*stops {
        moved += stop.start - stop.arrival;
        // A service may begin later by as much as its window is open, and by as much as later waits take up.
        let latest = latest_in_window(&round.visits()[stop.visit], stop.start);
        slack = slack.min(moved + (latest - stop.start).max(0.0));
    }
    let delay = slack.min(moved).max(0.0);
    let mut shift = delay;
    for stop in &mut *stops {
        let arrival = stop.arrival + shift;
        let start = stop.start.max(arrival);
        shift = start - stop.start;
        let service = stop.departure - stop.start;
        (stop.arrival, stop.start, stop.departure) = (arrival, start, start + service);
    }
    take_off + delay
}

fn latest_in_window(visit: &RoundVisit, start: f64) -> f64 {
    let holding = visit.windows.iter().filter(|window| window.earliest <= start && start <= window.latest);
    if visit.windows.is_empty() {
        return f64::INFINITY;
    }
    holding.map(|window| window.latest).fold(start, f64::max)
}

fn count_violations(round: &Round, routes: &[Vec<Trip>]) -> Vec<RoundViolation> {
    let mut num_times = vec![0usize; round.visits().len()];
    for stop in routes.iter().flatten().flat_map(|trip| &trip.stops) {
        num_times[stop.visit] += 1;
    }
    let mut violations = Vec::new();
    for (visit, &num_times) in num_times.iter().enumerate() {
        match num_times {
            0 => violations.push(RoundViolation::Unserved { visit }),
            1 => {}
            _ => violations.push(RoundViolation::Repeated { visit, num_times }),
        }
    }
    let (num_routes, num_drones) = (routes.len(), round.fleet().num_drones);
    if num_routes > num_drones {
        violations.push(RoundViolation::TooManyRoutes { num_routes, num_drones });
    }
    violations
}
