//! When the last drone of a round lands at the earliest, and how many trips it takes at least, whatever the plan.
//!
//! What is counted is a plan that makes all visits and breaks no rule. The proofs are in `docs/explanation/bounds.md`, "Bounds of
//! a round with trips"; in short:
//!
//! 1. *One visit.* Some drone flies there, waits for its window, and comes home.
//! 2. *One trip a drone.* Without its stays at the depot no drone is slower: the plain problem's bound ([`crate::bound`]).
//! 3. *Fewest trips.* The legs of exactly K trips are a tree with K edges at the depot and K ways home, so they take at least what
//!    the least of these takes (Held and Karp 1970), of energy, time or length; K trips may take K times the limit.
//! 4. *Far visits* (Haimovich and Rinnooy Kan, Bounds and heuristics for capacitated routing problems, Mathematics of Operations
//!    Research 1985): a trip to a far visit has less left for services. Every visit is charged for its share of a trip.
//! 5. *Shared time.* All drones together fly the legs of 3 or 4, the services and the turnarounds; the last lands no earlier than
//!    the mean.
//! 6. *Late windows.* What begins after some hour is shared by the drones from that hour on.
//! 7. *Places at the depot*, and *many trips of one drone*: turnarounds that cannot be at the same time.
//!
//! What we changed: in wind a leg takes another time back. Each closed trip comes back to where it was, so a multiple of the way
//! along the wind may be taken off every leg; what is left is nearly the same in both directions, and the lesser of both loses
//! little. Trees are sparse ones that bound the complete one, as in [`crate::bound`].
//!
//! O(n^2) for n visits up to 2,000; O(n log n) above, without 3.

use super::round::{Round, RoundVisit, Rounding};
use crate::bound::{Ascent, NUM_NEIGHBOURS, SparseGraph, lower_bound_of_makespan};
use crate::geometry::Point;
use crate::neighbours::KdTree;
use crate::problem::{Depot, Problem, VehicleType, WayHome};
use crate::travel::{Leg, LegKind, leg_duration};

/// Rounds with more visits have no bounds that look at all pairs.
const MAX_VISITS_OF_PAIRS: usize = 2_000;
/// Numbers of drones for which the legs of as many trips are bounded one by one; more fly no less than the last of these.
const MAX_ASCENTS: usize = 8;
/// Parts of the difference between a way down the wind and one up that are tried.
const WIND_PARTS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
/// By how much the judge forgives what is over a limit, relative to it, and a little more for our own rounding.
const TOLERANCE: f64 = 2e-9;
/// Keeps a bound that equals the optimum from exceeding it by rounding.
const ROUNDING: f64 = 1.0 - 1e-10;

/// A time that the last landing of no feasible plan with all visits falls below, in seconds on the clock of the round
/// ([`super::RoundPlan::makespan`]); infinite if there is proof that there is no such plan.
#[must_use]
pub fn makespan_bound(round: &Round) -> f64 {
    let facts = Facts::new(round);
    let (Some(starts), Some(trips)) = (earliest_starts(&facts), Trips::new(&facts)) else { return f64::INFINITY };
    let bounds = [
        one_visit(&facts, &starts),
        facts.takeoff + one_trip_a_drone(&facts),
        shared_time(&facts, &trips),
        late_windows(&facts, &starts),
        turnarounds(&facts, trips.fewest),
    ];
    facts.takeoff + (bounds.into_iter().fold(facts.takeoff, f64::max) - facts.takeoff) * ROUNDING
}

/// A number of trips that no feasible plan with all visits falls below; `None` if there is proof that there is no such plan.
/// At least 1.
#[must_use]
pub fn fewest_trips(round: &Round) -> Option<usize> {
    Trips::new(&Facts::new(round)).map(|trips| trips.fewest)
}

/// What counts against one limit of a trip.
struct Resource {
    of_leg: fn(&Leg) -> f64,
    of_service: fn(&RoundVisit) -> f64,
    /// What one stop takes.
    of_stop: f64,
    /// What one trip may take.
    most: f64,
    /// Whether no way of several legs takes less than the straight one.
    is_metric: bool,
    /// Whether no leg takes less than nothing, as one might in a wind that carries the drone.
    is_positive: bool,
}

/// What a trip to a visit takes at least on its way there and on its way home, services aside.
#[derive(Clone, Copy)]
struct Ways {
    out: f64,
    home: f64,
}

