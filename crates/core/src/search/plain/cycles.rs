//! What one of two plans has and the other has not, cut into parts that can be exchanged: alternating cycles of legs.
//!
//! Source: Nagata and Kobayashi, A Powerful Genetic Algorithm Using Edge Assembly Crossover for the Traveling Salesman
//! Problem, INFORMS J. Computing 2013: a random walk along legs of the one plan and of the other in turn, whose loops of even
//! length are the AB-cycles. To put the legs of the other plan in the place of those of the one, for all legs of a cycle,
//! leaves every visit two legs, and the depot as many as it had. Changed: the depot is one place with two legs for each route,
//! as by He and Hao, European J. of Operational Research 2023, for the min-max problem with several drones.
//!
//! O(n), and for each leg at the depot as many steps as the depot has legs.

use super::network::Network;
use super::state::{AFTER, BEFORE, Node, State};
use crate::random::Random;

/// What a visit is joined to: another visit, or the depot, which is `num_visits`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub leg: f64,
    pub to: u32,
}

/// A leg that only one of two plans has.
#[derive(Clone, Copy, Debug)]
pub(super) struct OddLeg {
    pub ends: [u32; 2],
    pub leg: f64,
    /// Whether the base has it, not the donor.
    pub is_of_base: bool,
}

impl OddLeg {
    /// What the total grows by when the donor's legs come in the place of the base's.
    pub fn change(&self) -> f64 {
        if self.is_of_base { -self.leg } else { self.leg }
    }
}

/// Both links of each visit.
pub(super) fn links(network: &Network, state: &State) -> Vec<[Link; 2]> {
    let depot = network.num_visits as u32;
    let both = |node: &Node| {
        let before = Link { leg: node.legs[BEFORE], to: node.previous.min(depot) };
        [before, Link { leg: node.legs[AFTER], to: node.next.min(depot) }]
    };
    state.nodes[..network.num_visits].iter().map(both).collect()
}

/// Cuts the legs that only one of two plans has into cycles, in which legs of `base` and of `donor` take turns, at random.
/// If the plans differ in the number of routes, what cannot be closed is left out.
pub(super) fn alternating_cycles(base: &[[Link; 2]], donor: &[[Link; 2]], random: &mut Random) -> Vec<Vec<OddLeg>> {
    let num_visits = base.len();
    let mut odd_links = [OddLinks::new(base, donor), OddLinks::new(donor, base)];
    let mut cycles = Vec::new();
    let mut walk = Walk { legs: Vec::new(), places: vec![[None; 2]; num_visits + 1] };
    let first = random.below(num_visits);
    for start in (first..num_visits).chain(0..first) {
        while odd_links[0].has_any(start) {
            let mut at = start as u32;
            walk.places[start][0] = Some(0);
            loop {
                let side = walk.legs.len() % 2;
                let Some(Link { leg, to }) = odd_links[side].draw(at, random) else {
                    walk.give_up();
                    break;
                };
                walk.legs.push(OddLeg { ends: [at, to], leg, is_of_base: side == 0 });
                at = to;
                if let Some(cycle) = walk.cut_loop(at) {
                    cycles.push(cycle);
                    if walk.legs.is_empty() {
                        break;
                    }
                }
            }
            walk.places[start][0] = None;
        }
    }
    cycles
}

/// Legs walked, those of the base and of the donor in turn.
struct Walk {
    legs: Vec<OddLeg>,
    /// How many legs had been walked at each node, the depot last, by parity: `None` if the walk does not go through it.
    places: Vec<[Option<usize>; 2]>,
}

impl Walk {
    /// Leaves out the legs walked: nothing leads on from the depot.
    fn give_up(&mut self) {
        for node in self.legs.drain(..).flat_map(|odd_leg| odd_leg.ends) {
            self.places[node as usize] = [None; 2];
        }
    }

