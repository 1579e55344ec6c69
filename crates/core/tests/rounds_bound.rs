//! `makespan_bound` and `fewest_trips` by hand, and against the plans that the search finds.

mod random_rounds;

use pondhop_core::geometry::Point;
use pondhop_core::problem::{Energy, VehicleType, WayHome};
use pondhop_core::random::Random;
use pondhop_core::rounds::{Fleet, Round, RoundVisit, Rounding, evaluate_round, fewest_trips, makespan_bound};
use pondhop_core::search::{Options, solve_round};
use pondhop_core::travel::Air;
use random_rounds::{fleet, random_round, round, visit};

fn assert_near(value: f64, hoped: f64) {
    assert!((value - hoped).abs() < 1e-6, "{value}, not {hoped}");
}

#[test]
fn one_visit_waits_for_its_window_and_its_release() {
    let task = round(vec![visit(10.0, 0.0, 5.0, &[(0.0, 8.0), (100.0, 110.0)])], fleet(1, None));
    // It is reached at 10, after its first window.
    assert_near(makespan_bound(&task), 115.0);
    let task = round(vec![RoundVisit { release: 120.0, ..visit(10.0, 0.0, 5.0, &[]) }], fleet(2, None));
    assert_near(makespan_bound(&task), 145.0);
    assert_eq!(fewest_trips(&task), Some(1));
    let late = round(vec![visit(10.0, 0.0, 5.0, &[(0.0, 8.0)])], fleet(1, None));
    assert_eq!(makespan_bound(&late), f64::INFINITY);
}

#[test]
fn what_is_too_much_for_one_trip_takes_more() {
    // Ten visits in one place 10 s away, 2 s each, and 4 of them a trip: 3 trips of 20 s, 20 s of service, two turnarounds.
    let visits: Vec<RoundVisit> = (0..10).map(|_| visit(10.0, 0.0, 2.0, &[])).collect();
    let loaded =
        |num_drones, turnaround| round(visits.clone(), Fleet { capacity: 4.0, ..fleet(num_drones, turnaround) });
    assert_eq!(fewest_trips(&loaded(1, Some(30.0))), Some(3));
    assert_near(makespan_bound(&loaded(1, Some(30.0))), 140.0);
    // Two drones: the mean of 80 s and one turnaround.
    assert_near(makespan_bound(&loaded(2, Some(30.0))), 55.0_f64.max(2.0 * 22.0 + 30.0));
    // Two drones that fly one trip each do not make it.
    assert_eq!((fewest_trips(&loaded(2, None)), makespan_bound(&loaded(2, None))), (None, f64::INFINITY));
    assert_near(makespan_bound(&loaded(3, None)), 80.0 / 3.0);
    // The same by energy: 1 J a second of the way, 20 there and back, 5 a visit, 40 at most.
    let energy = Energy { leg_power: 1.0, usable_energy: 40.0, ..Energy::UNKNOWN };
    let mut fleet = fleet(1, Some(30.0));
    fleet.vehicle_type.energy = energy;
    let mut visits = visits;
    for visit in &mut visits {
        visit.visit.service_energy = 5.0;
    }
    let task = round(visits, fleet);
    assert_eq!(fewest_trips(&task), Some(3));
    assert_near(makespan_bound(&task), 140.0);
}

#[test]
fn one_place_at_the_depot_turns_drones_round_one_after_the_other() {
    // Six trips of three drones, one visit each 10 s away: three turnarounds of 100 s on one place, between two trips.
    let visits: Vec<RoundVisit> = (0..6).map(|_| visit(10.0, 0.0, 0.0, &[])).collect();
    let fleet = Fleet { capacity: 1.0, num_pads: 1, ..fleet(3, Some(100.0)) };
    let task = round(visits, fleet);
    assert_near(makespan_bound(&task), 20.0 + 300.0 + 20.0);
    let routes: Vec<Vec<Vec<usize>>> = (0..3).map(|drone| vec![vec![2 * drone], vec![2 * drone + 1]]).collect();
    assert_near(evaluate_round(&task, &routes).unwrap().makespan(), 340.0);
}

#[test]
fn late_windows_are_shared_from_their_hour_on() {
    // Six visits of 30 s that begin at 1000 or later, by two drones, 10 s from home.
    let visits: Vec<RoundVisit> = (0..6).map(|_| visit(0.0, 10.0, 30.0, &[(1000.0, 2000.0)])).collect();
    assert_near(makespan_bound(&round(visits, fleet(2, None))), 1000.0 + 90.0 + 10.0);
}

#[test]
fn drones_that_take_off_later_fly_less() {
    // Two drones, 20 s apart, for 100 s of service at the depot: the mean of 0 and 20, and 50.
    let visits: Vec<RoundVisit> = (0..10).map(|_| visit(0.0, 0.0, 10.0, &[])).collect();
    let task = round(visits, Fleet { takeoff_interval: 20.0, ..fleet(2, None) });
    assert_near(makespan_bound(&task), 60.0);
}

