//! What every plan of the search must be, on any input.

use pondhop_core::bound::lower_bound;
use pondhop_core::effort::Progress;
use pondhop_core::evaluate::evaluate;
use pondhop_core::generate::{Variant, generate};
use pondhop_core::geometry::Point;
use pondhop_core::plan::Plan;
use pondhop_core::problem::{Depot, Problem, VehicleType, Visit, WayHome};
use pondhop_core::search::{Goal, Options, solve};
use proptest::prelude::*;
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

fn plan(problem: &Problem, options: &Options<'_>) -> Plan {
    let outcome = solve(problem, options);
    assert!(outcome.routes.iter().all(|route| !route.is_empty()));
    evaluate(problem, &outcome.routes).unwrap()
}

fn iterations(max_iterations: u64) -> Options<'static> {
    Options { max_iterations: Some(max_iterations), ..Options::default() }
}

/// The least longest route, and the least total among plans that have it.
fn optimum(problem: &Problem) -> (f64, f64) {
    let mut best = (f64::INFINITY, f64::INFINITY);
    for routes in every_plan(problem) {
        let plan = evaluate(problem, &routes).unwrap();
        let (longest, total) = (plan.makespan(), plan.routes.iter().map(|route| route.duration).sum::<f64>());
        if longest < best.0 - 1e-9 || (longest < best.0 + 1e-9 && total < best.1) {
            best = (longest, total);
        }
    }
    best
}

fn every_plan(problem: &Problem) -> Vec<Vec<Vec<usize>>> {
    fn extend(routes: &mut Vec<Vec<usize>>, visit: usize, num_visits: usize, plans: &mut Vec<Vec<Vec<usize>>>) {
        if visit == num_visits {
            plans.push(routes.iter().filter(|route| !route.is_empty()).cloned().collect());
            return;
        }
        let mut has_tried_empty = false;
        for route in 0..routes.len() {
            // Empty routes are alike.
            if routes[route].is_empty() && std::mem::replace(&mut has_tried_empty, true) {
                continue;
            }
            for place in 0..=routes[route].len() {
                routes[route].insert(place, visit);
                extend(routes, visit + 1, num_visits, plans);
                routes[route].remove(place);
            }
        }
    }
    let mut plans = Vec::new();
    extend(&mut vec![vec![]; problem.vehicle_type().num_available], 0, problem.num_visits(), &mut plans);
    plans
}

fn points(max_size: usize) -> impl Strategy<Value = Vec<Point>> {
    prop::collection::vec((-3.0..3.0f64, -3.0..3.0f64), 1..=max_size)
        .prop_map(|places| places.into_iter().map(|(x, y)| Point::new(x, y)).collect())
}

