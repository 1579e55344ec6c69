//! The one truth about a plan of a round: everything recomputed from the round and bare routes.
//!
//! It flies every trip twice: forward as early as it can, for arrivals, and backward from its landing, for the latest take-off
//! that lands as early. Trips of all drones are flown in the order of their landings, because drones wait for each other where
//! they are turned round. No code is shared with the search beyond what a leg is ([`Round::leg`]). O(n) for n visits with a
//! bounded number of windows, O(n^2) for trips that must wait on the ground to be short enough.

use super::plan::{RoundPlan, RoundStop, RoundViolation, Trip};
use super::round::{Round, RoundVisit};
use crate::error::{Faults, InvalidInput};
use crate::problem::VehicleType;
use crate::travel::LegKind;

/// How late something may be by rounding, relative to the time it is late at.
const TOLERANCE: f64 = 1e-9;

/// Flies `routes` (for each drone its trips, each the visits in flying order) and reports schedule, energy and violations. Route
/// i is flown by drone i. Empty trips are dropped. A visit that comes too late for all its windows is served at once, and is a
/// violation.
///
/// # Errors
/// [`InvalidInput`] if a trip names a visit that does not exist.
pub fn evaluate_round(round: &Round, routes: &[Vec<Vec<usize>>]) -> Result<RoundPlan, InvalidInput> {
    evaluate_held_round(round, routes, &[])
}

/// The same, where trips are held back: trip j of route i, empty ones not counted, takes off `holds[i][j]` seconds later than it
/// otherwise would; not at all held back where nothing is said.
///
/// # Errors
/// As [`evaluate_round`]; if a hold is negative or no number.
pub fn evaluate_held_round(
    round: &Round,
    routes: &[Vec<Vec<usize>>],
    holds: &[Vec<f64>],
) -> Result<RoundPlan, InvalidInput> {
    check_indices(round, routes)?;
    check_holds(holds)?;
    let mut late = Vec::new();
    let flown = fly_all(round, routes, holds, &mut late);
    let mut violations = count_violations(round, &flown);
    for (route, trips) in flown.iter().enumerate() {
        violations.extend(limit_violations(round, route, trips));
    }
    violations.extend(late);
    Ok(RoundPlan { routes: flown, violations })
}

fn check_holds(holds: &[Vec<f64>]) -> Result<(), InvalidInput> {
    let mut faults = Faults::default();
    for (route, holds) in holds.iter().enumerate() {
        for (trip, hold) in holds.iter().enumerate() {
            if !(0.0..=1e9).contains(hold) {
                faults.add(format!("holds[{route}][{trip}]"), format!("the hold is {hold:?}"), "give 0 to 1e9 seconds");
            }
        }
    }
    faults.into_result(())
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

/// Flies the trips of all drones, those that land first first: the turnaround after a landing begins when a place is free.
fn fly_all(
    round: &Round,
    routes: &[Vec<Vec<usize>>],
    holds: &[Vec<f64>],
    late: &mut Vec<RoundViolation>,
) -> Vec<Vec<Trip>> {
    let fleet = round.fleet();
    let mut flown: Vec<Vec<Trip>> = vec![Vec::new(); routes.len()];
    let waiting = |trips: &Vec<Vec<usize>>| trips.iter().filter(|trip| !trip.is_empty()).cloned().rev().collect();
    let mut left: Vec<Vec<Vec<usize>>> = routes.iter().map(waiting).collect();
    let fly_next = |route: usize, number: usize, left: &mut Vec<Vec<Vec<usize>>>, ready: f64| {
        let hold = holds.get(route).and_then(|holds| holds.get(number)).copied().unwrap_or(0.0);
        left[route].pop().map(|visits| {
            let drone = fleet.drone(route);
            let flown = fly_trip(round, &drone, &visits, ready);
            // What is held back takes off later than it otherwise would, also where it waits for a window.
            if hold > 0.0 { fly_trip(round, &drone, &visits, flown.0.departure + hold) } else { flown }
        })
    };
    let mut in_the_air: Vec<Option<(Trip, Vec<RoundViolation>)>> =
        (0..routes.len()).map(|route| fly_next(route, 0, &mut left, fleet.first_takeoff(route))).collect();
    let mut pads_free = vec![f64::NEG_INFINITY; fleet.num_pads.min(routes.len())];
    loop {
        let landing = |(route, flight): (usize, &Option<(Trip, Vec<RoundViolation>)>)| {
            flight.as_ref().map(|(trip, _)| (trip.arrival, route))
        };
        let earliest = |one: &(f64, usize), other: &(f64, usize)| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1));
        let Some((arrival, route)) = in_the_air.iter().enumerate().filter_map(landing).min_by(earliest) else { break };
        let Some((mut trip, came_late)) = in_the_air[route].take() else { break };
        late.extend(came_late);
        if !left[route].is_empty() {
            let by_time = |one: &&mut f64, other: &&mut f64| one.total_cmp(other);
            if let Some(pad) = pads_free.iter_mut().min_by(by_time) {
                trip.ready = arrival.max(*pad) + fleet.turnaround.unwrap_or(0.0);
                *pad = trip.ready;
            }
            in_the_air[route] = fly_next(route, flown[route].len() + 1, &mut left, trip.ready);
        }
        flown[route].push(trip);
    }
    flown
}

