//! One search from start to end: several threads, each from its first plans to the total of the best.

use super::airspace::SharedAirspace;
use super::anneal::{Chain, Schedule};
use super::balance::balance;
use super::construct::Cuts;
use super::context::{MAX_HEAT, Search, TOTAL_HEAT};
use super::cooperate::Meeting;
use super::improve::improve_routes;
use super::islands::settle;
use super::lin_kernighan::shorten;
use super::network::Network;
use super::population::Population;
use super::rough::RoughPlan;
use super::state::State;
use crate::direction::fly_cheaper_way;
use crate::effort::{Budget, Effort};
use crate::problem::Problem;
use crate::search::objective::Rank;
use crate::search::options::{Goal, Options, Outcome};

/// Shares of the effort at which threads share their best plan while they work on the longest route.
const MEETINGS: [f64; 2] = [0.5, 0.7];
/// Share of the effort at which the work on the longest route ends.
const MAX_END: f64 = 0.88;
/// How long it takes to find neighbours and to do better with them than without, in times of making a rough plan.
const NEIGHBOURS_COST: f64 = 28.0;
/// How much longer than the longest a route may become, as a share, while a plan is shortened, before it is evened out again.
const ALLOWANCES: [f64; 2] = [0.1, 0.02];
/// Steps per visit that take as long as refining a plan, and the share of the effort that it may take: in less time, steps gain
/// more.
const REFINE_STEPS_PER_VISIT: f64 = 4.0;
const MAX_REFINE_SHARE: f64 = 0.2;
/// Share of the total, over what one drone may take, that surely needs as many routes.
const FULL_SHARE: f64 = 0.8;

/// Plans routes for `problem`: see [`crate::search::solve`].
pub fn solve(problem: &Problem, options: &Options<'_>) -> Outcome {
    let budget = Budget::new(options.max_iterations, options.clock, options.watch);
    let mut network = Network::new(problem);
    let rough = (options.start.is_none() && options.clock.is_some()).then(|| RoughPlan::new(&network, &budget));
    // Neighbours cannot be found by halves: without the time for all, the time goes into what does without them.
    let has_time = rough.is_none() || budget.share(0) * NEIGHBOURS_COST <= 1.0;
    let neighbours = if has_time { network.find_neighbours(&budget) } else { None };
    let Some(neighbours) = neighbours else {
        let routes = match options.start {
            Some(routes) => to_nodes(routes),
            None => rough.unwrap_or_else(|| RoughPlan::new(&network, &budget)).improved(&budget),
        };
        return Outcome { routes: to_indices(problem, routes), num_iterations: 0 };
    };
    network.set_neighbours(neighbours);
    let search = Search { network: &network, budget: &budget, options };
    let meeting = Meeting::new(options.num_threads);
    let thread = |index: usize| Thread { search: &search, meeting: &meeting, index };
    let found: Vec<Found> = std::thread::scope(|scope| {
        let others: Vec<_> = (1..options.num_threads)
            .map(|index| {
                let thread = thread(index);
                scope.spawn(move || thread.run())
            })
            .collect();
        let first = thread(0).run();
        let rest =
            others.into_iter().map(|thread| thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        std::iter::once(first).chain(rest).collect()
    });
    let num_iterations = found[0].num_iterations;
    // A longest route that does not matter is as good as any other.
    let free_cost = found.iter().map(|found| found.free_cost).fold(f64::INFINITY, f64::min);
    let rank = |plan: &State| Rank::of(plan.costs()).free_up_to(free_cost);
    let better = |one: State, other: State| if rank(&other).is_clearly_better(&rank(&one)) { other } else { one };
    let best = found.into_iter().map(|found| found.plan).reduce(better);
    let routes = best.map_or_else(Vec::new, |best| to_indices(problem, best.routes(&network)));
    Outcome { routes, num_iterations }
}

/// What one thread found.
struct Found {
    plan: State,
    /// Up to which cost its longest route did not matter in the end.
    free_cost: f64,
    num_iterations: u64,
}

/// One of the threads of a search.
struct Thread<'a> {
    search: &'a Search<'a>,
    meeting: &'a Meeting,
    index: usize,
}

