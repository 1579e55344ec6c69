//! Ruin and recreate over trips with windows, loads and releases: the engine for what is more than one sum a route.
//!
//! ```text
//! every visit where it costs least; what fits nowhere waits in the bank                                  run
//! until the end:                                                                                         run
//!     take some ten visits out, as strings of neighbouring trips                                         ruin
//!     in an order drawn anew (far, near, early, late, narrow windows, large loads, at random),           recreate
//!         put each back where it adds the least length, into a trip of its own if that is least
//!     keep the plan if it is cheaper than now plus a random allowance that shrinks; else take it back    run
//! ```
//!
//! Source: Christiaens and Vanden Berghe, Slack Induction by String Removals, Transportation Science 2020; segments of trips:
//! Vidal, Crainic, Gendreau and Prins, Computers and Operations Research 2013. Changed: a drone may fly several trips, each a
//! list of its own, whose times hang together in `ready` and `after`; hard limits in all places, with a bank of what does not
//! fit; places are tried beside near neighbours and at the ends of trips only.
//!
//! One step costs O(visits removed x (neighbours + trips) + length of the trips changed).
//!
//! The modules, in reading order; each uses only those before it:
//!
//! 1. `segment`: the times of a piece of a trip, joined in constant time.
//! 2. `network`: what is known about places: legs, services, windows, nearest neighbours.
//! 3. `state`: a plan under change: routes of trips.
//! 4. `objective`: what is minimised.
//! 5. `ruin`: takes strings of neighbouring visits out.
//! 6. `recreate`: puts them back.
//! 7. `exchange`: moves whole trips between drones.
//! 8. `run`: one search from start to end.

mod exchange;
mod network;
mod objective;
mod recreate;
mod ruin;
mod run;
mod segment;
mod state;

pub use run::solve;
