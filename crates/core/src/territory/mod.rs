//! Territory: balanced routes, each in a territory of its own.
//!
//! Problem: that of [`crate::search`], with the further condition that the convex hulls of different routes do not touch. Then
//! no two drones fly over the same place except on their ways from and to the depot. It is HPP as its authors wish it in their
//! future work: clusters balanced so that the longest route is shortest, and routes optimised (Davis et al., section 5).
//!
//! Method ([`plan`]): many ways of cutting the farm along straight lines, balanced by estimate (`cuts`); the most promising
//! ones toured, improved by 2-opt and Or-opt and balanced again by the costs of their tours; from the best, ruin and recreate
//! under annealing as in [`crate::search`], where a visit may change its route only if the hulls stay apart (`hulls`).
//! O(n log n) for the cuts, O(visits of a route) for a change of the territories; memory O(n).

mod cuts;
mod exact;
mod hulls;

use crate::effort::{Budget, Clock, Effort, Watch};
use crate::geometry::Point;
use crate::problem::Problem;
use crate::random::Random;
use crate::search::{
    Chain, Network, Objective, Rank, Schedule, State, curve_keys, improve_routes, open_at_best_leg, smooth_routes,
    to_indices,
};
use cuts::{Cut, Cutter, Draw};
use exact::compare;
use hulls::Hulls;

/// Ways of cutting that are drawn.
const NUM_DRAWN: usize = 64;
/// How many of the best of them are toured; more would not show in the plans.
const NUM_TOURED: usize = 4;
/// Items for which cuts are judged: enough to tell good cuts from bad ones, whatever the number of ponds.
const NUM_ITEMS: usize = 128;
/// Items per route, at least.
const NUM_ITEMS_PER_ROUTE: usize = 8;
/// How often tours are balanced by their costs; without it plans were 2 % longer, and a third time gained nothing.
const NUM_BALANCINGS: usize = 2;
/// Steps per visit where no time limit is given.
const STEPS_PER_VISIT: u64 = 4;
/// Shares of the effort at which drawing ends, and touring.
const DRAWING_END: f64 = 0.2;
const TOURING_END: f64 = 0.5;
/// Share of the effort at which the work on the longest route ends and that on the total begins.
const MAX_END: f64 = 0.9;
/// How long it takes to find neighbours and to make use of them, in times of making strips.
const NEIGHBOURS_COST: f64 = 10.0;
/// Temperatures relative to the longest route.
const MAX_HEAT: (f64, f64) = (1e-3, 1e-6);
const TOTAL_HEAT: (f64, f64) = (1e-3, 3e-6);

/// How long to plan. Without an iteration limit and a clock the effort is a fixed number of steps per visit.
#[derive(Clone, Copy)]
pub struct Options<'a> {
    /// Same seed and iterations, and no clock: same routes.
    pub seed: u64,
    /// Steps.
    pub max_iterations: Option<u64>,
    /// Share of the time limit used so far.
    pub clock: Option<Clock<'a>>,
    /// Told how far the planner is; may end it with the best plan so far.
    pub watch: Option<Watch<'a>>,
}

impl Default for Options<'_> {
    fn default() -> Self {
        Self { seed: 1, max_iterations: None, clock: None, watch: None }
    }
}

/// Plans routes for `problem` whose hulls do not touch: visit indices in flying order, every visit once, at most one route per
/// drone, none empty. Visits in one place are on one route.
#[must_use]
pub fn plan(problem: &Problem, options: &Options<'_>) -> Vec<Vec<usize>> {
    let Options { seed, max_iterations, clock, watch } = *options;
    let mut network = Network::new(problem);
    let default_iterations = clock.is_none().then_some(STEPS_PER_VISIT * network.num_visits as u64);
    let budget = Budget::new(max_iterations.or(default_iterations), clock, watch);
    // Where they are in truth: what is divided by the speed is rounded.
    let points: Vec<Point> = problem.visits().iter().map(|visit| visit.position).collect();
    let curve_keys = curve_keys(&network.points[..network.num_visits]);
    let mut strips = strips(&points, network.num_routes);
    strips.iter_mut().for_each(|part| tour(&network, &curve_keys, part));
    let has_time = budget.share(0) * NEIGHBOURS_COST <= 1.0;
    let neighbours = if has_time { network.find_neighbours(&budget) } else { None };
    let Some(neighbours) = neighbours else {
        smooth_routes(&network, &budget, &mut strips);
        return to_indices(problem, strips);
    };
    network.set_neighbours(neighbours);
    let network = &network;
    let tours = best_tours(network, &points, &curve_keys, &budget, strips, &mut Random::new(seed));
    let state = State::new(network, &tours);
    let objective = Objective::longest_route(network.num_routes, state.costs());
    let mut chain = Chain::new(network, state, objective, seed, Hulls::new(&points, network.num_routes, &tours));
    let mut effort = Effort::new(&budget);
    anneal(network, &mut effort, &mut chain, MAX_END, MAX_HEAT);
    chain.restart(Objective::total_within(chain.best.max_route_cost(), chain.best.costs()));
    anneal(network, &mut effort, &mut chain, 1.0, TOTAL_HEAT);
    to_indices(problem, chain.best.routes(network))
}

