//! What a route may use of things other than its cost: length and energy.
//!
//! A route costs time, and its longest time is what is minimised, or a cap for all. Where drones have a longest length or so much
//! energy besides, that is another sum of legs and visits, which no price of the first sum can stand for. It is kept in shares of
//! the limit, so that all limits count alike; plans without limits carry nothing of it.
//!
//! Changed to what [`crate::travel`] says: a route is a ring, so that legs at the depot are charged alike both ways: the mean of
//! out and home where the way that takes less time takes less energy too, else the worse of them. A route within its limits here
//! is so the way it will be flown.

use crate::problem::Problem;

/// What a leg takes of a limit, in shares of it.
#[derive(Clone, Copy, Debug)]
struct LegUse {
    /// For each second of flight.
    per_second: f64,
    /// For each leg of some length.
    per_leg: f64,
}

impl LegUse {
    fn of(self, seconds: f64) -> f64 {
        self.per_second * seconds + if seconds > 0.0 { self.per_leg } else { 0.0 }
    }
}

/// One thing that a route may use so much of.
#[derive(Clone, Debug)]
struct Limit {
    between: LegUse,
    at_depot: LegUse,
    /// For each leg at the depot, whatever its length.
    per_depot_leg: f64,
    /// Of each visit; empty where visits use nothing.
    services: Vec<f64>,
}

/// All limits of a fleet.
#[derive(Clone, Debug, Default)]
pub(crate) struct Limits {
    limits: Vec<Limit>,
}

impl Limits {
    pub fn new(problem: &Problem) -> Self {
        let vehicle_type = problem.vehicle_type();
        let mut limits = Vec::new();
        if vehicle_type.max_length.is_finite() && !has_cost_like_length(problem) {
            let legs = LegUse { per_second: vehicle_type.speed / vehicle_type.max_length, per_leg: 0.0 };
            limits.push(Limit { between: legs, at_depot: legs, per_depot_leg: 0.0, services: Vec::new() });
        }
        let energy = &vehicle_type.energy;
        if energy.usable_energy.is_finite() {
            let share = 1.0 / energy.usable_energy;
            let stop = vehicle_type.leg_stop_duration * energy.leg_stop_power * share;
            let between = LegUse { per_second: energy.leg_power * share, per_leg: stop };
            let (home_per_second, home_stop, home_fixed) =
                vehicle_type.way_home.map_or((between.per_second, stop, 0.0), |way_home| {
                    let slowness = vehicle_type.speed / way_home.speed;
                    (slowness * energy.way_home_power * share, 0.0, energy.way_home_fixed_energy * share)
                });
            // A route is flown the way that takes less time. Where that way takes less energy too, it takes no more than the
            // mean of both; else nobody knows which way it will be, and the worse one counts.
            let time_saved = vehicle_type.way_home.map_or(0.0, |way_home| 1.0 - vehicle_type.speed / way_home.speed);
            let energy_saved = between.per_second - home_per_second;
            let per_second = if time_saved * energy_saved > 0.0 {
                0.5 * (between.per_second + home_per_second)
            } else {
                between.per_second.max(home_per_second)
            };
            let at_depot = LegUse { per_second, per_leg: 0.0 };
            limits.push(Limit {
                between,
                at_depot,
                per_depot_leg: 0.5 * (energy.takeoff_energy * share + stop + home_stop + home_fixed),
                services: problem.visits().iter().map(|visit| visit.service_energy * share).collect(),
            });
        }
        Self { limits }
    }

    /// How many limits there are.
    #[inline]
    pub fn len(&self) -> usize {
        self.limits.len()
    }

    /// What a leg between two visits uses of a limit, of which the flight alone takes `seconds`.
    pub fn of_leg(&self, limit: usize, seconds: f64) -> f64 {
        self.limits[limit].between.of(seconds)
    }

