//! Evens out the routes of a plan: the longest hands visits on to its neighbours, and those to theirs.
//!
//! Problem: after annealing, the longest route is up to two per cent above the mean one. A single exchange that takes enough
//! from it gives another route too much; two or three small ones, far from each other, may fit.
//!
//! Method: the elementary moves are CROSS exchanges (Taillard, Badeau, Gendreau, Guertin and Potvin, Transportation Science
//! 1997): one or two visits in a row of one route change places with up to two of another, each run either way
//! round, near each other by neighbour lists. Those that do not touch the same leg are independent: their changes of the
//! routes add up. A depth-first search looks for the few that together leave the longest route shortest: it always relieves
//! the route that is longest at the moment, as an ejection chain does (Glover, Discrete Applied Mathematics 1996), by the
//! move that adds least to the total first, and turns back where the mean route would be longer than the longest of the best
//! set found. The routes changed are then smoothed, and all that is repeated until nothing is gained.
//!
//! One round costs O(n) for its buffers, O(visits of the routes relieved or changed x neighbours), and a bounded number of
//! sets tried.

use super::budget::Budget;
use super::improve_routes;
use super::network::Network;
use super::state::{AFTER, State, Touched};

/// Visits in a run, at most.
const MAX_RUN: usize = 2;
/// Neighbours tried per end of a run.
const NUM_TRIED: usize = 5;
/// Exchanges in a set, at most.
const MAX_SET: usize = 4;
/// Exchanges tried for sets of each size, at most.
const MAX_TRIES: usize = 500;
/// Sets in a row, at most; two or three are usual.
const MAX_ROUNDS: usize = 100;
/// What a set must gain, relative to the longest route: above rounding.
const MIN_GAIN: f64 = 1e-9;

/// Visits of a route that follow each other.
#[derive(Clone, Copy, Debug)]
struct Run {
    /// The node before the first.
    before: u32,
    size: u32,
    /// Whether the other route makes them in the opposite order.
    is_turned: bool,
}

/// Two runs that change places, of which `taken` may be empty.
#[derive(Clone, Copy, Debug)]
struct Exchange {
    given: Run,
    taken: Run,
    taker: u32,
    /// What it adds to the cost of the giver, which is less than nothing.
    giver_change: f64,
    /// What it adds to the cost of the taker.
    taker_change: f64,
}

impl Exchange {
    /// What tells it from other exchanges.
    fn place(&self) -> [(u32, u32, bool); 2] {
        [self.given, self.taken].map(|run| (run.before, run.size, run.is_turned && run.size > 1))
    }

    fn change(&self) -> f64 {
        self.giver_change + self.taker_change
    }
}

/// Exchanges visits between routes until no set of exchanges shortens the longest route of `state`. Returns whether it did
/// anything.
pub(super) fn balance(network: &Network, budget: &Budget<'_>, state: &mut State) -> bool {
    for num_rounds in 0..MAX_ROUNDS {
        let Some(set) = Sets::new(network, state).best(budget) else { return num_rounds > 0 };
        let mut touched = Touched::default();
        for exchange in &set {
            apply(network, state, exchange, &mut touched);
        }
        touched.routes.sort_unstable();
        touched.routes.dedup();
        for &route in &touched.routes {
            let mut visits = state.route(network, route as usize);
            improve_routes(network, budget, std::slice::from_mut(&mut visits));
            state.replace_route(network, route as usize, &visits);
        }
    }
    true
}

fn apply(network: &Network, state: &mut State, exchange: &Exchange, touched: &mut Touched) {
    let [given, taken] = [exchange.given, exchange.taken].map(|run| {
        let mut visits = Vec::with_capacity(MAX_RUN);
        let first = state.nodes[run.before as usize].next;
        if run.size > 0 {
            state.remove_string(network, first, run.size as usize, &mut visits, touched);
        }
        if run.is_turned {
            visits.reverse();
        }
        visits
    });
    for (visits, place) in [(given, exchange.taken.before), (taken, exchange.given.before)] {
        state.insert_string(network, place, &visits, touched);
    }
}

/// The run a route gives.
struct GivenRun {
    before: u32,
    size: u32,
    first: u32,
    last: u32,
    after: u32,
    /// Its legs and services.
    inner: f64,
    /// The same with the legs to and from it.
    freed: f64,
    /// The leg that would close the gap.
    closing: f64,
}

