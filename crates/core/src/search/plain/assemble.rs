//! Puts into a plan what is better in another one: edge assembly.
//!
//! Problem: good plans differ in a few dozen places, and each is better in some of them. Which places can be exchanged one by
//! one, and what does the whole plan gain by each?
//!
//! Source: the edge assembly crossover of Nagata and Kobayashi, INFORMS J. Computing 2013, with single cycles. He and Hao,
//! European J. of Operational Research 2023, use it for the min-max problem with several drones. The legs that only one of two
//! plans has are cut into alternating cycles ([`super::cycles`]). To exchange the legs of a cycle may leave rings without the
//! depot: each is joined to another ring where that costs least, as by 2-opt between the two. Changed: the cycles are tried
//! one after the other, those that shorten the total most first, and each is kept if the whole plan is better by the measure
//! that the caller gives, so that one child has all that is better in the donor.
//!
//! O(n) for each of at most [`MAX_CYCLES`] cycles, which takes microseconds.

use super::cycles::{Link, OddLeg, alternating_cycles, links};
use super::network::Network;
use super::state::State;
use crate::random::Random;

/// Cycles tried, at most.
const MAX_CYCLES: usize = 64;
/// Neighbours tried per visit to join two rings.
const NUM_TRIED: usize = 10;
/// What a change must gain, relative to the value: above rounding.
const MIN_GAIN: f64 = 1e-9;
/// Ring of a visit that has not been walked to; end of a link that was taken out.
const NONE: u32 = u32::MAX;

/// `base` with those cycles of `donor` that make it better by `value`, which is told the costs of all routes; `None` if there
/// are none. No route should grow beyond `target`.
pub(super) fn assemble(
    network: &Network,
    base: &State,
    donor: &State,
    target: f64,
    value: impl Fn(&[f64]) -> f64,
    random: &mut Random,
) -> Option<State> {
    let mut assembly = Assembly::new(network, base, target);
    let cycles = alternating_cycles(&assembly.links, &links(network, donor), random);
    let change = |cycle: &Vec<OddLeg>| cycle.iter().map(OddLeg::change).sum::<f64>();
    let mut cycles: Vec<(f64, Vec<OddLeg>)> = cycles.into_iter().map(|cycle| (change(&cycle), cycle)).collect();
    cycles.sort_by(|a, b| a.0.total_cmp(&b.0));
    assembly.follow_rings();
    let mut least = value(&assembly.costs);
    let mut is_better = false;
    for (_, cycle) in cycles.iter().take(MAX_CYCLES) {
        let new_value = if assembly.exchange(cycle) { value(&assembly.costs) } else { f64::INFINITY };
        if new_value < least * (1.0 - MIN_GAIN) {
            (least, is_better) = (new_value, true);
            assembly.replaced.clear();
        } else {
            assembly.undo();
        }
    }
    is_better.then(|| State::new(network, &assembly.routes()))
}

/// Visits joined to a ring, with the depot (a route) or without it.
#[derive(Clone, Copy, Debug)]
struct Ring {
    /// One of them: the first, if it is a route.
    first: u32,
    size: u32,
}

/// Two legs, one of a ring without the depot, whose ends are to be joined crosswise.
#[derive(Clone, Copy, Debug)]
struct Joint {
    legs: [[u32; 2]; 2],
    /// What the total grows by.
    change: f64,
    price: f64,
}

/// A plan as links.
struct Assembly<'a> {
    network: &'a Network,
    target: f64,
    links: Vec<[Link; 2]>,
    /// What the links of a visit were, for all changes since the last that was kept.
    replaced: Vec<(u32, [Link; 2])>,
    /// Rings, those through the depot first; their costs; and the ring of each visit.
    rings: Vec<Ring>,
    costs: Vec<f64>,
    ring_of: Vec<u32>,
}

impl<'a> Assembly<'a> {
    fn new(network: &'a Network, state: &State, target: f64) -> Self {
        Self {
            network,
            target,
            links: links(network, state),
            replaced: Vec::new(),
            rings: Vec::new(),
            costs: Vec::new(),
            ring_of: vec![NONE; network.num_visits],
        }
    }

