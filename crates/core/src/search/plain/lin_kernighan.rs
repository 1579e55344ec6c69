//! Shortens a plan by moves that change up to five legs, of one route or of several.
//!
//! Problem: a plan that was annealed for a short while can still be made shorter by changing three to five legs of two routes at
//! once. Ruin and recreate finds those moves one in a thousand steps.
//!
//! Source: Lin and Kernighan, Operations Research 1973, in the form of Helsgaun, European J. of Operational Research 2000: one
//! leg is cut, a shorter one added from its end to a near neighbour, a leg beside that cut, and so on, as long as what was cut
//! is longer than what was added; a few of the ways to go on are tried, the most promising first; any of them may be closed by
//! a leg back to where it began. As there, only the closed move must be feasible. What we changed: the legs may be of any
//! routes, so that a move may also exchange runs or tails between them (a giant tour with a copy of the depot per route does
//! not keep the routes from being joined; a walk along the new routes does, and finds what each will cost). A move counts by
//! the total and by a price for what it adds to routes above the mean one, because those that leave no route longer are few,
//! and [`super::balance`] evens out the routes for less than what the others gain.
//!
//! Nodes whose moves failed wait until a leg of theirs has changed (don't-look bits, Bentley, ORSA J. Computing 1992). Looking
//! at a node costs O(1), a walk O(legs changed), and making a move O(visits of the routes it changes).

use super::moves::{CutLeg, MAX_CUTS, Move};
use super::network::{Network, leg_of_length};
use super::state::{AFTER, BEFORE, State};
use crate::effort::Budget;
use crate::geometry::Point;

/// Ways to go on that are tried after each cut but the last; after the last but one, a move is only closed.
const BREADTHS: [usize; MAX_CUTS - 1] = [5, 3, 1, 0];
/// Neighbours that a leg may be added to.
const NUM_TRIED: usize = 8;
/// What it costs to make a route longer that is above the mean, beside the total.
const PRICE: f64 = 0.3;
/// What a move must gain, relative to the total times the number of visits: a multiple of the rounding of a sum of as many legs,
/// so that what gains more makes the plan better in truth, and no moves can undo each other.
const MIN_GAIN: f64 = 4.0 * f64::EPSILON;
/// Nodes looked at, and moves made, between two looks at the clock.
const NODES_PER_LOOK: usize = 16;

/// A node on its route.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
struct RouteNode {
    x: f64,
    y: f64,
    /// Legs back and forth, and where they lead.
    legs: [f64; 2],
    links: [u32; 2],
    /// Cost of the route up to the node, with its service.
    cost: f64,
    service: f64,
    route: u32,
    position: u32,
}

/// A way to go on: add a leg to `node`, and cut its leg back or forth.
#[derive(Clone, Copy, Debug)]
struct Extension {
    /// What the cuts save less what the legs cost.
    gain: f64,
    added: f64,
    node: u32,
    is_forth: bool,
}

/// A plan whose pieces can be priced by where they begin and end.
struct Routes<'a> {
    network: &'a Network,
    places: Vec<RouteNode>,
    /// A copy of the depot, then the visits, per route.
    routes: Vec<Vec<u32>>,
    costs: Vec<f64>,
    is_changed: Vec<bool>,
    /// Cost of a route above which it costs more to make it longer.
    target: f64,
    /// Cost that no route may exceed after a move.
    cap: f64,
    min_gain: f64,
    queue: Vec<u32>,
    is_queued: Vec<bool>,
    change: Move,
    /// Extensions of all cuts of `change` but the last.
    extensions: Vec<Extension>,
}

