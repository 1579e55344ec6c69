//! Makes a plan of two: neighbouring routes of one among the routes of the other, and the better parts of each.
//!
//! Problem: runs of the search end in plans that are almost equally good but differ in a fifth of their visits, and a longer
//! run of one is no better than several short ones. What each of them found must be put together.
//!
//! Sources: [`cross`] inherits whole routes like the crossover of Mahmoudinazlou and Kwon, Computers & Operations Research
//! 2024 (HGA), except that the routes taken lie side by side, so that only the seam between the parents has to be mended.
//! [`blend`] is the partition crossover of Whitley, Hains and Howe, GECCO 2009, for closed routes through a depot: the edges
//! that only one parent has fall into components that can be exchanged one by one. Changed: components are judged by the
//! longest route, and kept one after the other. [`cross`] costs O(n); [`blend`] O(n) for each of at most
//! [`MAX_PARTS`] components.

use super::airspace::SharedAirspace;
use super::construct::pseudo_angle;
use super::network::Network;
use super::recreate::{Objective, Recreate};
use super::state::{ABSENT, AFTER, BEFORE, Node, RouteCosts, State, Touched};
use crate::random::Random;

/// Runs of routes tried for one child.
const NUM_RUNS: usize = 8;
/// Components tried for one blend; those that change the total most come first.
const MAX_PARTS: usize = 64;

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
    let objective = Objective { target, ..Objective::longest_route(network, keeper) };
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

/// `base` with those components of `donor` that make it better by `objective`; `None` if there are none.
pub(super) fn blend(network: &Network, base: &State, donor: &State, objective: &Objective) -> Option<State> {
    let mut kept = links(network, base);
    let offered = links(network, donor);
    let parts = differing_parts(network, &kept, &offered);
    let mut value = objective.value(base);
    let mut is_better = false;
    let mut walk = Walk::new(network);
    for part in parts.iter().take(MAX_PARTS) {
        let replaced: Vec<[Link; 2]> = part.iter().map(|&visit| kept[visit as usize]).collect();
        for &visit in part {
            kept[visit as usize] = offered[visit as usize];
        }
        let new_value = walk.follow(network, &kept).map_or(f64::INFINITY, |costs| objective.value_of(costs));
        if new_value < value {
            (value, is_better) = (new_value, true);
        } else {
            for (&visit, &old) in part.iter().zip(&replaced) {
                kept[visit as usize] = old;
            }
        }
    }
    is_better.then(|| State::new(network, &walk.routes(network, &kept)))
}

/// What a visit is joined to: another visit, or the depot, which is `num_visits`.
#[derive(Clone, Copy, Debug)]
struct Link {
    leg: f64,
    to: u32,
}

/// Both links of each visit.
fn links(network: &Network, state: &State) -> Vec<[Link; 2]> {
    let depot = network.num_visits as u32;
    let both = |node: &Node| {
        let before = Link { leg: node.legs[BEFORE], to: node.previous.min(depot) };
        [before, Link { leg: node.legs[AFTER], to: node.next.min(depot) }]
    };
    state.nodes[..network.num_visits].iter().map(both).collect()
}

/// Visits whose links differ, in components that can be exchanged one by one; those that change the total most come first.
fn differing_parts(network: &Network, old: &[[Link; 2]], new: &[[Link; 2]]) -> Vec<Vec<u32>> {
    let depot = network.num_visits as u32;
    let mut components = Components::new(network.num_visits);
    // Per visit: change of the cost (half a leg at each of its ends) and of the number of routes that end there.
    let mut changes = vec![None; network.num_visits];
    for visit in 0..network.num_visits {
        let (mut removed, mut added) = (old[visit].to_vec(), new[visit].to_vec());
        added.retain(|link| match removed.iter().position(|other| other.to == link.to) {
            Some(place) => {
                removed.swap_remove(place);
                false
            }
            None => true,
        });
        if added.is_empty() {
            continue;
        }
        let (mut cost, mut num_ends) = (0.0, 0);
        for (link, sign) in removed.iter().map(|link| (link, -1)).chain(added.iter().map(|link| (link, 1))) {
            if link.to == depot {
                num_ends += sign;
                cost += f64::from(sign) * link.leg;
            } else {
                components.join(visit as u32, link.to);
                cost += f64::from(sign) * link.leg / 2.0;
            }
        }
        changes[visit] = Some((cost, num_ends));
    }
    let mut parts: Vec<(f64, i32, Vec<u32>)> = Vec::new();
    let mut part_of = vec![usize::MAX; network.num_visits];
    for (visit, change) in changes.iter().enumerate() {
        let Some((cost, num_ends)) = *change else { continue };
        let part = &mut part_of[components.root(visit as u32) as usize];
        if *part == usize::MAX {
            *part = parts.len();
            parts.push((0.0, 0, Vec::new()));
        }
        let part = &mut parts[*part];
        part.0 += cost;
        part.1 += num_ends;
        part.2.push(visit as u32);
    }
    // Parts that give the depot another number of ends cannot go alone; together they even out.
    let (mut parts, odd): (Vec<_>, Vec<_>) = parts.into_iter().partition(|part| part.1 == 0);
    if !odd.is_empty() {
        let cost = odd.iter().map(|part| part.0).sum();
        parts.push((cost, 0, odd.into_iter().flat_map(|part| part.2).collect()));
    }
    parts.sort_by(|a, b| a.0.total_cmp(&b.0));
    parts.into_iter().map(|part| part.2).collect()
}

