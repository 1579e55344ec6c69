//! Limits of length and energy: kept wherever a plan keeps them, and then as good as the best such plan.

use pondhop_core::evaluate::evaluate;
use pondhop_core::generate::{Variant, generate};
use pondhop_core::geometry::Point;
use pondhop_core::plan::Plan;
use pondhop_core::problem::{Depot, Energy, Problem, VehicleType, Visit, WayHome};
use pondhop_core::search::{Goal, Options, solve};
use pondhop_core::territory;
use proptest::prelude::*;

fn total(plan: &Plan) -> f64 {
    plan.routes.iter().map(|route| route.duration).sum()
}

/// All plans, as routes of which some may be empty.
fn every_plan(num_visits: usize, num_routes: usize) -> Vec<Vec<Vec<usize>>> {
    let mut plans = vec![vec![vec![]; num_routes]];
    for visit in 0..num_visits {
        let extended = |plan: &Vec<Vec<usize>>| {
            let places = (0..num_routes).flat_map(|route| (0..=plan[route].len()).map(move |place| (route, place)));
            let with = |(route, place): (usize, usize)| {
                let mut plan = plan.clone();
                plan[route].insert(place, visit);
                plan
            };
            places.map(with).collect::<Vec<_>>()
        };
        plans = plans.iter().flat_map(extended).collect();
    }
    plans
}

/// What counts first and second, less is better.
fn key(plan: &Plan, goal: Goal) -> (f64, f64) {
    match goal {
        Goal::Max => (plan.makespan(), total(plan)),
        Goal::Total => (total(plan), 0.0),
    }
}

/// The best of all plans that keep the limits.
fn best_by_force(problem: &Problem, goal: Goal) -> Option<(f64, f64)> {
    let plans = every_plan(problem.num_visits(), problem.vehicle_type().num_available);
    let plans = plans.into_iter().map(|mut routes| {
        routes.retain(|route| !route.is_empty());
        evaluate(problem, &routes).unwrap()
    });
    let keys = plans.filter(Plan::is_feasible).map(|plan| key(&plan, goal));
    keys.min_by(|a, b| a.partial_cmp(b).unwrap())
}

fn plan(problem: &Problem, options: &Options<'_>) -> Plan {
    evaluate(problem, &solve(problem, options).routes).unwrap()
}

fn steps(max_iterations: u64, goal: Goal) -> Options<'static> {
    Options { max_iterations: Some(max_iterations), goal, ..Options::default() }
}

fn visits(places: &[(f64, f64)], services: &[f64]) -> Vec<Visit> {
    let visit = |(&(x, y), &service): (&(f64, f64), &f64)| Visit {
        position: Point::new(x, y),
        service_duration: service,
        service_energy: 2.0 * service,
    };
    places.iter().zip(services).map(visit).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn the_best_plan_within_a_limit_of_length(
        places in prop::collection::vec((-3.0..3.0f64, -3.0..3.0f64), 1..6),
        services in prop::collection::vec(prop_oneof![Just(0.0), 0.0..6.0f64], 6),
        share in 0.5..1.1f64, stop in prop_oneof![Just(0.0), 0.0..1.0f64], num_routes in 1..4usize,
        goal in prop_oneof![Just(Goal::Max), Just(Goal::Total)],
    ) {
        let of_length = |max_length: f64| {
            let vehicle_type =
                VehicleType { max_length, leg_stop_duration: stop, speed: 2.0, ..VehicleType::unlimited(num_routes) };
            Problem::new(Depot { position: Point::new(0.5, 0.0) }, visits(&places, &services), vehicle_type).unwrap()
        };
        let free = plan(&of_length(f64::INFINITY), &steps(2_000, goal));
        let problem = of_length(share * free.max_route_length());
        let plans = [1, 2, 3].map(|seed| plan(&problem, &Options { seed, ..steps(5_000, goal) }));
        match best_by_force(&problem, goal) {
            Some(best) => {
                for plan in &plans {
                    prop_assert!(plan.is_feasible(), "{:?}", plan.violations);
                }
                let found = plans.iter().map(|plan| key(plan, goal)).min_by(|a, b| a.partial_cmp(b).unwrap()).unwrap();
                prop_assert!(found.0 <= best.0 * (1.0 + 1e-9), "{found:?} {best:?}");
            }
            None => prop_assert!(plans.iter().all(|plan| !plan.is_feasible())),
        }
    }

    #[test]
    fn energy_is_kept(
        places in prop::collection::vec((-3.0..3.0f64, -3.0..3.0f64), 1..6),
        services in prop::collection::vec(0.0..2.0f64, 6), share in 0.6..1.0f64, num_routes in 2..4usize,
        way_home in prop::option::of((0.5..5.0f64, 0.0..3.0f64)),
    ) {
        let of_energy = |usable_energy: f64| {
            let energy = Energy {
                takeoff_energy: 3.0,
                leg_power: 2.0,
                leg_stop_power: 1.0,
                way_home_power: if way_home.is_some() { 2.0 } else { 0.0 },
                way_home_fixed_energy: way_home.map_or(0.0, |way| way.1),
                usable_energy,
            };
            let vehicle_type = VehicleType {
                leg_stop_duration: 0.5,
                way_home: way_home.map(|way| WayHome { speed: way.0, fixed_duration: 1.0 }),
                energy,
                ..VehicleType::unlimited(num_routes)
            };
            Problem::new(Depot { position: Point::new(0.5, 0.0) }, visits(&places, &services), vehicle_type).unwrap()
        };
        let free = plan(&of_energy(f64::INFINITY), &steps(2_000, Goal::Total));
        let most = free.routes.iter().map(|route| route.energy).fold(0.0, f64::max);
        let problem = of_energy(share * most);
        let plan = plan(&problem, &steps(5_000, Goal::Total));
        let best = best_by_force(&problem, Goal::Total);
        // Where drones come home in their own way, a route is charged for the dearer of both ways round.
        if best.is_some() && way_home.is_none() {
            prop_assert!(plan.is_feasible(), "{:?}", plan.violations);
        }
        if plan.is_feasible() {
            prop_assert!(best.is_some_and(|best| best.0 <= total(&plan) * (1.0 + 1e-9)));
        }
    }
}

