//! Makes a plan of two: neighbouring routes of one among the routes of the other. Or of one: some neighbouring routes cut anew.
//!
//! Problem: runs of the search end in plans that are almost equally good but differ in a fifth of their visits, and a longer
//! run of one is no better than several short ones. What each of them found must be put together.
//!
//! Source: whole routes are inherited as by the crossover of Mahmoudinazlou and Kwon, Computers & Operations Research 2024
//! (HGA). Changed: the routes taken lie side by side, so that only the seam between the parents has to be mended. O(n).

use super::airspace::SharedAirspace;
use super::construct::Cuts;
use super::improve::improve_routes;
use super::network::Network;
use super::order::pseudo_angle;
use super::recreate::Recreate;
use super::state::{ABSENT, State, Touched};
use crate::effort::Budget;
use crate::random::Random;
use crate::search::objective::Objective;

/// Runs of routes tried for one child.
const NUM_RUNS: usize = 8;
/// Visits passed on the way to neighbouring routes, at most.
const MAX_WALK: usize = 64;

/// A child that takes a run of routes from `giver`, neighbours by their angle around the depot, and the other routes from
/// `keeper`; the best by total of [`NUM_RUNS`] random runs. What is then in no route is put back where it is cheapest. A giver
/// with one route has none to give: the child is then the keeper's twin.
pub(super) fn cross(network: &Network, keeper: &State, giver: &State, random: &mut Random) -> State {
    let order = routes_by_angle(network, giver);
    if order.len() < 2 {
        return keeper.clone();
    }
    let children = (0..NUM_RUNS).filter_map(|_| {
        let (first, count) = (random.below(order.len()), 1 + random.below(order.len() - 1));
        let mut is_taken = vec![false; network.num_routes];
        for place in first..first + count {
            is_taken[order[place % order.len()] as usize] = true;
        }
        inherit(network, keeper, giver, &is_taken, random)
    });
    let shorter = |best: State, child: State| if child.total < best.total { child } else { best };
    children.reduce(shorter).unwrap_or_else(|| keeper.clone())
}

/// The plan of `keeper` with two or three of its routes, neighbours of each other, cut anew at random.
pub(super) fn recut(
    network: &Network,
    budget: &Budget<'_>,
    cuts: &Cuts<'_>,
    keeper: &State,
    random: &mut Random,
) -> State {
    let chosen = neighbouring_routes(network, keeper, 2 + random.below(2), random);
    let (cut, kept): (Vec<usize>, Vec<usize>) = (0..network.num_routes).partition(|route| chosen.contains(route));
    let mut visits: Vec<u32> = cut.iter().flat_map(|&route| keeper.route(network, route)).collect();
    let mut routes = cuts.cut_at_random(&mut visits, cut.len(), random);
    improve_routes(network, budget, &mut routes);
    routes.extend(kept.iter().map(|&route| keeper.route(network, route)));
    State::new(network, &routes)
}

/// Up to `num_routes` routes that a random walk from neighbour to neighbour meets.
fn neighbouring_routes(network: &Network, state: &State, num_routes: usize, random: &mut Random) -> Vec<usize> {
    let mut visit = random.below(network.num_visits) as u32;
    let mut met = Vec::with_capacity(num_routes);
    for _ in 0..MAX_WALK {
        let route = state.nodes[visit as usize].route as usize;
        if !met.contains(&route) {
            met.push(route);
        }
        let neighbours = network.neighbours(visit);
        if met.len() == num_routes || neighbours.is_empty() {
            break;
        }
        visit = neighbours[random.below(neighbours.len())].node;
    }
    met
}

/// Routes that are not empty, by the angle of their middle around the depot.
fn routes_by_angle(network: &Network, state: &State) -> Vec<u32> {
    let depot = network.depot();
    let mut middles = vec![(0.0, 0.0); network.num_routes];
    for (point, node) in network.points[..network.num_visits].iter().zip(&state.nodes) {
        let middle = &mut middles[node.route as usize];
        *middle = (middle.0 + point.x - depot.x, middle.1 + point.y - depot.y);
    }
    let mut order: Vec<u32> =
        (0..network.num_routes as u32).filter(|&route| state.route_sizes[route as usize] > 0).collect();
    let angle = |route: u32| pseudo_angle(middles[route as usize].0, middles[route as usize].1);
    order.sort_by(|&a, &b| angle(a).total_cmp(&angle(b)));
    order
}