    /// The even loop that was closed by coming to `node`, which is then no longer part of the walk.
    fn cut_loop(&mut self, node: u32) -> Option<Vec<OddLeg>> {
        let place = &mut self.places[node as usize][self.legs.len() % 2];
        let Some(begin) = *place else {
            *place = Some(self.legs.len());
            return None;
        };
        let cycle = self.legs.split_off(begin);
        for (offset, odd_leg) in cycle.iter().enumerate().skip(1) {
            self.places[odd_leg.ends[0] as usize][(begin + offset) % 2] = None;
        }
        Some(cycle)
    }
}

/// Links of one plan that the other has not, as far as they have not been drawn.
struct OddLinks {
    /// Per visit, the first `counts` of them.
    of_visits: Vec<[Link; 2]>,
    counts: Vec<usize>,
    of_depot: Vec<Link>,
}

impl OddLinks {
    fn new(own: &[[Link; 2]], others: &[[Link; 2]]) -> Self {
        let depot = own.len() as u32;
        let mut odd_links = Self { of_visits: own.to_vec(), counts: vec![0; own.len()], of_depot: Vec::new() };
        for (visit, (own, others)) in own.iter().zip(others).enumerate() {
            let mut others = others.map(|link| Some(link.to));
            for link in own {
                // A route with one visit has the same link twice.
                if let Some(common) = others.iter_mut().find(|other| **other == Some(link.to)) {
                    *common = None;
                    continue;
                }
                odd_links.of_visits[visit][odd_links.counts[visit]] = *link;
                odd_links.counts[visit] += 1;
                if link.to == depot {
                    odd_links.of_depot.push(Link { leg: link.leg, to: visit as u32 });
                }
            }
        }
        odd_links
    }

    fn has_any(&self, visit: usize) -> bool {
        self.counts[visit] > 0
    }

    /// A random link of `node`, which is then gone, at both of its ends.
    fn draw(&mut self, node: u32, random: &mut Random) -> Option<Link> {
        let links = self.links(node);
        let link = *links.get(random.below(links.len().max(1)))?;
        self.remove(node, link.to);
        self.remove(link.to, node);
        Some(link)
    }

    fn links(&self, node: u32) -> &[Link] {
        match self.counts.get(node as usize) {
            Some(&count) => &self.of_visits[node as usize][..count],
            None => &self.of_depot,
        }
    }

