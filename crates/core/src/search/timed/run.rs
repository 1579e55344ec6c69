//! One search from start to end.

use super::network::Network;
use super::recreate::Recreate;
use super::ruin::Ruin;
use super::state::{State, Touched};
use crate::effort::{Budget, Effort};
use crate::random::Random;
use crate::rounds::Round;
use crate::search::options::{Options, RoundOutcome};

/// Temperatures at the beginning and at the end, in mean legs of the first plan.
const HOT: f64 = 0.3;
const COLD: f64 = 0.003;
/// What a visit costs that is not made, in lengths of the longest way out and home.
const ABSENT_COST: f64 = 100.0;
/// Steps between two looks at the clock.
const STEPS_PER_LOOK: u64 = 8;

/// Plans trips for `round`: see [`crate::search::solve_round`].
pub fn solve(round: &Round, options: &Options<'_>) -> RoundOutcome {
    let budget = Budget::new(options.max_iterations, options.clock, options.watch);
    let network = Network::new(round);
    let mut search = Search::new(&network, options.seed);
    search.anneal(&budget);
    search.into_outcome()
}

/// An annealing chain.
struct Search<'a> {
    network: &'a Network<'a>,
    random: Random,
    ruin: Ruin,
    recreate: Recreate,
    best: State,
    best_value: f64,
    current: State,
    current_value: f64,
    /// Equal to `current` between steps.
    trial: State,
    touched: Touched,
    /// What differs between `current` and `best`.
    since_best: Touched,
    absent_cost: f64,
    num_iterations: u64,
}

impl<'a> Search<'a> {
    fn new(network: &'a Network<'a>, seed: u64) -> Self {
        let mut random = Random::new(seed);
        let mut recreate = Recreate::default();
        let mut touched = Touched::default();
        let mut state = State::new(network);
        let furthest = (0..network.depot()).map(|visit| network.leg(network.depot(), visit)).fold(0.0, f64::max);
        // Of a place that is late by rounding after all, the first plan knows nothing; the steps find others.
        let mut first = state.clone();
        if recreate.insert(network, &mut first, network.num_visits, &mut random, &mut touched).is_ok() {
            state = first;
        }
        let absent_cost = ABSENT_COST * (2.0 * furthest).max(f64::MIN_POSITIVE);
        let mut search = Self {
            network,
            random,
            ruin: Ruin::default(),
            recreate,
            best: state.clone(),
            best_value: 0.0,
            current: state.clone(),
            current_value: 0.0,
            trial: state,
            touched: Touched::default(),
            since_best: Touched::default(),
            absent_cost,
            num_iterations: 0,
        };
        search.current_value = search.value();
        search.best_value = search.current_value;
        search
    }

    fn value(&self) -> f64 {
        self.trial.length + self.absent_cost * self.trial.bank.len() as f64
    }

    fn anneal(&mut self, budget: &Budget<'_>) {
        let mut effort = Effort::new(budget);
        let mean_leg = self.current.length / (self.network.num_visits as f64).max(1.0);
        let mut share = effort.share();
        while share < 1.0 {
            let temperature = mean_leg * HOT * libm::pow(COLD / HOT, share);
            for _ in 0..STEPS_PER_LOOK {
                self.step(temperature);
            }
            effort.add(STEPS_PER_LOOK, self.best.length);
            share = effort.share();
        }
        self.num_iterations = effort.num_iterations;
    }

    fn step(&mut self, temperature: f64) {
        // 1 - u is never 0, so the logarithm is finite.
        let threshold = self.current_value - temperature * libm::log(1.0 - self.random.uniform());
        let num_old = self.trial.bank.len();
        let ruined = self.ruin.remove(self.network, &mut self.trial, &mut self.random, &mut self.touched);
        let num_new = self.trial.bank.len() - num_old;
        let made = ruined.and_then(|()| {
            self.recreate.insert(self.network, &mut self.trial, num_new, &mut self.random, &mut self.touched)
        });
        let value = if made.is_ok() { self.value() } else { f64::INFINITY };
        if value < threshold {
            self.accept(value);
        } else {
            self.trial.copy_touched(&self.current, &self.touched);
        }
        self.touched.clear();
    }

    fn accept(&mut self, value: f64) {
        self.current.copy_touched(&self.trial, &self.touched);
        self.current_value = value;
        self.since_best.extend(&self.touched);
        if value < self.best_value {
            self.best_value = value;
            self.best.copy_touched(&self.current, &self.since_best);
            self.since_best.clear();
        }
    }

    fn into_outcome(self) -> RoundOutcome {
        let to_indices =
            |&trip: &u32| self.best.trips[trip as usize].visits.iter().map(|&visit| visit as usize).collect();
        let routes = (self.best.routes.iter().filter(|route| !route.trips.is_empty()))
            .map(|route| route.trips.iter().map(to_indices).collect())
            .collect();
        RoundOutcome { routes, num_iterations: self.num_iterations }
    }
}
