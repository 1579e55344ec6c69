//! Puts removed visits back, each at its cheapest place among its neighbours.
//!
//! Source: greedy insertion with blinks, Christiaens and Vanden Berghe 2020, section 5.2. Changed for the min-max objective:
//! what an insertion would push a route over the best known maximum is charged tenfold or a thousandfold, as the lot falls, a
//! step ends as soon as it is sure to be rejected, and only places beside near neighbours and at the depot are tried.
//! O(neighbours) for a visit.

use super::airspace::Airspace;
use super::network::{Network, leg_of_length};
use super::state::{AFTER, BEFORE, Node, Place, State, Touched};
use crate::random::Random;
use crate::search::objective::Objective;

/// One place in 2⁸ is passed over, so that a step can leave the greedy path.
const PLACE_BLINK: u64 = 1 << (u64::BITS - 8);
/// One route in this number times its mean number of visits is passed over whole, without which a visit would never leave a
/// short route for an empty one. On long routes most visits have no other route near them, and would be put far away.
const VISITS_PER_ROUTE_BLINK: u64 = 6;
/// Routes at whose ends a visit is tried, beside those near it: a random run of them where there are more.
const MAX_DEPOT_ENDS: u32 = 16;
/// What a unit of overflow over the target costs, beside the added length: the one or the other for every insertion. The high
/// price makes plans that are well balanced, though longer in total, which the low one alone passes by; the low one leads to
/// short plans, which are better where routes have many visits.
const OVERFLOW_PRICES: [f64; 2] = [1000.0, 10.0];

/// Buffers of the insertion.
#[derive(Debug)]
pub(super) struct Recreate {
    keyed: Vec<(f64, u32)>,
    /// Hashes below this pass over a whole route.
    route_blink: u64,
}

impl Recreate {
    pub fn new(network: &Network) -> Self {
        let mean_size = network.num_visits.div_ceil(network.num_routes) as u64;
        Self { keyed: Vec::new(), route_blink: u64::MAX / (VISITS_PER_ROUTE_BLINK * mean_size) }
    }

    /// Inserts the `removed` visits. Returns false, with visits still absent, once the result is sure to exceed `threshold`.
    #[allow(clippy::too_many_arguments)]
    pub fn insert(
        &mut self,
        network: &Network,
        state: &mut State,
        removed: &[u32],
        objective: &Objective,
        threshold: f64,
        airspace: &mut impl Airspace,
        random: &mut Random,
        touched: &mut Touched,
    ) -> bool {
        self.order(network, removed, random);
        let mut longest = state.max_route_cost();
        let mut longest_end = longest_end(network, state);
        for (order, &(_, visit)) in self.keyed.iter().enumerate() {
            let blinks = Blinks { salt: random.bits(), route_limit: self.route_blink };
            let Some(place) = cheapest_place(network, state, visit, objective, airspace, &blinks, longest_end) else {
                return false;
            };
            state.insert(network, visit, &place, touched);
            longest_end = end_after(network, state, visit, longest_end);
            let route = state.nodes[visit as usize].route;
            airspace.assign(visit, route);
            longest = longest.max(state.route_costs[route as usize]);
            // Costs only grow from here on, so that a lower bound over the threshold decides.
            let is_bound = !network.may_visits_save || order + 1 == self.keyed.len();
            if is_bound && objective.max_weight * longest + objective.total_weight * state.total > threshold {
                return false;
            }
        }
        // A route may have become longer by what it lost.
        !network.may_visits_save || state.max_route_cost() <= objective.cap
    }

    /// Sorts the removed visits: at random, far from the depot first or near it first, with odds 4 : 2 : 1.
    fn order(&mut self, network: &Network, removed: &[u32], random: &mut Random) {
        self.keyed.clear();
        let kind = random.below(7);
        for &visit in removed {
            let key = match kind {
                0..4 => random.uniform(),
                4..6 => -network.depot_legs[visit as usize],
                _ => network.depot_legs[visit as usize],
            };
            // Insertion sort: there are about ten.
            let mut place = self.keyed.len();
            self.keyed.push((key, visit));
            while place > 0 && self.keyed[place - 1].0 > key {
                self.keyed[place] = self.keyed[place - 1];
                place -= 1;
            }
            self.keyed[place] = (key, visit);
        }
    }
}

/// No leg from or to the depot is longer; infinite where a route is empty, or where only some of many routes are tried.
fn longest_end(network: &Network, state: &State) -> f64 {
    if network.num_routes > MAX_DEPOT_ENDS as usize {
        return f64::INFINITY;
    }
    let depots = &state.nodes[network.num_visits..];
    let is_empty = |(depot, node): (usize, &Node)| node.next as usize == depot;
    if (network.num_visits..).zip(depots).any(is_empty) {
        return f64::INFINITY;
    }
    depots.iter().fold(0.0, |longest, node| greater(longest, greater(node.legs[BEFORE], node.legs[AFTER])))
}

