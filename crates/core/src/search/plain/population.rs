//! Several plans at once: starts that race, then children of the survivors.
//!
//! Which start leads to the best plan cannot be seen from it, so that many are improved a little and the better half goes on.
//! What is left are the parents: two of them make a child ([`super::recombine`]), which is annealed for a while, takes what is
//! better in the other plans ([`super::assemble`]), is evened out, and replaces a worse one. After Prins, Computers & Operations
//! Research 2004, whose memetic algorithm improves every child by local search.

use super::airspace::SharedAirspace;
use super::anneal::{Chain, Schedule};
use super::assemble::assemble;
use super::balance::balance;
use super::construct::Cuts;
use super::context::{MAX_HEAT, Search};
use super::recombine::{cross, recut};
use super::starts::Starts;
use super::state::State;
use crate::effort::Effort;
use crate::random::Random;
use crate::search::objective::{Objective, RouteCosts};

/// Share of a population's effort at which the race of the starts ends.
const RACE_END: f64 = 0.25;
/// Starts in a race, at most.
const MAX_STARTS: usize = 16;
/// Steps per visit and start below which a race gains less than it costs.
const RACE_STEPS_PER_VISIT: f64 = 5.0;
/// Steps per visit of the whole effort from which on several plans with children are better than one that is annealed longer:
/// at least the first, and the second times the number of visits.
const CHILDREN_STEPS_PER_VISIT: (f64, f64) = (60.0, 0.2);
/// Steps per visit of the whole effort for one more parent.
const STEPS_PER_VISIT_AND_PARENT: f64 = 30.0;
/// Parents, if there are children.
const MIN_PARENTS: usize = 4;
const MAX_PARENTS: usize = 16;
/// Steps per visit for one child, at least.
const CHILD_STEPS_PER_VISIT: f64 = 10.0;
/// Share of a population's effort for one child, at least: with more children they become alike before the effort is used.
const MIN_CHILD_SHARE: f64 = 0.006;
/// Share of the children that are one plan with some routes cut anew, where there are such.
const RECUT_SHARE: f64 = 0.25;
/// Share of what is left for children that plans are annealed for when only the total counts from then on.
const TURN_SHARE: f64 = 0.25;
/// Parts of other plans are first judged by the sum of this power of the routes' costs: low enough for a longer route to be
/// taken for a shorter total, high enough for what is gained not to be lost when the routes are evened out.
const CROWDING_POWER: i32 = 16;
/// Temperatures relative to the longest route.
const RACE_HEAT: (f64, f64) = (3e-3, 3e-7);
const CHILD_HEAT: (f64, f64) = (MAX_HEAT.0, RACE_HEAT.1);

/// How a population breeds.
pub(super) struct Breeding<'a> {
    /// The shares of the effort between which it does.
    pub begin: f64,
    pub end: f64,
    /// Steps a visit that the whole effort is worth.
    pub steps_per_visit: f64,
    /// Number of its random stream, another for each population of a search.
    pub stream: u64,
    /// What cuts routes of children anew: `None`, if none are.
    pub recuts_along: Option<&'a Cuts<'a>>,
    /// Longest route of the best plan of other populations, so that progress tells of the best of all.
    pub longest_elsewhere: f64,
}

/// The plans of one thread, the best first.
pub(super) struct Population<'a> {
    chains: Vec<Chain<SharedAirspace>>,
    breeding: Breeding<'a>,
    random: Random,
    /// What no route may cost more than, once only the total counts.
    cap: Option<f64>,
}

impl Breeding<'_> {
    /// Steps a visit of this population.
    fn own_steps_per_visit(&self) -> f64 {
        self.steps_per_visit * (self.end - self.begin)
    }

    /// Share of the effort for one child.
    fn child_share(&self) -> f64 {
        (CHILD_STEPS_PER_VISIT / self.steps_per_visit).max(MIN_CHILD_SHARE * (self.end - self.begin))
    }
}

impl<'a> Population<'a> {
    /// The best of `chains`, as many as can be parents.
    pub fn new(search: &Search<'_>, mut chains: Vec<Chain<SharedAirspace>>, breeding: Breeding<'a>) -> Self {
        sort(&mut chains);
        chains.truncate(MAX_PARENTS);
        let random = Random::new(search.seed(u64::MAX - breeding.stream));
        Self { chains, breeding, random, cap: None }
    }

    /// One plan, which has no children.
    pub fn single(search: &Search<'_>, chain: Chain<SharedAirspace>) -> Self {
        let breeding = Breeding {
            begin: 0.0,
            end: 1.0,
            steps_per_visit: 0.0,
            stream: 0,
            recuts_along: None,
            longest_elsewhere: f64::INFINITY,
        };
        Self::new(search, vec![chain], breeding)
    }