/// Makes moves until none is found that gains, or the time is over. Returns whether it made any.
///
/// No move makes a route longer than `cap`. `links` tells what was beside every node when it was last looked at: only the
/// others are looked at, unless moves come by.
pub(super) fn shorten(
    network: &Network,
    budget: &Budget<'_>,
    state: &mut State,
    cap: f64,
    links: &mut Vec<[u32; 2]>,
) -> bool {
    let mut plan = Routes::new(network, state, cap);
    plan.queue_changed(links);
    let mut num_looked_at = 0_usize;
    while let Some(node) = plan.queue.pop() {
        plan.is_queued[node as usize] = false;
        let mut is_over = false;
        loop {
            num_looked_at += 1;
            is_over |= num_looked_at.is_multiple_of(NODES_PER_LOOK) && budget.is_time_over();
            if is_over || !plan.improve_from(node) {
                break;
            }
        }
        if is_over {
            break;
        }
    }
    for route in (0..network.num_routes).filter(|&route| plan.is_changed[route]) {
        state.replace_route(network, route, &plan.routes[route][1..]);
    }
    links.clear();
    links.extend(plan.places.iter().map(|place| place.links));
    plan.is_changed.contains(&true)
}

impl<'a> Routes<'a> {
    fn new(network: &'a Network, state: &State, cap: f64) -> Self {
        let place =
            |(point, &service): (&Point, &f64)| RouteNode { x: point.x, y: point.y, service, ..RouteNode::default() };
        let mean = state.total / network.num_routes as f64;
        let mut plan = Self {
            network,
            places: network.points.iter().zip(&network.services).map(place).collect(),
            routes: vec![Vec::new(); network.num_routes],
            costs: vec![0.0; network.num_routes],
            is_changed: vec![false; network.num_routes],
            target: mean,
            cap,
            min_gain: MIN_GAIN * (network.num_visits + MAX_CUTS) as f64 * state.total,
            queue: Vec::with_capacity(network.points.len()),
            is_queued: vec![false; network.points.len()],
            change: Move::default(),
            extensions: Vec::new(),
        };
        for route in 0..network.num_routes {
            plan.routes[route].push((network.num_visits + route) as u32);
            plan.routes[route].extend(state.route(network, route));
            plan.measure(route);
        }
        plan
    }

    /// Tells the nodes of a route where they are.
    fn measure(&mut self, route: usize) {
        let nodes = &self.routes[route];
        let mut last = nodes[nodes.len() - 1];
        let mut cost = 0.0;
        for (position, &node) in nodes.iter().enumerate() {
            let leg = self.leg(last, node);
            let place = &mut self.places[node as usize];
            if position > 0 {
                cost += leg + place.service;
            }
            (place.cost, place.route, place.position) = (cost, route as u32, position as u32);
            (place.links[BEFORE], place.legs[BEFORE]) = (last, leg);
            let place = &mut self.places[last as usize];
            (place.links[AFTER], place.legs[AFTER]) = (node, leg);
            last = node;
        }
        self.costs[route] = cost + self.places[last as usize].legs[AFTER];
    }

    fn queue_changed(&mut self, links: &[[u32; 2]]) {
        for &node in self.routes.iter().rev().flat_map(|route| route.iter().rev()) {
            let [back, forth] = self.places[node as usize].links;
            if !links.get(node as usize).is_some_and(|known| [[back, forth], [forth, back]].contains(known)) {
                self.is_queued[node as usize] = true;
                self.queue.push(node);
            }
        }
    }

    #[inline]
    fn leg(&self, from: u32, to: u32) -> f64 {
        if let Some(leg) = self.network.priced_leg(from, to) {
            return leg;
        }
        let (from, to) = (&self.places[from as usize], &self.places[to as usize]);
        let (x, y) = (to.x - from.x, to.y - from.y);
        leg_of_length((x * x + y * y).sqrt(), self.network.stop)
    }

    /// Makes the first move found that begins by cutting a leg of `node`.
    fn improve_from(&mut self, node: u32) -> bool {
        [true, false].into_iter().any(|is_forth| {
            self.change.num_cuts = 0;
            self.change.push(self.cut(node, is_forth, 0.0));
            let is_found = self.extend(self.places[node as usize].legs[usize::from(is_forth)]);
            self.extensions.clear();
            if is_found {
                self.make();
            }
            is_found
        })
    }