/// What all bounds ask of a round.
struct Facts<'a> {
    round: &'a Round,
    /// A drone that takes off and comes home as cheaply as the best of each.
    drone: VehicleType,
    num_drones: usize,
    turnaround: f64,
    /// No trip takes off before.
    takeoff: f64,
    ways: Vec<Ways>,
    /// Per visit the length of the leg to the nearest other.
    nearest: Vec<f64>,
}

impl<'a> Facts<'a> {
    fn new(round: &'a Round) -> Self {
        let fleet = round.fleet();
        let num_visits = round.visits().len();
        let drone = least_drone(round);
        let release = round.visits().iter().map(|visit| visit.release).fold(f64::INFINITY, f64::min);
        let positions: Vec<Point> = round.visits().iter().map(|visit| visit.visit.position).collect();
        let tree = KdTree::new(&positions);
        let mut found = Vec::new();
        let nearest = (0..num_visits).map(|visit| {
            tree.nearest(visit, 1, &mut found);
            let to = |other: u32| positions[other as usize];
            let length = |other| round.leg(to(other), positions[visit], LegKind::Between, &drone).length;
            found.first().map_or(f64::INFINITY, |near| length(near.index))
        });
        let nearest = nearest.collect();
        let mut facts = Self {
            round,
            drone,
            num_drones: fleet.vehicle_type.num_available.min(num_visits),
            turnaround: fleet.turnaround.unwrap_or(0.0),
            takeoff: fleet.shift.earliest.max(release),
            ways: Vec::new(),
            nearest,
        };
        facts.ways = facts.ways_of(&facts.durations(), &drone);
        facts
    }

    fn visits(&self) -> &'a [RoundVisit] {
        self.round.visits()
    }

    fn position(&self, visit: usize) -> Point {
        self.visits()[visit].visit.position
    }

    fn durations(&self) -> Resource {
        Resource {
            of_leg: |leg| leg.duration,
            of_service: |visit| visit.visit.service_duration,
            of_stop: self.drone.leg_stop_duration,
            most: with_tolerance(self.drone.max_duration),
            is_metric: self.round.rounding() == Rounding::Exact,
            is_positive: true,
        }
    }

    fn lengths(&self) -> Resource {
        Resource {
            of_leg: |leg| leg.length,
            of_service: |_| 0.0,
            of_stop: 0.0,
            most: with_tolerance(self.drone.max_length),
            is_metric: self.round.rounding() == Rounding::Exact,
            is_positive: true,
        }
    }

    fn energies(&self) -> Resource {
        let (air, energy) = (&self.round.fleet().air, &self.drone.energy);
        let ways = [
            Some((self.drone.speed, energy.leg_power)),
            self.drone.way_home.map(|way_home| (way_home.speed, energy.way_home_power)),
        ];
        let mut ways = ways.into_iter().flatten();
        let is_calm = ways.clone().all(|(speed, _)| air.is_calm_at(speed));
        // Carried by the wind a drone saves at most what its own airspeed takes.
        let is_positive = is_calm || ways.all(|(speed, power)| power >= air.drag_power * speed * speed * speed);
        Resource {
            of_leg: |leg| leg.energy,
            of_service: |visit| visit.visit.service_energy,
            of_stop: self.drone.leg_stop_duration * energy.leg_stop_power,
            most: with_tolerance(energy.usable_energy),
            is_metric: is_calm && self.round.rounding() == Rounding::Exact,
            is_positive,
        }
    }

    fn leg(&self, from: Point, to: Point, kind: LegKind, drone: &VehicleType, resource: &Resource) -> f64 {
        (resource.of_leg)(&self.round.leg(from, to, kind, drone))
    }

    /// What a trip of such a drone to each visit takes at least, on whatever way. O(n) where the straight way takes the least,
    /// else O(n^2).
    fn ways_of(&self, resource: &Resource, drone: &VehicleType) -> Vec<Ways> {
        let (depot, num_visits) = (self.round.depot(), self.visits().len());
        let leg = |from, to, kind| self.leg(from, to, kind, drone, resource);
        let positions = (0..num_visits).map(|visit| self.position(visit));
        let (takeoff, landing) = (leg(depot, depot, LegKind::First), leg(depot, depot, LegKind::Last));
        if resource.is_metric {
            // Where the way home is dear, it is less to fly most of it like the other legs.
            let home = |place| leg(place, depot, LegKind::Last).min(leg(place, depot, LegKind::Between) + landing);
            return positions.map(|place| Ways { out: leg(depot, place, LegKind::First), home: home(place) }).collect();
        }
        if num_visits > MAX_VISITS_OF_PAIRS {
            return vec![Ways { out: takeoff, home: landing }; num_visits];
        }
        let firsts = positions.clone().map(|place| leg(depot, place, LegKind::First)).collect();
        let lasts = positions.map(|place| leg(place, depot, LegKind::Last)).collect();
        let between = |from, to| leg(self.position(from), self.position(to), LegKind::Between);
        let outs = least_ways(firsts, between);
        let homes = least_ways(lasts, |near, far| between(far, near));
        outs.into_iter().zip(homes).map(|(out, home)| Ways { out, home }).collect()
    }

    /// What a trip with this visit alone takes at least, and each trip with it among others.
    fn alone(&self, visit: usize) -> f64 {
        self.ways[visit].out + self.visits()[visit].visit.service_duration + self.ways[visit].home
    }
}