    /// Puts the donor's legs of a cycle in the place of the base's, and joins what is then apart. False, if a leg is gone by an
    /// earlier change, or a ring has no other near it.
    fn exchange(&mut self, cycle: &[OddLeg]) -> bool {
        let (old, new): (Vec<&OddLeg>, Vec<&OddLeg>) = cycle.iter().partition(|odd_leg| odd_leg.is_of_base);
        old.iter().all(|odd_leg| self.take_out(odd_leg.ends))
            && new.iter().all(|odd_leg| self.put_in(odd_leg.ends, odd_leg.leg))
            && self.join_rings()
    }

    fn undo(&mut self) {
        while let Some((visit, links)) = self.replaced.pop() {
            self.links[visit as usize] = links;
        }
    }

    fn take_out(&mut self, [one, other]: [u32; 2]) -> bool {
        let gap = Link { leg: 0.0, to: NONE };
        self.replace_link(one, other, gap) && self.replace_link(other, one, gap)
    }

    fn put_in(&mut self, [one, other]: [u32; 2], leg: f64) -> bool {
        self.replace_link(one, NONE, Link { leg, to: other }) && self.replace_link(other, NONE, Link { leg, to: one })
    }

    /// Replaces the link of `node` to `to`; false, if it has none. The depot has no links of its own.
    fn replace_link(&mut self, node: u32, to: u32, link: Link) -> bool {
        let Some(links) = self.links.get_mut(node as usize) else { return true };
        let Some(place) = links.iter().position(|link| link.to == to) else { return false };
        self.replaced.push((node, *links));
        links[place] = link;
        true
    }

    /// Walks from `first`, coming from the node `last`, until the depot or `first` again. Tells each visit and the link by which
    /// it is left.
    fn walk(&self, first: u32, last: u32, mut tell: impl FnMut(u32, &Link)) {
        let (mut last, mut at) = (last, first);
        loop {
            let [one, other] = &self.links[at as usize];
            let onward = if one.to == last { other } else { one };
            tell(at, onward);
            (last, at) = (at, onward.to);
            if at == first || at as usize == self.network.num_visits {
                return;
            }
        }
    }

    /// Finds the rings. Returns how many go through the depot.
    fn follow_rings(&mut self) -> usize {
        let network = self.network;
        let depot = network.num_visits as u32;
        self.rings.clear();
        self.costs.clear();
        let mut ring_of = std::mem::take(&mut self.ring_of);
        ring_of.fill(NONE);
        let mut num_routes = 0;
        for is_route in [true, false] {
            for first in 0..depot {
                if ring_of[first as usize] != NONE {
                    continue;
                }
                let links = &self.links[first as usize];
                let entry = if is_route { links.iter().find(|link| link.to == depot) } else { links.first() };
                let Some(entry) = entry else { continue };
                let mut size = 0;
                // The link by which a ring without the depot is entered is the one by which it is closed.
                let mut cost = if is_route { entry.leg } else { 0.0 };
                self.walk(first, entry.to, |visit, onward| {
                    ring_of[visit as usize] = self.rings.len() as u32;
                    size += 1;
                    cost += network.services[visit as usize] + onward.leg;
                });
                self.rings.push(Ring { first, size });
                self.costs.push(cost);
            }
            if is_route {
                num_routes = self.rings.len();
            }
        }
        self.ring_of = ring_of;
        num_routes
    }

    /// Joins every ring without the depot to another, the smallest first. False, if one has no other near it.
    fn join_rings(&mut self) -> bool {
        let num_routes = self.follow_rings();
        let mut loose: Vec<usize> = (num_routes..self.rings.len()).collect();
        loose.sort_by_key(|&ring| self.rings[ring].size);
        let is_joined = loose.into_iter().all(|ring| match self.cheapest_joint(ring, num_routes) {
            Some(joint) => self.join(ring, &joint),
            None => false,
        });
        self.costs.truncate(num_routes);
        is_joined
    }