fn limit_violations(round: &Round, route: usize, trips: &[Trip]) -> Vec<RoundViolation> {
    let fleet = round.fleet();
    let mut violations = Vec::new();
    if fleet.turnaround.is_none() && trips.len() > 1 {
        violations.push(RoundViolation::TooManyTrips { route, num_trips: trips.len() });
    }
    for (index, trip) in trips.iter().enumerate() {
        violations.extend(trip_violations(round, route, index, trip));
    }
    if let Some(by) = trips.last().map(|trip| trip.arrival - fleet.shift.latest)
        && is_over(by + fleet.shift.latest, fleet.shift.latest)
    {
        violations.push(RoundViolation::ShiftOver { route, by });
    }
    violations
}

fn trip_violations(round: &Round, route: usize, index: usize, trip: &Trip) -> Vec<RoundViolation> {
    let (fleet, drone) = (round.fleet(), round.fleet().drone(route));
    let (load, capacity) = (trip.load, fleet.capacity);
    let (length, max_length) = (trip.length, drone.max_length);
    let (duration, max_duration) = (trip.arrival - trip.departure, drone.max_duration);
    let (energy, usable_energy) = (trip.energy, drone.energy.usable_energy);
    let mut violations = Vec::new();
    if is_over(load, capacity) {
        violations.push(RoundViolation::OverCapacity { route, trip: index, load, capacity });
    }
    if is_over(length, max_length) {
        violations.push(RoundViolation::TooLong { route, trip: index, length, max_length });
    }
    if is_over(duration, max_duration) {
        violations.push(RoundViolation::TooSlow { route, trip: index, duration, max_duration });
    }
    if is_over(energy, usable_energy) {
        violations.push(RoundViolation::TooMuchEnergy { route, trip: index, energy, usable_energy });
    } else if let Some(stop) = stranded(trip, &drone) {
        let by = stop.energy_used + stop.energy_home - usable_energy;
        violations.push(RoundViolation::NoWayHome { route, trip: index, visit: stop.visit, by });
    }
    violations
}

fn is_over(value: f64, limit: f64) -> bool {
    value > limit + TOLERANCE * limit.abs().max(1.0)
}

/// The first stop from which the battery is not enough for the way home.
fn stranded<'a>(trip: &'a Trip, drone: &VehicleType) -> Option<&'a RoundStop> {
    trip.stops.iter().find(|stop| is_over(stop.energy_used + stop.energy_home, drone.energy.usable_energy))
}