/// The same, now that `visit` is in.
fn end_after(network: &Network, state: &State, visit: u32, longest_end: f64) -> f64 {
    let node = &state.nodes[visit as usize];
    let is_end = node.previous.max(node.next) as usize >= network.num_visits;
    if is_end { longest_end.max(network.depot_legs[visit as usize]) } else { longest_end }
}

/// Finds where `visit` costs least; nowhere if every place tried would break the cap. No leg at the depot is longer than
/// `longest_end`.
fn cheapest_place(
    network: &Network,
    state: &State,
    visit: u32,
    objective: &Objective,
    airspace: &mut impl Airspace,
    blinks: &Blinks,
    longest_end: f64,
) -> Option<Place> {
    if network.has_priced_depot_legs() {
        cheapest_place_priced::<true>(network, state, visit, objective, airspace, blinks, longest_end)
    } else {
        cheapest_place_priced::<false>(network, state, visit, objective, airspace, blinks, longest_end)
    }
}

/// The same, compiled for legs at the depot that have a price of their own and for those that have none.
fn cheapest_place_priced<const IS_PRICED: bool>(
    network: &Network,
    state: &State,
    visit: u32,
    objective: &Objective,
    airspace: &mut impl Airspace,
    blinks: &Blinks,
    longest_end: f64,
) -> Option<Place> {
    let overflow_price = OVERFLOW_PRICES[(blinks.salt >> 63) as usize];
    let insertion = Insertion::new(network, visit, objective.target, overflow_price);
    let mut cheapest = Cheapest {
        network,
        has_limits: network.limits.len() > 0,
        state,
        visit,
        objective,
        airspace,
        blinks,
        price: f64::INFINITY,
        place: None,
    };
    let mut reach = 0.0;
    for neighbour in network.neighbours(visit) {
        let (leg, node) = (neighbour.leg, &state.nodes[neighbour.node as usize]);
        reach = leg;
        // A place whose other end is nearer was tried from there, so the other leg is at least as long. The legs of absent
        // neighbours are such that none of them passes.
        if 2.0 * leg + insertion.service - greater(node.legs[BEFORE], node.legs[AFTER]) >= cheapest.price {
            continue;
        }
        let offers = insertion.offers_beside::<IS_PRICED>(node, leg, state.route_costs[node.route as usize]);
        if lesser(offers.prices[BEFORE], offers.prices[AFTER]) < cheapest.price {
            cheapest.consider(neighbour.node, leg, &offers);
        }
    }
    // Beside a near neighbour the ends of the routes were tried too; others are at least `reach` away.
    let leg = network.depot_legs[visit as usize];
    let least = leg + reach + insertion.service;
    if least - longest_end >= cheapest.price {
        return cheapest.place;
    }
    let num_routes = network.num_routes as u32;
    let first = if num_routes > MAX_DEPOT_ENDS { (blinks.salt >> 32) as u32 % num_routes } else { 0 };
    for offset in 0..num_routes {
        if offset >= MAX_DEPOT_ENDS && cheapest.place.is_some() {
            break;
        }
        let route = (first + offset) % num_routes;
        let depot = network.num_visits as u32 + route;
        let node = &state.nodes[depot as usize];
        let is_empty = node.next == depot;
        if least - greater(node.legs[BEFORE], node.legs[AFTER]) < cheapest.price || is_empty {
            cheapest.consider(
                depot,
                leg,
                &insertion.offers_beside::<IS_PRICED>(node, leg, state.route_costs[route as usize]),
            );
        }
    }
    cheapest.place
}

/// All that the prices of places for one visit have in common.
struct Insertion {
    x: f64,
    y: f64,
    service: f64,
    stop: f64,
    depot_leg: f64,
    first_depot: u32,
    target: f64,
    overflow_price: f64,
}

/// The places before and after one node.
struct Offers {
    /// Legs between the visit and the other end of the place.
    other_legs: [f64; 2],
    added: [f64; 2],
    prices: [f64; 2],
}

impl Insertion {
    fn new(network: &Network, visit: u32, target: f64, overflow_price: f64) -> Self {
        let (point, service) = (network.points[visit as usize], network.services[visit as usize]);
        let (depot_leg, first_depot) = (network.depot_legs[visit as usize], network.num_visits as u32);
        Self { x: point.x, y: point.y, service, stop: network.stop, depot_leg, first_depot, target, overflow_price }
    }

