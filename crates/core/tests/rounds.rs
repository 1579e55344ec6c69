//! What the search says of rounds against their judge, and against brute force.

mod random_rounds;

use pondhop_core::random::Random;
use pondhop_core::rounds::{
    Fleet, Round, RoundPlan, RoundViolation, Rounding, TimeWindow, evaluate_round, makespan_bound,
};
use pondhop_core::search::{Goal, Options, solve_round};
use random_rounds::{fleet, random_round, round, visit};

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
    let mut fleet = Fleet { capacity: 1.0, shift: TimeWindow { earliest: 0.0, latest: 70.0 }, ..fleet(1, None) };
    fleet.vehicle_type.max_duration = 40.0;
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
            "trip 0 of route 0 takes 2, it may take 1",
            "trip 0 of route 0 takes 45 s, the limit is 40 s",
            "route 0 ends 45 s after the shift",
            "visit 0 begins 2 s too late",
            "visit 0 begins 32 s too late",
        ]
    );
    assert!(plan.violations.contains(&RoundViolation::Unserved { visit: 2 }));
    assert_eq!(evaluate_round(&task, &[vec![vec![3]]]).unwrap_err().faults[0].path, "routes[0][0][0]");
}

fn solved(task: &Round, goal: Goal, steps: u64, seed: u64) -> Vec<Vec<Vec<usize>>> {
    solve_round(task, &Options { seed, goal, max_iterations: Some(steps), ..Options::default() }).routes
}

/// What a plan breaks, besides leaving visits out.
fn broken(plan: &RoundPlan) -> Vec<&RoundViolation> {
    plan.violations.iter().filter(|broken| !matches!(broken, RoundViolation::Unserved { .. })).collect()
}

#[test]
fn what_the_search_calls_feasible_is_feasible() {
    let mut random = Random::new(7);
    let (mut num_made, mut num_exact) = (0, 0);
    for seed in 0..6000 {
        let num_visits = 1 + random.below(30);
        let task = random_round(&mut random, num_visits, false);
        let goal = if seed % 2 == 0 { Goal::Max } else { Goal::Total };
        let outcome = solve_round(&task, &Options { seed, goal, max_iterations: Some(40), ..Options::default() });
        let routes = outcome.routes;
        let plan = evaluate_round(&task, &routes).unwrap();
        // Where a visit has several windows the judge may begin it in an earlier one, and another drone may wait for a place.
        let is_exact = task.visits().iter().all(|visit| visit.windows.len() < 2);
        let has_queue = task.fleet().num_pads < task.fleet().vehicle_type.num_available;
        let difference = outcome.makespan - plan.makespan();
        assert!(difference > -1e-6 || (!is_exact && has_queue), "seed {seed}: {difference}");
        assert!(difference < 1e-6 || !is_exact, "seed {seed}: {difference}");
        num_exact += usize::from(is_exact);
        let bound = makespan_bound(&task);
        assert!(!plan.is_feasible() || bound <= plan.makespan() + 1e-6, "seed {seed}: {bound}");
        assert!(broken(&plan).is_empty(), "seed {seed}: {:?}", broken(&plan));
        num_made += routes.iter().flatten().map(Vec::len).sum::<usize>();
    }
    assert!(
        num_made > 30_000 && num_exact > 1000,
        "{num_made} visits were made, {num_exact} rounds had one window a visit"
    );
}

#[test]
fn the_same_seed_gives_the_same_routes() {
    for goal in [Goal::Max, Goal::Total] {
        let task = random_round(&mut Random::new(3), 25, false);
        assert_eq!(solved(&task, goal, 500, 4), solved(&task, goal, 500, 4));
        let options = Options { seed: 4, goal, max_iterations: Some(500), num_threads: 3, ..Options::default() };
        let threads = [(); 2].map(|()| solve_round(&task, &options).routes);
        assert_eq!(threads[0], threads[1]);
        // The best of three chains is no worse than the first of them.
        let ranks = [&threads[0], &solved(&task, goal, 500, 4)]
            .map(|routes| rank(&task, &evaluate_round(&task, routes).unwrap(), goal));
        assert!(!is_better(ranks[1], ranks[0]));
    }
}

