//! Evens out the routes of a plan: the longest hands visits on to its neighbours, and those to theirs.
//!
//! Problem: after annealing, the longest route is up to two per cent above the mean one. A single exchange that takes enough
//! from it gives another route too much; two or three small ones, far from each other, may fit.
//!
//! Method: the elementary moves are CROSS exchanges (Taillard, Badeau, Gendreau, Guertin and Potvin, Transportation Science
//! 1997): one or two visits in a row of one route change places with up to two of another, each stretch either way
//! round, near each other by neighbour lists. Those that do not touch the same leg are independent: their changes of the
//! routes add up. A depth-first search looks for the few that together leave the longest route shortest: it always relieves
//! the route that is longest at the moment, as an ejection chain does (Glover, Discrete Applied Mathematics 1996), by the
//! move that adds least to the total first, and turns back where the mean route would be longer than the longest of the best
//! set found. All routes are smoothed before, those changed by a set after it, and sets follow each other until nothing is
//! gained.
//!
//! Smoothing costs O(n) for its buffers and about O(visits), one set O(n) for its buffers, O(visits of the routes relieved or changed x neighbours), and a
//! bounded number of sets tried.

use super::improve::{Room, improve_route};
use super::network::Network;
use super::state::{AFTER, BEFORE, State, Touched};
use crate::effort::Budget;

/// Visits in a stretch, at most.
const MAX_STRETCH: usize = 2;
/// Neighbours tried per end of a stretch.
const NUM_TRIED: usize = 5;
/// Exchanges in a set, at most.
const MAX_SET: usize = 3;
/// What an exchange may add to the total, in mean legs: longer lists take time and shorten no plan.
const MAX_CHANGE: f64 = 1.0;
/// Exchanges tried for sets of each size, at most.
const MAX_TRIES: usize = 500;
/// Sets in a row, at most; two or three are usual.
const MAX_ROUNDS: usize = 100;
/// What a set must gain, relative to the longest route: above rounding.
const MIN_GAIN: f64 = 1e-9;

/// Visits of a route that follow each other.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    /// The node before the first.
    before: u32,
    size: u32,
    /// Whether the other route makes them in the opposite order.
    is_turned: bool,
}

/// Two stretches that change places, of which `taken` may be empty.
#[derive(Clone, Copy, Debug)]
struct Exchange {
    given: Stretch,
    taken: Stretch,
    taker: u32,
    /// What it adds to the cost of the giver, which is less than nothing.
    giver_change: f64,
    /// What it adds to the cost of the taker.
    taker_change: f64,
}

impl Exchange {
    fn change(&self) -> f64 {
        self.giver_change + self.taker_change
    }
}

/// Smooths the routes of `state` and exchanges visits between them until no set of exchanges shortens the longest one. Returns
/// whether it did anything.
pub(super) fn balance(network: &Network, budget: &Budget<'_>, state: &mut State) -> bool {
    let mut has_changed = false;
    let mut room = Room::new(network);
    for route in 0..network.num_routes {
        if budget.is_time_over() {
            break;
        }
        has_changed |= improve_one(network, budget, state, route, |_| true, &mut room);
    }
    for _ in 0..MAX_ROUNDS {
        let Some(set) = Sets::new(network, state).best(budget) else { break };
        let mut touched = Touched::default();
        for exchange in &set {
            apply(network, state, exchange, &mut touched);
        }
        touched.routes.sort_unstable();
        touched.routes.dedup();
        for &route in &touched.routes {
            improve_one(network, budget, state, route as usize, |visit| touched.nodes.contains(&visit), &mut room);
        }
        has_changed = true;
    }
    has_changed
}

/// Improves one route, from those visits that `is_new` says have new neighbours. Returns whether it did anything.
fn improve_one(
    network: &Network,
    budget: &Budget<'_>,
    state: &mut State,
    route: usize,
    is_new: impl Fn(u32) -> bool,
    room: &mut Room,
) -> bool {
    let mut visits = state.route(network, route);
    let queue = visits.iter().rev().copied().filter(|&visit| is_new(visit)).collect();
    let has_moved = improve_route(network, budget, &mut visits, queue, room);
    if has_moved {
        state.replace_route(network, route, &visits);
    }
    has_moved
}