    /// The places beside `node`, which is `leg` away. Most of the time of a search is spent here: both places are priced at
    /// once, without a branch, so that one instruction does for both.
    #[inline(always)]
    fn offers_beside<const IS_PRICED: bool>(&self, node: &Node, leg: f64, route_cost: f64) -> Offers {
        let mut offers = Offers { other_legs: [0.0; 2], added: [0.0; 2], prices: [0.0; 2] };
        let (excess, leg) = (route_cost - self.target, leg + self.service);
        for side in [BEFORE, AFTER] {
            let (dx, dy) = (node.xs[side] - self.x, node.ys[side] - self.y);
            let length = (dx * dx + dy * dy).sqrt();
            let mut other_leg = leg_of_length(length, self.stop);
            if IS_PRICED && [node.previous, node.next][side] >= self.first_depot {
                other_leg = self.depot_leg;
            }
            let added = leg + other_leg - node.legs[side];
            let overflow = if IS_PRICED {
                // A visit may save time here.
                greater(excess + added, 0.0) - greater(excess, 0.0)
            } else {
                lesser(greater(excess + added, 0.0), added)
            };
            offers.other_legs[side] = other_leg;
            offers.added[side] = added;
            offers.prices[side] = added + self.overflow_price * overflow;
        }
        offers
    }
}

/// Unlike `f64::min` one instruction, because it does not look for what is not a number.
#[inline(always)]
fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Unlike `f64::max` one instruction.
#[inline(always)]
fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The cheapest place so far.
struct Cheapest<'a, A> {
    network: &'a Network,
    /// Whether routes may use only so much of something.
    has_limits: bool,
    state: &'a State,
    visit: u32,
    objective: &'a Objective,
    airspace: &'a mut A,
    blinks: &'a Blinks,
    price: f64,
    place: Option<Place>,
}

impl<A: Airspace> Cheapest<'_, A> {
    /// Takes what `near`, which is `leg` away, offers, if it is cheaper and allowed. Kept apart, because it is seldom called.
    #[inline(never)]
    fn consider(&mut self, near: u32, leg: f64, offers: &Offers) {
        let node = &self.state.nodes[near as usize];
        for side in [AFTER, BEFORE] {
            let (added, other_leg) = (offers.added[side], offers.other_legs[side]);
            let place = if side == AFTER {
                Place { after: near, leg_in: leg, leg_out: other_leg, added }
            } else {
                Place { after: node.previous, leg_in: other_leg, leg_out: leg, added }
            };
            let mut price = offers.prices[side];
            if self.has_limits && price < self.price {
                price += self.objective.excess_price * self.state.excess_added(self.network, self.visit, place.after);
            }
            if price < self.price
                && self.state.route_costs[node.route as usize] + added <= self.objective.cap
                && !self.blinks.pass_over(place.after, node.route)
                && self.airspace.admits(self.visit, node.route)
            {
                (self.price, self.place) = (price, Some(place));
            }
        }
    }
}

/// Which places and routes are passed over for one visit: decided for a place, which is tried from both of its ends, not for a
/// trial.
struct Blinks {
    salt: u64,
    route_limit: u64,
}

impl Blinks {
    fn pass_over(&self, after: u32, route: u32) -> bool {
        let hash = |index: u32| (self.salt ^ u64::from(index)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        hash(after) < PLACE_BLINK || hash(!route) < self.route_limit
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Variant, generate};
    use crate::search::plain::airspace::SharedAirspace;
    use crate::search::plain::testing::{research_network, routes_of};
    use proptest::prelude::*;

    proptest! {
        /// Leaving out the ends of the routes changes nothing, and the bound holds while visits come in.
        #[test]
        fn ends_left_out_are_never_cheapest(
            (num_ponds, num_routes, seed) in (2_usize..60, 1_usize..7, 0_u64..1000),
            homes in prop::collection::vec(0_usize..7, 60),
            num_removed in 1_usize..12,
        ) {
            let farm = generate(num_ponds, Variant::Authors, seed).unwrap();
            let network = research_network(farm.depot, &farm.ponds, num_routes);
            let routes = routes_of(&homes[..num_ponds], network.num_routes);
            let (mut state, mut touched) = (State::new(&network, &routes), Touched::default());
            let objective = Objective::longest_route(network.num_routes, state.costs());
            let removed: Vec<u32> = (0..num_removed.min(num_ponds) as u32).collect();
            for &visit in &removed {
                state.remove_string(&network, visit, 1, &mut Vec::new(), &mut touched);
            }
            let (mut random, mut bound) = (Random::new(seed), longest_end(&network, &state));
            for visit in removed {
                let blinks = Blinks { salt: random.bits(), route_limit: u64::MAX / 20 };
                let place = |longest_end| {
                    let airspace = &mut SharedAirspace;
                    cheapest_place(&network, &state, visit, &objective, airspace, &blinks, longest_end)
                };
                let (with, without) = (place(bound), place(f64::INFINITY));
                prop_assert_eq!(with.map(|place| place.after), without.map(|place| place.after));
                let Some(place) = with else { return Ok(()) };
                state.insert(&network, visit, &place, &mut touched);
                bound = end_after(&network, &state, visit, bound);
                prop_assert!(longest_end(&network, &state).is_infinite() || longest_end(&network, &state) <= bound);
            }
        }
    }
}
