//! Min-max routing of a drone fleet over the ponds of an aquaculture farm.
//!
//! The modules, in reading order; each uses only those before it:
//!
//! 1. [`error`]: what can be wrong with an input, all faults at once.
//! 2. [`geometry`]: points and planar constructions, each citing its source.
//! 3. [`random`]: seeded random numbers, the same on every machine.
//! 4. [`generate`]: research farms, as the paper draws them.
//! 5. [`problem`]: what is to be planned; validated once, then immutable.
//! 6. [`travel`]: what a leg costs, and the local metric frame of a farm on the globe.
//! 7. [`plan`]: the immutable result: routes, schedule, violations.
//! 8. [`evaluate`]: the one truth: a plan recomputed from a problem and bare routes.
//! 9. [`kmeans`]: clusters of nearby points.
//! 10. [`sweep`]: back-and-forth coverage of a convex polygon.
//! 11. [`hpp`]: the paper's planner.
//! 12. [`separation`]: how well a plan keeps the drones apart.
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod error;
pub mod evaluate;
pub mod generate;
pub mod geometry;
pub mod hpp;
pub mod kmeans;
pub mod plan;
pub mod problem;
pub mod random;
pub mod separation;
pub mod sweep;
pub mod travel;