fn anneal(network: &Network, effort: &mut Effort<'_>, chain: &mut Chain<Hulls<'_>>, end: f64, heat: (f64, f64)) {
    let schedule = Schedule::scaled(effort.share(), end, heat, chain.best.max_route_cost());
    chain.anneal(network, effort, &schedule, end, 0.0);
}

/// Parts of a farm whose hulls do not touch, whatever the farm: in the order of their places from left to right, about as many
/// visits each. As many as routes, unless there are fewer places.
fn strips(points: &[Point], num_routes: usize) -> Vec<Vec<u32>> {
    let mut visits: Vec<(Point, u32)> = points.iter().copied().zip(0..).collect();
    visits.sort_unstable_by(|a, b| compare(a.0, b.0).then(a.1.cmp(&b.1)));
    let places: Vec<&[(Point, u32)]> = visits.chunk_by(|a, b| compare(a.0, b.0).is_eq()).collect();
    let num_parts = num_routes.min(places.len());
    let (mut parts, mut num_placed, mut first) = (Vec::with_capacity(num_parts), 0, 0);
    for part in 1..=num_parts {
        let mut end = first;
        // Each of the parts to come needs a place.
        while end < places.len() - (num_parts - part) && (end == first || num_placed * num_parts < points.len() * part)
        {
            num_placed += places[end].len();
            end += 1;
        }
        parts.push(places[first..end].iter().flat_map(|place| place.iter().map(|&(_, visit)| visit)).collect());
        first = end;
    }
    parts
}

/// Puts the visits of a part into the order of a first tour.
fn tour(network: &Network, curve_keys: &[u32], part: &mut [u32]) {
    let mut keys: Vec<u64> =
        part.iter().map(|&visit| u64::from(curve_keys[visit as usize]) << 32 | u64::from(visit)).collect();
    keys.sort_unstable();
    part.iter_mut().zip(keys).for_each(|(visit, key)| *visit = key as u32);
    open_at_best_leg(network, part);
}

/// The best of several plans made of cuts; `strips`, if cuts keep none apart or there is no time for any.
fn best_tours(
    network: &Network,
    points: &[Point],
    curve_keys: &[u32],
    budget: &Budget<'_>,
    strips: Vec<Vec<u32>>,
    random: &mut Random,
) -> Vec<Vec<u32>> {
    let mut curve: Vec<u32> = (0..network.num_visits as u32).collect();
    curve.sort_unstable_by_key(|&visit| (curve_keys[visit as usize], visit));
    let whole = Cutter::new(network, &curve, 1);
    let is_over = || budget.is_time_over() || budget.share(0) >= TOURING_END;
    let (mut best, mut best_rank): (_, Option<Rank>) = (strips, None);
    for (num_tried, candidate) in promising_cuts(network, budget, &curve, random).into_iter().enumerate() {
        let is_enough = num_tried >= NUM_TOURED && best_rank.is_some_and(|rank| rank.is_within_limits());
        if is_enough || is_over() {
            break;
        }
        let mut cutter = whole.clone();
        cutter.cut_by_estimate(&candidate.cuts);
        for _ in 0..=NUM_BALANCINGS {
            let mut tours = cutter.parts();
            if is_over() || !Hulls::new(points, network.num_routes, &tours).are_apart() {
                break;
            }
            tours.iter_mut().for_each(|part| tour(network, curve_keys, part));
            improve_routes(network, budget, &mut tours);
            let state = State::new(network, &tours);
            // A part that exceeds a limit is cut as if it cost as much more.
            let cost = |route: usize| state.route_costs[route] * state.greatest_use(network, route).max(1.0);
            cutter.cut_by_costs(&candidate.cuts, &(0..tours.len()).map(cost).collect::<Vec<f64>>());
            let rank = Rank::of(state.costs());
            if best_rank.is_none_or(|best_rank| rank.is_better(&best_rank)) {
                (best, best_rank) = (tours, Some(rank));
            }
        }
    }
    if best_rank.is_none() {
        improve_routes(network, budget, &mut best);
    }
    best
}