#[test]
fn a_way_against_the_wind_counts() {
    // 8 m/s from the west, 10 m/s over ground, 12 through the air: 8 s out, 20 s home.
    let mut fleet =
        Fleet { air: Air { wind: Point::new(8.0, 0.0), max_airspeed: 12.0, drag_power: 0.0 }, ..fleet(1, None) };
    fleet.vehicle_type.speed = 10.0;
    let visits: Vec<RoundVisit> = (1..=8).map(|place| visit(10.0 * f64::from(place), 0.0, 0.0, &[])).collect();
    assert_near(makespan_bound(&round(visits, fleet)), 28.0);
}

#[test]
fn a_fast_way_home_makes_many_trips_faster_than_one() {
    // Four visits 100 s out and 1 s back, by one drone without a turnaround.
    let mut fleet = fleet(1, Some(0.0));
    fleet.vehicle_type.way_home = Some(WayHome { speed: 100.0, fixed_duration: 0.0 });
    let places = [(100.0, 0.0), (0.0, 100.0), (-100.0, 0.0), (0.0, -100.0)];
    let visits = places.iter().map(|&(x, y)| visit(x, y, 0.0, &[])).collect();
    let task = round(visits, fleet);
    assert_near(makespan_bound(&task), 404.0);
    assert_near(evaluate_round(&task, &[vec![vec![0], vec![1], vec![2], vec![3]]]).unwrap().makespan(), 404.0);
}

#[test]
fn no_bound_exceeds_a_plan() {
    let mut random = Random::new(11);
    let (mut num_whole, mut gaps) = (0, 0.0);
    for seed in 0..8000 {
        let num_visits = 1 + random.below(if seed % 8 == 0 { 30 } else { 9 });
        let task = random_round(&mut random, num_visits, true);
        let bound = makespan_bound(&task);
        let routes = solve_round(&task, &Options { seed, max_iterations: Some(200), ..Options::default() }).routes;
        let plan = evaluate_round(&task, &routes).unwrap();
        if plan.is_feasible() {
            let makespan = plan.makespan();
            assert!(bound <= makespan + 1e-6, "seed {seed}: {bound} over {makespan}");
            let num_trips = plan.routes.iter().map(Vec::len).sum();
            assert!(fewest_trips(&task).unwrap() <= num_trips, "seed {seed}");
            num_whole += 1;
            gaps += (makespan - bound) / makespan;
        }
    }
    let gap = gaps / f64::from(num_whole);
    println!("{num_whole} plans, mean gap {gap:.3}");
    assert!(num_whole > 1000 && gap < 0.2, "{num_whole} plans, {gap}");
}

/// A farm of so many visits of 60 s, with drones whose batteries last for about ten of them.
fn farm(seed: u64, num_visits: usize, num_drones: usize, wind: f64) -> Round {
    let mut random = Random::new(seed);
    let mut place = || 3.0 * random.below(400) as f64;
    let visits = (0..num_visits).map(|_| {
        let mut visit = visit(place(), place(), 60.0, &[]);
        visit.visit.service_energy = 60.0 * 354.0;
        visit
    });
    let energy = Energy {
        takeoff_energy: 3000.0,
        leg_power: 380.0,
        leg_stop_power: 354.0,
        usable_energy: 95.0 * 3600.0,
        ..Energy::UNKNOWN
    };
    let vehicle_type = VehicleType {
        speed: 8.0,
        leg_stop_duration: 3.0,
        takeoff_duration: 9.0,
        energy,
        ..VehicleType::unlimited(num_drones)
    };
    let air = Air { wind: Point::new(wind, 0.0), max_airspeed: 12.0, drag_power: 0.032 };
    let fleet = Fleet { air, turnaround: Some(240.0), ..Fleet::of(vehicle_type) };
    Round::new(Point::new(600.0, 600.0), visits.collect(), fleet, Rounding::Exact).unwrap()
}

#[test]
fn bounds_of_farms_are_near_the_plans() {
    for (wind, most) in [(0.0, 0.1), (8.0, 0.2)] {
        for seed in 0..3 {
            let task = farm(seed, 60, 3, wind);
            let bound = makespan_bound(&task);
            let routes =
                solve_round(&task, &Options { seed, max_iterations: Some(20_000), ..Options::default() }).routes;
            let plan = evaluate_round(&task, &routes).unwrap();
            assert!(plan.is_feasible());
            let num_trips: usize = plan.routes.iter().map(Vec::len).sum();
            let gap = 1.0 - bound / plan.makespan();
            println!(
                "wind {wind}: bound {bound:.0}, plan {:.0}, gap {gap:.3}, trips {:?} of {num_trips}",
                plan.makespan(),
                fewest_trips(&task)
            );
            assert!((0.0..most).contains(&gap), "wind {wind}, seed {seed}: {gap}");
        }
    }
}
