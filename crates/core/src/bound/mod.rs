//! Lower bounds: what no plan can beat.
//!
//! The proofs are in `docs/explanation/bounds.md`; in short:
//!
//! 1. *Farthest pond.* Some route flies there and back: twice its distance from the depot.
//! 2. *Averages over far ponds.* Leave out the nearer ponds: by the triangle inequality no route grows. A route of several
//!    ponds can be split in two, neither longer than the whole, so all m drones may be taken to fly (if there are as many
//!    ponds). The longest route is then at least 1/m of the least total of exactly m routes over the ponds left. Where the
//!    depot is far off, leaving out near ponds makes every drone pay the way to the far ones.
//! 3. *Totals.* m routes over a set of ponds are a tree with m edges at the depot (each route without its last leg) and m
//!    more depot legs to different ponds. The least such structure is a lower bound, and stays one if every pond gets a
//!    penalty that is added to all its legs and taken off twice: Held and Karp, The traveling-salesman problem and minimum
//!    spanning trees, Operations Research 1970, part II Mathematical Programming 1971. Penalties rise by subgradient steps.
//!    Among trees with m edges at the depot the least one comes from the one with one by m - 1 best exchanges (Glover and
//!    Klingman, Finding minimum spanning trees with a fixed number of links at a node, 1975).
//!
//! What we changed: trees are found on a sparse graph and still bound the complete one. A pair of ponds i, j that is not
//! among each other's k nearest is at least (rᵢ + rⱼ) / 2 apart, r the distance to the k-th. With such costs, sums of a term
//! for each end, every pair costs no less than the two legs through the pond with the least term. So a star around that
//! pond stands for all pairs that the graph lacks.
//!
//! In seconds the same holds for what each leg takes at least, with the time on station of the ponds that are left (`price`).
//!
//! The rooms, in reading order: `price` (what is counted), `graph` (ponds and legs), `tree`, `ascent` (penalties).
//!
//! O(i n (k + log n + m)) for i steps, the last term in the worst case only: where every exchange cuts off a small part.

mod ascent;
mod graph;
mod price;
mod tree;

use crate::problem::Problem;
pub(crate) use ascent::Ascent;
pub(crate) use graph::SparseGraph;
use price::{Durations, Lengths};

/// Neighbours of a pond in the sparse graph: enough that on a grid pairs beyond them hardly enter a tree.
pub(crate) const NUM_NEIGHBOURS: usize = 12;
/// Shares of the ponds, the farthest ones, among which the best bound is sought.
const PARTS: [f64; 11] = [0.97, 0.94, 0.91, 0.87, 0.82, 0.75, 0.66, 0.55, 0.43, 0.3, 0.15];
/// Keeps a bound that equals the optimum from exceeding it by rounding.
const ROUNDING: f64 = 1.0 - 1e-10;

/// A length that the longest route of no plan falls below, in length units. Speed, service and limits are not considered.
#[must_use]
pub fn lower_bound(problem: &Problem) -> f64 {
    bound_of_longest_route(&SparseGraph::new(problem, &Lengths, NUM_NEIGHBOURS), problem.vehicle_type().num_available)
}

/// A duration that the longest route of no plan falls below, in seconds: with take-off, stops, time on station and the way
/// home. Limits are not considered. Equal to [`lower_bound`] where seconds are length units.
#[must_use]
pub fn lower_bound_of_makespan(problem: &Problem) -> f64 {
    let vehicle_type = problem.vehicle_type();
    bound_of_longest_route(
        &SparseGraph::new(problem, &Durations(vehicle_type), NUM_NEIGHBOURS),
        vehicle_type.num_available,
    )
}

/// A length that the total of no plan falls below, in length units. By the triangle inequality one route is the shortest way
/// to visit everything, so it does not depend on the number of drones.
#[must_use]
pub fn lower_bound_of_total(problem: &Problem) -> f64 {
    bound_of_total(&SparseGraph::new(problem, &Lengths, NUM_NEIGHBOURS))
}

fn bound_of_longest_route(graph: &SparseGraph, num_routes: usize) -> f64 {
    let num_ponds = graph.num_ponds();
    let mut ascent = Ascent::new(graph);
    let mean_route = |total: f64, num_ponds: usize| {
        (total + graph.service_of_farthest(num_ponds)) / num_routes.min(num_ponds) as f64
    };
    let all = mean_route(ascent.rise(num_ponds, num_routes), num_ponds);
    // The penalties of all ponds serve any part of them well enough to tell which part gives the best bound.
    let (far, num_far) = PARTS
        .iter()
        .map(|part| (part * num_ponds as f64).ceil() as usize)
        .map(|num_far| (mean_route(ascent.relax(num_far, num_routes), num_far), num_far))
        .fold((all, num_ponds), |best, part| if part.0 > best.0 { part } else { best });
    let risen = mean_route(ascent.rise(num_far, num_routes), num_far);
    graph.farthest_pond_bound().max(ROUNDING * far.max(risen))
}

