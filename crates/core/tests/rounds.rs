//! What the search says of rounds against their judge, and against brute force.

use pondhop_core::geometry::Point;
use pondhop_core::random::Random;
use pondhop_core::rounds::{Fleet, Round, RoundViolation, RoundVisit, Rounding, TimeWindow, evaluate_round};
use pondhop_core::search::{Options, solve_round};

fn visit(x: f64, y: f64, service: f64, windows: &[(f64, f64)]) -> RoundVisit {
    RoundVisit {
        position: Point::new(x, y),
        service_duration: service,
        windows: windows.iter().map(|&(earliest, latest)| TimeWindow { earliest, latest }).collect(),
        release: 0.0,
        load: 1.0,
    }
}

fn fleet(num_drones: usize, turnaround: Option<f64>) -> Fleet {
    Fleet { num_drones, capacity: f64::INFINITY, max_trip_duration: f64::INFINITY, shift: TimeWindow::ANY, turnaround }
}

fn round(visits: Vec<RoundVisit>, fleet: Fleet) -> Round {
    Round::new(Point::new(0.0, 0.0), visits, fleet, Rounding::Exact).unwrap()
}

#[test]
fn a_drone_waits_on_the_ground() {
    let task = round(vec![visit(10.0, 0.0, 5.0, &[(100.0, 110.0)])], fleet(1, None));
    let plan = evaluate_round(&task, &[vec![vec![0]]]).unwrap();
    let trip = &plan.routes[0][0];
    assert!(plan.is_feasible());
    assert_eq!((trip.departure, trip.stops[0].arrival, trip.stops[0].start, trip.arrival), (90.0, 100.0, 100.0, 115.0));
}

#[test]
fn what_cannot_be_waited_on_the_ground_is_waited_in_the_air() {
    // A [0, 20] and B [100, 120], 10 s apart and from the depot, 5 s each: out at 10, not at 0, and 65 s in the air.
    let height = 75.0_f64.sqrt();
    let visits = vec![visit(10.0, 0.0, 5.0, &[(0.0, 20.0)]), visit(5.0, height, 5.0, &[(100.0, 120.0)])];
    let task = round(visits, fleet(1, Some(30.0)));
    let plan = evaluate_round(&task, &[vec![vec![0, 1]]]).unwrap();
    let trip = &plan.routes[0][0];
    assert!((trip.departure - 10.0).abs() < 1e-9 && (trip.arrival - 115.0).abs() < 1e-9);
    assert!((trip.stops[1].start - trip.stops[1].arrival - 65.0).abs() < 1e-9);
    // Two trips land as early, without a wait in the air.
    let plan = evaluate_round(&task, &[vec![vec![0], vec![1]]]).unwrap();
    assert!((plan.makespan() - 115.0).abs() < 1e-9 && plan.is_feasible());
}

#[test]
fn every_broken_rule_is_told_with_its_amount() {
    let mut visits = vec![visit(10.0, 0.0, 5.0, &[(0.0, 8.0)]), visit(20.0, 0.0, 0.0, &[]), visit(0.0, 5.0, 0.0, &[])];
    visits[1].release = 30.0;
    let fleet = Fleet {
        capacity: 1.0,
        max_trip_duration: 40.0,
        shift: TimeWindow { earliest: 0.0, latest: 70.0 },
        ..fleet(1, None)
    };
    let task = round(visits, fleet);
    let plan = evaluate_round(&task, &[vec![vec![0, 1], vec![1]], vec![vec![0]]]).unwrap();
    let told: Vec<String> = plan.violations.iter().map(ToString::to_string).collect();
    assert_eq!(
        told,
        [
            "visit 0 is made 2 times",
            "visit 1 is made 2 times",
            "visit 2 is not made",
            "2 routes for 1 drones",
            "route 0 has 2 trips, a drone flies one",
            "visit 0 begins 32 s too late",
            "trip 0 of route 0 takes 2, it may take 1",
            "trip 0 of route 0 takes 45 s, the limit is 40 s",
            "route 0 ends 45 s after the shift",
            "visit 0 begins 2 s too late",
        ]
    );
    assert!(plan.violations.contains(&RoundViolation::Unserved { visit: 2 }));
    assert_eq!(evaluate_round(&task, &[vec![vec![3]]]).unwrap_err().faults[0].path, "routes[0][0][0]");
}

