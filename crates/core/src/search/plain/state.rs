//! The mutable twin of a plan: routes as linked rings of nodes, so that no step costs more on a long route.
//!
//! Every route is a ring through its own copy of the depot. Nodes carry the legs to both sides and where they lead; routes
//! carry their cost and size. Nothing here depends on a visit's position within its route, and nothing but the touched nodes is
//! copied when a change is taken back: one step of the search costs O(visits touched), whatever the length of the routes.

use super::limits::excess;
use super::network::Network;
use crate::search::objective::RouteCosts;

/// Route of a visit that no route makes at the moment.
pub(crate) const ABSENT: u32 = u32::MAX;

/// Legs of an absent visit: no place beside it is ever cheap.
const NO_LEGS: [f64; 2] = [f64::NEG_INFINITY; 2];

/// Where a visit can be put.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub after: u32,
    pub leg_in: f64,
    pub leg_out: f64,
    /// What the plan costs more with it.
    pub added: f64,
}

/// A visit or a depot copy: all that the price of a place beside it depends on, in one line of the cache, which saves one
/// fiftieth of the time at 700 visits.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Node {
    /// Cost of the legs from `previous` and to `next`.
    pub legs: [f64; 2],
    /// Where `previous` and `next` are.
    pub xs: [f64; 2],
    pub ys: [f64; 2],
    pub previous: u32,
    pub next: u32,
    /// [`ABSENT`] while removed.
    pub route: u32,
}

/// Index of what lies before or after a node, in its pairs.
pub(crate) const BEFORE: usize = 0;
pub(crate) const AFTER: usize = 1;

/// A solution under change.
#[derive(Clone, Debug)]
pub(crate) struct State {
    pub nodes: Vec<Node>,
    /// Legs and service per route.
    pub route_costs: Vec<f64>,
    pub route_sizes: Vec<u32>,
    /// What each route uses of each limit, in shares of it: route by route. Empty where there is no limit.
    pub route_uses: Vec<f64>,
    pub total: f64,
}

/// Which parts of a state one step touched; members may repeat.
#[derive(Clone, Debug, Default)]
pub(crate) struct Touched {
    pub nodes: Vec<u32>,
    pub routes: Vec<u32>,
}

impl Touched {
    pub fn clear(&mut self) {
        self.nodes.clear();
        self.routes.clear();
    }
}

/// What differs between two states, gathered over many steps; every member once.
#[derive(Clone, Debug)]
pub(super) struct Difference {
    members: Touched,
    has_node: Vec<bool>,
    has_route: Vec<bool>,
}

impl Difference {
    pub fn new(network: &Network) -> Self {
        let members = Touched::default();
        Self { members, has_node: vec![false; network.points.len()], has_route: vec![false; network.num_routes] }
    }

    pub fn add(&mut self, touched: &Touched) {
        for (added, has, members) in [
            (&touched.nodes, &mut self.has_node, &mut self.members.nodes),
            (&touched.routes, &mut self.has_route, &mut self.members.routes),
        ] {
            for &member in added {
                if !has[member as usize] {
                    has[member as usize] = true;
                    members.push(member);
                }
            }
        }
    }

    /// Copies to `state` what differs from `other`.
    pub fn copy_to(&self, state: &mut State, other: &State) {
        state.copy_touched(other, &self.members);
    }

    /// The same, after which nothing differs any more.
    pub fn settle(&mut self, state: &mut State, other: &State) {
        state.copy_touched(other, &self.members);
        self.clear();
    }

    pub fn clear(&mut self) {
        for &node in &self.members.nodes {
            self.has_node[node as usize] = false;
        }
        for &route in &self.members.routes {
            self.has_route[route as usize] = false;
        }
        self.members.clear();
    }
}

