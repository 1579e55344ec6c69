//! What to search for, how long, and what a search found.

use crate::effort::{Clock, Watch};

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

/// What a search found for a round.
#[derive(Clone, Debug, Default)]
pub struct RoundOutcome {
    /// For each drone that flies its trips, each the visits in flying order; no visit twice. What no trip could make is left out.
    pub routes: Vec<Vec<Vec<usize>>>,
    /// When the last drone lands, in seconds, as the search reckons: its judge may find earlier windows.
    pub makespan: f64,
    /// Steps made.
    pub num_iterations: u64,
}
