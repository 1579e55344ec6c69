//! The min-max optimiser: minimises the costliest route, then the total.
//!
//! Problem: one depot, m equal drones, every visit once; the single-depot min-max multiple travelling salesman problem, with
//! service times and a fixed time per leg. Costs are seconds, which in a research instance are length units.
//!
//! Method ([`solve`]): balanced sectors around the depot (`construct`), each toured and improved by 2-opt and Or-opt
//! (`improve`); if the effort allows, a race of several cuts of the sectors; from the winner, ruin (`ruin`) and
//! recreate (`recreate`) under annealing (`anneal`), first for the longest route, then for the total with the longest route
//! as a limit. Threads share their best plans now and then (`cooperate`). A time too short for all that goes into a rough
//! plan (`rough`): sectors toured along strips, smoothed without neighbour lists (`smooth`) and balanced.
//!
//! One step costs O(visits removed x neighbours), whatever the number of ponds and the length of the routes (`state`); memory
//! is O(n). `docs/explanation/search.md` says what was tried and what it gave.

mod airspace;
mod anneal;
mod budget;
mod construct;
mod cooperate;
mod improve;
mod network;
mod recreate;
mod rough;
mod ruin;
mod smooth;
mod state;

use crate::problem::Problem;
use crate::random::Random;
pub(crate) use airspace::Airspace;
use airspace::SharedAirspace;
pub(crate) use anneal::{Chain, Schedule};
pub(crate) use budget::Budget;
pub use budget::{Clock, Progress, Watch};
use construct::Sweep;
pub(crate) use construct::{curve_keys, improve_routes, open_at_best_leg, place_after_widest_gap, pseudo_angle};
use cooperate::Meeting;
pub(crate) use network::Network;
pub(crate) use recreate::Objective;
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
    /// Told how far the first thread is; may end the search.
    pub watch: Option<Watch<'a>>,
    /// Chains that search side by side; at least 1.
    pub num_threads: usize,
    /// What to minimise.
    pub goal: Goal,
    /// How much the longest route may grow, as a share, to shorten the total.
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

/// Share of the effort at which the race of the starts ends.
const RACE_END: f64 = 0.25;
/// Shares of the effort at which threads share their best plan while they work on the longest route.
const MEETINGS: [f64; 2] = [0.5, 0.7];
/// Share of the effort at which the work on the longest route ends.
const MAX_END: f64 = 0.88;
/// Starts in a race, at most.
const MAX_STARTS: usize = 16;
/// How far the shares of the sectors of a start are from equal, at most: wide enough for other petals to win.
const SHARE_SPREAD: f64 = 0.3;
/// Steps per visit and start below which a race gains less than it costs.
const RACE_STEPS_PER_VISIT: f64 = 5.0;
/// Steps that take as long as making a start, per visit.
const START_STEPS_PER_VISIT: f64 = 0.3;
/// How long it takes to find neighbours and to do better with them than without, in times of making a rough plan.
const NEIGHBOURS_COST: f64 = 28.0;
/// Temperatures relative to the longest route.
const RACE_HEAT: (f64, f64) = (3e-3, 3e-7);
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
    if options.start.is_none() {
        let rough = RoughPlan::new(&network);
        // Neighbours cannot be found by halves: without the time for all, the time goes into what does without them.
        if budget.share(0) * NEIGHBOURS_COST > 1.0 {
            return Outcome { routes: to_indices(rough.improved(&budget)), num_iterations: 0 };
        }
    }
    network.find_neighbours();
    let search = Search { network: &network, budget: &budget, options, meeting: Meeting::new(options.num_threads) };
    let mut chains: Vec<Chain<SharedAirspace>> = std::thread::scope(|scope| {
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
    let num_iterations = chains[0].num_iterations;
    chains.sort_by(|a, b| a.best_rank.compare(&b.best_rank));
    Outcome { routes: to_indices(chains[0].best.routes(&network)), num_iterations }
}

/// What the threads of one search share.
struct Search<'a> {
    network: &'a Network,
    budget: &'a Budget<'a>,
    options: &'a Options<'a>,
    meeting: Meeting,
}