impl State {
    /// The state of the given routes; visits not in them are absent.
    pub fn new(network: &Network, routes: &[Vec<u32>]) -> Self {
        let num_nodes = network.num_visits + network.num_routes;
        let absent = Node { legs: NO_LEGS, xs: [0.0; 2], ys: [0.0; 2], previous: ABSENT, next: ABSENT, route: ABSENT };
        let mut state = Self {
            nodes: vec![absent; num_nodes],
            route_costs: vec![0.0; network.num_routes],
            route_sizes: vec![0; network.num_routes],
            route_uses: vec![0.0; network.num_routes * network.limits.len()],
            total: 0.0,
        };
        for route in 0..network.num_routes {
            state.replace_route(network, route, routes.get(route).map_or(&[], Vec::as_slice));
        }
        state
    }

    /// Makes `route` visit `visits`, whatever it did before: O(visits).
    pub fn replace_route(&mut self, network: &Network, route: usize, visits: &[u32]) {
        let depot = (network.num_visits + route) as u32;
        let mut last = depot;
        let mut cost = 0.0;
        for &node in visits.iter().chain([&depot]) {
            let leg = network.leg(last, node);
            cost += leg + network.services[node as usize];
            self.link(network, last, node, leg);
            self.nodes[node as usize].route = route as u32;
            last = node;
        }
        self.total += cost - self.route_costs[route];
        self.route_costs[route] = cost;
        self.route_sizes[route] = visits.len() as u32;
        for limit in 0..network.limits.len() {
            let mut sum = 0.0;
            let mut last = depot;
            for &node in visits.iter().chain([&depot]) {
                sum += network.use_of_leg(limit, last, node) + network.limits.of_visit(limit, node);
                last = node;
            }
            self.route_uses[route * network.limits.len() + limit] = sum;
        }
    }

    /// By how much the routes exceed limits, in shares of them, summed.
    pub fn excess(&self) -> f64 {
        excess(&self.route_uses)
    }

    /// What a route uses of the limit that it uses most of, in shares of it; 0 where there is no limit.
    pub fn greatest_use(&self, network: &Network, route: usize) -> f64 {
        let num_limits = network.limits.len();
        self.route_uses[route * num_limits..(route + 1) * num_limits].iter().copied().fold(0.0, f64::max)
    }

    /// By how much more a route would exceed limits with `visit` put behind the node `after`.
    pub fn excess_added(&self, network: &Network, visit: u32, after: u32) -> f64 {
        let Node { next, route, .. } = self.nodes[after as usize];
        let num_limits = network.limits.len();
        (0..num_limits)
            .map(|limit| {
                let uses = self.route_uses[route as usize * num_limits + limit];
                excess(&[uses + use_added(network, limit, after, &[visit], next)]) - excess(&[uses])
            })
            .sum()
    }

    fn change_uses(&mut self, network: &Network, route: u32, before: u32, visits: &[u32], after: u32, sign: f64) {
        let num_limits = network.limits.len();
        for limit in 0..num_limits {
            self.route_uses[route as usize * num_limits + limit] +=
                sign * use_added(network, limit, before, visits, after);
        }
    }

    /// Visits per route in flying order; empty routes are left out.
    pub fn routes(&self, network: &Network) -> Vec<Vec<u32>> {
        let routes = (0..network.num_routes).map(|route| self.route(network, route));
        routes.filter(|visits| !visits.is_empty()).collect()
    }

    /// Visits of one route in flying order.
    pub fn route(&self, network: &Network, route: usize) -> Vec<u32> {
        let depot = (network.num_visits + route) as u32;
        let mut visits = Vec::with_capacity(self.route_sizes[route] as usize);
        let mut node = self.nodes[depot as usize].next;
        while node != depot {
            visits.push(node);
            node = self.nodes[node as usize].next;
        }
        visits
    }

    /// What its routes cost.
    pub fn costs(&self) -> RouteCosts {
        RouteCosts { longest: self.max_route_cost(), total: self.total, excess: self.excess() }
    }

    /// Cost of the longest route.
    #[inline]
    pub fn max_route_cost(&self) -> f64 {
        self.route_costs.iter().copied().fold(0.0, f64::max)
    }

