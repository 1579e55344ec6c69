//! A first plan: balanced sectors around the depot, each toured along a space-filling curve and then improved.
//!
//! Sources: the sweep of Gillett and Miller, Operations Research 1974, with the sectors balanced by the cost of their tours
//! instead of by load; Bartholdi and Platzman, Management Science 1988, for the curve as a tour.
//!
//! A sweep beats cutting one giant tour on farms: the routes of good min-max plans are petals around the depot. The first sector
//! begins at the widest gap, which is where the farm ends if the depot is at its edge. Which petals are best cannot be seen
//! from the sectors, so the search starts from several cuts. O(n log n).

use super::network::Network;
use super::order::{curve_keys, ends_by_cost, place_after_widest_gap, pseudo_angle};

/// The visits by their angle around the depot, and what that order makes of them.
pub(super) struct Sectors<'a> {
    network: &'a Network,
    /// Sorted by angle; the first follows the widest gap.
    visits: Vec<u32>,
    /// Place of each visit along a Hilbert curve over the farm.
    curve_keys: Vec<u32>,
}

impl<'a> Sectors<'a> {
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
    pub fn routes(&self, shares: &[f64]) -> Vec<Vec<u32>> {
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
