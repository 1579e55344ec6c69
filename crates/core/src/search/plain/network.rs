//! What the search knows about places: coordinates, leg costs, service, nearest neighbours.
//!
//! Costs are seconds ([`crate::travel::leg_duration`]); in a research instance a second is a length unit. There is no n x n
//! matrix: a leg is computed from coordinates (one square root), and the legs to the nearest neighbours are stored beside
//! them, because those are what insertions ask for.
//!
//! A route costs the same both ways. Where drones take off or come home in a way of their own, a leg at the depot is therefore
//! priced at half of what it costs out and home: a route then costs the mean of both ways, and who turns every route to its
//! cheaper way ([`crate::direction`]) gets no route that costs more than it did here.

use super::limits::{Limits, has_cost_like_length};
use crate::effort::Budget;
use crate::geometry::Point;
use crate::neighbours::KdTree;
use crate::problem::{Problem, VehicleType};
use crate::travel::{LegKind, leg_duration, leg_length};

/// Nearest neighbours kept per visit. The 8 lattice neighbours and most of the next ring; 24 did not shorten plans, and
/// slowed the steps by a quarter.
pub(crate) const NUM_NEIGHBOURS: usize = 16;

/// Visits whose neighbours are found between two looks at the clock.
const VISITS_PER_LOOK: usize = 128;

/// A nearest neighbour of a visit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Neighbour {
    /// Cost of the leg to it.
    pub leg: f64,
    /// Its node index.
    pub node: u32,
}

/// Cost of a leg whose flight alone takes `length`: who is there already need not stop.
#[inline(always)]
pub(super) fn leg_of_length(length: f64, stop: f64) -> f64 {
    if length > 0.0 { length + stop } else { 0.0 }
}

/// The mean of what a leg of `length` at the depot costs out and home.
fn mean_depot_leg(length: f64, vehicle_type: &VehicleType) -> f64 {
    0.5 * (leg_duration(length, LegKind::First, vehicle_type) + leg_duration(length, LegKind::Last, vehicle_type))
}

/// Visits `0..num_visits`, then one copy of the depot per route: `num_visits + route`.
#[derive(Debug)]
pub(crate) struct Network {
    pub num_visits: usize,
    pub num_routes: usize,
    /// Positions of all nodes, in seconds of flight.
    pub points: Vec<Point>,
    /// Time on station of all nodes; 0 for the depot copies.
    pub services: Vec<f64>,
    /// Cost of the leg between the depot and each visit.
    pub depot_legs: Vec<f64>,
    /// What a route that visits it pays at least to reach each visit, or to come home from it; empty where that is the leg
    /// between the depot and the visit.
    least_ways: Vec<f64>,
    /// Whether a route may cost less for one more visit: where drones come home more slowly than they fly, so that a visit on
    /// the way home saves time.
    pub may_visits_save: bool,
    /// Nodes from this on have legs of a price of their own: the copies of the depot, or none.
    first_priced: u32,
    /// Longest time a drone can be under way, also by its limit of length where that is one of time.
    pub max_route_cost: f64,
    /// What a route may use of other things.
    pub limits: Limits,
    /// Fixed time per leg.
    pub stop: f64,
    lists: NeighbourLists,
}

/// The nearest neighbours of all visits, as many for each.
#[derive(Debug, Default)]
pub(crate) struct NeighbourLists {
    neighbours: Vec<Neighbour>,
    list_size: usize,
}

impl Network {
    /// Without neighbour lists: O(n).
    pub fn new(problem: &Problem) -> Self {
        let vehicle_type = problem.vehicle_type();
        let (num_visits, num_routes) = (problem.num_visits(), vehicle_type.num_available.min(problem.num_visits()));
        let depot = problem.depot().position;
        let pace = 1.0 / vehicle_type.speed;
        let scaled = |place: Point| Point::new(place.x * pace, place.y * pace);
        let mut points: Vec<Point> = problem.visits().iter().map(|visit| scaled(visit.position)).collect();
        points.resize(num_visits + num_routes, scaled(depot));
        let mut services: Vec<f64> = problem.visits().iter().map(|visit| visit.service_duration).collect();
        services.resize(num_visits + num_routes, 0.0);
        let mut network = Self {
            num_visits,
            num_routes,
            points,
            services,
            depot_legs: Vec::new(),
            least_ways: Vec::new(),
            may_visits_save: false,
            first_priced: u32::MAX,
            max_route_cost: if has_cost_like_length(problem) {
                vehicle_type.max_duration.min(vehicle_type.max_length * pace)
            } else {
                vehicle_type.max_duration
            },
            limits: Limits::new(problem),
            stop: vehicle_type.leg_stop_duration,
            lists: NeighbourLists::default(),
        };
        network.depot_legs = (0..num_visits)
            .map(|visit| network.leg_between(network.points[num_visits], network.points[visit]))
            .collect();
        if !vehicle_type.has_plain_depot_legs() {
            network.price_depot_legs(problem);
        }
        network
    }

