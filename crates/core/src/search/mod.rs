//! The min-max optimiser: minimises the costliest route, then the total.
//!
//! Problem: one depot, m equal drones, every visit once; the single-depot min-max multiple travelling salesman problem, with
//! service times and a fixed time per leg. Costs are seconds, which in a research instance are length units.
//!
//! The modules, in reading order; each uses only those before it, and this one alone chooses the engine:
//!
//! 1. `options`: what to search for, how long, and what a search found.
//! 2. `objective`: what is minimised, and by what plans are compared.
//! 3. `plain`: the engine for what is one number a route, the same both ways: all that farms are planned with today.
//! 4. `petals`: a first plan of many trips, by the plain engine.
//! 5. `timed`: the engine for trips with windows, loads and releases.
//!
//! `docs/explanation/search.md` says what was tried and what it gave.

mod objective;
mod options;
mod petals;
mod plain;
mod timed;

use crate::problem::Problem;
use crate::rounds::Round;
pub(crate) use objective::{Objective, Rank};
pub use options::{Goal, Options, Outcome, RoundOutcome};
pub(crate) use plain::{
    Airspace, Chain, Network, Schedule, State, curve_keys, improve_routes, open_at_best_leg, place_after_widest_gap,
    pseudo_angle, smooth_routes, to_indices,
};

/// Plans routes for `problem`, each of at least one visit, at most one per drone.
///
/// # Panics
/// If [`Options::start`] names a visit that does not exist or misses one: check it with [`crate::evaluate::evaluate`].
#[must_use]
pub fn solve(problem: &Problem, options: &Options<'_>) -> Outcome {
    plain::solve(problem, options)
}

/// Plans trips for `round` so that the last drone lands early, or what all fly is short, as the goal says; the visits of most
/// priority come first where not all can be made. Threads search each for itself; slack and start of the options are without effect.
#[must_use]
pub fn solve_round(round: &Round, options: &Options<'_>) -> RoundOutcome {
    let start = petals::petals(round, options.seed).unwrap_or_default();
    timed::solve(round, &start, options)
}