    /// What a leg at the depot uses of a limit.
    pub fn of_depot_leg(&self, limit: usize, seconds: f64) -> f64 {
        self.limits[limit].at_depot.of(seconds) + self.limits[limit].per_depot_leg
    }

    /// What a visit uses of a limit.
    pub fn of_visit(&self, limit: usize, visit: u32) -> f64 {
        self.limits[limit].services.get(visit as usize).copied().unwrap_or(0.0)
    }
}

/// Whether a route costs as many seconds as it is long, divided by the speed: then a limit of length is one of cost.
pub(super) fn has_cost_like_length(problem: &Problem) -> bool {
    let vehicle_type = problem.vehicle_type();
    vehicle_type.has_plain_depot_legs()
        && vehicle_type.leg_stop_duration == 0.0
        && problem.visits().iter().all(|visit| visit.service_duration == 0.0)
}

/// By how much routes exceed limits, summed, of which they use these shares.
pub(super) fn excess(shares: &[f64]) -> f64 {
    shares.iter().fold(0.0, |sum, share| sum + (share - LIMIT).max(0.0))
}

/// The share that is too much: but for rounding, the whole.
const LIMIT: f64 = 1.0 + 1e-10;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::evaluate;
    use crate::geometry::Point;
    use crate::problem::{Depot, Energy, VehicleType, Visit, WayHome};
    use crate::search::plain::network::Network;
    use crate::search::plain::state::State;
    use proptest::prelude::*;

    proptest! {
        /// Held against the judge: never less than what a route takes the way it is flown, and just that where the ways are
        /// alike.
        #[test]
        fn uses_are_what_the_judge_says_or_more(
            places in prop::collection::vec((-3_i8..4, -3_i8..4, 0.0..2.0_f64), 1..7),
            way_home in prop::option::of((0.3..8.0_f64, 0.0..9.0_f64, 0.0..9.0_f64)),
            (takeoff_energy, leg_power, leg_stop_power) in (0.0..9.0_f64, 0.0..9.0_f64, 0.0..9.0_f64),
        ) {
            let visits = places.iter().map(|&(x, y, service)| Visit {
                position: Point::new(x.into(), y.into()), service_duration: service, service_energy: 3.0 * service,
            });
            let energy = Energy {
                takeoff_energy,
                leg_power,
                leg_stop_power,
                way_home_power: way_home.map_or(0.0, |way| way.1),
                way_home_fixed_energy: way_home.map_or(0.0, |way| way.2),
                usable_energy: 50.0,
            };
            let vehicle_type = VehicleType {
                speed: 2.0,
                leg_stop_duration: 0.7,
                way_home: way_home.map(|way| WayHome { speed: way.0, fixed_duration: 1.0 }),
                energy,
                max_length: 20.0,
                ..VehicleType::unlimited(2)
            };
            let problem = Problem::new(Depot { position: Point::default() }, visits.collect(), vehicle_type).unwrap();
            let network = Network::new(&problem);
            let mut route: Vec<usize> = (0..places.len()).collect();
            let state = State::new(&network, &[route.iter().map(|&visit| visit as u32).collect()]);
            let [length, energy] = state.route_uses[..2] else { unreachable!() };
            let ways = [0, 1].map(|_| {
                let flown = evaluate(&problem, std::slice::from_ref(&route)).unwrap().routes[0].clone();
                route.reverse();
                flown
            });
            let flown = if ways[1].duration < ways[0].duration { &ways[1] } else { &ways[0] };
            prop_assert!((length - flown.length / 20.0).abs() < 1e-9);
            // A pond at the depot has a leg without a stop on one way only.
            let is_apart = places.iter().all(|&(x, y, _)| (x, y) != (0, 0));
            if is_apart && (ways[1].duration - ways[0].duration).abs() > 1e-9 {
                prop_assert!(energy >= flown.energy / 50.0 - 1e-9);
            }
            if is_apart && way_home.is_none() {
                prop_assert!((energy - flown.energy / 50.0).abs() < 1e-9);
            }
        }
    }
}
