//! How early the last drone of a round can land at best: what no plan that makes all visits can beat.
//!
//! - Farthest: some drone makes each visit. Before it lies at least the way there, after it the way home; times of flight through
//!   moving air keep the triangle inequality ([`crate::travel`]), so no way round is shorter.
//! - Work: all drones together serve, fly, take off, land and are turned round. Their legs connect all places with the depot,
//!   so they take at least a shortest spanning tree, over what a leg takes at least in either direction. Closed trips lead
//!   nowhere, so that for any vector b the sum of b.d over their legs d is 0: times less b.d serve as well, and a b along the
//!   wind makes a stronger tree.
//! - Radial (Haimovich and Rinnooy Kan, Bounds and heuristics for capacitated routing problems, 1985): a trip flies at least to
//!   its farthest visit and back, and that is shared by its visits by what they take of its battery.
//! - Trips: what all visits take of loads, batteries and times over what one trip may take. Some drone flies its share of them,
//!   rounded up.
//!
//! Energies are bounded by the least power of flight times the time, because energy need not keep the triangle inequality.
//! O(n^2) for n visits, O(n) where there are more than 2,000.

use super::round::{Round, RoundVisit, Rounding};
use crate::geometry::Point;
use crate::problem::VehicleType;
use crate::travel::leg_length;

/// More visits have no tree.
const MAX_TREE: usize = 2000;
/// Trees tried in wind, with b at these shares of what the wind makes of a second along it.
const TILTS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// No plan of `round` that makes all visits has its last landing earlier, in seconds; infinite if there is none. Legs cut to tenths break the
/// triangle inequality, so for them only windows and services count.
#[must_use]
pub fn makespan_bound(round: &Round) -> f64 {
    let least_service = |visit: &RoundVisit| earliest_begin(visit) + visit.visit.service_duration;
    let served = round.visits().iter().map(least_service).fold(0.0, f64::max);
    if round.rounding() == Rounding::Dimacs {
        return served;
    }
    let limits = Limits::new(round);
    let (travel, num_trips) = (limits.least_travel(), limits.fewest_trips());
    if round.fleet().turnaround.is_none() && num_trips > limits.drones.len() as f64 {
        return f64::INFINITY;
    }
    let farthest = round.visits().iter().map(|visit| limits.alone(visit)).fold(served, f64::max);
    farthest.max(limits.by_work(travel, num_trips)).max(limits.by_trips(num_trips))
}

/// When the service of a visit can begin at best, as its windows say.
fn earliest_begin(visit: &RoundVisit) -> f64 {
    let earliest = visit.windows.iter().map(|window| window.earliest).fold(f64::INFINITY, f64::min);
    if visit.windows.is_empty() { 0.0 } else { earliest }
}

/// What the parts of a plan take at least.
struct Limits<'a> {
    round: &'a Round,
    drones: Vec<VehicleType>,
    /// The faster of both speeds over ground, with which no leg takes longer than it is flown.
    speed: f64,
    /// Seconds and joules of take-off and landing of a trip.
    ends_duration: f64,
    ends_energy: f64,
    /// The least power of flight, in watts.
    power: f64,
    num_places: usize,
}

impl<'a> Limits<'a> {
    fn new(round: &'a Round) -> Self {
        let fleet = round.fleet();
        let num_drones = fleet.vehicle_type.num_available.min(round.visits().len() + fleet.layers.len());
        let drones: Vec<VehicleType> = (0..num_drones).map(|drone| fleet.drone(drone)).collect();
        let least = |value: fn(&VehicleType) -> f64| drones.iter().map(value).fold(f64::INFINITY, f64::min);
        let VehicleType { speed, way_home, energy, .. } = fleet.vehicle_type;
        let home_speed = way_home.map_or(speed, |way_home| way_home.speed);
        let hover = |power: f64, speed: f64| power - fleet.air.drag_power * speed * speed * speed;
        let way_home_power = if way_home.is_some() { hover(energy.way_home_power, home_speed) } else { f64::INFINITY };
        let mut places: Vec<(u64, u64)> = (round.visits().iter())
            .map(|visit| (visit.visit.position.x.to_bits(), visit.visit.position.y.to_bits()))
            .collect();
        places.sort_unstable();
        places.dedup();
        Self {
            round,
            speed: speed.max(home_speed),
            ends_duration: least(|drone| {
                drone.takeoff_duration + drone.way_home.map_or(0.0, |way_home| way_home.fixed_duration)
            }),
            ends_energy: least(|drone| {
                let home = if drone.way_home.is_some() { drone.energy.way_home_fixed_energy } else { 0.0 };
                drone.energy.takeoff_energy + home
            }),
            power: hover(energy.leg_power, speed).min(way_home_power).max(0.0),
            drones,
            num_places: places.len(),
        }
    }