    /// The leg of `node` back or forth, reached along the leg `added`.
    #[inline]
    fn cut(&self, node: u32, is_forth: bool, added: f64) -> CutLeg {
        let place = &self.places[node as usize];
        let to = place.links[usize::from(is_forth)];
        let (position, head, leg) = if is_forth {
            (place.position, place.cost, place.legs[AFTER])
        } else {
            let before = &self.places[to as usize];
            (before.position, before.cost, before.legs[AFTER])
        };
        CutLeg { route: place.route, position, from: node, to, is_forth, head, head_and_leg: head + leg, added }
    }

    /// Looks for a move that gains among those that begin with the cuts of `change`, which save `gain` more than the legs
    /// added between them cost; leaves it there.
    fn extend(&mut self, gain: f64) -> bool {
        let num_cuts = self.change.num_cuts;
        let (start, last) = (self.change.cuts[0].from, self.change.cuts[num_cuts - 1].to);
        if last as usize >= self.network.num_visits {
            return false;
        }
        let begin = self.extensions.len();
        let breadth = BREADTHS[num_cuts - 1];
        let links = self.places[last as usize].links;
        for neighbour in self.network.neighbours(last).iter().take(NUM_TRIED) {
            let left = gain - neighbour.leg;
            if left <= self.min_gain {
                break;
            }
            let node = neighbour.node;
            if links.contains(&node) {
                continue;
            }
            for is_forth in [true, false] {
                let cut = self.cut(node, is_forth, neighbour.leg);
                if self.change.has(&cut) {
                    continue;
                }
                let gain = left + self.places[node as usize].legs[usize::from(is_forth)];
                let closing = self.leg(cut.to, start);
                if gain - closing > self.min_gain {
                    self.change.push(cut);
                    self.change.cuts[0].added = closing;
                    if self.is_better() {
                        return true;
                    }
                    self.change.pop();
                }
                self.note(begin, breadth, Extension { gain, added: neighbour.leg, node, is_forth });
            }
        }
        for index in begin..self.extensions.len() {
            let Extension { gain, added, node, is_forth } = self.extensions[index];
            self.change.push(self.cut(node, is_forth, added));
            if self.extend(gain) {
                return true;
            }
            self.change.pop();
        }
        self.extensions.truncate(begin);
        false
    }

    /// Keeps the `breadth` best extensions from `begin` on, the best first.
    #[inline]
    fn note(&mut self, begin: usize, breadth: usize, extension: Extension) {
        if self.extensions.len() - begin == breadth {
            if self.extensions[begin..].last().is_none_or(|worst| worst.gain >= extension.gain) {
                return;
            }
            self.extensions.pop();
        }
        let better = self.extensions[begin..].iter().rposition(|other| other.gain >= extension.gain);
        self.extensions.insert(begin + better.map_or(0, |index| index + 1), extension);
    }

    /// Whether the plan is better after `change`.
    fn is_better(&self) -> bool {
        let value = |cost: f64| cost + PRICE * (cost - self.target).max(0.0);
        let mut added = self.min_gain;
        let is_whole = self.change.walk(
            &self.costs,
            |_, _, _| {},
            |cost| {
                added += value(cost);
                cost <= self.cap
            },
        );
        if !is_whole {
            return false;
        }
        let mut last = None;
        for &index in &self.change.order[..self.change.num_cuts] {
            let route = self.change.cuts[index as usize].route;
            if last != Some(route) {
                added -= value(self.costs[route as usize]);
            }
            last = Some(route);
        }
        added < 0.0
    }

