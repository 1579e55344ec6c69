//! Territory: balanced routes, each in a territory of its own.
//!
//! Problem: that of [`crate::search`], with the further condition that the convex hulls of different routes do not touch. Then
//! no two drones fly over the same place except on their ways from and to the depot. It is HPP as its authors wish it in their
//! future work: clusters balanced so that the longest route is shortest, and routes optimised (Davis et al., section 5).
//!
//! Method ([`plan`]): many ways of cutting the farm along straight lines, balanced by estimate ([`cuts`]); the most promising
//! ones toured, improved by 2-opt and Or-opt and balanced again by the costs of their tours; from the best, ruin and recreate
//! under annealing as in [`crate::search`], where a visit may change its route only if the hulls stay apart ([`hulls`]).
//! O(n log n) for the cuts, O(visits of a route) for a change of the territories; memory O(n).

mod cuts;
mod hulls;

use crate::problem::Problem;
use crate::random::Random;
use crate::search::{
    Budget, Chain, Clock, Network, Objective, Schedule, State, curve_keys, improve_routes, open_at_best_leg, to_indices,
};
use cuts::{Cut, Cutter, Estimate, draw_cuts};
use hulls::Hulls;

/// Ways of cutting that are tried by estimate.
const NUM_DRAWN: usize = 48;
/// How many of them are toured.
const NUM_TOURED: usize = 6;
/// How often the toured ones are balanced by the costs of their tours.
const NUM_BALANCINGS: usize = 2;
/// Steps per visit where no time limit is given.
const STEPS_PER_VISIT: u64 = 20;
/// Share of the effort at which the work on the longest route ends and that on the total begins.
const MAX_END: f64 = 0.9;
/// Temperatures relative to the longest route.
const MAX_HEAT: (f64, f64) = (1e-3, 1e-6);
const TOTAL_HEAT: (f64, f64) = (1e-3, 3e-6);
/// Weight of the mean route beside the longest.
const MEAN_WEIGHT: f64 = 0.02;

/// Plans routes for `problem` whose hulls do not overlap: visit indices in flying order, every visit once, at most one route
/// per drone, none empty. Where visits share a place, hulls may share that place.
///
/// `clock` tells the share of the time limit used so far; without one the effort is a fixed number of steps per visit, and the
/// same `seed` gives the same routes.
#[must_use]
pub fn plan(problem: &Problem, seed: u64, clock: Option<Clock<'_>>) -> Vec<Vec<usize>> {
    let mut network = Network::new(problem);
    network.find_neighbours();
    let network = &network;
    let max_iterations = clock.is_none().then_some(STEPS_PER_VISIT * network.num_visits as u64);
    let budget = Budget::new(max_iterations, clock, None);
    let mut random = Random::new(seed);
    let tours = best_tours(network, &budget, &mut random);
    let state = State::new(network, &tours);
    let objective = Objective {
        max_weight: 1.0,
        total_weight: MEAN_WEIGHT / network.num_routes as f64,
        cap: f64::INFINITY,
        target: state.max_route_cost(),
    };
    let mut chain = Chain::new(state, objective, seed, Hulls::new(network, &tours));
    anneal(network, &budget, &mut chain, MAX_END, MAX_HEAT);
    let longest = chain.best.max_route_cost();
    chain.restart(Objective { max_weight: 0.0, total_weight: 1.0, cap: longest, target: longest });
    anneal(network, &budget, &mut chain, 1.0, TOTAL_HEAT);
    to_indices(chain.best.routes(network))
}

fn anneal(network: &Network, budget: &Budget<'_>, chain: &mut Chain<Hulls<'_>>, end: f64, (hot, cold): (f64, f64)) {
    let scale = chain.best.max_route_cost();
    let schedule = Schedule { begin: budget.share(chain.num_iterations), end, hot: hot * scale, cold: cold * scale };
    chain.anneal(network, budget, &schedule, end, 0.0);
}

struct Candidate {
    cuts: Vec<Cut>,
    estimate: Estimate,
    longest: f64,
}

/// Tours of the best of many ways of cutting the farm.
fn best_tours(network: &Network, budget: &Budget<'_>, random: &mut Random) -> Vec<Vec<u32>> {
    let mut cutter = Cutter::new(network);
    let estimate = Estimate::new(network);
    let draw = |_| {
        let mut cuts = Vec::with_capacity(network.num_routes);
        draw_cuts(network.num_routes, random, &mut cuts);
        let mut estimate = estimate.clone();
        let parts = cutter.parts(&cuts, &estimate);
        estimate.learn_approaches(network, &parts);
        let parts = cutter.parts(&cuts, &estimate);
        let longest = estimate.learn_approaches(network, &parts);
        Candidate { cuts, estimate, longest }
    };
    let mut candidates: Vec<Candidate> = (0..NUM_DRAWN).map(draw).collect();
    candidates.sort_by(|a, b| a.longest.total_cmp(&b.longest));
    let curve_keys = curve_keys(&network.points[..network.num_visits]);
    let mut best = (f64::INFINITY, Vec::new());
    let mut num_toured = 0;
    for mut candidate in candidates {
        if num_toured >= NUM_TOURED {
            break;
        }
        let parts = cutter.parts(&candidate.cuts, &candidate.estimate);
        if !Hulls::new(network, &parts).are_apart() {
            continue;
        }
        num_toured += 1;
        for _ in 0..=NUM_BALANCINGS {
            let mut tours = cutter.parts(&candidate.cuts, &candidate.estimate);
            let are_apart = Hulls::new(network, &tours).are_apart();
            for tour in &mut tours {
                tour.sort_unstable_by_key(|&visit| (curve_keys[visit as usize], visit));
                open_at_best_leg(network, tour);
            }
            improve_routes(network, budget, &mut tours);
            let longest = candidate.estimate.learn_costs(network, &tours);
            if are_apart && longest < best.0 {
                best = (longest, tours);
            }
        }
    }
    best.1
}
