//! Rounds for tests: by hand, and at random.

use pondhop_core::geometry::Point;
use pondhop_core::problem::{Energy, Layer, VehicleType, Visit, WayHome};
use pondhop_core::random::Random;
use pondhop_core::rounds::{Fleet, Round, RoundVisit, Rounding, TimeWindow};
use pondhop_core::travel::Air;

pub fn visit(x: f64, y: f64, service: f64, windows: &[(f64, f64)]) -> RoundVisit {
    RoundVisit {
        windows: windows.iter().map(|&(earliest, latest)| TimeWindow { earliest, latest }).collect(),
        load: 1.0,
        ..RoundVisit::at_any_time(Visit { position: Point::new(x, y), service_duration: service, service_energy: 0.0 })
    }
}

pub fn fleet(num_drones: usize, turnaround: Option<f64>) -> Fleet {
    Fleet { turnaround, ..Fleet::of(VehicleType::unlimited(num_drones)) }
}

pub fn round(visits: Vec<RoundVisit>, fleet: Fleet) -> Round {
    Round::new(Point::new(0.0, 0.0), visits, fleet, Rounding::Exact).unwrap()
}

/// A random round in which every feature is on. Where bounds go wrong most easily, ways home may be much faster than other legs, and
/// the airspeed unlimited (`has_fast_ways`).
pub fn random_round(random: &mut Random, num_visits: usize, has_fast_ways: bool) -> Round {
    let number = |random: &mut Random, most: usize| random.below(most) as f64;
    let most_windows = 1 + random.below(2);
    let visits = (0..num_visits)
        .map(|_| {
            let mut windows: Vec<(f64, f64)> = (0..random.below(most_windows + 1))
                .map(|_| {
                    let earliest = number(random, 300);
                    (earliest, earliest + number(random, 80))
                })
                .collect();
            windows.sort_by(|one, other| one.0.total_cmp(&other.0));
            let mut visit = RoundVisit {
                release: if random.below(3) == 0 { number(random, 100) } else { 0.0 },
                load: number(random, 4),
                priority: 1.0 + number(random, 3),
                ..visit(number(random, 60), number(random, 60), number(random, 10), &windows)
            };
            visit.visit.service_energy = number(random, 60);
            visit
        })
        .collect();
    let rounding = if random.below(3) > 0 { Rounding::Exact } else { Rounding::Dimacs };
    Round::new(Point::new(30.0, 30.0), visits, random_fleet(random, has_fast_ways), rounding).unwrap()
}

fn random_fleet(random: &mut Random, has_fast_ways: bool) -> Fleet {
    let number = |random: &mut Random, most: usize| random.below(most) as f64;
    let unlimited_or = |random: &mut Random, least: f64, more: usize| {
        if random.below(2) == 0 { f64::INFINITY } else { least + number(random, more) }
    };
    let step = if has_fast_ways { 4.0 } else { 1.0 };
    let way_home = (random.below(2) == 0)
        .then(|| WayHome { speed: 1.0 + step * number(random, 3), fixed_duration: number(random, 9) });
    let energy = Energy {
        takeoff_energy: number(random, 30),
        leg_power: 3.0,
        leg_stop_power: 2.0,
        way_home_power: 4.0,
        way_home_fixed_energy: number(random, 30),
        usable_energy: unlimited_or(random, 400.0, 600),
    };
    let vehicle_type = VehicleType {
        speed: 1.0 + number(random, 3),
        leg_stop_duration: number(random, 3),
        takeoff_duration: number(random, 5),
        way_home,
        energy,
        max_length: unlimited_or(random, 100.0, 200),
        max_duration: unlimited_or(random, 100.0, 200),
        ..VehicleType::unlimited(1 + random.below(3))
    };
    let layers = (0..if way_home.is_some() { random.below(3) } else { 0 })
        .map(|_| Layer {
            takeoff_duration: number(random, 9),
            way_home_duration: number(random, 9),
            takeoff_energy: number(random, 30),
            way_home_energy: number(random, 30),
        })
        .collect();
    let wind = Point::new(number(random, 5) - 2.0, number(random, 5) - 2.0);
    let max_airspeed = if has_fast_ways { unlimited_or(random, 3.0, 3) } else { 3.0 + number(random, 3) };
    Fleet {
        layers,
        air: Air { wind, max_airspeed, drag_power: 0.1 },
        capacity: 4.0 + number(random, 8),
        shift: TimeWindow { earliest: number(random, 20), latest: 300.0 + number(random, 300) },
        takeoff_interval: number(random, 5),
        turnaround: (random.below(3) > 0).then(|| number(random, 30)),
        num_pads: 1 + random.below(3),
        ..Fleet::of(vehicle_type)
    }
}