/// Looks for the best set of independent exchanges.
struct Sets<'a> {
    network: &'a Network,
    state: &'a State,
    /// What each route can give, the exchange that adds least to the total first; found when it is first asked for.
    relieving: Vec<Option<Vec<Exchange>>>,
    /// Costs of the routes after the exchanges of `set`.
    costs: Vec<f64>,
    total: f64,
    /// Whether the leg out of each node is touched by an exchange of `set`.
    is_touched: Vec<bool>,
    set: Vec<Exchange>,
    best_set: Vec<Exchange>,
    /// Longest route after the exchanges of `best_set`.
    longest: f64,
    num_tries: usize,
}

impl<'a> Sets<'a> {
    fn new(network: &'a Network, state: &'a State) -> Self {
        Self {
            network,
            state,
            relieving: vec![None; network.num_routes],
            costs: state.route_costs.clone(),
            total: state.total,
            is_touched: vec![false; network.points.len()],
            set: Vec::with_capacity(MAX_SET),
            best_set: Vec::new(),
            longest: state.max_route_cost(),
            num_tries: 0,
        }
    }

    /// The set that leaves the longest route shortest; `None` if none shortens it.
    fn best(mut self, budget: &Budget<'_>) -> Option<Vec<Exchange>> {
        for size in 1..=MAX_SET {
            if budget.is_time_over() {
                break;
            }
            self.num_tries = 0;
            self.extend(size, None);
        }
        (!self.best_set.is_empty()).then_some(self.best_set)
    }

    /// What the longest route must come below.
    fn goal(&self) -> f64 {
        self.longest * (1.0 - MIN_GAIN)
    }

    /// Tries all ways to add up to `num_left` exchanges to `set`. `last` is the route relieved by the last one of it, and its
    /// place in the list of that route.
    fn extend(&mut self, num_left: usize, last: Option<(usize, usize)>) {
        let mut route = 0;
        let (mut num_over, goal) = (0, self.goal());
        for (other, &cost) in self.costs.iter().enumerate() {
            if cost > self.costs[route] {
                route = other;
            }
            num_over += usize::from(cost >= goal);
        }
        if num_over == 0 {
            self.longest = self.costs[route];
            self.best_set.clone_from(&self.set);
        }
        // An exchange is counted on to relieve one route.
        if num_left == 0 || num_over > num_left {
            return;
        }
        if self.relieving[route].is_none() {
            self.relieving[route] = Some(self.exchanges(route as u32));
        }
        let first = last.map_or(0, |(relieved, index)| if relieved == route { index + 1 } else { 0 });
        let mut index = first;
        while let Some(&exchange) = self.relieving[route].as_ref().and_then(|list| list.get(index)) {
            if self.total + exchange.change() >= self.goal() * self.costs.len() as f64 || self.num_tries >= MAX_TRIES {
                return;
            }
            self.num_tries += 1;
            let giver_cost = self.costs[route];
            let taker_cost = self.costs[exchange.taker as usize];
            let longer = (giver_cost + exchange.giver_change).max(taker_cost + exchange.taker_change);
            if (num_left > 1 || longer < self.goal()) && !self.touches_set(&exchange) {
                let total = self.total;
                self.costs[route] += exchange.giver_change;
                self.costs[exchange.taker as usize] += exchange.taker_change;
                self.total += exchange.change();
                self.mark(&exchange, true);
                self.set.push(exchange);
                self.extend(num_left - 1, Some((route, index)));
                self.set.pop();
                self.mark(&exchange, false);
                self.costs[route] = giver_cost;
                self.costs[exchange.taker as usize] = taker_cost;
                self.total = total;
            }
            index += 1;
        }
    }

    fn touches_set(&self, exchange: &Exchange) -> bool {
        [exchange.given, exchange.taken].iter().any(|run| {
            let mut node = run.before;
            (0..=run.size).any(|_| {
                let is_touched = self.is_touched[node as usize];
                node = self.state.nodes[node as usize].next;
                is_touched
            })
        })
    }

    fn mark(&mut self, exchange: &Exchange, is_touched: bool) {
        for run in [exchange.given, exchange.taken] {
            let mut node = run.before;
            for _ in 0..=run.size {
                self.is_touched[node as usize] = is_touched;
                node = self.state.nodes[node as usize].next;
            }
        }
    }