fn evaluate_territory(problem: &Problem) -> Plan {
    let options = territory::Options { max_iterations: Some(40_000), ..territory::Options::default() };
    evaluate(problem, &territory::plan(problem, &options)).unwrap()
}

/// The ponds on the left take long, so that balanced times make long routes on the right.
fn farm(service_duration: f64, max_length: f64) -> Problem {
    let farm = generate(60, Variant::Authors, 5).unwrap();
    let visits = farm.ponds.iter().map(|&position| {
        let is_left = position.x < farm.depot.x;
        Visit { service_duration: if is_left { service_duration } else { 0.0 }, ..Visit::at(position) }
    });
    let vehicle_type = VehicleType { max_length, ..VehicleType::unlimited(4) };
    Problem::new(Depot { position: farm.depot }, visits.collect(), vehicle_type).unwrap()
}

#[test]
fn farms_are_planned_within_a_limit_of_length() {
    let free = plan(&farm(0.2, f64::INFINITY), &steps(40_000, Goal::Max));
    let shortest = plan(&farm(0.0, f64::INFINITY), &steps(40_000, Goal::Max)).max_route_length();
    assert!(free.max_route_length() > 1.03 * shortest);
    for allowance in [1.03, 1.02, 1.01] {
        let limited = farm(0.2, allowance * shortest);
        for num_threads in [1, 2] {
            let plan = plan(&limited, &Options { num_threads, ..steps(40_000, Goal::Max) });
            assert!(plan.is_feasible(), "{allowance}: {:?}", plan.violations);
        }
        let plan = plan(&limited, &steps(40_000, Goal::Total));
        assert!(plan.is_feasible(), "{allowance}: {:?}", plan.violations);
    }
    // Apart from each other, routes are longer.
    let free = evaluate_territory(&farm(0.2, f64::INFINITY));
    let limited = evaluate_territory(&farm(0.2, 0.99 * free.max_route_length()));
    assert!(limited.is_feasible(), "{:?}", limited.violations);
}

#[test]
fn lengths_are_limited_where_a_route_costs_its_length() {
    let farm = generate(50, Variant::Authors, 3).unwrap();
    let of_length = |max_length: f64| {
        let visits = farm.ponds.iter().map(|&position| Visit::at(position)).collect();
        let vehicle_type = VehicleType { max_length, speed: 3.0, ..VehicleType::unlimited(5) };
        Problem::new(Depot { position: farm.depot }, visits, vehicle_type).unwrap()
    };
    let balanced = plan(&of_length(f64::INFINITY), &steps(20_000, Goal::Max));
    let problem = of_length(1.05 * balanced.max_route_length());
    for options in [steps(20_000, Goal::Total), Options { slack: 0.3, ..steps(20_000, Goal::Max) }] {
        let plan = plan(&problem, &options);
        assert!(plan.is_feasible(), "{:?}", plan.violations);
        assert!(plan.total_length() < balanced.total_length());
    }
}