    /// Seconds that flying from one place to another takes at least, stops left aside.
    fn way(&self, from: Point, to: Point) -> f64 {
        let length = leg_length(from, to);
        if length == 0.0 {
            return 0.0;
        }
        let speeds = self.round.fleet().air.speeds(to.x - from.x, to.y - from.y, self.speed);
        speeds.map_or(f64::INFINITY, |(ground_speed, _)| length / ground_speed)
    }

    fn round_trip(&self, place: Point) -> f64 {
        self.way(self.round.depot(), place) + self.way(place, self.round.depot())
    }

    /// When a drone that makes this visit is back at best.
    fn alone(&self, visit: &RoundVisit) -> f64 {
        let (fleet, place) = (self.round.fleet(), visit.visit.position);
        let least = |value: fn(&VehicleType) -> f64| self.drones.iter().map(value).fold(f64::INFINITY, f64::min);
        let out = least(|drone| drone.takeoff_duration) + self.way(self.round.depot(), place);
        let home = least(|drone| drone.way_home.map_or(0.0, |way_home| way_home.fixed_duration));
        let begin = (fleet.shift.earliest.max(visit.release) + out).max(earliest_begin(visit));
        begin + visit.visit.service_duration + self.way(place, self.round.depot()) + home
    }

    /// Seconds that the legs of all trips take at least, stops with them.
    fn least_travel(&self) -> f64 {
        // A drone comes to every place by a leg that stops there.
        let stops = self.num_places as f64 * self.round.fleet().vehicle_type.leg_stop_duration;
        let tree = if self.round.visits().len() > MAX_TREE { 0.0 } else { self.tree() };
        stops + tree.max(self.radial())
    }

    /// The longest of the shortest spanning trees.
    fn tree(&self) -> f64 {
        let wind = self.round.fleet().air.wind;
        let unit = Point::new(100.0 * wind.x, 100.0 * wind.y);
        let tilts = if wind == Point::default() { &TILTS[..1] } else { &TILTS[..] };
        let against = self.way(unit, Point::default());
        let along = self.way(Point::default(), unit);
        let squared = unit.x * unit.x + unit.y * unit.y;
        let trees = tilts.iter().map(|tilt| {
            // At a share of 1 a leg along the wind and one against it take the same.
            let scale = if squared > 0.0 { -tilt * 0.5 * (against - along) / squared } else { 0.0 };
            self.tree_less(Point::new(scale * unit.x, scale * unit.y))
        });
        trees.fold(0.0, f64::max)
    }

    /// The shortest spanning tree of depot and visits, over times less the product with a vector, in the lesser direction (Prim).
    fn tree_less(&self, tilt: Point) -> f64 {
        let places: Vec<Point> = std::iter::once(self.round.depot())
            .chain(self.round.visits().iter().map(|visit| visit.visit.position))
            .collect();
        let cost = |from: Point, to: Point| {
            let product = tilt.x * (to.x - from.x) + tilt.y * (to.y - from.y);
            (self.way(from, to) - product).min(self.way(to, from) + product)
        };
        let mut nearest: Vec<f64> = places.iter().map(|&place| cost(places[0], place)).collect();
        let mut is_in = vec![false; places.len()];
        is_in[0] = true;
        let mut total = 0.0;
        for _ in 1..places.len() {
            let others = (0..places.len()).filter(|&index| !is_in[index]);
            let Some(next) = others.min_by(|&one, &other| nearest[one].total_cmp(&nearest[other])) else { break };
            total += nearest[next];
            is_in[next] = true;
            for (index, near) in nearest.iter_mut().enumerate() {
                if !is_in[index] {
                    *near = near.min(cost(places[next], places[index]));
                }
            }
        }
        total.max(0.0)
    }

