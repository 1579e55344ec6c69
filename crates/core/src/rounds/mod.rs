//! Rounds of several trips: time windows, releases, loads and limits of a trip, for drones that come back between trips.
//!
//! The plain [`crate::problem::Problem`] is what a round is without all these; it has an engine of its own, which is faster.
//!
//! The modules, in reading order; each uses only those before it:
//!
//! 1. [`round`]: what is to be flown; validated once, then immutable.
//! 2. [`plan`]: the immutable result: routes of trips, their schedule, violations.
//! 3. [`judge`]: the one truth: a plan recomputed from a round and bare routes.
//! 4. [`bound`]: when the last drone lands at the earliest, and how many trips there are at least.

pub mod bound;
pub mod judge;
pub mod plan;
pub mod round;

pub use bound::{fewest_trips, makespan_bound};
pub use judge::{evaluate_held_round, evaluate_round};
pub use plan::{RoundPlan, RoundStop, RoundViolation, Trip};
pub use round::{Fleet, Round, RoundVisit, Rounding, TimeWindow};