    /// Where it costs least to join a ring without the depot to another; what a route grows over the target counts twice.
    fn cheapest_joint(&self, ring: usize, num_routes: usize) -> Option<Joint> {
        let network = self.network;
        let mut cheapest: Option<Joint> = None;
        let first = self.rings[ring].first;
        self.walk(first, self.links[first as usize][0].to, |visit, _| {
            for neighbour in network.neighbours(visit).iter().take(NUM_TRIED) {
                let other_ring = self.ring_of[neighbour.node as usize] as usize;
                if other_ring == ring {
                    continue;
                }
                for own in &self.links[visit as usize] {
                    for other in &self.links[neighbour.node as usize] {
                        let change = neighbour.leg + network.leg(own.to, other.to) - own.leg - other.leg;
                        let cost = self.costs[other_ring] + self.costs[ring] + change;
                        let is_over = other_ring < num_routes && cost > self.target;
                        let price = change + if is_over { cost - self.target } else { 0.0 };
                        if cheapest.is_none_or(|joint| price < joint.price) {
                            let legs = [[visit, own.to], [neighbour.node, other.to]];
                            cheapest = Some(Joint { legs, change, price });
                        }
                    }
                }
            }
        });
        cheapest
    }

    fn join(&mut self, ring: usize, joint: &Joint) -> bool {
        let Joint { legs: [[one, one_end], [other, other_end]], change, .. } = *joint;
        let other_ring = self.ring_of[other as usize];
        let mut ring_of = std::mem::take(&mut self.ring_of);
        let first = self.rings[ring].first;
        self.walk(first, self.links[first as usize][0].to, |visit, _| ring_of[visit as usize] = other_ring);
        self.ring_of = ring_of;
        self.costs[other_ring as usize] += self.costs[ring] + change;
        let leg = |from, to| self.network.leg(from, to);
        let new_legs = [leg(one, other), leg(one_end, other_end)];
        self.take_out([one, one_end])
            && self.take_out([other, other_end])
            && self.put_in([one, other], new_legs[0])
            && self.put_in([one_end, other_end], new_legs[1])
    }