/// The routes of `giver` that are taken, and of `keeper` those that lose least by it; `None` if a visit finds no place.
fn inherit(network: &Network, keeper: &State, giver: &State, is_taken: &[bool], random: &mut Random) -> Option<State> {
    let goes_with_giver = |visit: u32| is_taken[giver.nodes[visit as usize].route as usize];
    let mut num_lost = vec![0u32; network.num_routes];
    for visit in 0..network.num_visits as u32 {
        num_lost[keeper.nodes[visit as usize].route as usize] += u32::from(goes_with_giver(visit));
    }
    let share_lost = |route: usize| f64::from(num_lost[route]) / f64::from(keeper.route_sizes[route]);
    let mut kept: Vec<usize> = (0..network.num_routes).filter(|&route| keeper.route_sizes[route] > 0).collect();
    kept.sort_by(|&a, &b| share_lost(a).total_cmp(&share_lost(b)));
    let mut routes: Vec<Vec<u32>> =
        (0..network.num_routes).filter(|&route| is_taken[route]).map(|route| giver.route(network, route)).collect();
    for &route in kept.iter().take(network.num_routes - routes.len()) {
        let mut visits = keeper.route(network, route);
        visits.retain(|&visit| !goes_with_giver(visit));
        routes.push(visits);
    }
    let mut child = State::new(network, &routes);
    let missing: Vec<u32> =
        (0..network.num_visits as u32).filter(|&visit| child.nodes[visit as usize].route == ABSENT).collect();
    let target = keeper.max_route_cost().min(giver.max_route_cost());
    let objective = Objective { target, ..Objective::longest_route(network.num_routes, keeper.costs()) };
    let is_complete = Recreate::new(network).insert(
        network,
        &mut child,
        &missing,
        &objective,
        f64::INFINITY,
        &mut SharedAirspace,
        random,
        &mut Touched::default(),
    );
    is_complete.then_some(child)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Variant, generate};
    use crate::geometry::Point;
    use crate::problem::Problem;
    use crate::search::plain::run::to_nodes;
    use crate::search::plain::testing::{self, research_network};
    use crate::search::{Options, solve};

    #[test]
    fn a_giver_with_one_route_makes_a_twin_of_the_keeper() {
        let ponds = [1.0, 2.0, 3.0].map(|x| Point::new(x, 0.0));
        let network = research_network(Point::new(0.0, 0.0), &ponds, 2);
        let keeper = State::new(&network, &[vec![0, 2], vec![1]]);
        let giver = State::new(&network, &[vec![0, 1, 2]]);
        let child = cross(&network, &keeper, &giver, &mut Random::new(1));
        assert_eq!(child.routes(&network), keeper.routes(&network));
    }

    /// Plans of several seeds of a farm.
    fn plans(num_ponds: usize, num_routes: usize) -> (Network, Vec<State>) {
        let farm = generate(num_ponds, Variant::Authors, 5).unwrap();
        let problem = Problem::research(farm.depot, &farm.ponds, num_routes).unwrap();
        let network = research_network(farm.depot, &farm.ponds, num_routes);
        let plan = |seed| {
            let options = Options { seed, max_iterations: Some(500), ..Options::default() };
            State::new(&network, &to_nodes(&solve(&problem, &options).routes))
        };
        let states = (1..12).map(plan).collect();
        (network, states)
    }

    fn assert_is_sound(network: &Network, state: &State) {
        testing::assert_every_visit_once(network, state);
        let costs = state.routes(network).iter().map(|route| network.route_cost(route)).sum::<f64>();
        assert!((costs - state.total).abs() < 1e-9 * costs);
    }

    #[test]
    fn children_make_every_visit_once() {
        let mut random = Random::new(3);
        for (num_ponds, num_routes) in [(30, 3), (120, 5), (40, 40)] {
            let (network, states) = plans(num_ponds, num_routes);
            for (keeper, giver) in states.iter().zip(&states[1..]) {
                assert_is_sound(&network, &cross(&network, keeper, giver, &mut random));
            }
        }
    }

    #[test]
    fn a_plan_cut_anew_keeps_all_but_two_or_three_of_its_routes() {
        let mut random = Random::new(3);
        for (num_ponds, num_routes) in [(2, 2), (30, 3), (120, 8), (40, 40)] {
            let (network, states) = plans(num_ponds, num_routes);
            let cuts = Cuts::new(&network);
            let mut num_changed = 0;
            for keeper in &states {
                let child = recut(&network, &testing::unlimited(), &cuts, keeper, &mut random);
                assert_is_sound(&network, &child);
                let (before, after) = (keeper.routes(&network), child.routes(&network));
                let num_kept = before.iter().filter(|route| after.contains(route)).count();
                assert!(num_kept + 3 >= before.len(), "{num_kept} of {} kept", before.len());
                num_changed += usize::from(num_kept < before.len());
            }
            // Single visits leave nothing to cut otherwise.
            assert!(num_changed > 0 || num_ponds == num_routes, "{num_ponds} ponds: every child is its parent");
        }
    }
}
