//! The min-max optimiser: minimises the costliest route, then the total.
//!
//! Problem: one depot, m equal drones, every visit once; the single-depot min-max multiple travelling salesman problem, with
//! service times and a fixed time per leg. Costs are seconds, which in a research instance are length units.
//!
//! Method ([`solve`]): balanced sectors around the depot (`construct`), each toured and improved by 2-opt and Or-opt
//! (`improve`); if the effort allows, a race of several cuts of the sectors (`population`); from the winner, ruin (`ruin`) and
//! recreate (`recreate`) under annealing (`anneal`), or, with more effort, children of the best plans (`recombine`), annealed
//! likewise and given what is better in the other plans (`cycles`, `assemble`); exchanges that even out the routes (`balance`),
//! for the last of the race, for the children and for the plan that is best in the end, which is first made shorter by deep
//! moves over all routes (`lin_kernighan`, `moves`); all that for the longest route, then annealing for the total with the
//! longest route as a limit. Threads share their best plans now and then (`cooperate`). A time too short for all that goes into
//! a rough plan (`rough`): sectors toured along strips, smoothed without neighbour lists (`smooth`) and balanced.
//!
//! One step costs O(visits removed x neighbours), whatever the number of ponds and the length of the routes (`state`); memory
//! is O(n). `docs/explanation/search.md` says what was tried and what it gave.

mod airspace;
mod anneal;
mod assemble;
mod balance;
mod construct;
mod cooperate;
mod cycles;
mod improve;
mod lin_kernighan;
mod moves;
mod network;
mod objective;
mod order;
mod population;
mod recombine;
mod recreate;
mod rough;
mod ruin;
mod smooth;
mod state;
#[cfg(test)]
mod testing;

use crate::effort::{Budget, Clock, Effort, Watch};
use crate::problem::Problem;
pub(crate) use airspace::Airspace;
use airspace::SharedAirspace;
pub(crate) use anneal::{Chain, Schedule};
use balance::balance;
use construct::Sweep;
pub(crate) use construct::open_at_best_leg;
use cooperate::Meeting;
pub(crate) use improve::improve_routes;
use lin_kernighan::shorten;
pub(crate) use network::Network;
pub(crate) use objective::Objective;
use objective::Rank;
pub(crate) use order::{curve_keys, place_after_widest_gap, pseudo_angle};
use population::Population;
use rough::RoughPlan;
pub(crate) use state::State;

/// What the search minimises.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Goal {
    /// The longest route, then the total.
    #[default]
    Max,
    /// The total, within the time a drone can be under way.
    Total,
}

/// What to search for, and how long. Without an iteration limit, a clock or a watch that ends it, a search never ends.
#[derive(Clone, Copy)]
pub struct Options<'a> {
    /// Same seed, iterations and threads: same plan.
    pub seed: u64,
    /// Steps per thread.
    pub max_iterations: Option<u64>,
    /// Share of the time limit used so far.
    pub clock: Option<Clock<'a>>,
    /// Told how far the threads are; may end the search.
    pub watch: Option<Watch<'a>>,
    /// Chains that search side by side; at least 1.
    pub num_threads: usize,
    /// What to minimise.
    pub goal: Goal,
    /// How much the longest route may grow, as a share, to shorten the total, within the time a drone can be under way. Without
    /// effect where the total is the goal.
    pub slack: f64,
    /// A plan to begin with: visit indices per route.
    pub start: Option<&'a [Vec<usize>]>,
}

impl Default for Options<'_> {
    fn default() -> Self {
        Self {
            seed: 1,
            max_iterations: None,
            clock: None,
            watch: None,
            num_threads: 1,
            goal: Goal::Max,
            slack: 0.0,
            start: None,
        }
    }
}

/// What a search found.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Visit indices per route in flying order; every visit once, no route empty.
    pub routes: Vec<Vec<usize>>,
    /// Steps made by the first thread.
    pub num_iterations: u64,
}

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
/// Temperatures relative to the longest route.
const MAX_HEAT: (f64, f64) = (1e-2, 1e-6);
const TOTAL_HEAT: (f64, f64) = (3e-3, 3e-6);