/// The trip that lands first, and what comes too late in it; if that takes longer or more energy than a trip may, the first that
/// does not, because a take-off that waits for later windows may spend less time in the air.
fn fly_trip(round: &Round, drone: &VehicleType, visits: &[usize], ready: f64) -> (Trip, Vec<RoundViolation>) {
    let take_off = visits.iter().map(|&visit| round.visits()[visit].release).fold(ready, f64::max);
    let (trip, late) = fly_from(round, drone, visits, take_off);
    let is_short = |trip: &Trip| {
        !is_over(trip.arrival - trip.departure, drone.max_duration)
            && !is_over(trip.energy, drone.energy.usable_energy)
            && stranded(trip, drone).is_none()
    };
    if late.is_empty() && !is_short(&trip) {
        let departures = later_departures(round, drone, visits, take_off);
        let mut later = departures.into_iter().map(|time| fly_from(round, drone, visits, time));
        if let Some((shorter, _)) = later.find(|(trip, late)| late.is_empty() && is_short(trip)) {
            return (shorter, Vec::new());
        }
    }
    (trip, late)
}

/// Take-offs by which some service begins when its window begins or ends, in rising order: between them nothing is gained.
fn later_departures(round: &Round, drone: &VehicleType, visits: &[usize], take_off: f64) -> Vec<f64> {
    let (mut position, mut kind, mut way) = (round.depot(), LegKind::First, 0.0);
    let mut departures = Vec::new();
    for &index in visits {
        let RoundVisit { visit, windows, .. } = &round.visits()[index];
        way += round.leg(position, visit.position, kind, drone).duration;
        let times = windows.iter().flat_map(|window| [window.earliest - way, window.latest - way]);
        departures.extend(times.filter(|&time| time > take_off && time.is_finite()));
        (position, kind, way) = (visit.position, LegKind::Between, way + visit.service_duration);
    }
    departures.sort_by(f64::total_cmp);
    departures
}

/// A trip that takes off then or later and lands as early as it can, and what comes too late in it.
fn fly_from(round: &Round, drone: &VehicleType, visits: &[usize], take_off: f64) -> (Trip, Vec<RoundViolation>) {
    let (mut position, mut kind, mut clock) = (round.depot(), LegKind::First, take_off);
    let (mut length, mut load) = (0.0, 0.0);
    let (mut stops, mut late) = (Vec::with_capacity(visits.len()), Vec::new());
    for &index in visits {
        let round_visit = &round.visits()[index];
        let visit = round_visit.visit;
        let leg = round.leg(position, visit.position, kind, drone);
        let arrival = clock + leg.duration;
        let start = match first_start(round_visit, arrival) {
            Ok(start) => start,
            Err(by) => {
                late.push(RoundViolation::Late { visit: index, by });
                arrival
            }
        };
        clock = start + visit.service_duration;
        (position, kind) = (visit.position, LegKind::Between);
        (length, load) = (length + leg.length, load + round_visit.load);
        stops.push(RoundStop {
            visit: index,
            arrival,
            start,
            departure: clock,
            leg,
            energy_used: 0.0,
            energy_home: 0.0,
        });
    }
    let last_leg = round.leg(position, round.depot(), LegKind::Last, drone);
    let arrival = clock + last_leg.duration;
    let departure = waits_at_depot(round, &mut stops, take_off);
    let energy = use_energy(round, drone, &mut stops) + last_leg.energy;
    let trip =
        Trip { stops, departure, arrival, last_leg, ready: arrival, length: length + last_leg.length, energy, load };
    (trip, late)
}

/// Fills in what the trip has taken from its battery at every stop; returns what it has at the last.
fn use_energy(round: &Round, drone: &VehicleType, stops: &mut [RoundStop]) -> f64 {
    let mut used = 0.0;
    for stop in stops {
        let visit = round.visits()[stop.visit].visit;
        used += stop.leg.energy + (stop.start - stop.arrival) * drone.energy.leg_stop_power + visit.service_energy;
        stop.energy_used = used;
        stop.energy_home = round.leg(visit.position, round.depot(), LegKind::Last, drone).energy;
    }
    used
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
    let num_routes = routes.iter().rposition(|trips| !trips.is_empty()).map_or(0, |last| last + 1);
    let num_drones = round.fleet().vehicle_type.num_available;
    if num_routes > num_drones {
        violations.push(RoundViolation::TooManyRoutes { num_routes, num_drones });
    }
    violations
}