/// What a plan is judged by: the priorities of what it leaves out, then when the last drone lands, if that counts, then what all
/// of them fly, with a stay at the depot for each trip if that counts.
fn rank(task: &Round, plan: &RoundPlan, goal: Goal) -> (f64, f64, f64) {
    let mut absent: f64 = task.visits().iter().map(|visit| visit.priority).sum();
    let mut flown = 0.0;
    for trip in plan.routes.iter().flatten() {
        flown += trip.arrival - trip.departure;
        if goal == Goal::Max {
            flown += task.fleet().turnaround.unwrap_or(0.0);
        }
        for stop in &trip.stops {
            absent -= task.visits()[stop.visit].priority;
            flown -= stop.departure - stop.arrival;
        }
    }
    (absent, if goal == Goal::Max { plan.makespan() } else { 0.0 }, flown)
}

fn is_better(one: (f64, f64, f64), other: (f64, f64, f64)) -> bool {
    let differs = |one: f64, other: f64| (one - other).abs() > 1e-6;
    if differs(one.0, other.0) {
        one.0 < other.0
    } else if differs(one.1, other.1) {
        one.1 < other.1
    } else {
        differs(one.2, other.2) && one.2 < other.2
    }
}

/// The best rank over all plans: all orders of all choices of visits, cut into trips and shared by the drones in every way.
fn best_by_brute_force(task: &Round, goal: Goal) -> (f64, f64, f64) {
    struct All<'a> {
        task: &'a Round,
        goal: Goal,
        best: (f64, f64, f64),
    }
    impl All<'_> {
        fn extend(&mut self, routes: &mut Vec<Vec<Vec<usize>>>, left: &mut Vec<usize>) {
            let plan = evaluate_round(self.task, routes).unwrap();
            if !broken(&plan).is_empty() {
                return;
            }
            let rank = rank(self.task, &plan, self.goal);
            if is_better(rank, self.best) {
                self.best = rank;
            }
            for index in 0..left.len() {
                let visit = left.remove(index);
                let last = routes.len() - 1;
                if let Some(trip) = routes[last].last_mut() {
                    trip.push(visit);
                    self.extend(routes, left);
                    routes[last].last_mut().unwrap().pop();
                }
                routes[last].push(vec![visit]);
                self.extend(routes, left);
                routes[last].pop();
                for skipped in 1..=self.task.fleet().vehicle_type.num_available - routes.len() {
                    let num_routes = routes.len();
                    routes.resize(num_routes + skipped - 1, Vec::new());
                    routes.push(vec![vec![visit]]);
                    self.extend(routes, left);
                    routes.truncate(num_routes);
                }
                left.insert(index, visit);
            }
        }
    }
    let mut all = All { task, goal, best: (f64::INFINITY, 0.0, 0.0) };
    all.extend(&mut vec![Vec::new()], &mut (0..task.visits().len()).collect());
    all.best
}

#[test]
fn the_search_finds_what_brute_force_finds() {
    let mut random = Random::new(11);
    for seed in 0..200 {
        let num_visits = 1 + random.below(5);
        let drawn = random_round(&mut random, num_visits, false);
        let mut fleet = drawn.fleet().clone();
        fleet.vehicle_type.num_available = fleet.vehicle_type.num_available.min(2);
        let task = Round::new(drawn.depot(), drawn.visits().to_vec(), fleet, Rounding::Exact).unwrap();
        let goal = if seed % 2 == 0 { Goal::Max } else { Goal::Total };
        let plan = evaluate_round(&task, &solved(&task, goal, 3000, seed)).unwrap();
        let (found, best) = (rank(&task, &plan, goal), best_by_brute_force(&task, goal));
        assert!(!is_better(best, found), "seed {seed}: found {found:?}, best {best:?}");
    }
}