fn bound_of_total(graph: &SparseGraph) -> f64 {
    let tour = Ascent::new(graph).rise(graph.num_ponds(), 1);
    graph.farthest_pond_bound().max(ROUNDING * tour)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::evaluate;
    use crate::generate::{Variant, generate};
    use crate::geometry::Point;
    use crate::problem::{Depot, VehicleType, Visit, WayHome};
    use proptest::prelude::*;

    fn problem(depot: (f64, f64), ponds: &[(f64, f64)], num_routes: usize) -> Problem {
        let ponds: Vec<Point> = ponds.iter().map(|&(x, y)| Point::new(x, y)).collect();
        Problem::research(Point::new(depot.0, depot.1), &ponds, num_routes).unwrap()
    }

    /// Per set of ponds (a bit each) the length of its shortest route: Held and Karp's dynamic program.
    fn shortest_routes(problem: &Problem) -> Vec<f64> {
        let ponds: Vec<Point> = problem.visits().iter().map(|visit| visit.position).collect();
        let depot = problem.depot().position;
        let num = ponds.len();
        let mut paths = vec![vec![f64::INFINITY; num]; 1 << num];
        let mut routes = vec![0.0; 1 << num];
        for set in 1usize..1 << num {
            for last in (0..num).filter(|last| set >> last & 1 == 1) {
                let before = set & !(1 << last);
                paths[set][last] = if before == 0 {
                    depot.distance(ponds[last])
                } else {
                    let via = |pond: usize| paths[before][pond] + ponds[pond].distance(ponds[last]);
                    (0..num).map(via).fold(f64::INFINITY, f64::min)
                };
            }
            let home = |last: usize| paths[set][last] + depot.distance(ponds[last]);
            routes[set] = (0..num).map(home).fold(f64::INFINITY, f64::min);
        }
        routes
    }

    /// The shortest longest route, by trying every partition.
    fn optimum(routes: &[f64], num_routes: usize) -> f64 {
        let mut best = routes.to_vec();
        for _ in 1..num_routes {
            let improved = |set: usize| {
                let mut least = best[set];
                let mut part = set;
                while part > 0 {
                    least = least.min(routes[part].max(best[set & !part]));
                    part = (part - 1) & set;
                }
                least
            };
            best = (0..routes.len()).map(improved).collect();
        }
        best[routes.len() - 1]
    }

    #[test]
    fn bounds_by_hand() {
        // All ponds on a line from the depot: the farthest decides, whatever the number of drones.
        let line = problem((0.0, 0.0), &[(1.0, 0.0), (2.0, 0.0), (5.0, 0.0)], 2);
        assert_eq!(lower_bound(&line), 10.0);
        assert!((lower_bound_of_total(&line) - 10.0).abs() < 1e-9);
        // One drone round a square: the bound is the perimeter.
        let square = problem((0.0, 0.0), &[(1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], 1);
        assert!((lower_bound(&square) - 4.0).abs() < 1e-9);
        // Two drones, two clusters far away on one side: each drone flies there.
        let far = problem((0.0, 0.0), &[(10.0, 0.0), (10.0, 3.0), (10.0, 6.0), (10.0, 9.0), (0.1, 0.0)], 2);
        assert!(lower_bound(&far) > 2.0 * 10.0 && lower_bound(&far) >= 2.0 * 181.0f64.sqrt());
    }

    #[test]
    fn ponds_in_one_place_and_at_the_depot() {
        assert_eq!(lower_bound(&problem((1.0, 1.0), &[(1.0, 1.0); 30], 4)), 0.0);
        assert_eq!(lower_bound(&problem((0.0, 0.0), &[(3.0, 4.0); 30], 4)), 10.0);
        assert_eq!(lower_bound(&problem((0.0, 0.0), &[(3.0, 4.0)], 4)), 10.0);
    }

    #[test]
    fn the_bound_of_far_ponds_beats_the_mean_of_all() {
        // Three drones for 100 ponds 10 away and three beside the depot. Over all ponds two drones may stay at the depot:
        // about (100 + 2 * 10) / 3. Without the near ones all three fly there: about (100 + 6 * 10) / 3.
        let far = (0..100).map(|pond| (10.0 + f64::from(pond % 10), f64::from(pond / 10)));
        let near = (1..=3).map(|pond| (0.01 * f64::from(pond), 4.5));
        let problem = problem((0.0, 4.5), &far.chain(near).collect::<Vec<_>>(), 3);
        let graph = SparseGraph::new(&problem, &Lengths, NUM_NEIGHBOURS);
        let mean_of_all = Ascent::new(&graph).rise(103, 3) / 3.0;
        assert!(lower_bound(&problem) > 1.25 * mean_of_all.max(graph.farthest_pond_bound()));
    }

    /// Per set of ponds (a bit each) the duration of its fastest route.
    fn fastest_routes(problem: &Problem) -> Vec<f64> {
        let num = problem.num_visits();
        let mut routes = vec![f64::INFINITY; 1 << num];
        routes[0] = 0.0;
        extend_route(problem, &mut Vec::new(), 0, &mut routes);
        routes
    }

    fn extend_route(problem: &Problem, route: &mut Vec<usize>, set: usize, routes: &mut [f64]) {
        for visit in (0..problem.num_visits()).filter(|visit| set >> visit & 1 == 0) {
            route.push(visit);
            let set = set | 1 << visit;
            let duration = evaluate(problem, std::slice::from_ref(route)).unwrap().makespan();
            routes[set] = routes[set].min(duration);
            extend_route(problem, route, set, routes);
            route.pop();
        }
    }

    /// Few ponds with time on station, some at the depot and some in one place, and drones with take-offs, stops, and a way
    /// home that is faster or slower than the other legs, or like them.
    fn problems_in_seconds() -> impl Strategy<Value = Problem> {
        let place = prop_oneof![
            3 => (0.0..4.0f64, 0.0..4.0f64),
            1 => (0..3u8, 0..3u8).prop_map(|(x, y)| (x.into(), y.into())),
        ];
        let visit = (place, prop_oneof![Just(0.0), 0.0..3.0f64]);
        let way_home = prop::option::of((0.3..8.0f64, 0.0..3.0f64));
        let stop = prop_oneof![Just(0.0), 0.0..2.0f64];
        (prop::collection::vec(visit, 1..7), 0.0..3.0f64, stop, way_home).prop_map(
            |(visits, takeoff_duration, leg_stop_duration, way_home)| {
                let visits = visits
                    .into_iter()
                    .map(|((x, y), service_duration)| Visit { service_duration, ..Visit::at(Point::new(x, y)) });
                let vehicle_type = VehicleType {
                    speed: 2.0,
                    leg_stop_duration,
                    takeoff_duration,
                    way_home: way_home.map(|(speed, fixed_duration)| WayHome { speed, fixed_duration }),
                    ..VehicleType::unlimited(1)
                };
                Problem::new(Depot { position: Point::new(1.0, 1.0) }, visits.collect(), vehicle_type).unwrap()
            },
        )
    }

    #[test]
    fn bounds_in_seconds_by_hand() {
        let visits = |places: &[(f64, f64)]| {
            let visit = |&(x, y)| Visit { service_duration: 10.0, ..Visit::at(Point::new(x, y)) };
            places.iter().map(visit).collect::<Vec<Visit>>()
        };
        let drones = VehicleType {
            speed: 5.0,
            leg_stop_duration: 3.0,
            takeoff_duration: 9.0,
            way_home: Some(WayHome { speed: 10.0, fixed_duration: 44.0 }),
            ..VehicleType::unlimited(2)
        };
        let bound = |places: &[(f64, f64)], vehicle_type| {
            let problem = Problem::new(Depot { position: Point::default() }, visits(places), vehicle_type).unwrap();
            lower_bound_of_makespan(&problem)
        };
        // 9 + 60 / 5 + 3, 10, 60 / 10 + 44 s.
        assert_eq!(bound(&[(60.0, 0.0), (20.0, 0.0)], drones), 84.0);
        // Home at 1 m/s: 60 s straight, or 12 s to the depot with one stop of 3 s, and 44 s there.
        let slow_home = VehicleType { way_home: Some(WayHome { speed: 1.0, fixed_duration: 44.0 }), ..drones };
        assert_eq!(bound(&[(60.0, 0.0)], slow_home), 24.0 + 10.0 + 12.0 + 3.0 + 44.0);
        // One drone round a square: four legs, of which the last is the way home.
        let one = VehicleType { num_available: 1, ..drones };
        let square = bound(&[(50.0, 0.0), (50.0, 50.0), (0.0, 50.0)], one);
        assert!((square - (9.0 + 3.0 * 13.0 + 30.0 + 5.0 + 44.0)).abs() < 1e-6, "{square}");
        // Ponds beside the depot: all that counts is the time on station, shared by two drones.
        let here = bound(&[(0.0, 0.0); 30], VehicleType { way_home: None, takeoff_duration: 0.0, ..drones });
        assert!((here - 150.0).abs() < 1e-6, "{here}");
    }

    fn place() -> impl Strategy<Value = (f64, f64)> {
        (0.0..1.0, 0.0..1.0)
    }

    proptest! {
        #[test]
        fn no_bound_exceeds_the_optimum(
            depot in place(), ponds in prop::collection::vec(place(), 1..9), num_neighbours in 1usize..9,
        ) {
            let problem = problem(depot, &ponds, 1);
            let routes = shortest_routes(&problem);
            let graph = SparseGraph::new(&problem, &Lengths, num_neighbours);
            prop_assert!(bound_of_total(&graph) <= routes[routes.len() - 1] * (1.0 + 1e-9));
            for num_routes in 1..=4 {
                let bound = bound_of_longest_route(&graph, num_routes);
                prop_assert!(bound <= optimum(&routes, num_routes) * (1.0 + 1e-9));
                prop_assert!(bound >= graph.farthest_pond_bound());
            }
        }

        #[test]
        fn no_bound_in_seconds_exceeds_the_optimum(problem in problems_in_seconds(), num_neighbours in 1usize..9) {
            let vehicle_type = problem.vehicle_type();
            let routes = fastest_routes(&problem);
            let graph = SparseGraph::new(&problem, &Durations(vehicle_type), num_neighbours);
            for num_routes in 1..=4 {
                let bound = bound_of_longest_route(&graph, num_routes);
                let optimum = optimum(&routes, num_routes);
                prop_assert!(bound <= optimum * (1.0 + 1e-9), "{bound} {optimum}");
                prop_assert!(bound >= graph.farthest_pond_bound());
            }
        }

        #[test]
        fn where_seconds_are_length_units_the_bounds_are_one(
            depot in place(), ponds in prop::collection::vec(place(), 1..60), num_routes in 1usize..9,
        ) {
            let problem = problem(depot, &ponds, num_routes);
            prop_assert_eq!(lower_bound_of_makespan(&problem), lower_bound(&problem));
        }

        #[test]
        fn faster_drones_have_a_lower_bound(
            depot in place(), ponds in prop::collection::vec(place(), 1..40), num_routes in 1usize..5,
        ) {
            let unit = problem(depot, &ponds, num_routes);
            let vehicle_type = VehicleType { speed: 4.0, ..unit.vehicle_type() };
            let fast = Problem::new(unit.depot(), unit.visits().to_vec(), vehicle_type).unwrap();
            prop_assert!((4.0 * lower_bound_of_makespan(&fast) - lower_bound(&unit)).abs() <= 1e-9);
        }

        #[test]
        fn no_bound_exceeds_a_plan(seed: u64, num_ponds in 1usize..150, num_routes in 1usize..9) {
            let farm = generate(num_ponds, Variant::Authors, seed).unwrap();
            let problem = Problem::research(farm.depot, &farm.ponds, num_routes).unwrap();
            // Columns of the grid, up and down, in parts of equal size.
            let mut order: Vec<usize> = (0..num_ponds).collect();
            order.sort_by(|&a, &b| {
                let (a, b) = (farm.ponds[a], farm.ponds[b]);
                let is_up = (a.x / farm.spacing).round() as i64 % 2 == 0;
                a.x.total_cmp(&b.x).then(if is_up { a.y.total_cmp(&b.y) } else { b.y.total_cmp(&a.y) })
            });
            let routes: Vec<Vec<usize>> =
                order.chunks(num_ponds.div_ceil(num_routes)).map(<[usize]>::to_vec).collect();
            let plan = evaluate(&problem, &routes).unwrap();
            prop_assert!(plan.is_feasible());
            prop_assert!(lower_bound(&problem) <= plan.max_route_length());
            prop_assert!(lower_bound_of_total(&problem) <= plan.total_length());
        }

        #[test]
        fn moving_turning_and_scaling_a_farm_scales_its_bound(
            ponds in prop::collection::vec((0u16.., 0u16..), 1..40), num_routes in 1usize..6,
        ) {
            // Whole numbers, so that every distance is computed alike.
            let ponds: Vec<(f64, f64)> = ponds.into_iter().map(|(x, y)| (x.into(), y.into())).collect();
            let bound = lower_bound(&problem((0.0, 0.0), &ponds, num_routes));
            let changed: Vec<(f64, f64)> = ponds.iter().map(|&(x, y)| (1000.0 - 4.0 * y, 4.0 * x - 77.0)).collect();
            let changed_bound = lower_bound(&problem((1000.0, -77.0), &changed, num_routes));
            prop_assert!((changed_bound - 4.0 * bound).abs() <= 1e-9 * changed_bound);
        }
    }
}