    fn price_depot_legs(&mut self, problem: &Problem) {
        let vehicle_type = problem.vehicle_type();
        let depot = problem.depot().position;
        let lengths = problem.visits().iter().map(|visit| leg_length(depot, visit.position));
        self.depot_legs = lengths.clone().map(|length| mean_depot_leg(length, &vehicle_type)).collect();
        let saved_per_length = vehicle_type
            .way_home
            .map_or(0.0, |way_home| f64::max(0.5 / way_home.speed - 0.5 / vehicle_type.speed, 0.0));
        self.least_ways =
            self.depot_legs.iter().zip(lengths).map(|(leg, length)| leg - saved_per_length * length).collect();
        self.may_visits_save = saved_per_length > 0.0;
        self.first_priced = self.num_visits as u32;
    }

    /// Whether the legs at the depot have a price of their own.
    #[inline]
    pub fn has_priced_depot_legs(&self) -> bool {
        self.first_priced != u32::MAX
    }

    /// Cost of the leg between two places that are not the depot, or where it has no price of its own.
    #[inline]
    fn leg_between(&self, from: Point, to: Point) -> f64 {
        leg_of_length(from.distance(to), self.stop)
    }

    /// Cost of the leg between two nodes.
    #[inline]
    pub fn leg(&self, from: u32, to: u32) -> f64 {
        match self.priced_leg(from, to) {
            Some(leg) => leg,
            None => self.leg_between(self.points[from as usize], self.points[to as usize]),
        }
    }

    /// Cost of the leg between two nodes, if it has a price of its own.
    #[inline]
    pub fn priced_leg(&self, from: u32, to: u32) -> Option<f64> {
        let (visit, depot) = (from.min(to), from.max(to));
        // A route without visits flies from one copy of the depot to another.
        (depot >= self.first_priced).then(|| self.depot_legs.get(visit as usize).copied().unwrap_or(0.0))
    }

    /// What the leg between two nodes uses of a limit.
    pub fn use_of_leg(&self, limit: usize, from: u32, to: u32) -> f64 {
        let seconds = self.points[from as usize].distance(self.points[to as usize]);
        match [from, to].map(|node| node as usize >= self.num_visits) {
            [false, false] => self.limits.of_leg(limit, seconds),
            // A route without visits flies nowhere.
            [true, true] => 0.0,
            _ => self.limits.of_depot_leg(limit, seconds),
        }
    }

    /// Where the depot is.
    pub fn depot(&self) -> Point {
        self.points[self.num_visits]
    }

    /// No plan has a cheaper longest route: the farthest visit must be made and left.
    pub fn farthest_visit_bound(&self) -> f64 {
        let ways = if self.has_priced_depot_legs() { &self.least_ways } else { &self.depot_legs };
        let there_and_back = ways.iter().zip(&self.services).map(|(way, service)| 2.0 * way + service);
        there_and_back.fold(0.0, f64::max)
    }

    /// Cost of a route: legs and service.
    pub fn route_cost(&self, visits: &[u32]) -> f64 {
        let (Some(&first), Some(&last)) = (visits.first(), visits.last()) else { return 0.0 };
        let legs: f64 = visits.windows(2).map(|pair| self.leg(pair[0], pair[1])).sum();
        let services: f64 = visits.iter().map(|&visit| self.services[visit as usize]).sum();
        self.depot_legs[first as usize] + legs + services + self.depot_legs[last as usize]
    }

    /// The nearest neighbours of a visit, nearest first. Empty before [`Network::set_neighbours`].
    #[inline]
    pub fn neighbours(&self, visit: u32) -> &[Neighbour] {
        let NeighbourLists { neighbours, list_size } = &self.lists;
        let start = visit as usize * list_size;
        &neighbours[start..start + list_size]
    }

