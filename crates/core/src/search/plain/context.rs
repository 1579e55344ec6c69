//! What the parts of one search share, and the questions that all of them ask about plans.

use super::airspace::SharedAirspace;
use super::anneal::Chain;
use super::balance::balance;
use super::network::Network;
use super::state::State;
use crate::effort::Budget;
use crate::search::objective::Objective;
use crate::search::options::{Goal, Options};

/// Temperatures relative to the longest route.
pub(super) const MAX_HEAT: (f64, f64) = (1e-2, 1e-6);
pub(super) const TOTAL_HEAT: (f64, f64) = (3e-3, 3e-6);

/// What the threads of one search share.
pub(super) struct Search<'a> {
    pub network: &'a Network,
    pub budget: &'a Budget<'a>,
    pub options: &'a Options<'a>,
}

impl Search<'_> {
    /// What no longest route can undercut, but for rounding.
    pub fn floor(&self) -> f64 {
        self.network.farthest_visit_bound() * (1.0 + 1e-12)
    }

    pub fn seed(&self, stream: u64) -> u64 {
        self.options.seed.wrapping_add(stream.wrapping_mul(STREAM_STEP))
    }

    /// Up to which cost the longest route does not matter.
    pub fn goal_cap(&self) -> f64 {
        if self.options.goal == Goal::Max { 0.0 } else { self.network.max_route_cost }
    }

    /// Whether the total is the goal, and no route takes more than it may.
    pub fn is_allowed(&self, plan: &State) -> bool {
        plan.is_down_to(self.goal_cap())
    }

    /// A chain that starts from `routes`.
    pub fn chain_from(&self, routes: &[Vec<u32>], stream: u64) -> Chain<SharedAirspace> {
        let state = State::new(self.network, routes);
        let objective = Objective::longest_route(self.network.num_routes, state.costs());
        Chain::new(self.network, state, objective, self.seed(stream), SharedAirspace)
    }

    /// Whether a shorter longest route is better, whatever the total.
    pub fn is_lexicographic(&self) -> bool {
        self.options.goal == Goal::Max && self.options.slack == 0.0
    }

    /// Only the total counts, while no route may outgrow the longest one, and the slack it is given, unless that is more than a
    /// drone can be under way.
    pub fn total_objective(&self, state: &State) -> Objective {
        let longest = state.max_route_cost();
        let slack = if self.options.goal == Goal::Max { self.options.slack } else { 0.0 };
        let cap = (longest * (1.0 + slack)).min(longest.max(self.network.max_route_cost));
        // Taking a visit out and putting it back changes the last bits of a route's cost.
        Objective::total_within((cap * (1.0 + 1e-12)).max(self.goal_cap()), state.costs())
    }

    /// Whether the longest route of a plan can still become shorter, and that counts.
    pub fn can_be_evened_out(&self, plan: &State) -> bool {
        plan.max_route_cost() > self.floor().max(self.goal_cap())
    }

    /// Evens out the routes of a plan, where that can gain anything.
    pub fn balance(&self, chain: &mut Chain<SharedAirspace>) {
        if self.can_be_evened_out(&chain.best) {
            let mut state = chain.best.clone();
            if balance(self.network, self.budget, &mut state) && state.excess() <= chain.best.excess() {
                chain.adopt(&state);
            }
        }
    }
}

/// Distance between the seeds of two streams: odd, so that streams of one search never meet.
const STREAM_STEP: u64 = 0x9e37_79b9_7f4a_7c15;
