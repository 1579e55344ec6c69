//! A first plan: parts of the farm, one for each route, toured along a space-filling curve and then improved. Parts are balanced
//! sectors around the depot, or come from random straight cuts.
//!
//! Sources: the sweep of Gillett and Miller, Operations Research 1974, with the sectors balanced by the cost of their tours
//! instead of by load; Bartholdi and Platzman, Management Science 1988, for the curve as a tour; the cuts as in the recursive
//! coordinate bisection of Berger and Bokhari, IEEE Transactions on Computers 1987, but in random directions.
//!
//! A sweep beats cutting one giant tour on farms: the routes of good min-max plans are petals around the depot. The first sector
//! begins at the widest gap, which is where the farm ends if the depot is at its edge. Which petals are best cannot be seen
//! from the sectors, so the search starts from several cuts. Best plans that are no petals, such as one route behind another,
//! are never found from sectors, however long the search: random cuts begin there. O(n log n).

use super::network::Network;
use super::order::{curve_keys, ends_by_cost, place_after_widest_gap, pseudo_angle};
use crate::geometry::Point;
use crate::random::Random;

/// Cuts a farm into parts, one for each route: what sectors and random lines need to know of the visits.
pub(super) struct Cuts<'a> {
    network: &'a Network,
    /// Sorted by angle; the first follows the widest gap.
    visits: Vec<u32>,
    /// Place of each visit along a Hilbert curve over the farm.
    curve_keys: Vec<u32>,
}

impl<'a> Cuts<'a> {
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
        ends.windows(2).map(|range| self.tour(self.visits[range[0]..range[1]].to_vec())).collect()
    }

    /// One route from each of `num_routes` parts of `visits`, about equally many in each: straight lines in random directions
    /// halve the number of routes until each part has one. O(n log m).
    pub fn cut_at_random(&self, visits: &mut [u32], num_routes: usize, random: &mut Random) -> Vec<Vec<u32>> {
        if num_routes == 1 {
            return vec![self.tour(visits.to_vec())];
        }
        let num_first = num_routes / 2;
        let num_visits = visits.len() * num_first / num_routes;
        // A direction without trigonometry: the same on every machine.
        let direction = Point::new(2.0 * random.uniform() - 1.0, 2.0 * random.uniform() - 1.0);
        let along = |visit: u32| {
            let point = self.network.points[visit as usize];
            point.x * direction.x + point.y * direction.y
        };
        if num_visits > 0 {
            visits.select_nth_unstable_by(num_visits, |&a, &b| along(a).total_cmp(&along(b)).then(a.cmp(&b)));
        }
        let (first, second) = visits.split_at_mut(num_visits);
        let mut routes = self.cut_at_random(first, num_first, random);
        routes.extend(self.cut_at_random(second, num_routes - num_first, random));
        routes
    }

    fn tour(&self, mut visits: Vec<u32>) -> Vec<u32> {
        visits.sort_unstable_by_key(|&visit| (self.curve_keys[visit as usize], visit));
        open_at_best_leg(self.network, &mut visits);
        visits
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Variant, generate};
    use crate::search::plain::testing::research_network;

    #[test]
    fn random_cuts_share_the_visits_evenly() {
        let farm = generate(97, Variant::Authors, 2).unwrap();
        let network = research_network(farm.depot, &farm.ponds, 5);
        let cuts = Cuts::new(&network);
        let mut random = Random::new(1);
        for _ in 0..20 {
            let mut visits: Vec<u32> = (0..97).collect();
            let routes = cuts.cut_at_random(&mut visits, 5, &mut random);
            let mut served = routes.concat();
            served.sort_unstable();
            assert_eq!(served, (0..97).collect::<Vec<u32>>());
            assert!(routes.iter().all(|route| (18..=21).contains(&route.len())), "{routes:?}");
        }
    }

    #[test]
    fn two_parts_of_a_line_are_its_halves() {
        let ponds: Vec<Point> = (0..10).map(|x| Point::new(f64::from(x), 0.0)).collect();
        let network = research_network(Point::new(0.0, 1.0), &ponds, 2);
        let cuts = Cuts::new(&network);
        let mut routes = cuts.cut_at_random(&mut (0..10).rev().collect::<Vec<u32>>(), 2, &mut Random::new(4));
        routes.iter_mut().for_each(|route| route.sort_unstable());
        routes.sort();
        assert_eq!(routes, [vec![0, 1, 2, 3, 4], vec![5, 6, 7, 8, 9]]);
    }

    #[test]
    fn more_parts_than_visits_leave_some_empty() {
        let ponds = [Point::new(1.0, 0.0), Point::new(2.0, 3.0)];
        let network = research_network(Point::new(0.0, 0.0), &ponds, 2);
        let routes = Cuts::new(&network).cut_at_random(&mut [0, 1], 5, &mut Random::new(4));
        assert_eq!((routes.len(), routes.concat().len()), (5, 2));
    }
}