/// Ponds that coincide, lie in lines, and lie on the depot.
fn lattice_points(max_size: usize) -> impl Strategy<Value = Vec<Point>> {
    prop::collection::vec((0..4u8, 0..3u8), 1..=max_size)
        .prop_map(|places| places.into_iter().map(|(x, y)| Point::new(x.into(), y.into())).collect())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn every_pond_once_on_any_farm(
        ponds in prop_oneof![points(60), lattice_points(60)],
        num_routes in 1..9usize, seed in any::<u64>(), num_iterations in 1..400u64, num_threads in 1..3usize,
    ) {
        let problem = Problem::research(Point::new(1.0, 1.0), &ponds, num_routes).unwrap();
        let options = Options { seed, num_threads, ..iterations(num_iterations) };
        let plan = plan(&problem, &options);
        prop_assert!(plan.is_feasible(), "{:?}", plan.violations);
        prop_assert!(lower_bound(&problem) <= plan.max_route_length() * (1.0 + 1e-9));
    }

    #[test]
    fn the_optimum_of_small_farms(
        ponds in prop_oneof![points(6), lattice_points(6)],
        services in prop::collection::vec(0.0..2.0f64, 6), leg_stop_duration in 0.0..1.0f64, num_routes in 1..4usize,
    ) {
        let visits = ponds.iter().zip(&services).map(|(&position, &service_duration)| Visit { service_duration, ..Visit::at(position) });
        let vehicle_type = VehicleType { leg_stop_duration, speed: 2.0, ..VehicleType::unlimited(num_routes) };
        let problem = Problem::new(Depot { position: Point::new(0.5, 0.0) }, visits.collect(), vehicle_type).unwrap();
        // A local optimum may hold one seed, not all of three.
        let plans = (1..=3).map(|seed| plan(&problem, &Options { seed, ..iterations(5_000) }));
        let total_of = |plan: &Plan| plan.routes.iter().map(|route| route.duration).sum::<f64>();
        let key = |plan: &Plan| (plan.makespan(), total_of(plan));
        let found = plans.map(|plan| key(&plan)).min_by(|a, b| a.partial_cmp(b).unwrap()).unwrap();
        let (longest, total) = optimum(&problem);
        prop_assert!((found.0 - longest).abs() <= 1e-9 * longest.max(1.0), "{found:?} {longest}");
        prop_assert!(found.1 <= 1.01 * total + 1e-9, "{found:?} {total}");
    }

    #[test]
    fn routes_with_a_way_home_of_their_own_are_flown_the_cheaper_way(
        ponds in prop_oneof![points(6), lattice_points(6)], takeoff_duration in 0.0..2.0f64,
        home_speed in 0.5..6.0f64, num_routes in 1..4usize,
    ) {
        let visits: Vec<Visit> = ponds.iter().map(|&position| Visit::at(position)).collect();
        let way_home = Some(WayHome { speed: home_speed, fixed_duration: 1.5 });
        let drones = VehicleType { speed: 2.0, leg_stop_duration: 0.3, ..VehicleType::unlimited(num_routes) };
        let depot = Depot { position: Point::new(0.5, 0.0) };
        let problem = Problem::new(depot, visits, VehicleType { takeoff_duration, way_home, ..drones }).unwrap();
        // What the search minimises: the mean of both ways of each route.
        let mean = |routes: &[Vec<usize>]| {
            let turned: Vec<Vec<usize>> = routes.iter().map(|route| route.iter().rev().copied().collect()).collect();
            let both = [routes, &turned].map(|routes| evaluate(&problem, routes).unwrap());
            let pairs = both[0].routes.iter().zip(&both[1].routes);
            pairs.map(|(one, other)| 0.5 * (one.duration + other.duration)).fold(0.0, f64::max)
        };
        let least = every_plan(&problem).iter().map(|routes| mean(routes)).fold(f64::INFINITY, f64::min);
        let plans = (1..=3).map(|seed| solve(&problem, &Options { seed, ..iterations(5_000) }).routes);
        let found = plans.min_by(|a, b| mean(a).total_cmp(&mean(b))).unwrap();
        prop_assert!((mean(&found) - least).abs() <= 1e-9 * least, "{} {least}", mean(&found));
        let plan = evaluate(&problem, &found).unwrap();
        prop_assert!(plan.makespan() <= mean(&found) * (1.0 + 1e-9));
        for route in &found {
            let turned: Vec<usize> = route.iter().rev().copied().collect();
            let [flown, turned] = [route.clone(), turned].map(|route| evaluate(&problem, &[route]).unwrap().makespan());
            prop_assert!(flown <= turned + 1e-9);
        }
    }

    #[test]
    fn a_start_is_never_made_worse(ponds in points(40), num_routes in 1..5usize, seed in any::<u64>()) {
        let problem = Problem::research(Point::new(0.0, 0.0), &ponds, num_routes).unwrap();
        let start = solve(&problem, &Options { seed, ..iterations(200) }).routes;
        let before = evaluate(&problem, &start).unwrap().max_route_length();
        let after = plan(&problem, &Options { start: Some(&start), ..iterations(50) }).max_route_length();
        prop_assert!(after <= before * (1.0 + 1e-9));
    }
}

fn farm(num_ponds: usize, num_routes: usize) -> Problem {
    let farm = generate(num_ponds, Variant::Authors, 8).unwrap();
    Problem::research(farm.depot, &farm.ponds, num_routes).unwrap()
}

#[test]
fn same_seed_iterations_and_threads_same_routes() {
    let problem = farm(150, 5);
    for num_threads in [1, 2, 3] {
        let options = Options { num_threads, ..iterations(2_000) };
        assert_eq!(solve(&problem, &options).routes, solve(&problem, &options).routes);
    }
}

#[test]
fn the_order_of_the_ponds_hardly_matters() {
    let farm = generate(60, Variant::Authors, 4).unwrap();
    let turned: Vec<Point> = farm.ponds.iter().rev().copied().collect();
    let longest = |ponds: &[Point]| {
        let problem = Problem::research(farm.depot, ponds, 4).unwrap();
        plan(&problem, &iterations(40_000)).max_route_length()
    };
    assert!((longest(&farm.ponds) / longest(&turned) - 1.0).abs() < 0.01);
}

#[test]
fn a_clock_that_has_run_out_still_gives_a_plan() {
    for share in [1.0, 2.0] {
        let clock = move || share;
        let plan = plan(&farm(300, 5), &Options { clock: Some(&clock), ..Options::default() });
        assert!(plan.is_feasible());
    }
}

#[test]
fn a_clock_that_runs_out_at_any_look_gives_a_plan() {
    let problem = farm(40, 3);
    for num_looks in 1..120 {
        let looks = AtomicU64::new(0);
        let clock = || looks.fetch_add(1, Ordering::Relaxed) as f64 / f64::from(num_looks);
        let plan = plan(&problem, &Options { clock: Some(&clock), ..Options::default() });
        assert!(plan.is_feasible());
    }
}

#[test]
fn progress_tells_of_the_best_plan_so_far() {
    let reported = Mutex::new(Vec::new());
    let watch = |progress: &Progress| {
        reported.lock().unwrap().push(progress.max_route_cost);
        ControlFlow::Continue(())
    };
    let problem = farm(60, 4);
    let plan = plan(&problem, &Options { watch: Some(&watch), ..iterations(40_000) });
    let reported = reported.into_inner().unwrap();
    let rounding = 1.0 + 1e-9;
    assert!(reported.len() > 10 && reported.windows(2).all(|pair| pair[1] <= pair[0] * rounding), "{reported:?}");
    assert!(plan.makespan() <= reported[reported.len() - 1] * rounding);
}