fn apply(network: &Network, state: &mut State, exchange: &Exchange, touched: &mut Touched) {
    let [given, taken] = [exchange.given, exchange.taken].map(|stretch| {
        let mut visits = Vec::with_capacity(MAX_STRETCH);
        let first = state.nodes[stretch.before as usize].next;
        if stretch.size > 0 {
            state.remove_string(network, first, stretch.size as usize, &mut visits, touched);
        }
        if stretch.is_turned {
            visits.reverse();
        }
        visits
    });
    for (visits, place) in [(given, exchange.taken.before), (taken, exchange.given.before)] {
        state.insert_string(network, place, &visits, touched);
    }
}

/// The stretch a route gives.
struct GivenStretch {
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

/// One end of a stretch given, and the leg to what it is put beside.
struct GivenEnd<'a> {
    given: &'a GivenStretch,
    is_first: bool,
    leg: f64,
}

/// The stretch a route takes out beside one of its nodes, to make room; none, if its size is 0.
#[derive(Clone, Copy, Debug)]
struct TakenStretch {
    near: u32,
    /// Whether the stretch lies after `near`.
    is_after: bool,
    size: u32,
    /// Beside `near`.
    first: u32,
    last: u32,
    /// The node beyond `last`.
    far: u32,
    /// Its legs and services.
    inner: f64,
    /// The same with the legs to and from it.
    freed: f64,
    /// What the legs to and from it cost at least, wherever it is put.
    least_legs: f64,
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
        [exchange.given, exchange.taken].iter().any(|stretch| {
            let mut node = stretch.before;
            (0..=stretch.size).any(|_| {
                let is_touched = self.is_touched[node as usize];
                node = self.state.nodes[node as usize].next;
                is_touched
            })
        })
    }

    fn mark(&mut self, exchange: &Exchange, is_touched: bool) {
        for stretch in [exchange.given, exchange.taken] {
            let mut node = stretch.before;
            for _ in 0..=stretch.size {
                self.is_touched[node as usize] = is_touched;
                node = self.state.nodes[node as usize].next;
            }
        }
    }

    /// The exchanges that shorten `giver`, each once, the one that adds least to the total first. An empty route gets nothing: the
    /// other end is always beside a visit.
    fn exchanges(&self, giver: u32) -> Vec<Exchange> {
        // A better set adds less to the total. An exchange that adds more alone is left out, though others might make up for it.
        let room = self.goal() * self.costs.len() as f64 - self.state.total;
        let mean_leg = self.state.total / self.network.points.len() as f64;
        let max_change = room.min(MAX_CHANGE * mean_leg);
        let stretches = self.given_stretches(giver);
        let mut found = Vec::new();
        for (place, stretch) in stretches[0].iter().enumerate() {
            for neighbour in self.network.neighbours(stretch.first).iter().take(NUM_TRIED) {
                if self.state.nodes[neighbour.node as usize].route == giver {
                    continue;
                }
                for is_after in [true, false] {
                    let taken = self.taken_stretches(neighbour.node, is_after);
                    for (size, stretches) in (1..).zip(&stretches) {
                        let beginning = stretches.get(place).map(|stretch| (stretch, true));
                        // Of one visit, both ends are the same.
                        let ending = if size > 1 { place.checked_sub(size - 1) } else { None };
                        for (given, is_first) in
                            beginning.into_iter().chain(ending.map(|first| (&stretches[first], false)))
                        {
                            let end = GivenEnd { given, is_first, leg: neighbour.leg };
                            found.extend(
                                taken.iter().flatten().filter_map(|taken| self.exchange(&end, taken, max_change)),
                            );
                        }
                    }
                }
            }
        }
        found.sort_by(|a, b| a.change().total_cmp(&b.change()));
        found
    }

    /// The stretches that `giver` can give: by size, then in flying order.
    fn given_stretches(&self, giver: u32) -> [Vec<GivenStretch>; MAX_STRETCH] {
        let (network, nodes) = (self.network, &self.state.nodes);
        let mut stretches =
            std::array::from_fn(|_| Vec::with_capacity(self.state.route_sizes[giver as usize] as usize));
        let mut before = network.num_visits as u32 + giver;
        while (nodes[before as usize].next as usize) < network.num_visits {
            let first = nodes[before as usize].next;
            let (mut last, mut inner) = (first, network.services[first as usize]);
            for (size, stretches) in (1..).zip(&mut stretches) {
                let after = nodes[last as usize].next;
                let freed = nodes[before as usize].legs[AFTER] + inner + nodes[last as usize].legs[AFTER];
                let closing = network.leg(before, after);
                stretches.push(GivenStretch { before, size, first, last, after, inner, freed, closing });
                if after as usize >= network.num_visits {
                    break;
                }
                inner += nodes[last as usize].legs[AFTER] + network.services[after as usize];
                last = after;
            }
            before = first;
        }
        stretches
    }

    /// The stretches that the route of `near` can give on one side of it, the shortest first.
    fn taken_stretches(&self, near: u32, is_after: bool) -> [Option<TakenStretch>; MAX_STRETCH + 1] {
        let nodes = &self.state.nodes;
        let (side, other_side) = if is_after { (AFTER, BEFORE) } else { (BEFORE, AFTER) };
        let step = |node: u32| {
            let node = &nodes[node as usize];
            if is_after { node.next } else { node.previous }
        };
        let mut stretches = [None; MAX_STRETCH + 1];
        let first = step(near);
        let (mut last, mut far, mut freed) = (near, first, nodes[near as usize].legs[side]);
        for (size, stretch) in (0..).zip(&mut stretches) {
            let (mut inner, mut least_legs) = (0.0, 0.0);
            if size > 0 {
                inner = freed - nodes[first as usize].legs[other_side] - nodes[last as usize].legs[side];
                least_legs = self.least_leg(first) + self.least_leg(last);
            }
            *stretch = Some(TakenStretch { near, is_after, size, first, last, far, inner, freed, least_legs });
            if far as usize >= self.network.num_visits {
                break;
            }
            last = far;
            far = step(last);
            freed += self.network.services[last as usize] + nodes[last as usize].legs[side];
        }
        stretches
    }

    /// The exchange that puts an end of a stretch beside the node next to which the taken one lies; `None` if that does not shorten
    /// the giver, adds more than `max_change` to the total, or is found from the other end as well.
    fn exchange(&self, end: &GivenEnd<'_>, taken: &TakenStretch, max_change: f64) -> Option<Exchange> {
        let (network, given) = (self.network, end.given);
        let far_end = if end.is_first { given.last } else { given.first };
        // What the giver has instead, but for the legs to and from a taken stretch.
        let inner = if taken.size > 0 { taken.inner } else { given.closing };
        let mut giver_change = inner - given.freed;
        let least_change = giver_change + taken.least_legs;
        let near_change = end.leg + given.inner - taken.freed;
        if least_change >= 0.0 || least_change + near_change + self.least_leg(far_end) >= max_change {
            return None;
        }
        let taker_change = near_change + network.leg(far_end, taken.far);
        if least_change + taker_change >= max_change || (!taken.is_after && self.is_tried(far_end, taken.far)) {
            return None;
        }
        let mut is_turned = false;
        if taken.size > 0 {
            let straight = network.leg(given.before, taken.first) + network.leg(taken.last, given.after);
            let turned = network.leg(given.before, taken.last) + network.leg(taken.first, given.after);
            giver_change += straight.min(turned);
            is_turned = (turned < straight) == taken.is_after;
        }
        let before = if taken.is_after { taken.near } else { taken.far };
        (giver_change < 0.0 && giver_change + taker_change < max_change).then_some(Exchange {
            given: Stretch { before: given.before, size: given.size, is_turned: end.is_first != taken.is_after },
            taken: Stretch { before, size: taken.size, is_turned },
            taker: self.state.nodes[taken.near as usize].route,
            giver_change,
            taker_change,
        })
    }

    /// Whether an exchange that puts `end` beside `node` is also found from there.
    fn is_tried(&self, end: u32, node: u32) -> bool {
        self.network.neighbours(end).iter().take(NUM_TRIED).any(|neighbour| neighbour.node == node)
    }

    /// No leg of a visit is cheaper.
    fn least_leg(&self, visit: u32) -> f64 {
        self.network.neighbours(visit)[0].leg.min(self.network.depot_legs[visit as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::search::plain::testing::{
        assert_costs_are_those_of_the_routes, assert_every_visit_once, farm_with_services, research_network, routes_of,
        unlimited,
    };
    use proptest::prelude::*;

    /// Seven ponds in a row north of the depot: 3, 3 and 1. The left route cannot give one to the middle one, which would be
    /// the longest, unless that hands one on.
    #[test]
    fn a_load_is_handed_on_to_a_third_route() {
        let ponds: Vec<Point> = (-3..=3).map(|x| Point::new(f64::from(x), 10.0)).collect();
        let network = research_network(Point::new(0.0, 0.0), &ponds, 3);
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
            let network = research_network(Point::new(0.0, 0.0), &ponds, routes.len());
            assert!(!balance(&network, &unlimited(), &mut State::new(&network, &routes)));
        }
    }

    #[test]
    fn without_time_nothing_is_changed() {
        let ponds: Vec<Point> = (-5..=5).map(|x| Point::new(f64::from(x), 10.0)).collect();
        let network = research_network(Point::new(0.0, 0.0), &ponds, 2);
        // Not evened out, and not in their order.
        let routes = [vec![0, 2, 1, 4, 3, 6, 5], vec![7, 9, 8, 10]];
        let mut state = State::new(&network, &routes);
        assert!(!balance(&network, &Budget::new(None, Some(&|| 1.0), None), &mut state));
        assert_eq!(state.routes(&network), routes);
        assert!(balance(&network, &unlimited(), &mut state));
    }

    fn assert_is_sound(network: &Network, state: &State) {
        assert_every_visit_once(network, state);
        assert_costs_are_those_of_the_routes(network, state);
    }

    /// `state` after `set`, whose routes must cost what the exchanges say.
    fn assert_changes_add_up(network: &Network, state: &State, set: &[Exchange]) {
        let (mut after, mut costs) = (state.clone(), state.route_costs.clone());
        for exchange in set {
            apply(network, &mut after, exchange, &mut Touched::default());
            costs[state.nodes[exchange.given.before as usize].route as usize] += exchange.giver_change;
            costs[exchange.taker as usize] += exchange.taker_change;
        }
        assert_is_sound(network, &after);
        for (cost, predicted) in after.route_costs.iter().zip(costs) {
            assert!((cost - predicted).abs() < 1e-9, "{set:?}");
        }
    }

    /// What tells an exchange from others.
    fn place(exchange: &Exchange) -> [(u32, u32, bool); 2] {
        [exchange.given, exchange.taken]
            .map(|stretch| (stretch.before, stretch.size, stretch.is_turned && stretch.size > 1))
    }

    proptest! {
        #[test]
        fn exchanges_change_the_routes_as_they_say(
            (num_ponds, num_routes, seed) in (2_usize..40, 2_usize..6, 0_u64..1000),
            services in prop::collection::vec(0.0_f64..0.3, 40),
            homes in prop::collection::vec(0_usize..6, 40),
            has_stops: bool,
        ) {
            let network = farm_with_services(num_ponds, num_routes, seed, &services, has_stops);
            let routes = routes_of(&homes[..num_ponds], network.num_routes);
            let mut state = State::new(&network, &routes);
            let sets = Sets::new(&network, &state);
            for giver in 0..network.num_routes as u32 {
                let exchanges = sets.exchanges(giver);
                for (index, exchange) in exchanges.iter().enumerate() {
                    assert_changes_add_up(&network, &state, &[*exchange]);
                    prop_assert!(exchanges[..index].iter().all(|other| place(other) != place(exchange)));
                }
            }
            if let Some(set) = sets.best(&unlimited()) {
                assert_changes_add_up(&network, &state, &set);
            }
            let before = state.clone();
            let has_changed = balance(&network, &unlimited(), &mut state);
            assert_is_sound(&network, &state);
            prop_assert!(state.max_route_cost() <= before.max_route_cost() + 1e-9);
            prop_assert_eq!(has_changed, state.routes(&network) != before.routes(&network));
        }
    }
}