/// Sets of visits that grow together (union-find with halved paths).
struct Components {
    parents: Vec<u32>,
}

impl Components {
    fn new(num_visits: usize) -> Self {
        Self { parents: (0..num_visits as u32).collect() }
    }

    fn root(&mut self, visit: u32) -> u32 {
        let mut at = visit as usize;
        while self.parents[at] as usize != at {
            self.parents[at] = self.parents[self.parents[at] as usize];
            at = self.parents[at] as usize;
        }
        at as u32
    }

    fn join(&mut self, one: u32, other: u32) {
        let (one, other) = (self.root(one), self.root(other));
        self.parents[one as usize] = other;
    }
}

/// Follows links from the depot back to the depot.
struct Walk {
    /// Number of the last walk that came by each visit.
    seen_in: Vec<u32>,
    number: u32,
}

impl Walk {
    fn new(network: &Network) -> Self {
        Self { seen_in: vec![0; network.num_visits], number: 0 }
    }

    /// What the routes cost; `None` if some visits are on a ring of their own.
    fn follow(&mut self, network: &Network, links: &[[Link; 2]]) -> Option<RouteCosts> {
        let (mut longest, mut total, mut num_seen) = (0.0_f64, 0.0, 0);
        let mut cost = 0.0;
        self.each_step(network, links, |step| match step {
            Step::Start(link) => cost = link.leg,
            Step::Visit(visit, link) => {
                num_seen += 1;
                cost += network.services[visit as usize] + link.leg;
                if link.to as usize == network.num_visits {
                    longest = longest.max(cost);
                    total += cost;
                }
            }
        });
        (num_seen == network.num_visits).then_some(RouteCosts { longest, total })
    }

    fn routes(&mut self, network: &Network, links: &[[Link; 2]]) -> Vec<Vec<u32>> {
        let mut routes: Vec<Vec<u32>> = Vec::with_capacity(network.num_routes);
        self.each_step(network, links, |step| match step {
            Step::Start(_) => routes.push(Vec::new()),
            Step::Visit(visit, _) => routes.last_mut().into_iter().for_each(|route| route.push(visit)),
        });
        routes
    }

    fn each_step(&mut self, network: &Network, links: &[[Link; 2]], mut tell: impl FnMut(Step)) {
        let depot = network.num_visits as u32;
        self.number += 1;
        for first in 0..depot {
            let Some(start) = links[first as usize].iter().find(|link| link.to == depot) else { continue };
            if self.seen_in[first as usize] == self.number {
                continue;
            }
            tell(Step::Start(*start));
            let (mut last, mut at) = (depot, first);
            while at != depot {
                self.seen_in[at as usize] = self.number;
                let [one, other] = links[at as usize];
                let onward = if one.to == last { other } else { one };
                tell(Step::Visit(at, onward));
                (last, at) = (at, onward.to);
            }
        }
    }
}

