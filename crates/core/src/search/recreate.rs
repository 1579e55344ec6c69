//! Puts removed visits back, each at its cheapest place among its neighbours.
//!
//! Source: greedy insertion with blinks, Christiaens and Vanden Berghe 2020, section 5.2. Changed for the min-max objective:
//! what an insertion would push a route over the best known maximum is charged tenfold, a step ends as soon as it is sure to
//! be rejected, and only places beside near neighbours and at the depot are tried. O(neighbours) for a visit.

use super::airspace::Airspace;
use super::network::Network;
use super::state::{ABSENT, RouteCosts, State, Touched};
use crate::random::Random;
use std::cmp::Ordering;

/// One place in 2⁸ is passed over, so that a step can leave the greedy path.
const PLACE_BLINK_BITS: u32 = 8;
/// One route in 2⁶ is passed over whole, without which a visit would never leave a short route for an empty one.
const ROUTE_BLINK_BITS: u32 = 6;
/// Routes at whose ends a visit is tried, beside those near it: a random run of them where there are more.
const MAX_DEPOT_ENDS: u32 = 16;
/// What a unit of overflow over the target costs, beside the added length.
const OVERFLOW_PRICE: f64 = 10.0;

/// What a plan costs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Objective {
    /// Weight of the longest route.
    pub max_weight: f64,
    /// Weight of the total.
    pub total_weight: f64,
    /// No route may become longer.
    pub cap: f64,
    /// Routes should not become longer.
    pub target: f64,
}

/// Weight of the mean route beside the longest: without it, shortening any other route would not count.
const MEAN_WEIGHT: f64 = 0.02;

impl Objective {
    /// The longest route, and a little the mean one, from `state` on.
    pub fn longest_route(network: &Network, state: &State) -> Self {
        let total_weight = MEAN_WEIGHT / network.num_routes as f64;
        Self { max_weight: 1.0, total_weight, cap: f64::INFINITY, target: state.max_route_cost() }
    }

    /// Only the total, while no route may become longer than `cap`.
    pub fn total_within(cap: f64) -> Self {
        Self { max_weight: 0.0, total_weight: 1.0, cap, target: cap }
    }

    /// What `state` costs.
    pub fn value(&self, state: &State) -> f64 {
        self.value_of(RouteCosts { longest: state.max_route_cost(), total: state.total })
    }

    /// What a plan with routes of these costs costs.
    pub fn value_of(&self, costs: RouteCosts) -> f64 {
        self.max_weight * costs.longest + self.total_weight * costs.total
    }

    /// By what two plans are compared in the end: the longest route first, if it counts, then the total. The value, which
    /// guides the search, would take a longer route for a shorter total.
    pub fn rank(&self, state: &State) -> Rank {
        Rank { longest: if self.max_weight > 0.0 { state.max_route_cost() } else { 0.0 }, total: state.total }
    }
}

/// By how much sums of the same legs differ at most, after many changes.
const ROUNDING: f64 = 1e-8;

/// How good a plan is: less is better, the fields in falling order of importance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rank {
    longest: f64,
    total: f64,
}

impl Rank {
    /// Orders two ranks, the better one first.
    pub fn compare(&self, other: &Self) -> Ordering {
        self.longest.total_cmp(&other.longest).then(self.total.total_cmp(&other.total))
    }

    /// Whether this is equal to `other` but for rounding.
    pub fn is_about(&self, other: &Self) -> bool {
        let is_near = |one: f64, other: f64| (one - other).abs() <= ROUNDING * other;
        is_near(self.longest, other.longest) && is_near(self.total, other.total)
    }

    /// Whether this is better than `other`.
    pub fn is_better(&self, other: &Self) -> bool {
        self.compare(other) == Ordering::Less
    }
}

/// Buffers of the insertion.
#[derive(Debug, Default)]
pub(super) struct Recreate {
    keyed: Vec<(f64, u32)>,
}

struct Place {
    after: u32,
    leg_in: f64,
    leg_out: f64,
    added: f64,
}

