//! Farms on which differences of costs are rounding noise: no loop that repeats until nothing is gained may go on for ever.
//!
//! What proves it is counted, not timed: every such loop looks at the clock, and a clock that stands still counts the looks.

use pondhop_core::effort::Clock;
use pondhop_core::evaluate::evaluate;
use pondhop_core::geometry::Point;
use pondhop_core::hpp;
use pondhop_core::problem::Problem;
use pondhop_core::search::{Goal, Options, solve};
use pondhop_core::territory;
use proptest::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// Looks at the clock after which a planner is taken not to end by itself: a hundred times what any farm here needs.
const MAX_LOOKS: u64 = 200_000;

/// Runs a planner with a clock that stands still until it has been looked at too often.
fn assert_ends(problem: &Problem, plan: impl Fn(Clock<'_>) -> Vec<Vec<usize>>) {
    let num_looks = AtomicU64::new(0);
    let clock = || if num_looks.fetch_add(1, Ordering::Relaxed) < MAX_LOOKS { 0.0 } else { 1.0 };
    let evaluated = evaluate(problem, &plan(&clock)).unwrap();
    assert!(evaluated.is_feasible(), "{:?}", evaluated.violations);
    let num_looks = num_looks.into_inner();
    assert!(num_looks < MAX_LOOKS, "still at work after {num_looks} looks at the clock");
}

fn assert_planners_end(depot: Point, ponds: &[Point], num_routes: usize, seed: u64) {
    let problem = Problem::research(depot, ponds, num_routes).unwrap();
    for (max_iterations, goal) in [(50, Goal::Max), (20_000, Goal::Max), (500, Goal::Total)] {
        let options = Options { seed, max_iterations: Some(max_iterations), goal, ..Options::default() };
        assert_ends(&problem, |clock| solve(&problem, &Options { clock: Some(clock), ..options }).routes);
    }
    let options = territory::Options { seed, max_iterations: Some(500), ..territory::Options::default() };
    assert_ends(&problem, |clock| territory::plan(&problem, &territory::Options { clock: Some(clock), ..options }));
    assert_ends(&problem, |_| hpp::plan(&problem, seed));
}

#[derive(serde::Deserialize)]
struct Farm {
    depot: (f64, f64),
    ponds: Vec<(f64, f64)>,
}

fn assert_ends_on_file(text: &str) {
    let farms: Vec<Farm> = serde_json::from_str(text).unwrap();
    for farm in farms {
        let ponds: Vec<Point> = farm.ponds.iter().map(|&(x, y)| Point::new(x, y)).collect();
        for num_routes in [1, 3, 5] {
            assert_planners_end(Point::new(farm.depot.0, farm.depot.1), &ponds, num_routes, 1);
        }
    }
}

#[test]
fn copies_with_noise_in_the_last_places() {
    assert_ends_on_file(include_str!("data/hang_dup1.json"));
}

#[test]
fn a_depot_a_billion_spacings_away() {
    assert_ends_on_file(include_str!("data/hang_search_2161.json"));
}

#[test]
fn ponds_of_all_magnitudes() {
    assert_ends_on_file(include_str!("data/hang_territory_4018.json"));
}

/// `value` with its last place changed by `units`.
fn nudged(value: f64, units: i64) -> f64 {
    if value == 0.0 { units as f64 * 1e-130 } else { f64::from_bits((value.to_bits() as i64 + units) as u64) }
}

type Nudges = Vec<(usize, i64, i64)>;

/// Ponds, and copies of them that differ in the last places.
fn with_copies(places: &[(f64, f64)], copies: &Nudges) -> Vec<Point> {
    let copy = |&(of, x, y): &(usize, i64, i64)| {
        let place = places[of % places.len()];
        Point::new(nudged(place.0, x), nudged(place.1, y))
    };
    places.iter().map(|&(x, y)| Point::new(x, y)).chain(copies.iter().map(copy)).collect()
}

fn places(max_size: usize) -> impl Strategy<Value = Vec<(f64, f64)>> {
    prop_oneof![
        prop::collection::vec((0.0..1.0, 0.0..1.0), 1..max_size),
        prop::collection::vec(
            (0_u8..5, 0_u8..4).prop_map(|(x, y)| (f64::from(x) / 3.0, f64::from(y) / 7.0)),
            1..max_size
        ),
        prop::collection::vec((0.0..1.0, Just(0.3)), 1..max_size),
    ]
}

fn copies(max_size: usize) -> impl Strategy<Value = Nudges> {
    prop::collection::vec((0_usize..100, -3_i64..=3, -3_i64..=3), 1..max_size)
}

fn of_any_magnitude() -> impl Strategy<Value = f64> {
    (-12_i32..9, -9.9..9.9_f64).prop_map(|(exponent, value)| value * 10.0_f64.powi(exponent - 1))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn noisy_copies(
        places in places(40), copies in copies(160), depot in (0.0..1.0, 0.0..1.0), num_routes in 1_usize..7, seed in 0_u64..9,
    ) {
        assert_planners_end(Point::new(depot.0, depot.1), &with_copies(&places, &copies), num_routes, seed);
    }

    #[test]
    fn a_far_depot(
        places in places(40), copies in copies(30), spacing in -16_i32..0, direction in (-1.0..1.0, -1.0..1.0),
        num_routes in 1_usize..7, seed in 0_u64..9,
    ) {
        let unit = 10.0_f64.powi(spacing);
        let ponds: Vec<Point> =
            with_copies(&places, &copies).into_iter().map(|point| Point::new(point.x * unit, point.y * unit)).collect();
        assert_planners_end(Point::new(1e9 * direction.0, 1e9 * direction.1), &ponds, num_routes, seed);
    }

    #[test]
    fn mixed_magnitudes(
        places in prop::collection::vec((of_any_magnitude(), of_any_magnitude()), 1..80),
        depot in (of_any_magnitude(), of_any_magnitude()), num_routes in 1_usize..7, seed in 0_u64..9,
    ) {
        let ponds: Vec<Point> = places.iter().map(|&(x, y)| Point::new(x, y)).collect();
        assert_planners_end(Point::new(depot.0, depot.1), &ponds, num_routes, seed);
    }
}