    fn routes(&mut self) -> Vec<Vec<u32>> {
        let num_routes = self.follow_rings();
        let visits_of = |ring: &Ring| {
            let mut visits = Vec::with_capacity(ring.size as usize);
            self.walk(ring.first, self.network.num_visits as u32, |visit, _| visits.push(visit));
            visits
        };
        self.rings[..num_routes].iter().map(visits_of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::search::plain::testing::{assert_every_visit_once, farm_with_services, research_network, routes_of};
    use proptest::prelude::*;

    fn total(costs: &[f64]) -> f64 {
        costs.iter().sum()
    }

    fn assemble_by_total(network: &Network, base: &State, donor: &State) -> Option<State> {
        assemble(network, base, donor, f64::INFINITY, total, &mut Random::new(1))
    }

    /// Two routes away from the depot in opposite directions: a plan makes detours on the left, another on the right.
    #[test]
    fn a_child_has_the_better_half_of_each() {
        let side = [(1.0, 0.0), (2.0, 1.0), (3.0, 0.0), (2.0, -1.0)];
        let ponds: Vec<Point> =
            [1.0, -1.0].into_iter().flat_map(|sign| side.map(|(x, y)| Point::new(sign * x, y))).collect();
        let network = research_network(Point::new(0.0, 0.0), &ponds, 2);
        let (around, zigzag) = (vec![0, 1, 2, 3], vec![1, 3, 0, 2]);
        let left = |route: &[u32]| route.iter().map(|visit| visit + 4).collect::<Vec<u32>>();
        let one = State::new(&network, &[around.clone(), left(&zigzag)]);
        let other = State::new(&network, &[zigzag, left(&around)]);
        let both = State::new(&network, &[around.clone(), left(&around)]);
        for (base, donor) in [(&one, &other), (&other, &one)] {
            let best = assemble_by_total(&network, base, donor).unwrap();
            assert!((best.total - both.total).abs() < 1e-12);
        }
        assert!(assemble_by_total(&network, &both, &one).is_none());
        assert!(assemble_by_total(&network, &both, &both).is_none());
    }

    /// One route of two squares far from each other: links within each cut it into a route and a ring, joined where they are
    /// nearest.
    #[test]
    fn a_ring_without_the_depot_is_joined_to_the_route() {
        let square = [(1.0, 0.0), (1.0, 1.0), (2.0, 1.0), (2.0, 0.0)];
        let ponds: Vec<Point> =
            [0.0, 10.0].into_iter().flat_map(|x| square.map(|(dx, y)| Point::new(x + dx, y))).collect();
        let network = research_network(Point::new(0.0, 0.0), &ponds, 1);
        let before = vec![0, 1, 5, 6, 7, 4, 2, 3];
        let mut assembly = Assembly::new(&network, &State::new(&network, std::slice::from_ref(&before)), f64::INFINITY);
        let leg = |from, to, is_of_base| OddLeg { ends: [from, to], leg: network.leg(from, to), is_of_base };
        let cycle = [leg(1, 5, true), leg(5, 4, false), leg(4, 2, true), leg(2, 1, false)];
        assert!(assembly.exchange(&cycle));
        // The side of the ring that faces the route is opened, and so is the side of the route that faces the ring.
        let routes = assembly.routes();
        assert_eq!(routes, [[0, 1, 2, 5, 6, 7, 4, 3]]);
        assert!((assembly.costs[0] - network.route_cost(&routes[0])).abs() < 1e-12);
        assembly.undo();
        assert_eq!(assembly.routes(), [before]);
    }

    #[test]
    fn a_cycle_whose_legs_are_gone_is_refused() {
        let ponds: Vec<Point> = (1..=4).map(|x| Point::new(f64::from(x), 0.0)).collect();
        let network = research_network(Point::new(0.0, 0.0), &ponds, 1);
        let mut assembly = Assembly::new(&network, &State::new(&network, &[vec![0, 1, 2, 3]]), f64::INFINITY);
        let leg = |from, to, is_of_base| OddLeg { ends: [from, to], leg: network.leg(from, to), is_of_base };
        assert!(!assembly.exchange(&[leg(0, 1, true), leg(1, 3, false), leg(3, 1, true), leg(1, 0, false)]));
        assembly.undo();
        assert_eq!(assembly.routes(), [[0, 1, 2, 3]]);
    }

    proptest! {
        #[test]
        fn what_is_assembled_makes_every_visit_once_and_costs_what_was_said(
            (num_ponds, num_routes, seed) in (2_usize..60, 1_usize..7, 0_u64..1000),
            homes in prop::collection::vec((0_usize..6, 0_usize..6), 60),
            services in prop::collection::vec(0.0_f64..0.3, 60),
            has_stops: bool,
        ) {
            let network = farm_with_services(num_ponds, num_routes, seed, &services, has_stops);
            let (one, other): (Vec<usize>, Vec<usize>) = homes[..num_ponds].iter().copied().unzip();
            let [base, donor] = [one, other].map(|homes| State::new(&network, &routes_of(&homes, network.num_routes)));
            let said = std::cell::Cell::new(f64::INFINITY);
            let value = |costs: &[f64]| {
                let value = costs.iter().copied().fold(0.0, f64::max) + 0.1 * total(costs);
                said.set(said.get().min(value));
                value
            };
            let target = base.max_route_cost();
            if let Some(better) = assemble(&network, &base, &donor, target, value, &mut Random::new(seed)) {
                assert_every_visit_once(&network, &better);
                prop_assert_eq!(better.routes(&network).len(), base.routes(&network).len());
                let costs: Vec<f64> = better.routes(&network).iter().map(|route| network.route_cost(route)).collect();
                let found = said.get();
                prop_assert!((value(&costs) - found).abs() < 1e-9 * found);
                prop_assert!(value(&costs) < value(&base.route_costs));
            }
        }
    }
}
