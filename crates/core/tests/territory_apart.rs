//! The hulls of territories do not touch, checked in whole numbers by trying all: two hulls have a point in common if two
//! segments between points of theirs do, or a point of one lies in a triangle of the other (Carathéodory).

use pondhop_core::evaluate::evaluate;
use pondhop_core::geometry::Point;
use pondhop_core::problem::Problem;
use pondhop_core::separation::separation;
use pondhop_core::territory::{Options, plan};
use proptest::prelude::*;

type Place = (i64, i64);

/// Twice the signed area of a triangle, exactly.
fn area(a: Place, b: Place, c: Place) -> i128 {
    let wide = i128::from;
    (wide(b.0) - wide(a.0)) * (wide(c.1) - wide(a.1)) - (wide(b.1) - wide(a.1)) * (wide(c.0) - wide(a.0))
}

fn is_on_segment(point: Place, (from, to): (Place, Place)) -> bool {
    area(from, to, point) == 0
        && (from.0.min(to.0)..=from.0.max(to.0)).contains(&point.0)
        && (from.1.min(to.1)..=from.1.max(to.1)).contains(&point.1)
}

fn do_segments_meet(one: (Place, Place), other: (Place, Place)) -> bool {
    let sides = |line: (Place, Place), ends: (Place, Place)| {
        area(line.0, line.1, ends.0).signum() * area(line.0, line.1, ends.1).signum()
    };
    (sides(one, other) < 0 && sides(other, one) < 0)
        || is_on_segment(one.0, other)
        || is_on_segment(one.1, other)
        || is_on_segment(other.0, one)
        || is_on_segment(other.1, one)
}

fn is_in_triangle(point: Place, [a, b, c]: [Place; 3]) -> bool {
    let sides = [area(a, b, point), area(b, c, point), area(c, a, point)];
    area(a, b, c) != 0 && (sides.iter().all(|&side| side >= 0) || sides.iter().all(|&side| side <= 0))
}

fn pairs(places: &[Place]) -> Vec<(Place, Place)> {
    (0..places.len()).flat_map(|one| (one..places.len()).map(move |other| (places[one], places[other]))).collect()
}

fn has_point_in_triangle(points: &[Place], corners: &[Place]) -> bool {
    let pairs = pairs(corners);
    let mut triangles = pairs.iter().flat_map(|&(a, b)| corners.iter().map(move |&c| [a, b, c]));
    triangles.any(|triangle| points.iter().any(|&point| is_in_triangle(point, triangle)))
}

fn do_hulls_meet(one: &[Place], other: &[Place]) -> bool {
    let others = pairs(other);
    pairs(one).into_iter().any(|segment| others.iter().any(|&other| do_segments_meet(segment, other)))
        || has_point_in_triangle(one, other)
        || has_point_in_triangle(other, one)
}

fn assert_territories_apart(depot: Place, ponds: &[Place], num_routes: usize, options: &Options<'_>) {
    let point = |(x, y): Place| Point::new(x as f64, y as f64);
    let points: Vec<Point> = ponds.iter().copied().map(point).collect();
    let problem = Problem::research(point(depot), &points, num_routes).unwrap();
    let routes = plan(&problem, options);
    let evaluated = evaluate(&problem, &routes).unwrap();
    assert!(evaluated.is_feasible(), "{:?}", evaluated.violations);
    let territories: Vec<Vec<Place>> =
        routes.iter().map(|route| route.iter().map(|&visit| ponds[visit]).collect()).collect();
    for (index, one) in territories.iter().enumerate() {
        for other in &territories[..index] {
            assert!(!do_hulls_meet(one, other), "{one:?} meets {other:?}");
        }
    }
}

fn ponds() -> impl Strategy<Value = Vec<Place>> {
    let copies = |places: Vec<Place>, copies: Vec<usize>| -> Vec<Place> {
        let copied: Vec<Place> = copies.into_iter().map(|place| places[place % places.len()]).collect();
        [places, copied].concat()
    };
    let copy_places = || prop::collection::vec(0_usize..40, 0..25);
    prop_oneof![
        // Copies on a lattice.
        (prop::collection::vec((0_i64..6, 0_i64..6), 1..20), copy_places()).prop_map(move |(p, c)| copies(p, c)),
        // Anywhere, with copies.
        (
            prop::collection::vec((-999_999_999_i64..1_000_000_000, -999_999_999_i64..1_000_000_000), 1..15),
            copy_places()
        )
            .prop_map(move |(p, c)| copies(p, c)),
        // Groups that are far from each other.
        prop::collection::vec(
            (prop_oneof![Just(0_i64), Just(100_000_000), Just(900_000_000)], 0_i64..9, 0_i64..9),
            1..35
        )
        .prop_map(|places| places.into_iter().map(|(far, x, y)| (far + x, far / 3 + y)).collect()),
        // Nearly on a line.
        (prop::collection::vec((-300_000_000_i64..300_000_000, -1_i64..2), 1..35), -2_i64..3)
            .prop_map(|(places, slope)| places.into_iter().map(|(x, off)| (x, slope * x + off)).collect()),
        // Noise around few places.
        prop::collection::vec((0_i64..4, 0_i64..4, -1_i64..2, -1_i64..2), 1..40).prop_map(|places| {
            places.into_iter().map(|(x, y, dx, dy)| (x * 123_456_789 + dx, y * 198_765_432 + dy)).collect()
        }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn on_any_farm(
        ponds in ponds(), depot in (-1_000_000_i64..1_000_000, -1_000_000_i64..1_000_000), num_routes in 1_usize..7,
        seed in 0_u64..9, num_looks in prop_oneof![Just(u32::MAX), 0_u32..300],
    ) {
        let looks = std::sync::atomic::AtomicU32::new(0);
        let watch = |_: &pondhop_core::effort::Progress| {
            let is_over = looks.fetch_add(1, std::sync::atomic::Ordering::Relaxed) >= num_looks;
            if is_over { std::ops::ControlFlow::Break(()) } else { std::ops::ControlFlow::Continue(()) }
        };
        let options = Options { seed, max_iterations: Some(2_000), watch: Some(&watch), ..Options::default() };
        assert_territories_apart(depot, &ponds, num_routes, &options);
        if num_looks < u32::MAX {
            let share = f64::from(num_looks) / 150.0;
            assert_territories_apart(depot, &ponds, num_routes, &Options { seed, clock: Some(&|| share), watch: Some(&watch), ..Options::default() });
        }
    }
}

#[derive(serde::Deserialize)]
struct Farm {
    depot: (f64, f64),
    ponds: Vec<(f64, f64)>,
}

#[test]
fn a_farm_whose_territories_overlapped() {
    let farm: Farm = serde_json::from_str(include_str!("data/territory_overlap.json")).unwrap();
    let ponds: Vec<Point> = farm.ponds.iter().map(|&(x, y)| Point::new(x, y)).collect();
    for num_routes in 2..9 {
        let problem = Problem::research(Point::new(farm.depot.0, farm.depot.1), &ponds, num_routes).unwrap();
        let separation = separation(&problem, &plan(&problem, &Options::default())).unwrap();
        assert_eq!((separation.overlap, separation.num_crossings), (0.0, 0));
    }
}