    /// Makes `change`, and queues what it touches.
    fn make(&mut self) {
        let change = std::mem::take(&mut self.change);
        let cuts = &change.cuts[..change.num_cuts];
        let mut routes: Vec<usize> = cuts.iter().map(|cut| cut.route as usize).collect();
        routes.sort_unstable();
        routes.dedup();
        let mut made: Vec<Vec<u32>> = Vec::with_capacity(routes.len());
        let append = |near: usize, far: usize, begins: bool| {
            if begins {
                made.push(vec![(self.network.num_visits + routes[made.len()]) as u32]);
            }
            let Some(route) = made.last_mut() else { return };
            let (near_node, far_node) = (change.node(near), change.node(far));
            let place = &self.places[near_node as usize];
            let old = &self.routes[place.route as usize];
            let position = place.position as usize;
            if near != far {
                let other = self.places[far_node as usize].position as usize;
                if position <= other {
                    route.extend_from_slice(&old[position..=other]);
                } else {
                    route.extend(old[other..=position].iter().rev());
                }
            } else if position > 0 {
                // From the depot to this end, or from this end to the depot.
                match (change.is_before_cut(near), begins) {
                    (true, true) => route.extend_from_slice(&old[1..=position]),
                    (true, false) => route.extend(old[1..=position].iter().rev()),
                    (false, true) => route.extend(old[position..].iter().rev()),
                    (false, false) => route.extend_from_slice(&old[position..]),
                }
            }
        };
        change.walk(&self.costs, append, |_| true);
        for (&route, nodes) in routes.iter().zip(made) {
            self.routes[route] = nodes;
            self.is_changed[route] = true;
            self.measure(route);
        }
        for node in cuts.iter().flat_map(|cut| [cut.from, cut.to]) {
            if !self.is_queued[node as usize] {
                self.is_queued[node as usize] = true;
                self.queue.push(node);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Variant, generate};
    use crate::search::plain::testing::{
        assert_costs_are_those_of_the_routes, assert_every_visit_once, farm_with_services, research_network, routes_of,
        unlimited,
    };
    use proptest::prelude::*;

    /// Two rows of three ponds, one on either side of the depot's axis; the routes have each other's last pond.
    fn crossed() -> (Network, State) {
        let ponds = [(1.0, 1.0), (2.0, 1.0), (3.0, 1.0), (1.0, -1.0), (2.0, -1.0), (3.0, -1.0)];
        let ponds = ponds.map(|(x, y)| Point::new(x, y));
        let network = research_network(Point::new(0.0, 0.0), &ponds, 2);
        let state = State::new(&network, &[vec![0, 1, 5], vec![3, 4, 2]]);
        (network, state)
    }

    fn sorted(network: &Network, state: &State) -> Vec<Vec<u32>> {
        let mut routes = state.routes(network);
        routes.iter_mut().for_each(|visits| visits.sort_unstable());
        routes.sort_unstable();
        routes
    }

    #[test]
    fn crossing_routes_exchange_their_tails() {
        let (network, mut state) = crossed();
        let longest = state.max_route_cost();
        assert!(shorten(&network, &unlimited(), &mut state, longest, &mut Vec::new()));
        assert_eq!(sorted(&network, &state), [[0, 1, 2], [3, 4, 5]]);
        let cost = 2.0_f64.sqrt() + 2.0 + 10.0_f64.sqrt();
        assert!(state.route_costs.iter().all(|route_cost| (route_cost - cost).abs() < 1e-12));
    }

    #[test]
    fn what_has_not_changed_is_passed_over() {
        let (network, mut state) = crossed();
        let mut links = Vec::new();
        assert!(shorten(&network, &unlimited(), &mut state, f64::INFINITY, &mut links));
        assert!(!shorten(&network, &unlimited(), &mut state, f64::INFINITY, &mut links));
        let (_, mut other) = crossed();
        let mut known: Vec<[u32; 2]> = other.nodes.iter().map(|node| [node.next, node.previous]).collect();
        assert!(!shorten(&network, &unlimited(), &mut other, f64::INFINITY, &mut known));
    }

    #[test]
    fn a_cap_below_all_routes_forbids_every_move() {
        let (network, mut state) = crossed();
        assert!(!shorten(&network, &unlimited(), &mut state, 1.0, &mut Vec::new()));
        assert_eq!(state.routes(&network), [vec![0, 1, 5], vec![3, 4, 2]]);
    }

    #[test]
    fn no_move_leaves_visits_on_a_ring_without_a_depot() {
        let ponds = [(0.0, 1.0), (1.0, 1.0), (9.0, 0.0), (9.0, 1.0), (10.0, 1.0), (10.0, 0.0)];
        let ponds = ponds.map(|(x, y)| Point::new(x, y));
        let network = research_network(Point::new(0.0, 0.0), &ponds, 1);
        let mut state = State::new(&network, &[vec![0, 1, 3, 4, 5, 2]]);
        assert!(!shorten(&network, &unlimited(), &mut state, f64::INFINITY, &mut Vec::new()));
    }

    #[test]
    fn one_leg_is_not_cut_twice_nor_a_route_emptied_of_its_depot() {
        for ponds in
            [vec![Point::new(1.0, 0.0)], vec![Point::new(0.0, 0.0), Point::new(0.0, 0.0), Point::new(0.0, 0.0)]]
        {
            let network = research_network(Point::new(0.0, 0.0), &ponds, 3);
            let mut state = State::new(&network, &[(0..ponds.len() as u32).collect()]);
            assert!(!shorten(&network, &unlimited(), &mut state, f64::INFINITY, &mut Vec::new()));
        }
    }

    #[test]
    fn without_time_few_nodes_are_looked_at() {
        let farm = generate(300, Variant::Authors, 1).unwrap();
        let network = research_network(farm.depot, &farm.ponds, 1);
        let visits: Vec<u32> = (0..300).collect();
        let mut state = State::new(&network, std::slice::from_ref(&visits));
        shorten(&network, &Budget::new(None, Some(&|| 1.0), None), &mut state, f64::INFINITY, &mut Vec::new());
        let [stopped] = &state.routes(&network)[..] else { panic!() };
        shorten(&network, &unlimited(), &mut state, f64::INFINITY, &mut Vec::new());
        assert!(network.route_cost(stopped) > 1.5 * state.total);
    }

    proptest! {
        #[test]
        fn visits_are_kept_and_the_value_falls(
            (num_ponds, num_routes, seed) in (1_usize..60, 1_usize..6, 0_u64..1000),
            services in prop::collection::vec(0.0_f64..0.3, 60),
            homes in prop::collection::vec(0_usize..6, 60),
            allowance in 0.0_f64..0.2,
            has_stops: bool,
        ) {
            let network = farm_with_services(num_ponds, num_routes, seed, &services, has_stops);
            let routes = routes_of(&homes[..num_ponds], network.num_routes);
            let mut state = State::new(&network, &routes);
            let mean = state.total / network.num_routes as f64;
            let value = |state: &State| state.total + PRICE * state.route_costs.iter().map(|cost| (cost - mean).max(0.0)).sum::<f64>();
            let (before, cap) = (value(&state), state.max_route_cost() * (1.0 + allowance));
            let is_changed = shorten(&network, &unlimited(), &mut state, cap, &mut Vec::new());
            assert_every_visit_once(&network, &state);
            assert_costs_are_those_of_the_routes(&network, &state);
            prop_assert!(state.max_route_cost() <= cap + 1e-9);
            prop_assert_eq!(is_changed, value(&state) < before - 1e-12);
        }

        /// With so few visits, all others are near neighbours; legs to the depot are only added to close a move.
        #[test]
        fn afterwards_no_stretch_between_visits_is_shorter_turned(
            (num_ponds, num_routes, seed) in (4_usize..9, 1_usize..4, 0_u64..1000),
            homes in prop::collection::vec(0_usize..6, 9),
        ) {
            let farm = generate(num_ponds, Variant::Authors, seed).unwrap();
            let network = research_network(farm.depot, &farm.ponds, num_routes);
            let routes = routes_of(&homes[..num_ponds], network.num_routes);
            let mut state = State::new(&network, &routes);
            while shorten(&network, &unlimited(), &mut state, f64::INFINITY, &mut Vec::new()) {}
            let mean = state.total / network.num_routes as f64;
            for route in 0..network.num_routes {
                let visits = state.route(&network, route);
                for first in 1..visits.len() {
                    for last in first + 1..visits.len() - 1 {
                        let mut other = visits.clone();
                        other[first..=last].reverse();
                        let cost = network.route_cost(&other);
                        prop_assert!(cost > state.route_costs[route] - 1e-6 * mean);
                    }
                }
            }
        }
    }
}