fn with_tolerance(limit: f64) -> f64 {
    limit + TOLERANCE * limit.max(1.0)
}

fn least_drone(round: &Round) -> VehicleType {
    let fleet = round.fleet();
    let num_kinds = fleet.layers.len().clamp(1, fleet.vehicle_type.num_available.max(1));
    let mut least = fleet.drone(0);
    for drone in (1..num_kinds).map(|index| fleet.drone(index)) {
        least.takeoff_duration = least.takeoff_duration.min(drone.takeoff_duration);
        least.energy.takeoff_energy = least.energy.takeoff_energy.min(drone.energy.takeoff_energy);
        least.energy.way_home_fixed_energy = least.energy.way_home_fixed_energy.min(drone.energy.way_home_fixed_energy);
        if let (Some(one), Some(other)) = (least.way_home, drone.way_home) {
            least.way_home = Some(WayHome { fixed_duration: one.fixed_duration.min(other.fixed_duration), ..one });
        }
    }
    least
}

/// The least that a way to each place takes, from what it takes straight and what steps from one place to the next take: Dijkstra,
/// A note on two problems in connexion with graphs, 1959. O(n^2).
fn least_ways(mut ways: Vec<f64>, step: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    let mut left: Vec<usize> = (0..ways.len()).collect();
    while let Some(place) = (0..left.len()).min_by(|&one, &other| ways[left[one]].total_cmp(&ways[left[other]])) {
        let nearest = left.swap_remove(place);
        for &other in &left {
            ways[other] = ways[other].min(ways[nearest] + step(nearest, other));
        }
    }
    ways
}

/// When each service begins at the earliest; `None` if a visit has no window late enough.
fn earliest_starts(facts: &Facts<'_>) -> Option<Vec<f64>> {
    let start = |(visit, ways): (&RoundVisit, &Ways)| {
        let arrival = visit.release.max(facts.takeoff) + ways.out;
        if visit.windows.is_empty() {
            return Some(arrival);
        }
        let is_open = |latest: f64| arrival * ROUNDING <= with_tolerance(latest);
        let open = visit.windows.iter().filter(|window| is_open(window.latest));
        open.map(|window| window.earliest.max(arrival)).min_by(f64::total_cmp)
    };
    facts.visits().iter().zip(&facts.ways).map(start).collect()
}

fn one_visit(facts: &Facts<'_>, starts: &[f64]) -> f64 {
    let landing =
        |(visit, start): (usize, &f64)| start + facts.visits()[visit].visit.service_duration + facts.ways[visit].home;
    starts.iter().enumerate().map(landing).fold(0.0, f64::max)
}

/// How long the drones fly if each flies one trip, as many visits as it likes, in calm air.
fn one_trip_a_drone(facts: &Facts<'_>) -> f64 {
    // Legs without their second decimal have no triangle inequality, and what rests on it does not hold.
    if facts.round.rounding() != Rounding::Exact || saves_time_at_depot(facts) {
        return 0.0;
    }
    let visits = facts.visits().iter().map(|visit| visit.visit).collect();
    let problem = Problem::new(Depot { position: facts.round.depot() }, visits, facts.drone);
    problem.map_or(0.0, |problem| lower_bound_of_makespan(&problem))
}