/// Plans routes for `problem`, each of at least one visit, at most one per drone.
///
/// # Panics
/// If [`Options::start`] names a visit that does not exist or misses one: check it with [`crate::evaluate::evaluate`].
#[must_use]
pub fn solve(problem: &Problem, options: &Options<'_>) -> Outcome {
    let budget = Budget::new(options.max_iterations, options.clock, options.watch);
    let mut network = Network::new(problem);
    if options.start.is_none() && options.clock.is_some() {
        let rough = RoughPlan::new(&network);
        // Neighbours cannot be found by halves: without the time for all, the time goes into what does without them.
        if budget.share(0) * NEIGHBOURS_COST > 1.0 {
            return Outcome { routes: to_indices(rough.improved(&budget)), num_iterations: 0 };
        }
    }
    network.find_neighbours();
    let search = Search { network: &network, budget: &budget, options, meeting: Meeting::new(options.num_threads) };
    let runs: Vec<Run> = std::thread::scope(|scope| {
        let others: Vec<_> = (1..options.num_threads)
            .map(|thread| {
                scope.spawn({
                    let search = &search;
                    move || search.run(thread)
                })
            })
            .collect();
        let first = search.run(0);
        let rest =
            others.into_iter().map(|thread| thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        std::iter::once(first).chain(rest).collect()
    });
    let num_iterations = runs[0].num_iterations;
    // A longest route that does not matter is as good as any other.
    let free_cost = runs.iter().map(|run| run.free_cost).fold(f64::INFINITY, f64::min);
    let rank = |plan: &State| Rank::new(plan.max_route_cost().max(free_cost), plan.total);
    let better = |one: State, other: State| if rank(&other).is_clearly_better(&rank(&one)) { other } else { one };
    let best = runs.into_iter().map(|run| run.plan).reduce(better);
    Outcome { routes: best.map_or_else(Vec::new, |best| to_indices(best.routes(&network))), num_iterations }
}

/// What one thread found.
struct Run {
    plan: State,
    /// Up to which cost its longest route did not matter in the end.
    free_cost: f64,
    num_iterations: u64,
}

/// What the threads of one search share.
struct Search<'a> {
    network: &'a Network,
    budget: &'a Budget<'a>,
    options: &'a Options<'a>,
    meeting: Meeting,
}