    fn remove(&mut self, node: u32, to: u32) {
        let Some(index) = self.links(node).iter().position(|link| link.to == to) else { return };
        match self.counts.get_mut(node as usize) {
            Some(count) => {
                *count -= 1;
                self.of_visits[node as usize].swap(index, *count);
            }
            None => {
                self.of_depot.swap_remove(index);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::problem::Problem;
    use proptest::prelude::*;

    fn network(num_visits: usize, num_routes: usize) -> Network {
        let ponds: Vec<Point> = (0..num_visits).map(|x| Point::new(x as f64, (x * x % 7) as f64)).collect();
        Network::new(&Problem::research(Point::new(0.0, -1.0), &ponds, num_routes).unwrap())
    }

    fn cycles_between(network: &Network, base: &[Vec<u32>], donor: &[Vec<u32>], seed: u64) -> Vec<Vec<OddLeg>> {
        let [base, donor] = [base, donor].map(|routes| links(network, &State::new(network, routes)));
        alternating_cycles(&base, &donor, &mut Random::new(seed))
    }

    /// Legs as sorted pairs, sorted; the depot is `num_visits`.
    fn legs(routes: &[Vec<u32>], depot: u32) -> Vec<[u32; 2]> {
        let mut legs = Vec::new();
        for route in routes.iter().filter(|route| !route.is_empty()) {
            let closed: Vec<u32> = [depot].into_iter().chain(route.iter().copied()).chain([depot]).collect();
            legs.extend(closed.windows(2).map(|ends| [ends[0].min(ends[1]), ends[0].max(ends[1])]));
        }
        legs.sort_unstable();
        legs
    }

    fn assert_alternates_and_closes(cycle: &[OddLeg]) {
        assert!(cycle.len() >= 4 && cycle.len().is_multiple_of(2));
        for (index, odd_leg) in cycle.iter().enumerate() {
            let next = &cycle[(index + 1) % cycle.len()];
            assert_eq!(odd_leg.ends[1], next.ends[0]);
            assert_ne!(odd_leg.is_of_base, next.is_of_base);
        }
    }

    #[test]
    fn two_visits_in_another_order_are_one_cycle() {
        let network = network(4, 1);
        for seed in 0..8 {
            let cycles = cycles_between(&network, &[vec![0, 1, 2, 3]], &[vec![0, 2, 1, 3]], seed);
            let [cycle] = cycles.as_slice() else { panic!("{cycles:?}") };
            assert_alternates_and_closes(cycle);
            let ends = |is_of_base| {
                let odd_legs = cycle.iter().filter(|odd_leg| odd_leg.is_of_base == is_of_base);
                let mut ends: Vec<[u32; 2]> = odd_legs.map(|odd_leg| odd_leg.ends).collect();
                ends.iter_mut().for_each(|ends| ends.sort_unstable());
                ends.sort_unstable();
                ends
            };
            assert_eq!(ends(true), [[0, 1], [2, 3]]);
            assert_eq!(ends(false), [[0, 2], [1, 3]]);
        }
    }

    #[test]
    fn a_plan_and_its_mirror_image_do_not_differ() {
        let network = network(4, 2);
        assert!(cycles_between(&network, &[vec![0, 1, 2], vec![3]], &[vec![3], vec![2, 1, 0]], 1).is_empty());
    }

    /// The donor has one route less: what ends at the depot cannot be closed, the two visits in another order can.
    #[test]
    fn what_cannot_be_closed_is_left_out_alone() {
        let network = network(6, 2);
        for seed in 0..16 {
            let cycles = cycles_between(&network, &[vec![0, 1, 2, 3, 5], vec![4]], &[vec![0, 2, 1, 3, 5, 4]], seed);
            let [cycle] = cycles.as_slice() else { panic!("{cycles:?}") };
            assert_alternates_and_closes(cycle);
            assert!(cycle.iter().flat_map(|odd_leg| odd_leg.ends).all(|end| end < 4));
        }
    }

    fn routes_of(homes: &[usize], order: &[usize], num_routes: usize) -> Vec<Vec<u32>> {
        let mut routes = vec![Vec::new(); num_routes];
        for &visit in order {
            routes[homes[visit] % num_routes].push(visit as u32);
        }
        routes
    }

    proptest! {
        #[test]
        fn all_cycles_together_turn_one_plan_into_the_other(
            homes in prop::collection::vec((0_usize..4, 0_usize..4), 1..25),
            num_routes in 1_usize..4,
            shuffle: u64,
        ) {
            let (num_visits, mut random) = (homes.len(), Random::new(shuffle));
            let network = network(num_visits, num_routes.min(num_visits));
            let order: Vec<usize> = (0..num_visits).collect();
            let mut other_order = order.clone();
            (1..num_visits).for_each(|place| other_order.swap(place, random.below(place + 1)));
            let (one, other): (Vec<usize>, Vec<usize>) = homes.into_iter().unzip();
            let base = routes_of(&one, &order, network.num_routes);
            let donor = routes_of(&other, &other_order, network.num_routes);
            let cycles = cycles_between(&network, &base, &donor, shuffle);
            cycles.iter().for_each(|cycle| assert_alternates_and_closes(cycle));
            let num_used = |routes: &[Vec<u32>]| routes.iter().filter(|route| !route.is_empty()).count();
            let depot = num_visits as u32;
            let mut turned = legs(&base, depot);
            for odd_leg in cycles.iter().flatten() {
                let mut ends = odd_leg.ends;
                ends.sort_unstable();
                if odd_leg.is_of_base {
                    let place = turned.iter().position(|leg| *leg == ends);
                    prop_assert!(place.is_some(), "{:?} is no leg of the base, or twice in cycles", ends);
                    turned.swap_remove(place.unwrap());
                } else {
                    turned.push(ends);
                }
            }
            turned.sort_unstable();
            if num_used(&base) == num_used(&donor) {
                prop_assert_eq!(turned, legs(&donor, depot));
            }
        }
    }
}