/// Whether coming home between two visits may take less than flying straight from one to the other: where the way home is faster
/// than other legs, by more than landing, turnaround and take-off take.
fn saves_time_at_depot(facts: &Facts<'_>) -> bool {
    let Some(way_home) = facts.drone.way_home else { return false };
    let distances = (0..facts.visits().len()).map(|visit| facts.round.depot().distance(facts.position(visit)));
    let saved = distances.fold(0.0, f64::max) * (1.0 / facts.drone.speed - 1.0 / way_home.speed);
    let lost = way_home.fixed_duration + facts.turnaround + facts.drone.takeoff_duration;
    facts.round.fleet().turnaround.is_some() && saved > lost
}

/// What there is to know about the trips of a round.
struct Trips {
    fewest: usize,
    /// Shares of a trip for each visit, such that no trip has visits of more than 1.
    shares: Vec<Vec<f64>>,
}

impl Trips {
    /// `None` if there is proof that no number of trips is enough.
    fn new(facts: &Facts<'_>) -> Option<Self> {
        let loads: Vec<f64> = facts.visits().iter().map(|visit| visit.load).collect();
        let capacity = with_tolerance(facts.round.fleet().capacity);
        let mut shares = vec![shares_of_trip(&loads, &vec![0.0; loads.len()], capacity)?];
        let limits = [facts.energies(), facts.durations(), facts.lengths()];
        let limits: Vec<Resource> = limits.into_iter().filter(|resource| resource.most.is_finite()).collect();
        for resource in limits.iter().filter(|resource| resource.is_positive) {
            shares.push(shares_of_trip(&needs(facts, resource), &there_and_back(facts, resource), resource.most)?);
        }
        let whole = |shares: &Vec<f64>| (shares.iter().sum::<f64>() * ROUNDING - 1e-9).ceil().max(1.0) as usize;
        let mut fewest = shares.iter().map(whole).fold(1, usize::max);
        for resource in &limits {
            fewest = fewest_by_legs(facts, resource, fewest)?;
        }
        let has_one_each = facts.round.fleet().turnaround.is_none();
        let is_possible = fewest <= facts.visits().len() && (!has_one_each || fewest <= facts.num_drones);
        is_possible.then_some(Self { fewest, shares })
    }
}

/// What each visit takes wherever in a trip it is: its service, and a stop if no other place is there.
fn needs(facts: &Facts<'_>, resource: &Resource) -> Vec<f64> {
    let depot = facts.round.depot();
    let need = |(visit, &nearest): (&RoundVisit, &f64)| {
        let from_depot = facts.round.leg(depot, visit.visit.position, LegKind::Between, &facts.drone).length;
        let stop = if nearest > 0.0 && from_depot > 0.0 { resource.of_stop } else { 0.0 };
        (resource.of_service)(visit) + stop
    };
    facts.visits().iter().zip(&facts.nearest).map(need).collect()
}

/// What the legs of a trip to each visit take at least, stops at visits aside.
fn there_and_back(facts: &Facts<'_>, resource: &Resource) -> Vec<f64> {
    let stopless = VehicleType { leg_stop_duration: 0.0, ..facts.drone };
    let depot = facts.round.depot();
    let is_away =
        |visit: &RoundVisit| facts.round.leg(depot, visit.visit.position, LegKind::Between, &facts.drone).length > 0.0;
    let stops_at_home = facts.drone.way_home.is_none() && facts.visits().iter().all(is_away);
    let stop = if stops_at_home { resource.of_stop } else { 0.0 };
    facts.ways_of(resource, &stopless).into_iter().map(|ways| ways.out + ways.home + stop).collect()
}

/// The share of a trip that each visit takes at least: what it needs, of what is left beside the way there and back. `None` if a
/// visit is too much for a trip.
fn shares_of_trip(needs: &[f64], ways: &[f64], most: f64) -> Option<Vec<f64>> {
    let share = |(&need, &way): (&f64, &f64)| match () {
        () if (need + way) * ROUNDING > most => None,
        // What is over only by what is forgiven is charged nothing.
        () if need == 0.0 || most.is_infinite() || most <= way => Some(0.0),
        () => Some((need / (most - way)).min(1.0)),
    };
    needs.iter().zip(ways).map(share).collect()
}

