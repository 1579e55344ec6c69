//! A first plan: balanced sectors around the depot, each toured along a space-filling curve and then improved.
//!
//! Sources: the sweep of Gillett and Miller, Operations Research 1974, with the sectors balanced by the cost of their tours
//! instead of by load; Bartholdi and Platzman, Management Science 1988, for the curve as a tour.
//!
//! A sweep beats cutting one giant tour on farms: the routes of good min-max plans are petals around the depot. The first sector
//! begins at the widest gap, which is where the farm ends if the depot is at its edge. Which petals are best cannot be seen
//! from the sectors, so the search starts from several cuts. O(n log n).

use super::improve::{Room, improve_ring};
use super::network::Network;
use crate::effort::Budget;
use crate::geometry::Point;

/// The visits by their angle around the depot, and what that order makes of them.
pub(super) struct Sweep<'a> {
    network: &'a Network,
    /// Sorted by angle; the first follows the widest gap.
    visits: Vec<u32>,
    /// Place of each visit along a Hilbert curve over the farm.
    curve_keys: Vec<u32>,
}

impl<'a> Sweep<'a> {
    pub fn new(network: &'a Network) -> Self {
        let depot = network.depot();
        let points = &network.points[..network.num_visits];
        let mut keyed: Vec<(f64, u32)> = points
            .iter()
            .zip(0..)
            .map(|(point, visit)| (pseudo_angle(point.x - depot.x, point.y - depot.y), visit))
            .collect();
        keyed.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let first = place_after_widest_gap(&keyed);
        keyed.rotate_left(first);
        Self { network, visits: keyed.into_iter().map(|entry| entry.1).collect(), curve_keys: curve_keys(points) }
    }

    /// One route from each of as many sectors as there are `shares`; the cost of a sector's curve is about its share of all.
    pub fn sectors(&self, shares: &[f64]) -> Vec<Vec<u32>> {
        let num_visits = self.network.num_visits;
        let mut ends = ends_by_cost(&[0, num_visits], &[1.0], shares);
        let mut routes = self.tour_sectors(&ends);
        for _ in 0..NUM_BALANCINGS {
            let costs: Vec<f64> = routes.iter().map(|route| self.network.route_cost(route)).collect();
            ends = ends_by_cost(&ends, &costs, shares);
            routes = self.tour_sectors(&ends);
        }
        routes
    }

    fn tour_sectors(&self, ends: &[usize]) -> Vec<Vec<u32>> {
        let tour = |range: &[usize]| {
            let mut route = self.visits[range[0]..range[1]].to_vec();
            route.sort_unstable_by_key(|&visit| (self.curve_keys[visit as usize], visit));
            open_at_best_leg(self.network, &mut route);
            route
        };
        ends.windows(2).map(tour).collect()
    }
}

/// Rounds of balancing; a second gained nothing that the search did not gain faster.
const NUM_BALANCINGS: usize = 1;

/// Rotates a closed tour of visits so that going through the depot between its last and first visit costs least.
pub(crate) fn open_at_best_leg(network: &Network, route: &mut [u32]) {
    let (mut best, mut best_detour) = (0, f64::INFINITY);
    for place in 0..route.len() {
        let (from, to) = (route[if place == 0 { route.len() - 1 } else { place - 1 }], route[place]);
        let depot_legs = network.depot_legs[from as usize] + network.depot_legs[to as usize];
        let detour = depot_legs - network.leg(from, to);
        if detour < best_detour {
            (best, best_detour) = (place, detour);
        }
    }
    route.rotate_left(best);
}

/// Improves each route on its own by 2-opt and Or-opt, and stops between two moves when the time is over.
pub(crate) fn improve_routes(network: &Network, budget: &Budget<'_>, routes: &mut [Vec<u32>]) {
    let mut room = Room::new(network);
    for visits in routes {
        let queue = visits.iter().rev().copied().collect();
        improve_route(network, budget, visits, queue, &mut room);
    }
}

/// Improves one route, from the visits of it that are in `queue`. Returns whether it did anything.
pub(super) fn improve_route(
    network: &Network,
    budget: &Budget<'_>,
    visits: &mut Vec<u32>,
    queue: Vec<u32>,
    room: &mut Room,
) -> bool {
    let depot = network.num_visits as u32;
    visits.push(depot);
    let has_moved = improve_ring(network, budget, visits, queue, room);
    let place = visits.iter().position(|&node| node == depot).unwrap_or(0);
    visits.rotate_left(place);
    visits.remove(0);
    has_moved
}

/// Ends of new sectors, each with its share of the cost, were cost spread evenly within each old sector.
pub(super) fn ends_by_cost(old_ends: &[usize], old_costs: &[f64], shares: &[f64]) -> Vec<usize> {
    let cost_of_a_share = old_costs.iter().sum::<f64>() / shares.iter().sum::<f64>();
    let mut ends = vec![0];
    let (mut sum, mut goal) = (0.0, shares[0] * cost_of_a_share);
    for (range, cost) in old_ends.windows(2).zip(old_costs) {
        let size = range[1] - range[0];
        for place in 0..size {
            sum += cost / size as f64;
            if sum >= goal && ends.len() < shares.len() {
                goal += shares[ends.len()] * cost_of_a_share;
                ends.push(range[0] + place + 1);
            }
        }
    }
    ends.resize(shares.len() + 1, old_ends[old_ends.len() - 1]);
    ends
}

/// Grows with the angle of `(x, y)` from 0 to 4, without trigonometry: the same on every machine.
pub(crate) fn pseudo_angle(x: f64, y: f64) -> f64 {
    let norm = x.abs() + y.abs();
    if norm == 0.0 {
        return 0.0;
    }
    let ratio = x / norm;
    if y >= 0.0 { 1.0 - ratio } else { 3.0 + ratio }
}

pub(crate) fn place_after_widest_gap(keyed: &[(f64, u32)]) -> usize {
    let last = keyed.len() - 1;
    let (mut place, mut widest) = (0, keyed[0].0 + 4.0 - keyed[last].0);
    for (index, pair) in keyed.windows(2).enumerate() {
        if pair[1].0 - pair[0].0 > widest {
            (place, widest) = (index + 1, pair[1].0 - pair[0].0);
        }
    }
    place
}

/// Place of each point along a Hilbert curve over the bounding square.
pub(crate) fn curve_keys(points: &[Point]) -> Vec<u32> {
    let (mut low, mut high) = (points[0], points[0]);
    for point in points {
        low = Point::new(low.x.min(point.x), low.y.min(point.y));
        high = Point::new(high.x.max(point.x), high.y.max(point.y));
    }
    let side = (high.x - low.x).max(high.y - low.y).max(f64::MIN_POSITIVE);
    let scale = f64::from(CURVE_SIDE - 1) / side;
    points
        .iter()
        .map(|point| curve_key(((point.x - low.x) * scale) as u32, ((point.y - low.y) * scale) as u32))
        .collect()
}

/// Cells along one side of the Hilbert curve.
const CURVE_SIDE: u32 = 1 << 16;

/// Position of a cell on the Hilbert curve.
fn curve_key(mut x: u32, mut y: u32) -> u32 {
    let mut key = 0;
    let mut side = CURVE_SIDE / 2;
    while side > 0 {
        let (right, upper) = (u32::from(x & side > 0), u32::from(y & side > 0));
        key += side * side * ((3 * right) ^ upper);
        if upper == 0 {
            if right == 1 {
                x = !x & (CURVE_SIDE - 1);
                y = !y & (CURVE_SIDE - 1);
            }
            std::mem::swap(&mut x, &mut y);
        }
        side >>= 1;
    }
    key
}
