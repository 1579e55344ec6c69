//! Min-max routing of a drone fleet over the ponds of an aquaculture farm.
//!
//! The modules, in reading order; each uses only those before it:
//!
//! 1. [`error`]: what can be wrong with an input, all faults at once.
//! 2. [`geometry`]: points and planar constructions, each citing its source.
//! 3. [`problem`]: what is to be planned; validated once, then immutable.
//! 4. [`travel`]: what a leg costs, and the local metric frame of a farm on the globe.
//! 5. [`plan`]: the immutable result: routes, schedule, violations.
//! 6. [`evaluate`]: the one truth: a plan recomputed from a problem and bare routes.
//! 7. [`kmeans`]: clusters of nearby points.
//! 8. [`hpp`]: the paper's planner.
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod error;
pub mod evaluate;
pub mod geometry;
pub mod hpp;
pub mod kmeans;
pub mod plan;
pub mod problem;
pub mod random;
pub mod travel;
