//! How much of the effort is used: steps, time, or the wish to stop.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// What a search reports while it runs.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Cost of the longest route of the best plan so far, in seconds (length units in research instances); infinite while there
    /// is no plan yet.
    pub max_route_cost: f64,
    /// Steps so far, of the thread that reported last.
    pub num_iterations: u64,
    /// Share of the effort used, 0 to 1.
    pub share: f64,
}

/// The share of the time limit used so far; 1 or more ends the search. The core has no clock of its own.
pub type Clock<'a> = &'a (dyn Fn() -> f64 + Sync);

/// Told now and then how far the search is, also by what makes no steps: cutting, smoothing, evening out. `Break` ends it with
/// the best plan so far. It is asked often, up to a million times a second.
pub type Watch<'a> = &'a (dyn Fn(&Progress) -> ControlFlow<()> + Sync);

/// The effort of one search, shared by its threads.
pub(crate) struct Budget<'a> {
    max_iterations: Option<u64>,
    clock: Option<Clock<'a>>,
    watch: Option<Watch<'a>>,
    /// What the watch was told last.
    latest: Mutex<Progress>,
    is_stopped: AtomicBool,
}

impl<'a> Budget<'a> {
    pub fn new(max_iterations: Option<u64>, clock: Option<Clock<'a>>, watch: Option<Watch<'a>>) -> Self {
        let latest = Mutex::new(Progress { max_route_cost: f64::INFINITY, num_iterations: 0, share: 0.0 });
        Self { max_iterations, clock, watch, latest, is_stopped: AtomicBool::new(false) }
    }

    /// Share of the effort used by a thread that made `num_iterations` steps.
    pub fn share(&self, num_iterations: u64) -> f64 {
        if self.is_stopped.load(Ordering::Relaxed) {
            return 1.0;
        }
        let of_iterations = self.max_iterations.map_or(0.0, |limit| num_iterations as f64 / limit as f64);
        let of_time = self.clock.map_or(0.0, |clock| clock());
        of_iterations.max(of_time)
    }

    /// Whether the time is over, or the watch ends the search; iterations do not count, so that what is not an iteration stays
    /// reproducible. Everything that repeats until nothing is gained, or takes more than a moment, asks this now and then.
    pub fn is_time_over(&self) -> bool {
        if self.is_stopped.load(Ordering::Relaxed) || self.clock.is_some_and(|clock| clock() >= 1.0) {
            return true;
        }
        let Some(watch) = self.watch else { return false };
        let latest = *self.latest.lock().unwrap_or_else(PoisonError::into_inner);
        let is_stopped = watch(&latest).is_break();
        self.is_stopped.fetch_or(is_stopped, Ordering::Relaxed) || is_stopped
    }

    /// Share of the effort that work worth `num_iterations` steps used, if it began when `begin` of the effort was used.
    pub fn share_of_work(&self, num_iterations: f64, begin: f64) -> f64 {
        let of_iterations = self.max_iterations.map_or(0.0, |limit| num_iterations / limit as f64);
        let of_time = self.clock.map_or(0.0, |clock| clock() - begin);
        of_iterations.max(of_time)
    }

    fn report(&self, progress: Progress) {
        let Some(watch) = self.watch else { return };
        *self.latest.lock().unwrap_or_else(PoisonError::into_inner) = progress;
        if watch(&progress).is_break() {
            self.is_stopped.store(true, Ordering::Relaxed);
        }
    }
}

/// Steps between two reports.
const STEPS_PER_REPORT: u64 = 2048;

/// What one thread has used of a budget, on whichever of its plans.
pub(crate) struct Effort<'a> {
    budget: &'a Budget<'a>,
    /// Steps made.
    pub num_iterations: u64,
    /// Longest route of the best plan beside the one at work, so that progress tells of the best of all.
    pub longest_elsewhere: f64,
}

impl<'a> Effort<'a> {
    pub fn new(budget: &'a Budget<'a>) -> Self {
        Self { budget, num_iterations: 0, longest_elsewhere: f64::INFINITY }
    }

    /// Share of the effort used.
    pub fn share(&self) -> f64 {
        self.budget.share(self.num_iterations)
    }

    /// Share of the effort that as many more steps would use, if they took as long as those made: infinite before the first.
    pub fn share_of_steps(&self, num_steps: f64) -> f64 {
        if self.num_iterations == 0 { f64::INFINITY } else { self.share() * num_steps / self.num_iterations as f64 }
    }

    /// Counts steps, after which the longest route of the plan at work costs `max_route_cost`; tells the watch now and then.
    pub fn add(&mut self, num_steps: u64, max_route_cost: f64) {
        self.num_iterations += num_steps;
        if self.num_iterations.is_multiple_of(STEPS_PER_REPORT) {
            let max_route_cost = max_route_cost.min(self.longest_elsewhere);
            self.budget.report(Progress { max_route_cost, num_iterations: self.num_iterations, share: self.share() });
        }
    }
}
