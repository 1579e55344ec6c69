//! What the search knows about places: coordinates, leg costs, service, nearest neighbours.
//!
//! Costs are seconds ([`crate::travel::leg_duration`]); in a research instance a second is a length unit. There is no n x n
//! matrix: a leg is computed from coordinates (one square root), and the legs to the nearest neighbours are stored beside
//! them, because those are what insertions ask for.

use crate::effort::Budget;
use crate::geometry::Point;
use crate::neighbours::KdTree;
use crate::problem::Problem;

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

/// Visits `0..num_visits`, then one copy of the depot per route: `num_visits + route`.
#[derive(Debug)]
pub(crate) struct Network {
    pub num_visits: usize,
    pub num_routes: usize,
    /// Positions of all nodes, in seconds of flight.
    pub points: Vec<Point>,
    /// Time on station of all nodes; 0 for the depot copies.
    pub services: Vec<f64>,
    /// Cost of the leg from the depot to each visit.
    pub depot_legs: Vec<f64>,
    /// Longest time a drone can be under way.
    pub max_route_cost: f64,
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
            max_route_cost: vehicle_type.max_duration,
            stop: vehicle_type.leg_stop_duration,
            lists: NeighbourLists::default(),
        };
        network.depot_legs = (0..num_visits)
            .map(|visit| network.leg_between(network.points[num_visits], network.points[visit]))
            .collect();
        network
    }

    /// Cost of the leg between two places.
    #[inline]
    pub fn leg_between(&self, from: Point, to: Point) -> f64 {
        leg_of_length(from.distance(to), self.stop)
    }

    /// Cost of the leg between two nodes.
    #[inline]
    pub fn leg(&self, from: u32, to: u32) -> f64 {
        self.leg_between(self.points[from as usize], self.points[to as usize])
    }

    /// Where the depot is.
    pub fn depot(&self) -> Point {
        self.points[self.num_visits]
    }

    /// No plan has a cheaper longest route: the farthest visit must be made and left.
    pub fn farthest_visit_bound(&self) -> f64 {
        let there_and_back = self.depot_legs.iter().zip(&self.services).map(|(leg, service)| 2.0 * leg + service);
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