/// A step of a walk.
enum Step {
    /// A route begins by this link.
    Start(Link),
    /// At a visit, which is left by this link.
    Visit(u32, Link),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Variant, generate};
    use crate::geometry::Point;
    use crate::problem::Problem;
    use crate::search::{Options, solve, to_nodes};

    fn network(depot: Point, ponds: &[Point], num_routes: usize) -> Network {
        let mut network = Network::new(&Problem::research(depot, ponds, num_routes).unwrap());
        network.find_neighbours();
        network
    }

    /// The cheapest plan of a total, longest route and mean alike.
    const TOTAL: Objective =
        Objective { max_weight: 0.0, total_weight: 1.0, cap: f64::INFINITY, target: f64::INFINITY };

    /// Two routes away from the depot in opposite directions: a plan makes detours on the left, another on the right.
    #[test]
    fn a_blend_has_the_better_half_of_each() {
        let side = [(1.0, 0.0), (2.0, 1.0), (3.0, 0.0), (2.0, -1.0)];
        let ponds: Vec<Point> =
            [1.0, -1.0].into_iter().flat_map(|sign| side.map(|(x, y)| Point::new(sign * x, y))).collect();
        let network = network(Point::new(0.0, 0.0), &ponds, 2);
        let (around, zigzag) = (vec![0, 1, 2, 3], vec![1, 3, 0, 2]);
        let left = |route: &[u32]| route.iter().map(|visit| visit + 4).collect::<Vec<u32>>();
        let one = State::new(&network, &[around.clone(), left(&zigzag)]);
        let other = State::new(&network, &[zigzag, left(&around)]);
        let both = State::new(&network, &[around.clone(), left(&around)]);
        for (base, donor) in [(&one, &other), (&other, &one)] {
            let best = blend(&network, base, donor, &TOTAL).unwrap();
            assert!((best.total - both.total).abs() < 1e-12);
        }
        assert!(blend(&network, &both, &one, &TOTAL).is_none());
        assert!(blend(&network, &both, &both, &TOTAL).is_none());
    }

    #[test]
    fn a_giver_with_one_route_makes_a_twin_of_the_keeper() {
        let ponds = [1.0, 2.0, 3.0].map(|x| Point::new(x, 0.0));
        let network = network(Point::new(0.0, 0.0), &ponds, 2);
        let keeper = State::new(&network, &[vec![0, 2], vec![1]]);
        let giver = State::new(&network, &[vec![0, 1, 2]]);
        let child = cross(&network, &keeper, &giver, &mut Random::new(1));
        assert_eq!(child.routes(&network), keeper.routes(&network));
    }

    #[test]
    fn exchanges_that_close_a_ring_are_left_out() {
        // One route of two squares far from each other: the donor's links within each would cut it into two rings.
        let square = [(1.0, 0.0), (1.0, 1.0), (2.0, 1.0), (2.0, 0.0)];
        let ponds: Vec<Point> =
            [0.0, 10.0].into_iter().flat_map(|x| square.map(|(dx, y)| Point::new(x + dx, y))).collect();
        let network = network(Point::new(0.0, 0.0), &ponds, 1);
        let mut links = links(&network, &State::new(&network, &[vec![0, 1, 5, 6, 7, 4, 2, 3]]));
        let mut walk = Walk::new(&network);
        assert!(walk.follow(&network, &links).is_some());
        let link = |from: usize, to: usize| Link { leg: network.leg(from as u32, to as u32), to: to as u32 };
        (links[1][1], links[2][0]) = (link(1, 2), link(2, 1));
        (links[5][0], links[4][1]) = (link(5, 4), link(4, 5));
        assert!(walk.follow(&network, &links).is_none());
    }

    /// Plans of several seeds of a farm.
    fn plans(num_ponds: usize, num_routes: usize) -> (Network, Vec<State>) {
        let farm = generate(num_ponds, Variant::Authors, 5).unwrap();
        let problem = Problem::research(farm.depot, &farm.ponds, num_routes).unwrap();
        let network = network(farm.depot, &farm.ponds, num_routes);
        let plan = |seed| {
            let options = Options { seed, max_iterations: Some(500), ..Options::default() };
            State::new(&network, &to_nodes(&solve(&problem, &options).routes))
        };
        let states = (1..12).map(plan).collect();
        (network, states)
    }

    fn assert_every_visit_once(network: &Network, state: &State) {
        let mut visits: Vec<u32> = state.routes(network).concat();
        visits.sort_unstable();
        assert_eq!(visits, (0..network.num_visits as u32).collect::<Vec<_>>());
        let costs = state.routes(network).iter().map(|route| network.route_cost(route)).sum::<f64>();
        assert!((costs - state.total).abs() < 1e-9 * costs);
    }

    #[test]
    fn children_make_every_visit_once_and_blends_are_never_worse() {
        let mut random = Random::new(3);
        let mut num_blends = 0;
        for (num_ponds, num_routes) in [(30, 3), (120, 5), (40, 40)] {
            let (network, states) = plans(num_ponds, num_routes);
            for (base, donor) in states.iter().zip(&states[1..]) {
                assert_every_visit_once(&network, &cross(&network, base, donor, &mut random));
                let objective = Objective::longest_route(&network, base);
                let Some(better) = blend(&network, base, donor, &objective) else { continue };
                num_blends += 1;
                assert_every_visit_once(&network, &better);
                assert!(objective.value(&better) < objective.value(base));
                let num_routes = better.routes(&network).len();
                assert!([base, donor].iter().any(|parent| parent.routes(&network).len() == num_routes));
            }
        }
        assert!(num_blends > 3);
    }
}