struct Candidate {
    cuts: Vec<Cut>,
    /// What the longest route is likely to cost.
    longest: f64,
}

/// Ways of cutting the farm, the most promising first.
fn promising_cuts(network: &Network, budget: &Budget<'_>, curve: &[u32], random: &mut Random) -> Vec<Candidate> {
    let num_items = NUM_ITEMS.max(NUM_ITEMS_PER_ROUTE * network.num_routes);
    let mut cutter = Cutter::new(network, curve, (network.num_visits / num_items).max(1));
    let mut draw = Draw::new(network, random);
    let mut candidates = Vec::with_capacity(NUM_DRAWN);
    while candidates.len() < NUM_DRAWN && (candidates.is_empty() || budget.share(0) < DRAWING_END) {
        let cuts = draw.cuts();
        let longest = cutter.cut_by_estimate(&cuts);
        candidates.push(Candidate { cuts, longest });
    }
    candidates.sort_by(|a, b| a.longest.total_cmp(&b.longest));
    candidates
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::evaluate;
    use crate::generate::{Variant, generate};
    use crate::separation::separation;
    use proptest::prelude::*;

    fn longest(problem: &Problem, routes: &[Vec<usize>]) -> f64 {
        let plan = evaluate(problem, routes).unwrap();
        assert!(plan.is_feasible(), "{:?}", plan.violations);
        plan.max_route_length()
    }

    fn assert_apart(problem: &Problem, routes: &[Vec<usize>]) {
        let separation = separation(problem, routes).unwrap();
        assert!(separation.overlap < 1e-9, "hulls overlap by {}", separation.overlap);
        assert_eq!(separation.num_crossings, 0);
    }

    /// The shortest longest route of plans with territories apart: all assignments, all orders.
    fn best_by_force(problem: &Problem, num_routes: usize) -> f64 {
        let num_visits = problem.num_visits();
        let mut best = f64::INFINITY;
        for code in 0..num_routes.pow(num_visits as u32) {
            let mut routes = vec![Vec::new(); num_routes];
            let mut rest = code;
            for visit in 0..num_visits {
                routes[rest % num_routes].push(visit);
                rest /= num_routes;
            }
            let parts: Vec<Vec<u32>> =
                routes.iter().map(|route| route.iter().map(|&visit| visit as u32).collect()).collect();
            let points: Vec<Point> = problem.visits().iter().map(|visit| visit.position).collect();
            if Hulls::new(&points, num_routes, &parts).are_apart() {
                let length = |route: &Vec<usize>| shortest_tour(problem, Vec::new(), route.clone());
                best = best.min(routes.iter().map(length).fold(0.0, f64::max));
            }
        }
        best
    }

    fn shortest_tour(problem: &Problem, tour: Vec<usize>, rest: Vec<usize>) -> f64 {
        if rest.is_empty() {
            return Network::new(problem).route_cost(&tour.iter().map(|&visit| visit as u32).collect::<Vec<u32>>());
        }
        let extended = |place: usize| {
            let (mut tour, mut rest) = (tour.clone(), rest.clone());
            tour.push(rest.swap_remove(place));
            shortest_tour(problem, tour, rest)
        };
        (0..rest.len()).map(extended).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn the_shortest_of_all_separate_plans_of_few_ponds_is_found() {
        let mut random = Random::new(5);
        for _ in 0..10 {
            let ponds: Vec<Point> = (0..7).map(|_| Point::new(random.uniform(), random.uniform())).collect();
            let problem = Problem::research(Point::new(random.uniform(), 0.0), &ponds, 2).unwrap();
            // An effort that leaves nothing to chance on so few ponds: a clock that runs by calls.
            let calls = std::sync::atomic::AtomicU32::new(0);
            let clock = || f64::from(calls.fetch_add(1, std::sync::atomic::Ordering::Relaxed)) / 5000.0;
            let found = longest(&problem, &plan(&problem, &Options { clock: Some(&clock), ..Options::default() }));
            let best = best_by_force(&problem, 2);
            assert!(found >= best - 1e-12, "{found} beats {best}, so hulls must touch");
            assert!(found <= best * 1.01, "{found} instead of {best}");
        }
    }

    #[test]
    fn territories_of_farms_do_not_touch() {
        for (num_ponds, num_routes, seed) in [(50, 5, 1), (100, 3, 2), (120, 12, 3), (300, 5, 4)] {
            let farm = generate(num_ponds, Variant::Authors, seed).unwrap();
            let problem = Problem::research(farm.depot, &farm.ponds, num_routes).unwrap();
            let routes = plan(&problem, &Options::default());
            longest(&problem, &routes);
            assert!(routes.len() <= num_routes);
            assert_apart(&problem, &routes);
            assert_eq!(routes, plan(&problem, &Options::default()));
        }
    }

    #[test]
    fn ponds_in_one_place() {
        let problem = Problem::research(Point::default(), &[Point::new(3.0, 4.0); 9], 4).unwrap();
        assert_eq!(longest(&problem, &plan(&problem, &Options::default())), 10.0);
    }

    #[test]
    fn fewer_ponds_than_routes() {
        let ponds = [Point::new(1.0, 0.0), Point::new(0.0, 2.0)];
        let problem = Problem::research(Point::default(), &ponds, 5).unwrap();
        assert_eq!(longest(&problem, &plan(&problem, &Options::default())), 4.0);
        let problem = Problem::research(Point::default(), &ponds[..1], 1).unwrap();
        assert_eq!(plan(&problem, &Options::default()), [[0]]);
    }

    #[test]
    fn ponds_on_a_line_through_the_depot() {
        let ponds: Vec<Point> = (-20..=20).filter(|&x| x != 0).map(|x| Point::new(f64::from(x), 0.0)).collect();
        let problem = Problem::research(Point::default(), &ponds, 4).unwrap();
        let routes = plan(&problem, &Options::default());
        assert_eq!(longest(&problem, &routes), 40.0);
        let mut spans: Vec<(f64, f64)> = routes
            .iter()
            .map(|route| {
                let places = route.iter().map(|&visit| ponds[visit].x);
                places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
            })
            .collect();
        spans.sort_by(|a, b| a.0.total_cmp(&b.0));
        assert!(spans.windows(2).all(|pair| pair[0].1 < pair[1].0), "{spans:?}");
    }

    #[test]
    fn a_watch_ends_it_at_any_look_with_territories_apart() {
        use std::ops::ControlFlow;
        let farm = generate(80, Variant::Authors, 6).unwrap();
        let problem = Problem::research(farm.depot, &farm.ponds, 4).unwrap();
        for num_allowed in 0..40 {
            let looks = std::sync::atomic::AtomicU32::new(0);
            let watch = |_: &crate::effort::Progress| {
                let is_over = looks.fetch_add(1, std::sync::atomic::Ordering::Relaxed) >= num_allowed;
                if is_over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            };
            // Steps without end: only the watch ends it.
            let options = Options { max_iterations: Some(u64::MAX), watch: Some(&watch), ..Options::default() };
            let routes = plan(&problem, &options);
            longest(&problem, &routes);
            assert_apart(&problem, &routes);
            assert_eq!(looks.into_inner(), num_allowed + 1);
        }
    }

    #[test]
    fn a_time_limit_long_over_still_gives_a_plan() {
        let farm = generate(200, Variant::Authors, 1).unwrap();
        let problem = Problem::research(farm.depot, &farm.ponds, 5).unwrap();
        let routes = plan(&problem, &Options { clock: Some(&|| 2.0), ..Options::default() });
        longest(&problem, &routes);
        assert_apart(&problem, &routes);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn every_pond_once_and_territories_apart(
            places in prop::collection::hash_set((0u8..12, 0u8..12), 1..60), depot in (0u8..12, 0u8..12),
            num_routes in 1usize..7, seed in 0u64..4,
        ) {
            let mut places: Vec<(u8, u8)> = places.into_iter().collect();
            places.sort_unstable();
            let ponds: Vec<Point> = places.iter().map(|&(x, y)| Point::new(x.into(), y.into())).collect();
            let problem = Problem::research(Point::new(depot.0.into(), depot.1.into()), &ponds, num_routes).unwrap();
            let routes = plan(&problem, &Options { seed, ..Options::default() });
            longest(&problem, &routes);
            prop_assert!(routes.len() <= num_routes && routes.iter().all(|route| !route.is_empty()));
            assert_apart(&problem, &routes);
        }
    }
}