    /// Whether no route costs more than `floor`, and none exceeds a limit.
    pub fn is_down_to(&self, floor: f64) -> bool {
        self.max_route_cost() <= floor && self.excess() == 0.0
    }

    /// The costliest route, the first of equals.
    #[inline]
    pub fn longest_route(&self) -> u32 {
        let mut longest = 0;
        for (route, &cost) in self.route_costs.iter().enumerate() {
            if cost > self.route_costs[longest] {
                longest = route;
            }
        }
        longest as u32
    }

    /// Makes `next` follow `previous`.
    #[inline]
    fn link(&mut self, network: &Network, previous: u32, next: u32, leg: f64) {
        let (from, to) = (network.points[previous as usize], network.points[next as usize]);
        let node = &mut self.nodes[previous as usize];
        node.next = next;
        (node.legs[AFTER], node.xs[AFTER], node.ys[AFTER]) = (leg, to.x, to.y);
        let node = &mut self.nodes[next as usize];
        node.previous = previous;
        (node.legs[BEFORE], node.xs[BEFORE], node.ys[BEFORE]) = (leg, from.x, from.y);
    }

    /// Puts an absent visit at a place.
    #[inline]
    pub fn insert(&mut self, network: &Network, visit: u32, place: &Place, touched: &mut Touched) {
        let &Place { after, leg_in, leg_out, added } = place;
        let Node { next, route, .. } = self.nodes[after as usize];
        if network.limits.len() > 0 {
            self.change_uses(network, route, after, &[visit], next, 1.0);
        }
        self.link(network, after, visit, leg_in);
        self.link(network, visit, next, leg_out);
        self.nodes[visit as usize].route = route;
        self.route_costs[route as usize] += added;
        self.route_sizes[route as usize] += 1;
        self.total += added;
        touched.nodes.extend([visit, after, next]);
        touched.routes.push(route);
    }

    /// Puts absent visits, in their order, behind `after`.
    pub fn insert_string(&mut self, network: &Network, after: u32, visits: &[u32], touched: &mut Touched) {
        let mut after = after;
        for &visit in visits {
            let node = &self.nodes[after as usize];
            let (leg_in, leg_out) = (network.leg(after, visit), network.leg(visit, node.next));
            let added = leg_in + leg_out - node.legs[AFTER] + network.services[visit as usize];
            self.insert(network, visit, &Place { after, leg_in, leg_out, added }, touched);
            after = visit;
        }
    }

    /// Takes out the `count` visits from `first` on, which must lie on one route without its depot; appends them to `removed`.
    pub fn remove_string(
        &mut self,
        network: &Network,
        first: u32,
        count: usize,
        removed: &mut Vec<u32>,
        touched: &mut Touched,
    ) {
        let Node { previous, route, .. } = self.nodes[first as usize];
        let mut saved = self.nodes[previous as usize].legs[AFTER];
        let mut visit = first;
        for _ in 0..count {
            let node = &mut self.nodes[visit as usize];
            saved += node.legs[AFTER] + network.services[visit as usize];
            removed.push(visit);
            touched.nodes.push(visit);
            (node.route, node.legs) = (ABSENT, NO_LEGS);
            visit = node.next;
        }
        let leg = network.leg(previous, visit);
        if network.limits.len() > 0 {
            self.change_uses(network, route, previous, &removed[removed.len() - count..], visit, -1.0);
        }
        self.link(network, previous, visit, leg);
        self.route_costs[route as usize] -= saved - leg;
        self.route_sizes[route as usize] -= count as u32;
        self.total -= saved - leg;
        touched.nodes.extend([previous, visit]);
        touched.routes.push(route);
    }

    /// Copies what was touched from `other`.
    pub fn copy_touched(&mut self, other: &Self, touched: &Touched) {
        for &node in &touched.nodes {
            self.nodes[node as usize] = other.nodes[node as usize];
        }
        for &route in &touched.routes {
            self.route_costs[route as usize] = other.route_costs[route as usize];
            self.route_sizes[route as usize] = other.route_sizes[route as usize];
        }
        self.route_uses.copy_from_slice(&other.route_uses);
        self.total = other.total;
    }
}