impl Search<'_> {
    /// One thread's search: the longest route, by several plans if the effort allows, then the total of the best. Returns the
    /// plan and the number of steps.
    fn run(&self, thread: usize) -> Run {
        let mut effort = Effort::new(self.budget);
        let mut population = match (self.options.start, self.options.goal) {
            (Some(routes), _) => Population::single(self.chain_from(&to_nodes(routes), thread as u64)),
            (None, Goal::Max) => Population::race(self, &mut effort, thread),
            (None, Goal::Total) => Population::single(self.fewest_routes(thread)),
        };
        let floor = self.floor();
        let max_end = if population.best().best.max_route_cost() <= self.goal_cap() { 0.0 } else { MAX_END };
        let schedule = Schedule::scaled(effort.share(), max_end, MAX_HEAT, population.best().best.max_route_cost());
        // Every thread comes to every meeting, also one that has nothing left to do, or the others would wait for ever.
        for until in MEETINGS.into_iter().chain([MAX_END]) {
            population.improve(self, &mut effort, &schedule, until.min(max_end), floor);
            if let Some(best) = self.meeting.best_of_all(thread, population.best()) {
                population.welcome(&best);
            }
        }
        let mut chain = population.into_best();
        self.finish(&mut chain, &mut effort);
        let free_cost = if self.is_lexicographic() { 0.0 } else { chain.objective.cap };
        Run { plan: chain.best, free_cost, num_iterations: effort.num_iterations }
    }

    /// Makes the most of the plan that is best: shortens it and evens it out, then works on the total.
    fn finish(&self, chain: &mut Chain<SharedAirspace>, effort: &mut Effort<'_>) {
        if effort.share_of_steps(REFINE_STEPS_PER_VISIT * self.network.num_visits as f64) <= MAX_REFINE_SHARE {
            self.refine(chain);
        } else {
            self.balance(chain);
        }
        effort.longest_elsewhere = f64::INFINITY;
        let halves = [(effort.share() + 1.0) / 2.0, 1.0];
        // With slack, the longest route must not be shortened again.
        let ends = if self.is_lexicographic() { &halves[..] } else { &halves[1..] };
        for &end in ends {
            chain.restart(self.total_objective(&chain.best));
            let schedule = Schedule::scaled(effort.share(), end, TOTAL_HEAT, chain.best.max_route_cost());
            chain.anneal(self.network, effort, &schedule, end, 0.0);
            if end < 1.0 {
                // Routes that became shorter have room for visits of the longest one.
                self.balance(chain);
            }
        }
    }

    /// Whether the longest route of a plan can still become shorter, and that counts.
    fn can_be_evened_out(&self, plan: &State) -> bool {
        plan.max_route_cost() > self.floor().max(self.goal_cap())
    }

    /// Evens out the routes of a plan, where that can gain anything.
    fn balance(&self, chain: &mut Chain<SharedAirspace>) {
        if self.can_be_evened_out(&chain.best) {
            let mut state = chain.best.clone();
            if balance(self.network, self.budget, &mut state) {
                chain.adopt(&state);
            }
        }
    }

    /// Shortens a plan and evens it out in turn, where that can gain anything.
    fn refine(&self, chain: &mut Chain<SharedAirspace>) {
        if !self.can_be_evened_out(&chain.best) {
            return;
        }
        let (mut state, mut best) = (chain.best.clone(), chain.best.clone());
        let rank = |plan: &State| Rank::new(plan.max_route_cost(), plan.total);
        let mut links = Vec::new();
        for allowance in ALLOWANCES {
            let cap = state.max_route_cost() * (1.0 + allowance);
            shorten(self.network, self.budget, &mut state, cap, &mut links);
            balance(self.network, self.budget, &mut state);
            if rank(&state).is_clearly_better(&rank(&best)) {
                best.clone_from(&state);
            }
        }
        if rank(&best).is_clearly_better(&rank(&chain.best)) {
            chain.adopt(&best);
        }
    }

    /// What no longest route can undercut, but for rounding.
    fn floor(&self) -> f64 {
        self.network.farthest_visit_bound() * (1.0 + 1e-12)
    }

    fn seed(&self, stream: u64) -> u64 {
        self.options.seed.wrapping_add(stream.wrapping_mul(STREAM_STEP))
    }

    /// Up to which cost the longest route does not matter.
    fn goal_cap(&self) -> f64 {
        if self.options.goal == Goal::Max { 0.0 } else { self.network.max_route_cost }
    }

    /// A start for the least total: as few routes as the drones' limit allows, because every route costs two depot legs, and no
    /// later step is wide enough to give up a long one.
    fn fewest_routes(&self, thread: usize) -> Chain<SharedAirspace> {
        let sweep = Sweep::new(self.network);
        let mut num_routes = 1;
        loop {
            let mut routes = sweep.sectors(&vec![1.0; num_routes]);
            improve_routes(self.network, self.budget, &mut routes);
            let chain = self.chain_from(&routes, thread as u64);
            if num_routes == self.network.num_routes || chain.best.max_route_cost() <= self.goal_cap() {
                return chain;
            }
            num_routes += 1;
        }
    }

    fn chain_from(&self, routes: &[Vec<u32>], stream: u64) -> Chain<SharedAirspace> {
        let state = State::new(self.network, routes);
        let objective = Objective::longest_route(self.network.num_routes, state.costs());
        Chain::new(self.network, state, objective, self.seed(stream), SharedAirspace)
    }

    /// Whether a shorter longest route is better, whatever the total.
    fn is_lexicographic(&self) -> bool {
        self.options.goal == Goal::Max && self.options.slack == 0.0
    }

    /// Only the total counts, while no route may outgrow the longest one, and the slack it is given, unless that is more than a
    /// drone can be under way.
    fn total_objective(&self, state: &State) -> Objective {
        let longest = state.max_route_cost();
        let slack = if self.options.goal == Goal::Max { self.options.slack } else { 0.0 };
        let cap = (longest * (1.0 + slack)).min(longest.max(self.network.max_route_cost));
        // Taking a visit out and putting it back changes the last bits of a route's cost.
        Objective::total_within((cap * (1.0 + 1e-12)).max(self.goal_cap()))
    }
}

/// Distance between the seeds of two streams: odd, so that streams of one search never meet.
const STREAM_STEP: u64 = 0x9e37_79b9_7f4a_7c15;

fn to_nodes(routes: &[Vec<usize>]) -> Vec<Vec<u32>> {
    routes.iter().map(|route| route.iter().map(|&visit| visit as u32).collect()).collect()
}

pub(crate) fn to_indices(routes: Vec<Vec<u32>>) -> Vec<Vec<usize>> {
    let to_index = |route: Vec<u32>| route.into_iter().map(|visit| visit as usize).collect::<Vec<usize>>();
    routes.into_iter().filter(|route| !route.is_empty()).map(to_index).collect()
}