    /// Finds the neighbours of all visits, which [`Network::set_neighbours`] takes: O(n log n). `None`, if the time is over before.
    ///
    /// On a lattice most distances are tied; [`NUM_NEIGHBOURS`] reaches beyond the ring of eight, so that none of it is lost.
    pub fn find_neighbours(&self, budget: &Budget<'_>) -> Option<NeighbourLists> {
        let list_size = NUM_NEIGHBOURS.min(self.num_visits - 1);
        let tree = KdTree::new(&self.points[..self.num_visits]);
        let mut found = Vec::with_capacity(list_size);
        let mut neighbours = Vec::with_capacity(self.num_visits * list_size);
        for visit in 0..self.num_visits {
            if visit % VISITS_PER_LOOK == VISITS_PER_LOOK - 1 && budget.is_time_over() {
                return None;
            }
            tree.nearest(visit, list_size, &mut found);
            neighbours.extend(found.iter().map(|near| {
                let leg = leg_of_length(near.squared_distance.sqrt(), self.stop);
                Neighbour { leg, node: near.index }
            }));
        }
        Some(NeighbourLists { neighbours, list_size })
    }

    /// Takes the lists that [`Network::find_neighbours`] made.
    pub fn set_neighbours(&mut self, lists: NeighbourLists) {
        self.lists = lists;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::direction::fly_cheaper_way;
    use crate::evaluate::evaluate;
    use crate::problem::{Depot, Visit, WayHome};
    use proptest::prelude::*;

    /// Few ponds, some of which lie at the depot, and drones that take off and perhaps come home in their own way.
    fn problems() -> impl Strategy<Value = Problem> {
        let place = prop_oneof![(-3.0..3.0f64, -3.0..3.0f64), Just((0.0, 0.0))];
        let way_home = prop::option::of((0.3..8.0f64, 0.0..5.0f64));
        (prop::collection::vec((place, 0.0..2.0f64), 1..6), 0.0..4.0f64, way_home).prop_map(
            |(visits, takeoff_duration, way_home)| {
                let visits = visits
                    .into_iter()
                    .map(|((x, y), service_duration)| Visit { service_duration, ..Visit::at(Point::new(x, y)) });
                let vehicle_type = VehicleType {
                    speed: 2.0,
                    leg_stop_duration: 0.7,
                    takeoff_duration,
                    way_home: way_home.map(|(speed, fixed_duration)| WayHome { speed, fixed_duration }),
                    ..VehicleType::unlimited(1)
                };
                Problem::new(Depot { position: Point::default() }, visits.collect(), vehicle_type).unwrap()
            },
        )
    }

    fn permutations(num_visits: usize) -> Vec<Vec<usize>> {
        if num_visits == 0 {
            return vec![vec![]];
        }
        let shorter = permutations(num_visits - 1);
        let with_last = |place: usize| {
            shorter.iter().map(move |order| {
                let mut order = order.clone();
                order.insert(place, num_visits - 1);
                order
            })
        };
        (0..num_visits).flat_map(with_last).collect()
    }

    proptest! {
        #[test]
        fn a_route_costs_the_mean_of_both_ways(problem in problems()) {
            let network = Network::new(&problem);
            let duration = |route: &[usize]| evaluate(&problem, &[route.to_vec()]).unwrap().makespan();
            for order in permutations(problem.num_visits()) {
                let turned: Vec<usize> = order.iter().rev().copied().collect();
                let nodes: Vec<u32> = order.iter().map(|&visit| visit as u32).collect();
                let cost = network.route_cost(&nodes);
                prop_assert!((cost - 0.5 * (duration(&order) + duration(&turned))).abs() < 1e-9);
                let mut flown = order.clone();
                fly_cheaper_way(&problem, &mut flown);
                prop_assert!(duration(&flown) <= cost + 1e-9);
                prop_assert!(duration(&flown) <= duration(&order).min(duration(&turned)) + 1e-9);
                prop_assert!(network.farthest_visit_bound() <= cost + 1e-9);
            }
        }

        #[test]
        fn every_leg_at_the_depot_has_one_price(problem in problems()) {
            let network = Network::new(&problem);
            let depot = network.num_visits as u32;
            for visit in 0..depot {
                prop_assert_eq!(network.leg(depot, visit), network.depot_legs[visit as usize]);
                prop_assert_eq!(network.leg(visit, depot), network.depot_legs[visit as usize]);
            }
            prop_assert_eq!(network.leg(depot, depot), 0.0);
        }
    }
}