/// What a route uses more of a limit, in which `visits` come between two nodes that follow each other.
fn use_added(network: &Network, limit: usize, before: u32, visits: &[u32], after: u32) -> f64 {
    let mut sum = -network.use_of_leg(limit, before, after);
    let mut last = before;
    for &visit in visits {
        sum += network.use_of_leg(limit, last, visit) + network.limits.of_visit(limit, visit);
        last = visit;
    }
    sum + network.use_of_leg(limit, last, after)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::problem::{Depot, Problem, VehicleType, Visit};
    use proptest::prelude::*;

    /// Ponds on a small lattice, so that some lie in one place or at the depot, with service, stops and a speed.
    fn network(places: &[(u8, u8)], num_routes: usize) -> Network {
        let visits = places.iter().zip(0..).map(|(&(x, y), index)| Visit {
            position: Point::new(f64::from(x), f64::from(y)),
            service_duration: f64::from(index % 3),
            service_energy: 0.0,
        });
        let vehicle_type = VehicleType { speed: 2.0, leg_stop_duration: 0.5, ..VehicleType::unlimited(num_routes) };
        Network::new(&Problem::new(Depot { position: Point::new(0.0, 0.0) }, visits.collect(), vehicle_type).unwrap())
    }

    /// What nodes know of their neighbours is true, and the costs are those of the routes.
    fn assert_is_sound(network: &Network, state: &State) {
        for (index, node) in (0_u32..).zip(&state.nodes).filter(|(_, node)| node.route != ABSENT) {
            for (side, other) in [(BEFORE, node.previous), (AFTER, node.next)] {
                let point = network.points[other as usize];
                assert_eq!((node.xs[side], node.ys[side]), (point.x, point.y));
                assert_eq!(node.legs[side], network.leg(index, other));
                assert_eq!(state.nodes[other as usize].route, node.route);
            }
            assert_eq!(state.nodes[node.next as usize].previous, index);
        }
        let mut total = 0.0;
        for route in 0..network.num_routes {
            let visits = state.route(network, route);
            let cost = network.route_cost(&visits);
            assert!((state.route_costs[route] - cost).abs() < 1e-9);
            assert_eq!(state.route_sizes[route] as usize, visits.len());
            total += cost;
        }
        assert!((state.total - total).abs() < 1e-9);
    }

    proptest! {
        #[test]
        fn strings_come_and_go(
            places in prop::collection::vec((0_u8..5, 0_u8..5), 2..20),
            num_routes in 1_usize..5,
            moves in prop::collection::vec((0_usize..20, 1_usize..4, 0_usize..25, any::<bool>()), 1..12),
        ) {
            let network = network(&places, num_routes);
            let mut routes = vec![Vec::new(); network.num_routes];
            for visit in 0..network.num_visits {
                routes[visit % network.num_routes].push(visit as u32);
            }
            let mut state = State::new(&network, &routes);
            assert_is_sound(&network, &state);
            for (first, count, place, is_kept) in moves {
                let (before, mut touched, mut removed) = (state.clone(), Touched::default(), Vec::new());
                let first = (first % network.num_visits) as u32;
                let route = state.route(&network, state.nodes[first as usize].route as usize);
                let rest = route.len() - route.iter().position(|&visit| visit == first).unwrap();
                state.remove_string(&network, first, count.min(rest), &mut removed, &mut touched);
                assert_is_sound(&network, &state);
                let places = (0..state.nodes.len() as u32).filter(|&node| state.nodes[node as usize].route != ABSENT);
                let places: Vec<u32> = places.collect();
                state.insert_string(&network, places[place % places.len()], &removed, &mut touched);
                assert_is_sound(&network, &state);
                if !is_kept {
                    state.copy_touched(&before, &touched);
                    assert_is_sound(&network, &state);
                    prop_assert_eq!(state.routes(&network), before.routes(&network));
                }
            }
        }
    }
}