impl Thread<'_> {
    /// The whole search: the longest route, by several plans if the effort allows, then the total of the best. Returns the
    /// plan and the number of steps.
    fn run(&self) -> Found {
        let search = self.search;
        let mut effort = Effort::new(search.budget);
        let cuts;
        let mut population = if let Some(routes) = search.options.start {
            Population::single(search, search.chain_from(&to_nodes(routes), self.index as u64))
        } else {
            cuts = Cuts::new(search.network);
            match search.options.goal {
                Goal::Max => settle(search, &cuts, &mut effort, self.index),
                Goal::Total => Population::single(search, self.fewest_routes(&cuts)),
            }
        };
        let floor = search.floor();
        let max_end = if search.is_allowed(&population.best().best) { 0.0 } else { MAX_END };
        let schedule = Schedule::scaled(effort.share(), max_end, MAX_HEAT, population.best().best.max_route_cost());
        // Every thread comes to every meeting, also one that has nothing left to do, or the others would wait for ever.
        for until in MEETINGS.into_iter().chain([MAX_END]) {
            population.improve(search, &mut effort, &schedule, until.min(max_end), floor);
            if let Some(best) = self.meeting.best_of_all(self.index, &population.best().best, floor) {
                population.welcome(&best);
            }
        }
        let mut chain = population.into_best();
        self.finish(&mut chain, &mut effort);
        let free_cost = if search.is_lexicographic() { 0.0 } else { chain.objective.cap };
        Found { plan: chain.best, free_cost, num_iterations: effort.num_iterations }
    }

    /// Makes the most of the plan that is best: shortens it and evens it out, then works on the total.
    fn finish(&self, chain: &mut Chain<SharedAirspace>, effort: &mut Effort<'_>) {
        if effort.share_of_steps(REFINE_STEPS_PER_VISIT * self.search.network.num_visits as f64) <= MAX_REFINE_SHARE {
            self.refine(chain);
        } else {
            self.search.balance(chain);
        }
        effort.longest_elsewhere = f64::INFINITY;
        let halves = [(effort.share() + 1.0) / 2.0, 1.0];
        // With slack, the longest route must not be shortened again.
        let ends = if self.search.is_lexicographic() { &halves[..] } else { &halves[1..] };
        for &end in ends {
            chain.restart(self.search.total_objective(&chain.best));
            let schedule = Schedule::scaled(effort.share(), end, TOTAL_HEAT, chain.best.max_route_cost());
            chain.anneal(self.search.network, effort, &schedule, end, 0.0);
            if end < 1.0 {
                // Routes that became shorter have room for visits of the longest one.
                self.search.balance(chain);
            }
        }
    }

    /// Shortens a plan and evens it out in turn, where that can gain anything.
    fn refine(&self, chain: &mut Chain<SharedAirspace>) {
        if !self.search.can_be_evened_out(&chain.best) {
            return;
        }
        let (mut state, mut best) = (chain.best.clone(), chain.best.clone());
        let rank = |plan: &State| Rank::of(plan.costs());
        let mut links = Vec::new();
        for allowance in ALLOWANCES {
            let cap = state.max_route_cost() * (1.0 + allowance);
            shorten(self.search.network, self.search.budget, &mut state, cap, &mut links);
            balance(self.search.network, self.search.budget, &mut state);
            if rank(&state).is_clearly_better(&rank(&best)) {
                best.clone_from(&state);
            }
        }
        if rank(&best).is_clearly_better(&rank(&chain.best)) {
            chain.adopt(&best);
        }
    }

    /// A start for the least total: as few routes as the drones' limit allows, because every route costs two depot legs, and no
    /// later step is wide enough to give up a long one.
    fn fewest_routes(&self, cuts: &Cuts<'_>) -> Chain<SharedAirspace> {
        let Search { network, budget, .. } = *self.search;
        let mut num_routes = 1;
        loop {
            let mut routes = cuts.routes(&vec![1.0; num_routes]);
            improve_routes(network, budget, &mut routes);
            let chain = self.search.chain_from(&routes, self.index as u64);
            if num_routes == network.num_routes || self.search.is_allowed(&chain.best) {
                return chain;
            }
            // Routes that are full on average are more than enough to try.
            let num_full = (FULL_SHARE * chain.best.total / self.search.goal_cap()) as usize;
            num_routes = if budget.is_time_over() { network.num_routes } else { num_full.max(num_routes + 1) };
            num_routes = num_routes.min(network.num_routes);
        }
    }
}

pub(super) fn to_nodes(routes: &[Vec<usize>]) -> Vec<Vec<u32>> {
    routes.iter().map(|route| route.iter().map(|&visit| visit as u32).collect()).collect()
}

/// The routes that were found, without the empty ones, as they are to be flown.
pub(crate) fn to_indices(problem: &Problem, routes: Vec<Vec<u32>>) -> Vec<Vec<usize>> {
    let to_route = |route: Vec<u32>| {
        let mut route: Vec<usize> = route.into_iter().map(|visit| visit as usize).collect();
        fly_cheaper_way(problem, &mut route);
        route
    };
    routes.into_iter().filter(|route| !route.is_empty()).map(to_route).collect()
}
