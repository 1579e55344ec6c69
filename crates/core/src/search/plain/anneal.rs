//! Ruin and recreate under simulated annealing.
//!
//! Source: Christiaens and Vanden Berghe 2020 (SISR), algorithm 1: a step replaces the current plan if its cost is below the
//! current cost plus an exponentially distributed allowance whose mean, the temperature, falls geometrically. Changed: the
//! allowance is drawn before the step, so that a step which cannot pass ends early; a step that fails is taken back by
//! copying what it touched, so that its cost does not depend on the size of the plan.

use super::airspace::Airspace;
use super::network::Network;
use super::recreate::Recreate;
use super::ruin::Ruin;
use super::state::{Difference, State, Touched};
use crate::effort::Effort;
use crate::random::Random;
use crate::search::objective::{Objective, Rank};

/// Share of the steps that start on the longest route.
const LONGEST_SHARE: f64 = 0.5;
/// Draws before a step gives up finding a visit of the longest route, which then is a short one.
const MAX_SEED_DRAWS: usize = 64;
/// Steps between two looks at the clock.
const STEPS_PER_LOOK: u64 = 8;

/// A temperature that falls geometrically between two shares of the effort.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Schedule {
    pub begin: f64,
    pub end: f64,
    /// Temperature at the beginning, in units of cost.
    pub hot: f64,
    /// Temperature at the end, in units of cost.
    pub cold: f64,
}

impl Schedule {
    /// Temperatures at the beginning and at the end as shares of `scale`.
    pub fn scaled(begin: f64, end: f64, (hot, cold): (f64, f64), scale: f64) -> Self {
        Self { begin, end, hot: hot * scale, cold: cold * scale }
    }

    fn temperature(&self, share: f64) -> f64 {
        let progress = ((share - self.begin) / (self.end - self.begin)).clamp(0.0, 1.0);
        self.hot * libm::pow(self.cold / self.hot, progress)
    }
}

/// One annealing chain.
pub(crate) struct Chain<A> {
    /// The best plan found.
    pub best: State,
    pub best_rank: Rank,
    pub objective: Objective,
    random: Random,
    current: State,
    current_value: f64,
    /// Equal to `current` between steps.
    trial: State,
    ruin: Ruin,
    recreate: Recreate,
    airspace: A,
    touched: Touched,
    /// What differs between `current` and `best`.
    since_best: Difference,
}

impl<A: Airspace> Chain<A> {
    pub fn new(network: &Network, state: State, objective: Objective, seed: u64, airspace: A) -> Self {
        let (value, rank) = (objective.value(state.costs()), objective.rank(state.costs()));
        Self {
            best: state.clone(),
            best_rank: rank,
            objective,
            random: Random::new(seed),
            current: state.clone(),
            current_value: value,
            trial: state,
            ruin: Ruin::default(),
            recreate: Recreate::new(network),
            airspace,
            touched: Touched::default(),
            since_best: Difference::new(network),
        }
    }

    /// Goes on from the best plan, judged by `objective`.
    pub fn restart(&mut self, objective: Objective) {
        self.since_best.copy_to(&mut self.current, &self.best);
        self.since_best.settle(&mut self.trial, &self.best);
        self.airspace.load(&self.best);
        self.objective = objective;
        self.best_rank = objective.rank(self.best.costs());
        self.current_value = objective.value(self.best.costs());
    }

    /// Goes on from another chain's best plan.
    pub fn adopt(&mut self, state: &State) {
        for own in [&mut self.best, &mut self.current, &mut self.trial] {
            own.clone_from(state);
        }
        self.since_best.clear();
        self.restart(self.objective.aimed_at(state.costs()));
    }

    /// Anneals until the share `until` of the effort is used, or no route costs more than `floor`, which none can
    /// undercut.
    pub fn anneal(&mut self, network: &Network, effort: &mut Effort<'_>, schedule: &Schedule, until: f64, floor: f64) {
        let mut share = effort.share();
        while share < until && !self.best.is_down_to(floor) {
            let temperature = schedule.temperature(share);
            for _ in 0..STEPS_PER_LOOK {
                self.step(network, temperature);
            }
            effort.add(STEPS_PER_LOOK, self.best.max_route_cost());
            share = effort.share();
        }
    }

    fn step(&mut self, network: &Network, temperature: f64) {
        let seed = self.draw_seed(network);
        // 1 - u is never 0, so the logarithm is finite.
        let threshold = self.current_value - temperature * libm::log(1.0 - self.random.uniform());
        self.ruin.remove(network, &mut self.trial, seed, &mut self.random, &mut self.touched);
        let is_complete = self.recreate.insert(
            network,
            &mut self.trial,
            &self.ruin.removed,
            &self.objective,
            threshold,
            &mut self.airspace,
            &mut self.random,
            &mut self.touched,
        );
        let value = if is_complete { self.objective.value(self.trial.costs()) } else { f64::INFINITY };
        if value < threshold {
            self.accept(value);
        } else {
            self.trial.copy_touched(&self.current, &self.touched);
            self.airspace.undo();
        }
        self.touched.clear();
    }

    fn accept(&mut self, value: f64) {
        self.current.copy_touched(&self.trial, &self.touched);
        self.current_value = value;
        self.airspace.keep();
        self.since_best.add(&self.touched);
        let rank = self.objective.rank(self.trial.costs());
        if rank.is_better(&self.best_rank) {
            self.best_rank = rank;
            self.since_best.settle(&mut self.best, &self.trial);
            self.objective = self.objective.aimed_at(self.trial.costs());
        }
    }

    /// A visit to ruin around: any, or one of the longest route.
    fn draw_seed(&mut self, network: &Network) -> u32 {
        let mut seed = self.random.below(network.num_visits) as u32;
        if self.random.uniform() < LONGEST_SHARE {
            let longest = self.trial.longest_route();
            for _ in 0..MAX_SEED_DRAWS {
                if self.trial.nodes[seed as usize].route == longest {
                    break;
                }
                seed = self.random.below(network.num_visits) as u32;
            }
        }
        seed
    }
}