impl Recreate {
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
        let mut longest: f64 = 0.0;
        for &(_, visit) in &self.keyed {
            let Some(place) = cheapest_place(network, state, visit, objective, airspace, random.bits()) else {
                return false;
            };
            state.insert(visit, place.after, place.leg_in, place.leg_out, place.added, touched);
            let route = state.nodes[visit as usize].route;
            airspace.assign(visit, route);
            longest = longest.max(state.route_costs[route as usize]);
            // Costs only grow from here on, so that a lower bound over the threshold decides.
            if objective.max_weight * longest + objective.total_weight * state.total > threshold {
                return false;
            }
        }
        true
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

/// Finds where `visit` costs least; nowhere if every place tried would break the cap.
///
/// A place is tried from both of its ends: `salt` decides for a place, not for a trial, whether it is passed over.
fn cheapest_place(
    network: &Network,
    state: &State,
    visit: u32,
    objective: &Objective,
    airspace: &mut impl Airspace,
    salt: u64,
) -> Option<Place> {
    let service = network.services[visit as usize];
    let mut best_price = f64::INFINITY;
    let mut best = Place { after: ABSENT, leg_in: 0.0, leg_out: 0.0, added: 0.0 };
    let mut consider = |best_price: &mut f64, after: u32, leg_in: f64, leg_out: f64, route: u32, leg_removed: f64| {
        let added = leg_in + leg_out - leg_removed + service;
        if added >= *best_price {
            return;
        }
        let cost = state.route_costs[route as usize] + added;
        let overflow = cost - objective.target;
        let price = if overflow > 0.0 { added + OVERFLOW_PRICE * overflow.min(added) } else { added };
        if price < *best_price
            && cost <= objective.cap
            && !is_blink(after, salt, PLACE_BLINK_BITS)
            && !is_blink(!route, salt, ROUTE_BLINK_BITS)
            && airspace.admits(visit, route)
        {
            *best_price = price;
            best = Place { after, leg_in, leg_out, added };
        }
    };
    let mut reach = 0.0;
    for neighbour in network.neighbours(visit) {
        let (leg, near) = (neighbour.leg, neighbour.node);
        reach = leg;
        let node = state.nodes[near as usize];
        if node.route == ABSENT {
            continue;
        }
        // A place whose other end is nearer than `near` was tried from there, so the other leg is at least as long.
        let least = 2.0 * leg + service;
        if least - node.leg_after < best_price {
            let leg_out = network.leg(visit, node.next);
            consider(&mut best_price, near, leg, leg_out, node.route, node.leg_after);
        }
        let leg_removed = state.nodes[node.previous as usize].leg_after;
        if least - leg_removed < best_price {
            let leg_in = network.leg(node.previous, visit);
            consider(&mut best_price, node.previous, leg_in, leg, node.route, leg_removed);
        }
    }
    // Beside a near neighbour the ends of the routes were tried too; others are at least `reach` away.
    let depot_leg = network.depot_legs[visit as usize];
    let least = depot_leg + reach + service;
    let num_routes = network.num_routes as u32;
    let first = if num_routes > MAX_DEPOT_ENDS { (salt >> 32) as u32 % num_routes } else { 0 };
    for offset in 0..num_routes {
        if offset >= MAX_DEPOT_ENDS && best_price.is_finite() {
            break;
        }
        let route = (first + offset) % num_routes;
        let depot = network.num_visits as u32 + route;
        let node = state.nodes[depot as usize];
        if least - node.leg_after < best_price || node.next == depot {
            consider(&mut best_price, depot, depot_leg, network.leg(visit, node.next), route, node.leg_after);
        }
        let leg_removed = state.nodes[node.previous as usize].leg_after;
        if least - leg_removed < best_price {
            consider(&mut best_price, node.previous, network.leg(node.previous, visit), depot_leg, route, leg_removed);
        }
    }
    (best.after != ABSENT).then_some(best)
}

/// Whether a place or route is passed over this time: whether the top bits of a multiplicative hash are 0.
fn is_blink(place: u32, salt: u64, num_bits: u32) -> bool {
    (salt ^ u64::from(place)).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (u64::BITS - num_bits) == 0
}