    /// The exchanges that shorten `giver`, the one that adds least to the total first. An empty route gets nothing: the other end is
    /// always beside a visit.
    fn exchanges(&self, giver: u32) -> Vec<Exchange> {
        let (network, nodes) = (self.network, &self.state.nodes);
        let num_visits = network.num_visits as u32;
        // A better set adds less to the total. An exchange that adds more alone is left out, though others might make up for it.
        let max_change = self.goal() * self.costs.len() as f64 - self.state.total;
        let mut found = Vec::new();
        let mut before = num_visits + giver;
        loop {
            let first = nodes[before as usize].next;
            if first >= num_visits {
                break;
            }
            let (mut end, mut inner) = (first, network.services[first as usize]);
            for size in 1..=MAX_RUN as u32 {
                let after = nodes[end as usize].next;
                let given = GivenRun {
                    before,
                    size,
                    first,
                    last: end,
                    after,
                    inner,
                    freed: nodes[before as usize].legs[AFTER] + inner + nodes[end as usize].legs[AFTER],
                    closing: network.leg(before, after),
                };
                self.exchanges_of(giver, &given, max_change, &mut found);
                if after >= num_visits {
                    break;
                }
                inner += nodes[end as usize].legs[AFTER] + network.services[after as usize];
                end = after;
            }
            before = first;
        }
        // The same exchange is found from both ends of its runs.
        found.sort_unstable_by_key(Exchange::place);
        found.dedup_by_key(|exchange| exchange.place());
        found.sort_by(|a, b| a.change().total_cmp(&b.change()));
        found
    }