    /// Takes in as many more starts as the effort allows, improves all for a while and keeps the better half, until those are
    /// left that can have enough children: one, if there is no effort for children.
    pub fn race(&mut self, search: &Search<'_>, effort: &mut Effort<'_>, starts: &mut Starts<'_>) {
        let steps_per_visit = self.breeding.own_steps_per_visit();
        let num_starts = ((steps_per_visit / RACE_STEPS_PER_VISIT) as usize).clamp(1, MAX_STARTS);
        while self.chains.len() < num_starts && !search.budget.is_time_over() {
            self.chains.push(starts.make());
        }
        let least_steps_per_visit =
            CHILDREN_STEPS_PER_VISIT.0.max(CHILDREN_STEPS_PER_VISIT.1 * search.network.num_visits as f64);
        let num_parents = if steps_per_visit < least_steps_per_visit || search.network.num_routes == 1 {
            1
        } else {
            ((steps_per_visit / STEPS_PER_VISIT_AND_PARENT) as usize).clamp(MIN_PARENTS, MAX_PARENTS)
        };
        let num_starts = self.chains.len();
        let num_rounds = (num_starts as f64 / num_parents as f64).log2().ceil() as usize;
        // Also starts that are all to be parents must first be improved.
        for rounds_left in (1..=num_rounds.max(usize::from(num_starts > 1))).rev() {
            // If there will be children, they get the effort that the longest route does not need.
            let floor = if num_parents > 1 && search.is_lexicographic() { search.floor() } else { 0.0 };
            self.run_round(search, effort, rounds_left, floor);
            if self.best().best.is_down_to(floor) {
                self.chains.truncate(num_parents);
                break;
            }
            self.chains.truncate(self.chains.len().div_ceil(2).max(num_parents));
        }
    }

    /// Anneals all plans for the same share of what is left for the race, or until one has no route that costs more than `floor`.
    fn run_round(&mut self, search: &Search<'_>, effort: &mut Effort<'_>, rounds_left: usize, floor: f64) {
        let begin = effort.share();
        let end = self.breeding.begin + RACE_END * (self.breeding.end - self.breeding.begin);
        let slice = (end - begin).max(0.0) / rounds_left as f64 / self.chains.len() as f64;
        effort.longest_elsewhere =
            self.chains.iter().map(|chain| chain.best.max_route_cost()).fold(self.breeding.longest_elsewhere, f64::min);
        for (index, chain) in self.chains.iter_mut().enumerate() {
            let from = begin + slice * index as f64;
            chain.restart(chain.objective);
            anneal(search, effort, chain, (from, from + slice), RACE_HEAT, floor);
            if chain.best.is_down_to(floor) {
                break;
            }
            // Half of what is wrong with a plan that was annealed for a short while is quickly mended, and hides the rest.
            if rounds_left == 1 {
                search.balance(chain);
            }
            effort.longest_elsewhere = effort.longest_elsewhere.min(chain.best.max_route_cost());
        }
        sort(&mut self.chains);
    }

    /// The plan with the shortest longest route.
    pub fn best(&self) -> &Chain<SharedAirspace> {
        &self.chains[0]
    }

    pub fn into_best(mut self) -> Chain<SharedAirspace> {
        self.chains.swap_remove(0)
    }

    /// All plans, the best first.
    pub fn into_chains(self) -> impl Iterator<Item = Chain<SharedAirspace>> {
        self.chains.into_iter()
    }

    /// Takes in a plan that is better than all: in the place of the worst.
    pub fn welcome(&mut self, state: &State) {
        if let Some(worst) = self.chains.last_mut() {
            worst.adopt(state);
        }
        self.chains.rotate_right(1);
    }

    /// Improves the plan by itself, by `schedule`, or the plans by children, until the share `until` of the effort is used, or
    /// no route costs more than `floor`, which none can undercut. Children go on for the total then, unless there is slack for it.
    pub fn improve(
        &mut self,
        search: &Search<'_>,
        effort: &mut Effort<'_>,
        schedule: &Schedule,
        until: f64,
        floor: f64,
    ) {
        if self.chains.len() == 1 {
            effort.longest_elsewhere = f64::INFINITY;
            return self.chains[0].anneal(search.network, effort, schedule, until, floor);
        }
        self.breed(search, effort, until, floor);
        // Where all is at the depot, no step is made.
        let can_turn =
            search.is_lexicographic() && self.best().best.is_down_to(floor) && !self.best().best.is_down_to(0.0);
        if can_turn && self.cap.is_none() && effort.share() < until {
            self.turn_to_total(search, effort, floor, until);
            self.breed(search, effort, until, floor);
        }
    }

    /// Improves the plans by children until the share `until` of the effort is used, or, while the longest route counts, no
    /// route costs more than `floor`.
    pub fn breed(&mut self, search: &Search<'_>, effort: &mut Effort<'_>, until: f64, floor: f64) {
        let floor = if self.cap.is_none() { floor } else { 0.0 };
        let mut share = effort.share();
        while share < until && self.chains.len() > 1 && !self.best().best.is_down_to(floor) {
            let mut child = self.child(search);
            effort.longest_elsewhere = self.best().best.max_route_cost().min(self.breeding.longest_elsewhere);
            let end = (share + self.breeding.child_share()).min(until);
            anneal(search, effort, &mut child, (share, end), CHILD_HEAT, floor);
            share = effort.share();
            self.take(search, child);
        }
    }