/// Graphs whose legs take no more than those of the round, in both directions, summed over a closed trip: one for each slope that
/// is tried along the wind.
fn graphs(facts: &Facts<'_>, resource: &Resource) -> Vec<SparseGraph> {
    let depot = facts.round.depot();
    let num_visits = facts.visits().len();
    let leg = |from, to, kind| facts.leg(from, to, kind, &facts.drone, resource);
    let graph = |slope: Point| {
        let rise = |from: Point, to: Point| slope.x * (to.x - from.x) + slope.y * (to.y - from.y);
        let positions = (0..num_visits).map(|visit| facts.position(visit));
        let first = |place| leg(depot, place, LegKind::First) - rise(depot, place);
        let last = |place| leg(place, depot, LegKind::Last) - rise(place, depot);
        let (firsts, lasts) = (positions.clone().map(first).collect(), positions.map(last).collect());
        SparseGraph::of_costs(firsts, lasts, NUM_NEIGHBOURS, |one, other| {
            let (one, other) = (facts.position(one), facts.position(other));
            let up = leg(one, other, LegKind::Between) - rise(one, other);
            up.min(leg(other, one, LegKind::Between) - rise(other, one))
        })
    };
    slopes(facts, resource).into_iter().map(graph).collect()
}

/// What a leg takes more for each metre down the wind, as tried; nothing in calm air.
fn slopes(facts: &Facts<'_>, resource: &Resource) -> Vec<Point> {
    let (depot, air) = (facts.round.depot(), &facts.round.fleet().air);
    let speed = air.wind_speed();
    if speed == 0.0 {
        return vec![Point::default()];
    }
    let (x, y) = (air.wind.x / speed, air.wind.y / speed);
    let far = Point::new(depot.x + 1000.0 * x, depot.y + 1000.0 * y);
    let leg = |from, to| facts.leg(from, to, LegKind::Between, &facts.drone, resource);
    let slope = (leg(depot, far) - leg(far, depot)) / 2000.0;
    if slope == 0.0 {
        return vec![Point::default()];
    }
    WIND_PARTS.iter().map(|part| Point::new(part * slope * x, part * slope * y)).collect()
}

/// The ascent that gives the best bound on the legs of exactly `num_trips` trips, and that bound.
fn best_ascent<'a>(graphs: &'a [SparseGraph], num_trips: usize) -> Option<(Ascent<'a>, f64)> {
    let rise = |graph: &'a SparseGraph| {
        let mut ascent = Ascent::new(graph);
        let total = ascent.rise(graph.num_ponds(), num_trips);
        (ascent, total)
    };
    graphs.iter().map(rise).max_by(|one, other| one.1.total_cmp(&other.1))
}

/// The least number of trips, not below `from`, whose legs leave enough for the services. With given penalties the bound on the
/// legs is convex in the number of trips (trees with so many edges at the depot are bases of a matroid, and the shortest ways
/// home come first), so what one more trip gains now is the most that any more gain.
fn fewest_by_legs(facts: &Facts<'_>, resource: &Resource, from: usize) -> Option<usize> {
    let num_visits = facts.visits().len();
    if num_visits > MAX_VISITS_OF_PAIRS {
        return Some(from);
    }
    let graphs = graphs(facts, resource);
    let services: f64 = facts.visits().iter().map(resource.of_service).sum();
    let mut num_trips = from;
    while num_trips <= num_visits {
        let (mut ascent, legs) = best_ascent(&graphs, num_trips)?;
        let excess = services + legs - num_trips as f64 * resource.most;
        if excess <= 1e-9 * (services + legs.abs()) {
            return Some(num_trips);
        }
        if num_trips == num_visits {
            break;
        }
        let gain = resource.most - (ascent.relax(num_visits, num_trips + 1) - ascent.relax(num_visits, num_trips));
        if gain <= 0.0 {
            break;
        }
        // A number that is too large for the type is the largest: there are fewer visits.
        num_trips = num_trips.saturating_add(((excess / gain - 1e-6).ceil() as usize).max(1));
    }
    None
}

/// The mean over the drones that fly of when they land: the time of all trips and turnarounds is shared among them.
fn shared_time(facts: &Facts<'_>, trips: &Trips) -> f64 {
    let fleet = facts.round.fleet();
    let graphs = match facts.visits().len() {
        ..=MAX_VISITS_OF_PAIRS => graphs(facts, &facts.durations()),
        _ => Vec::new(),
    };
    let fewest_drones = if fleet.turnaround.is_none() { trips.fewest } else { 1 };
    let mut busy: Option<(usize, f64)> = None;
    let (mut sum_takeoffs, mut least) = (0.0, f64::INFINITY);
    for num_drones in 1..=facts.num_drones {
        sum_takeoffs += fleet.first_takeoff(num_drones - 1).max(facts.takeoff);
        if num_drones < fewest_drones {
            continue;
        }
        let num_trips = trips.fewest.max(num_drones);
        let time = match busy {
            Some((last, time)) if last == num_trips || num_trips >= trips.fewest + MAX_ASCENTS => time,
            _ => busy_time(facts, trips, &graphs, num_trips),
        };
        busy = Some((num_trips, time));
        least = least.min((sum_takeoffs + time) / num_drones as f64 - facts.turnaround);
    }
    least
}