    /// Exchanges that put an end of the run beside a near neighbour of it.
    fn exchanges_of(&self, giver: u32, given: &GivenRun, max_change: f64, found: &mut Vec<Exchange>) {
        let (network, nodes) = (self.network, &self.state.nodes);
        let num_visits = network.num_visits as u32;
        let ends = [(given.first, given.last, true), (given.last, given.first, false)];
        for &(near_end, far_end, is_first) in &ends[..if given.size == 1 { 1 } else { 2 }] {
            for neighbour in network.neighbours(near_end).iter().take(NUM_TRIED) {
                let near = neighbour.node;
                let taker = nodes[near as usize].route;
                if taker == giver {
                    continue;
                }
                for is_after in [true, false] {
                    // The run taken lies after or before `near`; the given one comes in its place, `near_end` beside `near`.
                    let step = |node: u32| {
                        let node = &nodes[node as usize];
                        if is_after { node.next } else { node.previous }
                    };
                    let leg_of = |from: u32, to: u32| nodes[if is_after { from } else { to } as usize].legs[AFTER];
                    let first = step(near);
                    let first_leg = leg_of(near, first);
                    let (mut last, mut far, mut freed) = (near, first, first_leg);
                    for size in 0..=MAX_RUN as u32 {
                        let taker_change = neighbour.leg + given.inner + network.leg(far_end, far) - freed;
                        let (mut giver_change, mut is_turned) = (given.closing - given.freed, false);
                        if size > 0 {
                            let straight = network.leg(given.before, first) + network.leg(last, given.after);
                            let turned = network.leg(given.before, last) + network.leg(first, given.after);
                            let inner = freed - first_leg - leg_of(last, far);
                            giver_change = inner + straight.min(turned) - given.freed;
                            is_turned = (turned < straight) == is_after;
                        }
                        if giver_change < 0.0 && giver_change + taker_change < max_change {
                            let before = if is_after { near } else { far };
                            found.push(Exchange {
                                given: Run { before: given.before, size: given.size, is_turned: is_first != is_after },
                                taken: Run { before, size, is_turned },
                                taker,
                                giver_change,
                                taker_change,
                            });
                        }
                        if far >= num_visits {
                            break;
                        }
                        last = far;
                        far = step(last);
                        freed += network.services[last as usize] + leg_of(last, far);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Variant, generate};
    use crate::geometry::Point;
    use crate::problem::{Depot, Problem, VehicleType, Visit};
    use proptest::prelude::*;

    fn network(depot: Point, ponds: &[Point], num_routes: usize) -> Network {
        network_of(&Problem::research(depot, ponds, num_routes).unwrap())
    }

    fn network_of(problem: &Problem) -> Network {
        let mut network = Network::new(problem);
        network.find_neighbours();
        network
    }

    fn unlimited() -> Budget<'static> {
        Budget::new(None, None, None)
    }

    /// Seven ponds in a row north of the depot: 3, 3 and 1. The left route cannot give one to the middle one, which would be
    /// the longest, unless that hands one on.
    #[test]
    fn a_load_is_handed_on_to_a_third_route() {
        let ponds: Vec<Point> = (-3..=3).map(|x| Point::new(f64::from(x), 10.0)).collect();
        let network = network(Point::new(0.0, 0.0), &ponds, 3);
        let mut state = State::new(&network, &[vec![0, 1, 2], vec![3, 4, 5], vec![6]]);
        assert_eq!(Sets::new(&network, &state).best(&unlimited()).unwrap().len(), 2);
        assert!(balance(&network, &unlimited(), &mut state));
        let sorted = |mut route: Vec<u32>| {
            route.sort_unstable();
            route
        };
        let routes: Vec<Vec<u32>> = state.routes(&network).into_iter().map(sorted).collect();
        assert_eq!(routes, [vec![0, 1], vec![2, 3, 4], vec![5, 6]]);
        assert!((state.max_route_cost() - (2.0 * 101.0_f64.sqrt() + 2.0)).abs() < 1e-12);
        assert!(!balance(&network, &unlimited(), &mut state));
    }

    #[test]
    fn one_route_and_a_route_for_every_pond_stay_as_they_are() {
        let ponds = [1.0, 2.0, 3.0].map(|x| Point::new(x, 0.0));
        for routes in [vec![vec![0, 1, 2]], vec![vec![0], vec![1], vec![2]]] {
            let network = network(Point::new(0.0, 0.0), &ponds, routes.len());
            assert!(!balance(&network, &unlimited(), &mut State::new(&network, &routes)));
        }
    }

    #[test]
    fn without_time_nothing_is_changed() {
        let ponds: Vec<Point> = (-3..=3).map(|x| Point::new(f64::from(x), 10.0)).collect();
        let network = network(Point::new(0.0, 0.0), &ponds, 3);
        let mut state = State::new(&network, &[vec![0, 1, 2], vec![3, 4, 5], vec![6]]);
        assert!(!balance(&network, &Budget::new(None, Some(&|| 1.0), None), &mut state));
        assert_eq!(state.routes(&network), [vec![0, 1, 2], vec![3, 4, 5], vec![6]]);
    }

    fn assert_costs_are_those_of_the_routes(network: &Network, state: &State) {
        let mut visits: Vec<u32> = state.routes(network).concat();
        visits.sort_unstable();
        assert_eq!(visits, (0..network.num_visits as u32).collect::<Vec<_>>());
        for (route, &cost) in state.route_costs.iter().enumerate() {
            assert!((cost - network.route_cost(&state.route(network, route))).abs() < 1e-9);
        }
    }

    /// `state` after `set`, whose routes must cost what the exchanges say.
    fn assert_changes_add_up(network: &Network, state: &State, set: &[Exchange]) {
        let (mut after, mut costs) = (state.clone(), state.route_costs.clone());
        for exchange in set {
            apply(network, &mut after, exchange, &mut Touched::default());
            costs[state.nodes[exchange.given.before as usize].route as usize] += exchange.giver_change;
            costs[exchange.taker as usize] += exchange.taker_change;
        }
        assert_costs_are_those_of_the_routes(network, &after);
        for (cost, predicted) in after.route_costs.iter().zip(costs) {
            assert!((cost - predicted).abs() < 1e-9, "{set:?}");
        }
    }

    proptest! {
        #[test]
        fn exchanges_change_the_routes_as_they_say(
            (num_ponds, num_routes, seed) in (2_usize..40, 2_usize..6, 0_u64..1000),
            services in prop::collection::vec(0.0_f64..0.3, 40),
            homes in prop::collection::vec(0_usize..6, 40),
            has_stops: bool,
        ) {
            let mut farm = generate(num_ponds, Variant::Authors, seed).unwrap();
            if has_stops {
                // Some ponds lie in one place, or at the depot, where a leg takes no time.
                let lattice = |point: Point| Point::new((4.0 * point.x).round(), (4.0 * point.y).round());
                (farm.depot, farm.ponds) = (lattice(farm.depot), farm.ponds.into_iter().map(lattice).collect());
            }
            let visits = farm.ponds.iter().zip(&services);
            let visits = visits.map(|(&position, &service_duration)| Visit { position, service_duration }).collect();
            let stop = if has_stops { 0.5 } else { 0.0 };
            let vehicle_type = VehicleType { speed: 2.0, leg_stop_duration: stop, ..VehicleType::unlimited(num_routes) };
            let network = network_of(&Problem::new(Depot { position: farm.depot }, visits, vehicle_type).unwrap());
            let mut routes = vec![Vec::new(); network.num_routes];
            for (visit, home) in homes[..num_ponds].iter().enumerate() {
                routes[home % network.num_routes].push(visit as u32);
            }
            let mut state = State::new(&network, &routes);
            let sets = Sets::new(&network, &state);
            for giver in 0..network.num_routes as u32 {
                for exchange in sets.exchanges(giver) {
                    assert_changes_add_up(&network, &state, &[exchange]);
                }
            }
            if let Some(set) = sets.best(&unlimited()) {
                assert_changes_add_up(&network, &state, &set);
            }
            let longest = state.max_route_cost();
            let has_changed = balance(&network, &unlimited(), &mut state);
            assert_costs_are_those_of_the_routes(&network, &state);
            prop_assert_eq!(has_changed, state.max_route_cost() < longest);
        }
    }
}
