//! Min-max routing of a drone fleet over the ponds of an aquaculture farm.
//!
//! The modules, in reading order; each uses only those before it:
//!
//! 1. [`error`]: what can be wrong with an input, all faults at once.
//! 2. [`geometry`]: points and planar constructions, each citing its source.
//! 3. [`neighbours`]: nearest neighbours of points.
//! 4. [`random`]: seeded random numbers, the same on every machine.
//! 5. [`effort`]: how much of the effort is used: steps, time, or the wish to stop.
//! 6. [`generate`]: research farms, as the paper draws them.
//! 7. [`problem`]: what is to be planned; validated once, then immutable.
//! 8. [`travel`]: what a leg costs, and the local metric frame of a farm on the globe.
//! 9. [`plan`]: the immutable result: routes, schedule, violations.
//! 10. [`evaluate`]: the one truth: a plan recomputed from a problem and bare routes.
//! 11. [`separation`]: how well a plan keeps the drones apart.
//! 12. [`bound`]: lower bounds: what no plan can beat.
//! 13. [`kmeans`]: clusters of nearby points.
//! 14. [`sweep`]: back-and-forth coverage of a convex polygon.
//! 15. [`hpp`]: the paper's planner.
//! 16. [`search`]: the min-max optimiser.
//! 17. [`territory`]: balanced routes in territories that do not overlap.
//! 18. [`attention`]: the attention model, a trained network that builds routes.
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod attention;
pub mod bound;
pub mod effort;
pub mod error;
pub mod evaluate;
pub mod generate;
pub mod geometry;
pub mod hpp;
pub mod kmeans;
pub mod neighbours;
pub mod plan;
pub mod problem;
pub mod random;
pub mod search;
pub mod separation;
pub mod sweep;
pub mod territory;
pub mod travel;