/// A random round in which every feature is on.
fn random_round(random: &mut Random, num_visits: usize) -> Round {
    let number = |random: &mut Random, most: usize| random.below(most) as f64;
    let visits = (0..num_visits)
        .map(|_| {
            let mut windows: Vec<(f64, f64)> = (0..random.below(3))
                .map(|_| {
                    let earliest = number(random, 300);
                    (earliest, earliest + number(random, 80))
                })
                .collect();
            windows.sort_by(|one, other| one.0.total_cmp(&other.0));
            RoundVisit {
                release: if random.below(3) == 0 { number(random, 100) } else { 0.0 },
                load: number(random, 4),
                ..visit(number(random, 60), number(random, 60), number(random, 10), &windows)
            }
        })
        .collect();
    let fleet = Fleet {
        num_drones: 1 + random.below(3),
        capacity: 4.0 + number(random, 8),
        max_trip_duration: if random.below(2) == 0 { f64::INFINITY } else { 100.0 + number(random, 200) },
        shift: TimeWindow { earliest: number(random, 20), latest: 300.0 + number(random, 300) },
        turnaround: (random.below(3) > 0).then(|| number(random, 30)),
    };
    let rounding = if random.below(2) == 0 { Rounding::Exact } else { Rounding::Dimacs };
    Round::new(Point::new(30.0, 30.0), visits, fleet, rounding).unwrap()
}

fn solved(task: &Round, steps: u64, seed: u64) -> Vec<Vec<Vec<usize>>> {
    solve_round(task, &Options { seed, max_iterations: Some(steps), ..Options::default() }).routes
}

#[test]
fn what_the_search_calls_feasible_is_feasible() {
    let mut random = Random::new(7);
    for seed in 0..3000 {
        let num_visits = 1 + random.below(30);
        let task = random_round(&mut random, num_visits);
        let plan = evaluate_round(&task, &solved(&task, 40, seed)).unwrap();
        let broken: Vec<&RoundViolation> =
            plan.violations.iter().filter(|broken| !matches!(broken, RoundViolation::Unserved { .. })).collect();
        assert!(broken.is_empty(), "seed {seed}: {broken:?}");
    }
}

#[test]
fn the_same_seed_gives_the_same_routes() {
    let task = random_round(&mut Random::new(3), 25);
    assert_eq!(solved(&task, 500, 4), solved(&task, 500, 4));
}

/// The most visits, and then the least length, over all plans of one drone.
fn best_by_brute_force(task: &Round) -> (usize, f64) {
    fn visit_all(task: &Round, route: &mut Vec<Vec<usize>>, left: &mut Vec<usize>, best: &mut (usize, f64)) {
        let plan = evaluate_round(task, std::slice::from_ref(route)).unwrap();
        if !plan.violations.iter().all(|broken| matches!(broken, RoundViolation::Unserved { .. })) {
            return;
        }
        let made: usize = route.iter().map(Vec::len).sum();
        if made > best.0 || (made == best.0 && plan.total_length() < best.1) {
            *best = (made, plan.total_length());
        }
        for index in 0..left.len() {
            let visit = left.remove(index);
            for is_new in [false, true] {
                if is_new || route.is_empty() {
                    route.push(Vec::new());
                }
                let last = route.len() - 1;
                route[last].push(visit);
                visit_all(task, route, left, best);
                route[last].pop();
                if route[last].is_empty() {
                    route.pop();
                }
            }
            left.insert(index, visit);
        }
    }
    let mut best = (0, f64::INFINITY);
    let mut left = (0..task.visits().len()).collect();
    visit_all(task, &mut Vec::new(), &mut left, &mut best);
    best
}

#[test]
fn the_search_finds_what_brute_force_finds() {
    let mut random = Random::new(11);
    for seed in 0..60 {
        let num_visits = 1 + random.below(5);
        let drawn = random_round(&mut random, num_visits);
        let fleet = Fleet { num_drones: 1, ..*drawn.fleet() };
        let task = Round::new(drawn.depot(), drawn.visits().to_vec(), fleet, Rounding::Exact).unwrap();
        let routes = solved(&task, 2000, seed);
        let plan = evaluate_round(&task, &routes).unwrap();
        let made: usize = routes.iter().flatten().map(Vec::len).sum();
        let best = best_by_brute_force(&task);
        assert_eq!(made, best.0, "seed {seed}");
        assert!(made == 0 || plan.total_length() < best.1 + 1e-6, "seed {seed}: {} {}", plan.total_length(), best.1);
    }
}
