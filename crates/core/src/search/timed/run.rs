//! One search from start to end.

use super::exchange::move_trip;
use super::network::Network;
use super::objective::{Objective, Rank, last_landing};
use super::recreate::Recreate;
use super::ruin::Ruin;
use super::state::{OverLimit, State, Touched};
use crate::effort::{Budget, Effort};
use crate::random::Random;
use crate::rounds::{Round, RoundViolation, evaluate_round};
use crate::search::options::{Goal, Options, RoundOutcome};

/// Temperatures at the beginning and at the end, in mean legs of the first plan.
const HOT: f64 = 0.3;
const COLD: f64 = 0.003;
/// At the beginning of the work on what is flown, once the last landing is settled.
const HOT_TOTAL: f64 = 0.3;
/// Share of the effort at which that begins.
const LONGEST_END: f64 = 0.9;
/// Share of steps that move a trip, where drones fly several.
const TRIP_SHARE: f64 = 0.05;
/// Steps between two looks at the clock.
const STEPS_PER_LOOK: u64 = 8;

/// Plans trips for `round`, from the trips of a start on: see [`crate::search::solve_round`].
pub fn solve(round: &Round, start: &[Vec<Vec<usize>>], options: &Options<'_>) -> RoundOutcome {
    let budget = Budget::new(options.max_iterations, options.clock, options.watch);
    let network = Network::new(round);
    let chain = |index: u64| {
        let mut search = Search::new(&network, start, options, options.seed.wrapping_add(index));
        search.run(&budget);
        search
    };
    let chains: Vec<Search<'_>> = std::thread::scope(|scope| {
        let chain = &chain;
        let others: Vec<_> = (1..options.num_threads as u64).map(|index| scope.spawn(move || chain(index))).collect();
        let first = chain(0);
        let rest =
            others.into_iter().map(|thread| thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        std::iter::once(first).chain(rest).collect()
    });
    let num_iterations = chains[0].num_iterations;
    // The first of equals, so that threads that find nothing better change nothing.
    let best = chains.into_iter().reduce(Search::better);
    best.map_or_else(RoundOutcome::default, |best| RoundOutcome { num_iterations, ..best.into_outcome() })
}

/// An annealing chain.
struct Search<'a> {
    network: &'a Network<'a>,
    goal: Goal,
    objective: Objective,
    random: Random,
    ruin: Ruin,
    recreate: Recreate,
    best: State,
    best_rank: Rank,
    current: State,
    current_value: f64,
    /// Equal to `current` between steps.
    trial: State,
    touched: Touched,
    /// What differs between `current` and `best`.
    since_best: Touched,
    num_iterations: u64,
    /// Whether it matters which drone flies a trip, and when.
    has_trip_moves: bool,
}

impl<'a> Search<'a> {
    fn new(network: &'a Network<'a>, start: &[Vec<Vec<usize>>], options: &Options<'_>, seed: u64) -> Self {
        let mut random = Random::new(seed);
        let mut recreate = Recreate::default();
        let mut touched = Touched::default();
        let mut objective = Objective::new(network, options.goal);
        let mut state = State::new(network);
        objective.target = first_target(network);
        // Of a place that is late by rounding after all, a first plan knows nothing; the steps find others.
        for routes in [&[][..], start] {
            let mut first = State::new(network);
            first.adopt(network, routes);
            let (num_new, no_end) = (first.bank.len(), f64::INFINITY);
            let made = recreate.insert(network, &mut first, num_new, &objective, no_end, &mut random, &mut touched);
            let is_made = made.is_ok() && objective.value(network, &first).is_finite();
            if is_made && objective.rank(network, &first).is_better(&objective.rank(network, &state)) {
                state = first;
            }
            if start.is_empty() {
                break;
            }
        }
        let (value, rank) = (objective.value(network, &state), objective.rank(network, &state));
        objective.target = state.longest();
        Self {
            network,
            goal: options.goal,
            objective,
            random,
            ruin: Ruin::default(),
            recreate,
            best: state.clone(),
            best_rank: rank,
            current: state.clone(),
            current_value: value,
            trial: state,
            touched: Touched::default(),
            since_best: Touched::default(),
            num_iterations: 0,
            has_trip_moves: network.round.fleet().turnaround.is_some() || !network.are_ends_alike,
        }
    }

    /// The whole search: when the last drone lands, if that counts, then what is flown.
    fn run(&mut self, budget: &Budget<'_>) {
        let mut effort = Effort::new(budget);
        if self.objective.is_longest {
            self.anneal(&mut effort, LONGEST_END, HOT);
            let within = self.objective.total_within(self.best_rank.longest);
            self.restart(within);
            self.anneal(&mut effort, 1.0, HOT_TOTAL);
        } else {
            self.anneal(&mut effort, 1.0, HOT);
        }
        self.num_iterations = effort.num_iterations;
    }

    /// Goes on from the best plan with another objective.
    fn restart(&mut self, objective: Objective) {
        self.objective = objective;
        self.current.clone_from(&self.best);
        self.trial.clone_from(&self.best);
        self.since_best.clear();
        self.current_value = objective.value(self.network, &self.best);
        self.best_rank = objective.rank(self.network, &self.best);
    }