    /// What a visit takes of a battery, and what its trip has for all its visits at most, if the battery is limited.
    fn shares(&self) -> impl Iterator<Item = (f64, f64, f64)> + '_ {
        let usable = self.round.fleet().vehicle_type.energy.usable_energy - self.ends_energy;
        self.round.visits().iter().map(move |visit| {
            let round_trip = self.round_trip(visit.visit.position);
            (round_trip, visit.visit.service_energy, usable - self.power * round_trip)
        })
    }

    fn radial(&self) -> f64 {
        let visits = self.shares().filter(|&(_, _, room)| room.is_finite() && room > 0.0);
        let shared: f64 = visits.map(|(round_trip, energy, room)| round_trip * energy / room).sum();
        // Without a battery there is still the way to the farthest.
        self.shares().map(|(round_trip, ..)| round_trip).fold(shared, f64::max)
    }

    /// The fewest trips of a plan that makes all visits; infinite if none does.
    fn fewest_trips(&self) -> f64 {
        let fleet = self.round.fleet();
        let share_of = |total: f64, limit: f64| {
            if limit.is_infinite() || total <= 0.0 {
                1.0
            } else if limit > 0.0 {
                (total / limit * (1.0 - 1e-9)).ceil()
            } else {
                f64::INFINITY
            }
        };
        let visits = self.round.visits();
        let sum = |value: fn(&RoundVisit) -> f64| visits.iter().map(value).sum::<f64>();
        let (services, energies) = (sum(|visit| visit.visit.service_duration), sum(|visit| visit.visit.service_energy));
        let travel = self.least_travel();
        let vehicle_type = &fleet.vehicle_type;
        let stops = self.num_places as f64 * vehicle_type.leg_stop_duration;
        let by_radius: f64 =
            self.shares().map(|(_, energy, room)| if room > 0.0 { energy / room } else { f64::INFINITY }).sum::<f64>();
        share_of(sum(|visit| visit.load), fleet.capacity)
            .max(share_of(
                energies + self.power * (travel - stops),
                vehicle_type.energy.usable_energy - self.ends_energy,
            ))
            .max(share_of(services + travel, vehicle_type.max_duration - self.ends_duration))
            .max((by_radius * (1.0 - 1e-9)).ceil())
    }

    /// When drones that share all the work are back at best, each from its first take-off on.
    fn by_work(&self, travel: f64, num_trips: f64) -> f64 {
        let fleet = self.round.fleet();
        let num_drones = self.drones.len() as f64;
        let turnarounds = fleet.turnaround.unwrap_or(0.0) * (num_trips - num_drones).max(0.0);
        let services: f64 = self.round.visits().iter().map(|visit| visit.visit.service_duration).sum();
        let mut work = services + travel + num_trips * self.ends_duration + turnarounds;
        // Drones take off one after the other: those that may not yet have taken off do nothing.
        let mut finish = fleet.first_takeoff(0);
        for num_flying in 1..=self.drones.len() {
            let next = if num_flying < self.drones.len() { fleet.first_takeoff(num_flying) } else { f64::INFINITY };
            let room = (next - finish) * num_flying as f64;
            if work <= room {
                return finish + work / num_flying as f64;
            }
            work -= room;
            finish = next;
        }
        finish
    }

    /// When the drone that flies most trips is back at best.
    fn by_trips(&self, num_trips: f64) -> f64 {
        let fleet = self.round.fleet();
        let own = (num_trips / self.drones.len() as f64).ceil();
        let trips = self
            .round
            .visits()
            .iter()
            .map(|visit| self.round_trip(visit.visit.position) + visit.visit.service_duration + self.ends_duration);
        let least = trips.fold(f64::INFINITY, f64::min);
        fleet.first_takeoff(0) + own * least + (own - 1.0) * fleet.turnaround.unwrap_or(0.0)
    }
}
