//! What HPP must do on any farm, however degenerate.

use pondhop_core::evaluate::evaluate;
use pondhop_core::generate::{Variant, generate};
use pondhop_core::geometry::Point;
use pondhop_core::hpp::{plan, plan_clusters};
use pondhop_core::problem::Problem;
use proptest::prelude::*;

fn points(coordinates: &[(f64, f64)]) -> Vec<Point> {
    coordinates.iter().map(|&(x, y)| Point::new(x, y)).collect()
}

/// Few distinct coordinates: repeated ponds, ponds on lines, the depot on a pond.
fn coarse() -> impl Strategy<Value = Vec<(f64, f64)>> {
    prop::collection::vec((0_i32..6, 0_i32..4), 2..60)
        .prop_map(|places| places.into_iter().map(|(x, y)| (f64::from(x), f64::from(y))).collect())
}

fn fine() -> impl Strategy<Value = Vec<(f64, f64)>> {
    prop::collection::vec((0.0..1.0, 0.0..1.0), 2..80)
}

/// The first point is the depot.
fn problem(places: &[Point], num_routes: usize) -> Problem {
    Problem::research(places[0], &places[1..], num_routes).unwrap()
}

fn assert_complete(problem: &Problem, seed: u64) {
    let routes = plan(problem, seed);
    assert!(routes.iter().all(|route| !route.is_empty()));
    let evaluated = evaluate(problem, &routes).unwrap();
    assert!(evaluated.is_feasible(), "{:?} in {routes:?}", evaluated.violations);
}

proptest! {
    #[test]
    fn every_pond_is_visited_once(places in prop_oneof![coarse(), fine()], num_routes in 1_usize..9, seed in 0_u64..100,
                                  exponent in -9_i32..9, offset in -1.0..1.0) {
        let scale = 10.0_f64.powi(exponent);
        let places: Vec<Point> = points(&places)
            .into_iter()
            .map(|place| Point::new((place.x + offset) * scale, (place.y - offset) * scale))
            .collect();
        assert_complete(&problem(&places, num_routes), seed);
    }

    #[test]
    fn the_plan_does_not_depend_on_place_or_unit(places in coarse(), num_routes in 1_usize..6, shift in -1000_i32..1000,
                                                 exponent in -20_i32..16) {
        // Whole numbers and powers of two: nothing is rounded on the way.
        let unit = 2.0_f64.powi(exponent);
        let moved: Vec<Point> = points(&places)
            .into_iter()
            .map(|place| Point::new((place.x + f64::from(shift)) * unit, (place.y - 7.0 * f64::from(shift)) * unit))
            .collect();
        prop_assert_eq!(plan(&problem(&points(&places), num_routes), 1), plan(&problem(&moved, num_routes), 1));
    }

    #[test]
    fn it_is_never_better_than_the_optimum(places in prop::collection::vec((0.0..1.0, 0.0..1.0), 2..8),
                                           num_routes in 1_usize..4) {
        let problem = problem(&points(&places), num_routes);
        let length = evaluate(&problem, &plan(&problem, 1)).unwrap().max_route_length();
        prop_assert!(length >= optimal_max_route_length(&problem) * (1.0 - 1e-12));
    }
}

/// The shortest possible longest route, by dynamic programming over sets of ponds (Held and Karp 1962).
fn optimal_max_route_length(problem: &Problem) -> f64 {
    let (depot, num_ponds) = (problem.depot().position, problem.num_visits());
    let place = |pond: usize| problem.visits()[pond].position;
    let num_sets = 1_usize << num_ponds;
    // Shortest path from the depot over a set, by its last pond.
    let mut paths = vec![vec![f64::INFINITY; num_ponds]; num_sets];
    let mut tours = vec![0.0; num_sets];
    for set in 1..num_sets {
        for last in (0..num_ponds).filter(|&last| set >> last & 1 == 1) {
            let rest = set & !(1 << last);
            paths[set][last] = if rest == 0 {
                depot.distance(place(last))
            } else {
                (0..num_ponds)
                    .map(|pond| paths[rest][pond] + place(pond).distance(place(last)))
                    .fold(f64::INFINITY, f64::min)
            };
        }
        tours[set] =
            (0..num_ponds).map(|last| paths[set][last] + place(last).distance(depot)).fold(f64::INFINITY, f64::min);
    }
    let mut best = tours.clone();
    for _ in 1..problem.vehicle_type().num_available {
        let fewer = best.clone();
        for set in 1..num_sets {
            let of_part = |part: &usize| tours[*part].max(fewer[set & !part]);
            best[set] = (1..=set).filter(|part| part & !set == 0).map(|part| of_part(&part)).fold(best[set], f64::min);
        }
    }
    best[num_sets - 1]
}

#[test]
fn named_degenerate_farms() {
    let line: Vec<Point> = (0..30).map(|step| Point::new(f64::from(step) * 3.0, f64::from(step))).collect();
    let coinciding = vec![Point::new(5.0, 5.0); 12];
    let far_pairs: Vec<Point> = (0..40)
        .map(|index| Point::new(f64::from(index / 2) * 1e5 + f64::from(index % 2) * 1e-3, f64::from(index % 7) * 1e4))
        .collect();
    for places in [line, coinciding, far_pairs, points(&[(0.0, 0.0), (1.0, 1.0)])] {
        for num_routes in 1..8 {
            assert_complete(&problem(&places, num_routes), 1);
        }
    }
}

#[test]
fn a_cluster_too_small_takes_the_nearest_ponds_of_its_neighbour() {
    // A grid of 5 x 5 ponds and one pond far out: k-means gives the far one a cluster of its own.
    let mut ponds: Vec<Point> = (0..25).map(|index| Point::new(f64::from(index % 5), f64::from(index / 5))).collect();
    ponds.push(Point::new(40.0, 2.5));
    let problem = Problem::research(Point::default(), &ponds, 2).unwrap();
    for seed in 0..20 {
        let mut routes = plan(&problem, seed);
        routes.sort_by_key(Vec::len);
        routes[0].sort_unstable();
        // The nearest to it are those at (4, 2) and (4, 3): indices 14 and 19.
        assert_eq!(routes[0], [14, 19, 25]);
        assert_eq!(routes[1].len(), 23);
    }
}

#[test]
fn fewer_ponds_than_drones_are_flown_one_each() {
    let ponds = points(&[(1.0, 0.0), (0.0, 1.0), (1.0, 1.0)]);
    let routes = plan(&Problem::research(Point::default(), &ponds, 5).unwrap(), 1);
    assert_eq!(routes.iter().map(Vec::len).collect::<Vec<_>>(), [1, 1, 1]);
}

#[test]
fn the_pitch_of_a_generated_farm_is_its_spacing() {
    for (num_ponds, seed) in [(50, 1), (200, 2), (700, 3)] {
        let farm = generate(num_ponds, Variant::Authors, seed).unwrap();
        let problem = Problem::research(farm.depot, &farm.ponds, 5).unwrap();
        let pitch = plan_clusters(&problem, 1).pitch;
        assert!((pitch / farm.spacing - 1.0).abs() < 1e-9, "{pitch} instead of {}", farm.spacing);
    }
}
