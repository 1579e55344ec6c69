//! Min-max routing of a drone fleet over the ponds of an aquaculture farm.
//!
//! The modules, in reading order; each uses only those before it:
//!
//! 1. [`error`]: what can be wrong with an input, all faults at once.
//! 2. [`geometry`]: points and planar constructions, each citing its source.
//! 3. [`frame`]: the local metric frame of a farm on the globe.
//! 4. [`neighbours`]: nearest neighbours of points.
//! 5. [`random`]: seeded random numbers, the same on every machine.
//! 6. [`effort`]: how much of the effort is used: steps, time, or the wish to stop.
//! 7. [`generate`]: research farms, as the paper draws them.
//! 8. [`problem`]: what is to be planned; validated once, then immutable.
//! 9. [`travel`]: what a leg costs.
//! 10. [`direction`]: which way round a route is flown.
//! 11. [`plan`]: the immutable result: routes, schedule, violations.
//! 12. [`evaluate`]: the one truth: a plan recomputed from a problem and bare routes.
//! 13. [`separation`]: how well a plan keeps the drones apart.
//! 14. [`encounters`]: where drones come too near to each other at the same moment.
//! 15. [`bound`]: lower bounds: what no plan can beat.
//! 16. [`rounds`]: rounds of several trips with windows, their plans, their judge and their bounds.
//! 17. [`kmeans`]: clusters of nearby points.
//! 18. [`sweep`]: back-and-forth coverage of a convex polygon.
//! 19. [`hpp`]: the paper's planner.
//! 20. [`search`]: the min-max optimiser.
//! 21. [`territory`]: balanced routes in territories that do not overlap.
//! 22. [`attention`]: the attention model, a trained network that builds routes.
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod attention;
pub mod bound;
pub mod direction;
pub mod effort;
pub mod encounters;
pub mod error;
pub mod evaluate;
pub mod frame;
pub mod generate;
pub mod geometry;
pub mod hpp;
pub mod kmeans;
pub mod neighbours;
pub mod plan;
pub mod problem;
pub mod random;
pub mod rounds;
pub mod search;
pub mod separation;
pub mod sweep;
pub mod territory;
pub mod travel;
