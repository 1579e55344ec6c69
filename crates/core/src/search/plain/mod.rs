//! Ruin and recreate over routes whose cost is one sum of legs and services, the same both ways.
//!
//! ```text
//! too little time for neighbour lists? sectors toured along strips, smoothed, balanced; stop             rough, smooth
//! sectors around the depot, balanced by the cost of their tours, each toured along a Hilbert curve       construct, order
//! 2-opt and Or-opt on each route                                                                         improve
//! enough time? the same for up to 16 cuts of the farm; race them by ruin and recreate                    starts, population
//! a lot of time? keep 4 to 16 of them; until 88 % of the time:                                           population
//!     a child of two: some routes of one, side by side, the others of the other, the seam mended         recombine
//!     anneal it as below; give it what is better in the others                                           cycles, assemble
//!     even out its routes, as below; it replaces the worst, if it is better                              population
//!     even more time? 2 to 8 races with children first, one after the other; the best of all go on      islands
//! else, until 88 % of the time:                                                                          anneal
//!     take some ten visits out, as strings of neighbouring routes, half the time around the longest      ruin
//!     put each back where it is cheapest, a route that grows too long charged 10 or 1,000 times the excess;
//!     stop as soon as the plan is sure to be rejected                                                    recreate
//!     keep the plan if it is cheaper than now plus a random allowance that shrinks; else take it back    state
//! enough time? moves of up to five legs, of any routes; a route may become a tenth too long              lin_kernighan, moves
//! hand visits on from the longest route to others, and from those to third ones; both once more          balance
//! until the end: anneal for the total, with the longest route as a limit for all                         run
//!     halfway, unless there is slack, hand visits on once more, to the routes that became shorter        balance
//! threads share their best plan at 50 %, 70 % and 88 %                                                   cooperate
//! ```
//!
//! One step costs O(visits removed x neighbours), whatever the number of ponds and the length of the routes; memory is O(n).
//!
//! The modules, in reading order; each uses only those before it:
//!
//! 1. `limits`: what a route may use of things other than its cost.
//! 2. `network`: what is known about places: coordinates, leg costs, services, nearest neighbours.
//! 3. `order`: orders of points around a place and along a curve.
//! 4. `state`: a plan under change: routes as linked rings.
//! 5. `airspace`: a rule on which route may take which visit.
//! 6. `improve`: 2-opt and Or-opt on one route.
//! 7. `construct`: a first plan from sectors around the depot.
//! 8. `smooth`: the same as `improve` without neighbour lists, in passes.
//! 9. `rough`: a plan in less time than it takes to find neighbours.
//! 10. `ruin`: takes strings of neighbouring visits out.
//! 11. `recreate`: puts them back.
//! 12. `anneal`: a chain of such steps.
//! 13. `balance`: evens out the routes.
//! 14. `moves`: legs cut from several routes at once, joined in another way.
//! 15. `lin_kernighan`: moves of up to five legs over all routes.
//! 16. `cycles`: what one plan has and another has not, in parts that can be exchanged.
//! 17. `assemble`: puts into a plan what is better in another.
//! 18. `recombine`: makes a plan of two.
//! 19. `context`: what the parts of one search share.
//! 20. `starts`: the plans that a search begins with.
//! 21. `population`: several plans at once, and their children.
//! 22. `islands`: several populations, and the best of them together.
//! 23. `cooperate`: where threads meet.
//! 24. `run`: one search from start to end.

mod airspace;
mod anneal;
mod assemble;
mod balance;
mod construct;
mod context;
mod cooperate;
mod cycles;
mod improve;
mod islands;
mod limits;
mod lin_kernighan;
mod moves;
mod network;
mod order;
mod population;
mod recombine;
mod recreate;
mod rough;
mod ruin;
mod run;
mod smooth;
mod starts;
mod state;
#[cfg(test)]
mod testing;

pub(crate) use airspace::Airspace;
pub(crate) use anneal::{Chain, Schedule};
pub(crate) use construct::open_at_best_leg;
pub(crate) use improve::improve_routes;
pub(crate) use network::Network;
pub(crate) use order::{curve_keys, place_after_widest_gap, pseudo_angle};
pub(crate) use rough::smooth_routes;
pub(super) use run::solve;
pub(crate) use run::to_indices;
pub(crate) use state::State;
