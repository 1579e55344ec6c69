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
mod context;
mod cooperate;
mod cycles;
mod improve;
mod lin_kernighan;
mod moves;
mod network;
mod objective;
mod options;
mod order;
mod population;
mod recombine;
mod recreate;
mod rough;
mod ruin;
mod run;
mod smooth;
mod state;
#[cfg(test)]
mod testing;

pub(crate) use airspace::Airspace;
pub(crate) use anneal::{Chain, Schedule};
pub(crate) use construct::open_at_best_leg;
pub(crate) use improve::improve_routes;
pub(crate) use network::Network;
pub(crate) use objective::Objective;
pub use options::{Goal, Options, Outcome};
pub(crate) use order::{curve_keys, place_after_widest_gap, pseudo_angle};
pub use run::solve;
pub(crate) use run::to_indices;
pub(crate) use state::State;