/// What `num_trips` trips or more take together, each with a turnaround.
fn busy_time(facts: &Facts<'_>, trips: &Trips, graphs: &[SparseGraph], num_trips: usize) -> f64 {
    let durations = facts.durations();
    let services: f64 = facts.visits().iter().map(durations.of_service).sum();
    let by_legs = services + least_legs_and_turnarounds(facts, graphs, num_trips);
    let (needs, ways) = (needs(facts, &durations), there_and_back(facts, &durations));
    let least_way = ways.iter().copied().fold(f64::INFINITY, f64::min);
    let by_shares = |shares: &Vec<f64>| {
        let to_visits: f64 = shares.iter().zip(&ways).map(|(share, way)| share * (way - least_way)).sum();
        to_visits + needs.iter().sum::<f64>() + num_trips as f64 * (least_way + facts.turnaround)
    };
    trips.shares.iter().map(by_shares).fold(by_legs, f64::max)
}

/// The same without services, by the tree; 0 where there is no graph.
fn least_legs_and_turnarounds(facts: &Facts<'_>, graphs: &[SparseGraph], num_trips: usize) -> f64 {
    let num_visits = facts.visits().len();
    let Some((mut ascent, _)) = best_ascent(graphs, num_trips) else { return 0.0 };
    let mut time = |num_trips: usize| ascent.relax(num_visits, num_trips) + num_trips as f64 * facts.turnaround;
    // More trips take more time, but where cut decimals or a fast way home make up for it: convex in their number.
    let (mut low, mut high) = (num_trips, num_visits);
    if num_trips < num_visits && time(num_trips + 1) >= time(num_trips) {
        high = num_trips;
    }
    while low < high {
        let middle = low.midpoint(high);
        if time(middle + 1) >= time(middle) { high = middle } else { low = middle + 1 }
    }
    time(low)
}

/// For every hour: what begins then or later is shared by the drones, each of which flies to all but the first of its visits after
/// that hour, and home in the end.
fn late_windows(facts: &Facts<'_>, starts: &[f64]) -> f64 {
    let mut order: Vec<usize> = (0..starts.len()).collect();
    order.sort_by(|&one, &other| starts[other].total_cmp(&starts[one]));
    let (mut services, mut legs, mut longest_leg, mut way_home) = (0.0, 0.0, 0.0_f64, f64::INFINITY);
    let mut latest = 0.0_f64;
    for (num_before, &visit) in order.iter().enumerate() {
        let first = facts.round.leg(facts.round.depot(), facts.position(visit), LegKind::First, &facts.drone).duration;
        let leg = leg_duration(facts.nearest[visit], LegKind::Between, &facts.drone).min(first);
        services += facts.visits()[visit].visit.service_duration;
        (legs, longest_leg) = (legs + leg, longest_leg.max(leg));
        way_home = way_home.min(facts.ways[visit].home);
        let num_drones = facts.num_drones.min(num_before + 1) as f64;
        let legs_after = (legs - num_drones * longest_leg).max(0.0);
        latest = latest.max(starts[visit] + (services + legs_after) / num_drones + way_home);
    }
    latest
}

/// Turnarounds that cannot be at the same time: those of the drone with most trips, and those on one place at the depot.
fn turnarounds(facts: &Facts<'_>, fewest_trips: usize) -> f64 {
    let mut alone: Vec<f64> = (0..facts.visits().len()).map(|visit| facts.alone(visit)).collect();
    alone.sort_by(f64::total_cmp);
    let num_of_one = fewest_trips.div_ceil(facts.num_drones);
    let of_one = alone[..num_of_one].iter().sum::<f64>() + (num_of_one - 1) as f64 * facts.turnaround;
    let num_turnarounds = fewest_trips.saturating_sub(facts.num_drones);
    if num_turnarounds == 0 {
        return facts.takeoff + of_one;
    }
    // A place is first taken after a trip, and last left for another.
    let num_on_one_place = num_turnarounds.div_ceil(facts.round.fleet().num_pads);
    let on_one_place = alone[0] + num_on_one_place as f64 * facts.turnaround + alone[1];
    facts.takeoff + of_one.max(on_one_place)
}
