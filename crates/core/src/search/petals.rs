//! A first plan for rounds of many trips: as many balanced routes as trips are needed, shared by the drones.
//!
//! Where nothing has its time, what counts is how many trips there are and how long they are in all: a plain min-max problem with
//! as many drones as trips. Its routes are about equally full, so that the fewest trips that batteries and samples allow are
//! found by trying, from a guess on. The longest go first to the drone that is free first. The plain engine flies in calm air; what
//! breaks a limit in wind is taken out and put back by the search.
//!
//! O(plain searches of a few steps a visit).

use super::options::Options;
use super::plain;
use crate::geometry::Point;
use crate::neighbours::KdTree;
use crate::problem::{Depot, Energy, Problem, VehicleType};
use crate::rounds::{Round, RoundVisit};
use crate::travel::LegKind;

/// Steps a visit of each plain search.
const STEPS_PER_VISIT: u64 = 4;
/// How full trips may be on average: some room is left for what the wind takes.
const MEAN_FILLING: f64 = 0.96;
/// Plain searches at most.
const MAX_TRIES: usize = 3;

/// For each drone trips that keep its limits in the mean; `None` where drones fly one trip, visits have their times, or nothing
/// limits a trip.
pub(super) fn petals(round: &Round, seed: u64) -> Option<Vec<Vec<Vec<usize>>>> {
    let fleet = round.fleet();
    fleet.turnaround?;
    let drone = fleet.drone(0);
    let is_limited =
        fleet.capacity.is_finite() || drone.energy.usable_energy.is_finite() || drone.max_duration.is_finite();
    if !is_limited || round.visits().iter().any(|visit| !visit.windows.is_empty() || visit.release > 0.0) {
        return None;
    }
    let mut num_trips = guess(round, &drone);
    let mut trips = balanced(round, num_trips, seed)?;
    for _ in 1..MAX_TRIES {
        let filling: f64 = trips.iter().map(|trip| filling(round, &drone, trip)).sum();
        let needed = ((filling / MEAN_FILLING).ceil() as usize).clamp(1, round.visits().len());
        if needed == num_trips {
            break;
        }
        num_trips = needed;
        trips = balanced(round, num_trips, seed)?;
    }
    Some(shared(round, &drone, trips))
}

/// About how many trips it takes: each visit takes its service and a leg from somewhere near of what a trip to it has left.
fn guess(round: &Round, drone: &VehicleType) -> usize {
    let points: Vec<Point> = round.visits().iter().map(|visit| visit.visit.position).collect();
    let tree = KdTree::new(&points);
    let mut near = Vec::new();
    let mut share = |index: usize, visit: &RoundVisit| {
        tree.nearest(index, 1, &mut near);
        let from = near.first().map_or(round.depot(), |near| points[near.index as usize]);
        let place = visit.visit.position;
        let leg = round.leg(from, place, LegKind::Between, drone);
        let out = round.leg(round.depot(), place, LegKind::First, drone);
        let home = round.leg(place, round.depot(), LegKind::Last, drone);
        let of_limit =
            |own: f64, ends: f64, limit: f64| if limit.is_finite() { own / (limit - ends).max(own) } else { 0.0 };
        of_limit(leg.energy + visit.visit.service_energy, out.energy + home.energy, drone.energy.usable_energy)
            .max(of_limit(
                leg.duration + visit.visit.service_duration,
                out.duration + home.duration,
                drone.max_duration,
            ))
            .max(of_limit(visit.load, 0.0, round.fleet().capacity))
    };
    let total: f64 = round.visits().iter().enumerate().map(|(index, visit)| share(index, visit)).sum();
    (total.ceil() as usize).clamp(1, round.visits().len())
}

/// So many balanced routes through all visits.
fn balanced(round: &Round, num_trips: usize, seed: u64) -> Option<Vec<Vec<usize>>> {
    let visits = round.visits().iter().map(|visit| visit.visit).collect();
    let drone = VehicleType {
        num_available: num_trips,
        energy: Energy { usable_energy: f64::INFINITY, ..round.fleet().vehicle_type.energy },
        max_length: f64::INFINITY,
        max_duration: f64::INFINITY,
        ..round.fleet().vehicle_type
    };
    let problem = Problem::new(Depot { position: round.depot() }, visits, drone).ok()?;
    let steps = STEPS_PER_VISIT * round.visits().len() as u64;
    let options = Options { seed, max_iterations: Some(steps), ..Options::default() };
    Some(plain::solve(&problem, &options).routes)
}

/// What a trip takes when flown alone.
struct Flown {
    energy: f64,
    duration: f64,
    load: f64,
}

fn fly(round: &Round, drone: &VehicleType, trip: &[usize]) -> Flown {
    let (mut position, mut kind) = (round.depot(), LegKind::First);
    let mut flown = Flown { energy: 0.0, duration: 0.0, load: 0.0 };
    for &index in trip {
        let RoundVisit { visit, load, .. } = &round.visits()[index];
        let leg = round.leg(position, visit.position, kind, drone);
        flown.energy += leg.energy + visit.service_energy;
        flown.duration += leg.duration + visit.service_duration;
        flown.load += load;
        (position, kind) = (visit.position, LegKind::Between);
    }
    let home = round.leg(position, round.depot(), LegKind::Last, drone);
    Flown { energy: flown.energy + home.energy, duration: flown.duration + home.duration, ..flown }
}

/// How much a trip uses of what limits it most, as a share.
fn filling(round: &Round, drone: &VehicleType, trip: &[usize]) -> f64 {
    let Flown { energy, duration, load } = fly(round, drone, trip);
    let shares = [energy / drone.energy.usable_energy, duration / drone.max_duration, load / round.fleet().capacity];
    shares.iter().copied().filter(|share| share.is_finite()).fold(0.0, f64::max)
}

/// The longest trip first, each to the drone that is free first.
fn shared(round: &Round, drone: &VehicleType, trips: Vec<Vec<usize>>) -> Vec<Vec<Vec<usize>>> {
    let fleet = round.fleet();
    let num_drones = fleet.vehicle_type.num_available.min(round.visits().len());
    let mut timed: Vec<(f64, Vec<usize>)> =
        trips.into_iter().map(|trip| (fly(round, drone, &trip).duration, trip)).collect();
    timed.sort_by(|one, other| other.0.total_cmp(&one.0).then(one.1.cmp(&other.1)));
    let mut free: Vec<f64> = (0..num_drones).map(|drone| fleet.first_takeoff(drone)).collect();
    let mut routes = vec![Vec::new(); num_drones];
    for (duration, trip) in timed {
        let first = (0..num_drones).min_by(|&one, &other| free[one].total_cmp(&free[other])).unwrap_or(0);
        free[first] += duration + fleet.turnaround.unwrap_or(0.0);
        routes[first].push(trip);
    }
    routes
}