    fn child(&mut self, search: &Search<'_>) -> Chain<SharedAirspace> {
        let keeper = self.random.below(self.chains.len());
        let sectors = self.breeding.recuts_along.filter(|_| self.random.uniform() < RECUT_SHARE);
        let state = if let Some(sectors) = sectors {
            recut(search.network, search.budget, sectors, &self.chains[keeper].best, &mut self.random)
        } else {
            let giver = (keeper + 1 + self.random.below(self.chains.len() - 1)) % self.chains.len();
            cross(search.network, &self.chains[keeper].best, &self.chains[giver].best, &mut self.random)
        };
        let objective = match self.cap {
            None => Objective::longest_route(search.network.num_routes, state.costs()),
            Some(cap) => Objective::total_within(cap, state.costs()),
        };
        Chain::new(search.network, state, objective, self.random.bits(), SharedAirspace)
    }

    /// From now on only the total counts, while no route costs more than `cap`, which none can undercut: anneals all plans for that.
    fn turn_to_total(&mut self, search: &Search<'_>, effort: &mut Effort<'_>, cap: f64, until: f64) {
        self.cap = Some(cap);
        let begin = effort.share();
        let slice = TURN_SHARE * (until - begin) / self.chains.len() as f64;
        for (index, chain) in self.chains.iter_mut().enumerate() {
            let from = begin + slice * index as f64;
            chain.restart(Objective::total_within(cap, chain.best.costs()));
            anneal(search, effort, chain, (from, from + slice), CHILD_HEAT, 0.0);
        }
        sort(&mut self.chains);
    }

    /// Gives `child` what is better in the others, and puts it in the place of the worst, if it is better.
    fn take(&mut self, search: &Search<'_>, mut child: Chain<SharedAirspace>) {
        self.enrich(search, &mut child);
        let is_known = self.chains.iter().any(|other| other.best_rank.is_about(&child.best_rank));
        let last = self.chains.len() - 1;
        if !is_known && child.best_rank.is_better(&self.chains[last].best_rank) {
            self.chains[last] = child;
            sort(&mut self.chains);
        }
    }

    /// Puts into `child` what is better in the others: first what makes it shorter, though a route may become too long, because
    /// the routes can be evened out afterwards; then what makes it better as it is.
    fn enrich(&mut self, search: &Search<'_>, child: &mut Chain<SharedAirspace>) {
        let objective = child.objective;
        let crowding = |costs: &[f64]| costs.iter().map(|cost| (cost / objective.target).powi(CROWDING_POWER)).sum();
        let mut is_balanced = self.cap.is_some();
        if self.cap.is_none()
            && let Some(mut shorter) = self.assemble_all(search, &child.best, objective.target, crowding)
        {
            balance(search.network, search.budget, &mut shorter);
            if objective.value(shorter.costs()) < objective.value(child.best.costs()) {
                child.adopt(&shorter);
                is_balanced = true;
            }
        }
        let value = |costs: &[f64]| objective.value(RouteCosts::of(costs));
        let better = self.assemble_all(search, &child.best, objective.target, value);
        if let Some(better) = better.filter(|better| better.excess() <= child.best.excess()) {
            child.adopt(&better);
            is_balanced = self.cap.is_some();
        }
        if !is_balanced {
            search.balance(child);
        }
    }

    /// `base` with all in the plans that makes it better by `value`; `None` if there is nothing.
    fn assemble_all(
        &mut self,
        search: &Search<'_>,
        base: &State,
        target: f64,
        value: impl Fn(&[f64]) -> f64,
    ) -> Option<State> {
        let mut assembled: Option<State> = None;
        for donor in &self.chains {
            if search.budget.is_time_over() {
                break;
            }
            let base = assembled.as_ref().unwrap_or(base);
            let better = assemble(search.network, base, &donor.best, target, &value, &mut self.random);
            assembled = better.or(assembled);
        }
        assembled
    }
}

fn sort(chains: &mut [Chain<SharedAirspace>]) {
    chains.sort_by(|a, b| a.best_rank.compare(&b.best_rank));
}

/// Anneals between two shares of the effort, with temperatures relative to the longest route, or until no route costs more than
/// `floor`.
fn anneal(
    search: &Search<'_>,
    effort: &mut Effort<'_>,
    chain: &mut Chain<SharedAirspace>,
    (begin, end): (f64, f64),
    heat: (f64, f64),
    floor: f64,
) {
    let schedule = Schedule::scaled(begin, end, heat, chain.best.max_route_cost());
    chain.anneal(search.network, effort, &schedule, end, floor);
}