impl Search<'_> {
    /// One thread's search: race, longest route, total.
    fn run(&self, thread: usize) -> Chain<SharedAirspace> {
        let mut chain = match (self.options.start, self.options.goal) {
            (Some(routes), _) => self.chain_from(&to_nodes(routes), thread as u64),
            (None, Goal::Max) => self.race(thread),
            (None, Goal::Total) => self.fewest_routes(thread),
        };
        let floor = self.network.farthest_visit_bound() * (1.0 + 1e-12);
        let max_end = if chain.best.max_route_cost() <= self.goal_cap() { 0.0 } else { MAX_END };
        let schedule = self.schedule(&chain, max_end, MAX_HEAT);
        // Every thread comes to every meeting, also one that has nothing left to do, or the others would wait for ever.
        for until in MEETINGS.into_iter().chain([MAX_END]) {
            chain.anneal(self.network, self.budget, &schedule, until.min(max_end), floor);
            self.meeting.share_best(thread, &mut chain);
        }
        chain.restart(self.total_objective(&chain.best));
        let schedule = self.schedule(&chain, 1.0, TOTAL_HEAT);
        chain.anneal(self.network, self.budget, &schedule, 1.0, 0.0);
        chain
    }

    /// Makes as many starts as the effort allows, improves all for a while and keeps the better half, until one is left.
    fn race(&self, thread: usize) -> Chain<SharedAirspace> {
        let sweep = Sweep::new(self.network);
        let start = |index: usize| {
            let stream = (index * self.options.num_threads + thread) as u64;
            let mut routes = sweep.sectors(&self.shares(stream));
            improve_routes(self.network, self.budget, &mut routes);
            self.chain_from(&routes, stream)
        };
        let begin = self.budget.share(0);
        let mut chains = vec![start(0)];
        let start_steps = START_STEPS_PER_VISIT * self.network.num_visits as f64;
        let start_share = self.budget.share_of_work(start_steps, begin);
        let num_starts = (START_STEPS_PER_VISIT / RACE_STEPS_PER_VISIT / start_share) as usize;
        let num_starts = num_starts.clamp(1, MAX_STARTS);
        chains.extend((1..num_starts).map(start));
        let mut num_iterations = 0;
        while chains.len() > 1 {
            let begin = self.budget.share(num_iterations);
            let num_rounds = (chains.len() as f64).log2().ceil();
            let slice = (RACE_END - begin).max(0.0) / num_rounds / chains.len() as f64;
            for (index, chain) in chains.iter_mut().enumerate() {
                chain.num_iterations = num_iterations;
                let from = begin + slice * index as f64;
                let (hot, cold) =
                    (RACE_HEAT.0 * chain.best.max_route_cost(), RACE_HEAT.1 * chain.best.max_route_cost());
                let schedule = Schedule { begin: from, end: from + slice, hot, cold };
                chain.restart(chain.objective);
                chain.anneal(self.network, self.budget, &schedule, from + slice, 0.0);
                num_iterations = chain.num_iterations;
            }
            chains.sort_by(|a, b| a.best_rank.compare(&b.best_rank));
            chains.truncate(chains.len().div_ceil(2));
        }
        let mut winner = chains.swap_remove(0);
        winner.num_iterations = num_iterations;
        winner
    }

    /// Shares of the sectors of a start: equal for the first, random about that for the others.
    fn shares(&self, stream: u64) -> Vec<f64> {
        let spread = if stream == 0 { 0.0 } else { SHARE_SPREAD };
        let mut random = Random::new(self.seed(stream));
        (0..self.network.num_routes).map(|_| 1.0 + spread * (2.0 * random.uniform() - 1.0)).collect()
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
        let objective = Objective::longest_route(self.network, &state);
        Chain::new(self.network, state, objective, self.seed(stream), SharedAirspace)
    }

    /// Only the total counts, while no route may outgrow the longest one, and the slack it is given.
    fn total_objective(&self, state: &State) -> Objective {
        // Taking a visit out and putting it back changes the last bits of a route's cost.
        let longest = state.max_route_cost() * (1.0 + self.options.slack) * (1.0 + 1e-12);
        Objective::total_within(longest.max(self.goal_cap()))
    }

    /// From now to `end`.
    fn schedule(&self, chain: &Chain<SharedAirspace>, end: f64, (hot, cold): (f64, f64)) -> Schedule {
        let scale = chain.best.max_route_cost();
        Schedule { begin: self.budget.share(chain.num_iterations), end, hot: hot * scale, cold: cold * scale }
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