#[test]
fn a_watch_ends_the_search_at_any_look() {
    let problem = farm(80, 5);
    for (num_looks, num_threads) in (0..200).chain([300, 400]).zip([1, 2].into_iter().cycle()) {
        let looks = AtomicU64::new(0);
        let watch = |progress: &Progress| {
            assert!(progress.max_route_cost > 0.0 && progress.share < 1.0);
            let is_over = looks.fetch_add(1, Ordering::Relaxed) >= num_looks;
            if is_over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let plan = plan(&problem, &Options { watch: Some(&watch), num_threads, ..Options::default() });
        assert!(plan.is_feasible());
        // Threads may look once more each before they see that another has ended the search.
        assert!(looks.into_inner() <= num_looks + 2 * num_threads as u64);
    }
}

#[test]
fn limits_hold_where_the_total_is_the_goal() {
    let ponds = generate(40, Variant::Authors, 2).unwrap();
    let balanced = plan(&farm_of(&ponds.ponds, ponds.depot, f64::INFINITY), &iterations(20_000));
    let max_duration = 1.2 * balanced.makespan();
    let options = Options { goal: Goal::Total, ..iterations(20_000) };
    let limited = plan(&farm_of(&ponds.ponds, ponds.depot, max_duration), &options);
    assert!(limited.is_feasible(), "{:?}", limited.violations);
    let stretched = plan(&farm_of(&ponds.ponds, ponds.depot, max_duration), &Options { slack: 0.5, ..options });
    assert!(stretched.is_feasible(), "{:?}", stretched.violations);
    assert!(limited.total_length() < balanced.total_length());
    let free = plan(&farm_of(&ponds.ponds, ponds.depot, f64::INFINITY), &options);
    assert_eq!(free.routes.len(), 1);
    assert!(free.total_length() <= limited.total_length());
}

#[test]
fn slack_ends_where_the_limit_does() {
    let ponds = generate(40, Variant::Authors, 2).unwrap();
    let balanced = plan(&farm_of(&ponds.ponds, ponds.depot, f64::INFINITY), &iterations(20_000));
    let max_duration = 1.05 * balanced.makespan();
    for num_threads in [1, 3] {
        let options = Options { slack: 0.5, num_threads, ..iterations(20_000) };
        let stretched = plan(&farm_of(&ponds.ponds, ponds.depot, max_duration), &options);
        assert!(stretched.is_feasible(), "{:?}", stretched.violations);
        assert!(stretched.total_length() < balanced.total_length());
    }
}

/// A pond far away makes any longest route of the others as good as another.
#[test]
fn a_longest_route_on_its_bound_leaves_the_effort_to_the_total() {
    let mut ponds = generate(48, Variant::Authors, 6).unwrap();
    let depot = ponds.depot;
    ponds.ponds.push(Point::new(depot.x + 1.5, depot.y));
    let problem = Problem::research(depot, &ponds.ponds, 6).unwrap();
    // The least total within a limit, which nothing else is worked for.
    let limit = 2.0 * problem.visits().iter().map(|visit| visit.position.distance(depot)).fold(0.0, f64::max);
    let totals = [2_000, 20_000, 200_000].map(|num_iterations| {
        let plan = plan(&problem, &iterations(num_iterations));
        assert!(plan.max_route_length() <= limit * (1.0 + 1e-9));
        plan.total_length()
    });
    let visits = problem.visits().to_vec();
    let vehicle_type = VehicleType { max_duration: limit * (1.0 + 1e-12), ..VehicleType::unlimited(6) };
    let limited = Problem::new(Depot { position: depot }, visits, vehicle_type).unwrap();
    let of_total = plan(&limited, &Options { goal: Goal::Total, ..iterations(200_000) }).total_length();
    assert!(totals[1] <= totals[0] * 1.001 && totals[2] <= totals[1] * 1.001, "{totals:?}");
    assert!(totals[2] <= of_total * 1.001, "{totals:?} {of_total}");
}

#[test]
fn ponds_at_the_depot_are_planned_at_any_effort() {
    let problem = Problem::research(Point::new(1.0, 1.0), &[Point::new(1.0, 1.0); 20], 3).unwrap();
    for num_iterations in [10, 1_000, 100_000] {
        assert_eq!(plan(&problem, &iterations(num_iterations)).max_route_length(), 0.0);
    }
}

fn farm_of(ponds: &[Point], depot: Point, max_duration: f64) -> Problem {
    let visits = ponds.iter().map(|&position| Visit::at(position)).collect();
    let vehicle_type = VehicleType { max_duration, ..VehicleType::unlimited(5) };
    Problem::new(Depot { position: depot }, visits, vehicle_type).unwrap()
}