    fn anneal(&mut self, effort: &mut Effort<'_>, end: f64, hot: f64) {
        let mean_leg = self.current.travel / self.network.num_visits as f64;
        let begin = effort.share();
        let mut share = begin;
        while share < end {
            let temperature = mean_leg * hot * libm::pow(COLD / hot, (share - begin) / (end - begin));
            for _ in 0..STEPS_PER_LOOK {
                self.step(temperature);
            }
            let cost = if self.objective.is_longest { self.best.longest() } else { self.best.travel };
            effort.add(STEPS_PER_LOOK, cost);
            share = effort.share();
        }
    }

    fn step(&mut self, temperature: f64) {
        // 1 - u is never 0, so the logarithm is finite.
        let threshold = self.current_value - temperature * libm::log(1.0 - self.random.uniform());
        let is_trip_move = self.has_trip_moves && self.random.uniform() < TRIP_SHARE;
        let made = if is_trip_move {
            move_trip(self.network, &mut self.trial, &mut self.random, &mut self.touched)
        } else {
            self.ruin_and_recreate(threshold)
        };
        let is_whole = made.is_ok_and(|is_whole| is_whole);
        let value = if is_whole { self.objective.value(self.network, &self.trial) } else { f64::INFINITY };
        if value < threshold {
            self.accept(value);
        } else {
            self.trial.copy_touched(&self.current, &self.touched);
        }
        self.touched.clear();
    }

    fn ruin_and_recreate(&mut self, threshold: f64) -> Result<bool, OverLimit> {
        let num_old = self.trial.bank.len();
        self.ruin.remove(self.network, &mut self.trial, &mut self.random, &mut self.touched)?;
        let num_new = self.trial.bank.len() - num_old;
        self.recreate.insert(
            self.network,
            &mut self.trial,
            num_new,
            &self.objective,
            threshold,
            &mut self.random,
            &mut self.touched,
        )
    }

    fn accept(&mut self, value: f64) {
        self.current.copy_touched(&self.trial, &self.touched);
        self.current_value = value;
        self.since_best.extend(&self.touched);
        let rank = self.objective.rank(self.network, &self.current);
        if rank.is_better(&self.best_rank) {
            self.best_rank = rank;
            self.objective.target = self.current.longest();
            self.best.copy_touched(&self.current, &self.since_best);
            self.since_best.clear();
        }
    }

    /// The one with the better plan; this one of equals.
    fn better(self, other: Self) -> Self {
        if other.final_rank().is_better(&self.final_rank()) { other } else { self }
    }

    /// How good the best plan is, as the goal says.
    fn final_rank(&self) -> Rank {
        Objective::new(self.network, self.goal).rank(self.network, &self.best)
    }

    fn into_outcome(self) -> RoundOutcome {
        let to_indices =
            |&trip: &u32| self.best.trips[trip as usize].visits.iter().map(|&visit| visit as usize).collect();
        let routes = self.best.routes.iter().map(|route| route.trips.iter().map(to_indices).collect()).collect();
        RoundOutcome {
            routes: without_late_visits(self.network, routes),
            makespan: last_landing(self.network, &self.best),
            num_iterations: self.num_iterations,
        }
    }
}

/// The routes without what comes too late after all: a drone that makes a visit in an earlier window than the search gave it may
/// take the place at the depot from another, which is late then.
fn without_late_visits(network: &Network<'_>, mut routes: Vec<Vec<Vec<usize>>>) -> Vec<Vec<Vec<usize>>> {
    let has_choice = (0..network.depot()).any(|visit| network.windows(visit).len() > 1);
    while has_choice && network.has_queue() {
        let Ok(plan) = evaluate_round(network.round, &routes) else { break };
        let last = |route: usize| plan.routes[route].last().and_then(|trip| trip.stops.last()).map(|stop| stop.visit);
        let late: Vec<usize> = (plan.violations.iter())
            .filter_map(|broken| match *broken {
                RoundViolation::Late { visit, .. } => Some(visit),
                RoundViolation::ShiftOver { route, .. } => last(route),
                _ => None,
            })
            .collect();
        if late.is_empty() {
            break;
        }
        routes.iter_mut().flatten().for_each(|trip| trip.retain(|visit| !late.contains(visit)));
    }
    routes
}

/// A landing that the first plan aims at: what all visits take, shared by the drones. Each comes from somewhere near, and a trip
/// is as full as its battery allows.
fn first_target(network: &Network<'_>) -> f64 {
    let depot = network.depot();
    let near = |visit: u32| match network.neighbours(visit).first() {
        Some(neighbour) => neighbour.leg_from,
        None => 0.0,
    };
    let mut busy = 0.0;
    let usable = network.round.fleet().vehicle_type.energy.usable_energy;
    for visit in 0..depot {
        busy += near(visit) + network.service_duration(visit);
        if network.has_energy {
            let nearest = network.neighbours(visit).first().map_or(0.0, |near| network.energy(near.visit, visit));
            let ends = network.ends[0].energy + network.energy(depot, visit) + network.energy(visit, depot);
            let trip = (usable - ends).max(0.05 * usable);
            let share = (nearest + network.service_energy(visit)) / trip;
            let legs = network.duration(depot, visit) + network.duration(visit, depot);
            let ends = network.ends[0].out_duration + network.ends[0].home_duration;
            busy += share * (legs + ends + network.turnaround());
        }
    }
    let fleet = network.round.fleet();
    fleet.first_takeoff(0) + busy / network.ends.len() as f64
}
