//! The one truth about a plan: everything recomputed from the problem and bare routes.
//!
//! This module judges all planners, so it shares no code with any of them beyond what a leg is ([`crate::travel`]).
//! O(n) for n visits.

use crate::error::{Faults, InvalidInput};
use crate::plan::{Plan, Route, Stop, Violation};
use crate::problem::{Problem, VehicleType};
use crate::travel::{Leg, LegKind};

/// How far beyond a limit rounding may carry a length or duration before it counts as a violation, relative to the limit.
const TOLERANCE: f64 = 1e-9;

/// Flies `routes` (visit indices in flying order, the depot implied at both ends) and reports lengths, schedule,
/// energy and violations. Empty routes are dropped; where drones fly in layers, route i of the rest has layer i.
///
/// # Errors
/// [`InvalidInput`] if a route names a visit that does not exist. A plan that breaks a rule is not an error: see
/// [`Plan::violations`].
pub fn evaluate(problem: &Problem, routes: &[Vec<usize>]) -> Result<Plan, InvalidInput> {
    check_indices(problem, routes)?;
    let flown: Vec<Route> = (routes.iter().filter(|visits| !visits.is_empty()).enumerate())
        .map(|(index, visits)| fly(problem, visits, &problem.drone_of(index)))
        .collect();
    let mut violations = count_violations(problem, &flown);
    violations.extend(limit_violations(problem, &flown));
    Ok(Plan { routes: flown, violations })
}

pub(crate) fn check_indices(problem: &Problem, routes: &[Vec<usize>]) -> Result<(), InvalidInput> {
    let mut faults = Faults::default();
    for (route, visits) in routes.iter().enumerate() {
        for (place, &visit) in visits.iter().enumerate() {
            if visit >= problem.num_visits() {
                let message = format!("there is no pond {visit}");
                let action = format!("give an index of 0 to {}", problem.num_visits() - 1);
                faults.add(format!("routes[{route}][{place}]"), message, &action);
            }
        }
    }
    faults.into_result(())
}

fn fly(problem: &Problem, visits: &[usize], vehicle_type: &VehicleType) -> Route {
    let depot = problem.depot().position;
    let (mut position, mut kind) = (depot, LegKind::First);
    let (mut length, mut clock, mut energy) = (0.0, 0.0, 0.0);
    let mut stops = Vec::with_capacity(visits.len());
    for &index in visits {
        let visit = problem.visits()[index];
        let leg = Leg::new(position, visit.position, kind, vehicle_type);
        (position, kind) = (visit.position, LegKind::Between);
        length += leg.length;
        energy += leg.energy + visit.service_energy;
        let arrival = clock + leg.duration;
        clock = arrival + visit.service_duration;
        stops.push(Stop { visit: index, leg, arrival, departure: clock, service_energy: visit.service_energy });
    }
    let last_leg = Leg::new(position, depot, LegKind::Last, vehicle_type);
    length += last_leg.length;
    Route { stops, last_leg, length, duration: clock + last_leg.duration, energy: energy + last_leg.energy }
}

fn count_violations(problem: &Problem, routes: &[Route]) -> Vec<Violation> {
    let mut num_times = vec![0usize; problem.num_visits()];
    for visit in routes.iter().flat_map(Route::visits) {
        num_times[visit] += 1;
    }
    let mut violations = Vec::new();
    for (visit, &num_times) in num_times.iter().enumerate() {
        match num_times {
            0 => violations.push(Violation::Unserved { visit }),
            1 => {}
            _ => violations.push(Violation::Repeated { visit, num_times }),
        }
    }
    violations
}

fn limit_violations(problem: &Problem, routes: &[Route]) -> Vec<Violation> {
    let vehicle_type = problem.vehicle_type();
    let (max_length, max_duration) = (vehicle_type.max_length, vehicle_type.max_duration);
    let usable_energy = vehicle_type.energy.usable_energy;
    let mut violations = Vec::new();
    if routes.len() > vehicle_type.num_available {
        let (num_routes, num_available) = (routes.len(), vehicle_type.num_available);
        violations.push(Violation::TooManyRoutes { num_routes, num_available });
    }
    for (index, route) in routes.iter().enumerate() {
        if route.length > max_length * (1.0 + TOLERANCE) {
            violations.push(Violation::TooLong { route: index, length: route.length, max_length });
        }
        if route.duration > max_duration * (1.0 + TOLERANCE) {
            violations.push(Violation::TooSlow { route: index, duration: route.duration, max_duration });
        }
        if route.energy > usable_energy * (1.0 + TOLERANCE) {
            violations.push(Violation::TooMuchEnergy { route: index, energy: route.energy, usable_energy });
        }
    }
    violations
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::problem::{Depot, Energy, VehicleType, Visit, WayHome};

    /// Depot at the corner of a 30 m x 40 m rectangle, ponds at the other three corners, 10 s and 1000 J each.
    fn rectangle(vehicle_type: VehicleType) -> Problem {
        let corner = |x, y| Visit { position: Point::new(x, y), service_duration: 10.0, service_energy: 1000.0 };
        let visits = vec![corner(30.0, 0.0), corner(30.0, 40.0), corner(0.0, 40.0)];
        Problem::new(Depot { position: Point::new(0.0, 0.0) }, visits, vehicle_type).unwrap()
    }

    fn drones(num_available: usize) -> VehicleType {
        VehicleType { speed: 5.0, leg_stop_duration: 3.0, ..VehicleType::unlimited(num_available) }
    }

    /// Drones that take off in 9 s and come home at 10 m/s and in 44 s beside, with a power for each phase.
    fn measured_drones() -> VehicleType {
        VehicleType {
            takeoff_duration: 9.0,
            way_home: Some(WayHome { speed: 10.0, fixed_duration: 44.0 }),
            energy: Energy {
                takeoff_energy: 2000.0,
                leg_power: 300.0,
                leg_stop_power: 100.0,
                way_home_power: 400.0,
                way_home_fixed_energy: 15_000.0,
                usable_energy: f64::INFINITY,
            },
            ..drones(2)
        }
    }

    #[test]
    fn every_route_is_flown_in_its_own_layer() {
        use crate::problem::Layer;
        let layer = |takeoff_duration, way_home_duration| Layer {
            takeoff_duration,
            way_home_duration,
            takeoff_energy: 100.0 * takeoff_duration,
            way_home_energy: 100.0 * way_home_duration,
        };
        let plain = rectangle(VehicleType { num_available: 3, ..measured_drones() });
        let layered = plain.clone().with_layers(vec![layer(9.0, 44.0), layer(11.0, 47.0)]).unwrap();
        let routes = [vec![0], vec![], vec![1], vec![2]];
        let (low, own) = (evaluate(&plain, &routes).unwrap(), evaluate(&layered, &routes).unwrap());
        // Routes beyond the last layer have the last: 2 s more on the way out and 3 s more on the way home.
        let longer: Vec<f64> =
            low.routes.iter().zip(&own.routes).map(|(low, own)| own.duration - low.duration).collect();
        assert_eq!(longer, [0.0, 5.0, 5.0]);
        assert_eq!(own.routes[0].energy, low.routes[0].energy + 900.0 - 2000.0 + 4400.0 - 15_000.0);
        assert_eq!(own.routes[1].energy, low.routes[1].energy + 1100.0 - 2000.0 + 4700.0 - 15_000.0);
        assert!(rectangle(drones(2)).with_layers(vec![layer(9.0, 44.0)]).is_err());
        let error = plain.with_layers(vec![layer(9.0, f64::NAN)]).unwrap_err();
        assert_eq!(error.faults[0].path, "layers[0].way_home_duration");
    }

    #[test]
    fn a_hand_computed_plan() {
        let plan = evaluate(&rectangle(drones(2)), &[vec![0, 1], vec![], vec![2]]).unwrap();
        assert!(plan.is_feasible());
        assert_eq!(plan.routes.len(), 2);
        // 30 + 40 + 50 m; (6+3) + 10 + (8+3) + 10 + (10+3) s.
        assert_eq!(plan.routes[0].length, 120.0);
        let leg = |length, duration| Leg { length, duration, energy: 0.0 };
        let stop = |visit, leg, arrival, departure| Stop { visit, leg, arrival, departure, service_energy: 1000.0 };
        assert_eq!(plan.routes[0].stops[0], stop(0, leg(30.0, 9.0), 9.0, 19.0));
        assert_eq!(plan.routes[0].stops[1], stop(1, leg(40.0, 11.0), 30.0, 40.0));
        assert_eq!(plan.routes[0].last_leg, leg(50.0, 13.0));
        assert_eq!((plan.routes[0].duration, plan.routes[0].energy), (53.0, 2000.0));
        assert_eq!(plan.routes[1].length, 80.0);
        assert_eq!((plan.max_route_length(), plan.total_length(), plan.makespan()), (120.0, 200.0, 53.0));
    }

    #[test]
    fn a_hand_computed_plan_with_take_off_way_home_and_energy() {
        let plan = evaluate(&rectangle(measured_drones()), &[vec![0, 1]]).unwrap();
        let route = &plan.routes[0];
        // 9 + (6+3) s, 2000 + 6 x 300 + 3 x 100 J; 8+3 s, 8 x 300 + 3 x 100 J; 50/10 + 44 s, 5 x 400 + 15000 J.
        let legs = [(30.0, 18.0, 4100.0), (40.0, 11.0, 2700.0), (50.0, 49.0, 17_000.0)];
        let legs = legs.map(|(length, duration, energy)| Leg { length, duration, energy });
        assert_eq!(route.legs().collect::<Vec<Leg>>(), legs);
        assert_eq!([route.stops[0].arrival, route.stops[0].departure], [18.0, 28.0]);
        assert_eq!([route.stops[1].arrival, route.stops[1].departure], [39.0, 49.0]);
        assert_eq!((route.length, route.duration, route.energy), (120.0, 98.0, 23_800.0 + 2000.0));
    }

    #[test]
    fn a_route_may_use_its_energy_to_the_last_joule() {
        let with_usable = |usable_energy: f64| {
            let energy = Energy { usable_energy, ..measured_drones().energy };
            let problem = rectangle(VehicleType { energy, ..measured_drones() });
            evaluate(&problem, &[vec![0, 1], vec![2]]).unwrap().violations
        };
        assert_eq!(with_usable(25_800.0), []);
        let violation = Violation::TooMuchEnergy { route: 0, energy: 25_800.0, usable_energy: 25_799.0 };
        assert_eq!(with_usable(25_799.0), [violation]);
        assert_eq!(violation.to_string(), "route 0 takes 25800 J, a drone may use 25799 J");
    }

    #[test]
    fn one_violation_is_enough_to_be_infeasible() {
        for (max_length, max_duration, routes) in [
            (119.0, f64::INFINITY, vec![vec![0, 1], vec![2]]),
            (f64::INFINITY, 52.0, vec![vec![0, 1], vec![2]]),
            (f64::INFINITY, f64::INFINITY, vec![vec![0, 1]]),
            (f64::INFINITY, f64::INFINITY, vec![vec![0], vec![1], vec![2]]),
        ] {
            let problem = rectangle(VehicleType { max_length, max_duration, ..drones(2) });
            let plan = evaluate(&problem, &routes).unwrap();
            assert_eq!(plan.violations.len(), 1, "{:?}", plan.violations);
            assert!(!plan.is_feasible());
        }
    }

    #[test]
    fn violations_are_named() {
        let vehicle_type = VehicleType { max_length: 119.0, max_duration: 52.0, ..drones(1) };
        let plan = evaluate(&rectangle(vehicle_type), &[vec![0, 1], vec![0]]).unwrap();
        assert_eq!(
            plan.violations,
            [
                Violation::Repeated { visit: 0, num_times: 2 },
                Violation::Unserved { visit: 2 },
                Violation::TooManyRoutes { num_routes: 2, num_available: 1 },
                Violation::TooLong { route: 0, length: 120.0, max_length: 119.0 },
                Violation::TooSlow { route: 0, duration: 53.0, max_duration: 52.0 },
            ]
        );
        assert_eq!(plan.unserved(), [2]);
    }

    #[test]
    fn legs_below_a_metre_take_their_time() {
        let visits = vec![Visit::at(Point::new(0.25, 0.0)), Visit::at(Point::new(0.25, 0.5))];
        let problem = Problem::new(Depot { position: Point::default() }, visits, drones(1)).unwrap();
        let plan = evaluate(&problem, &[vec![0, 1]]).unwrap();
        assert_eq!(plan.routes[0].stops[0].arrival, 3.05);
        assert_eq!(plan.routes[0].stops[1].leg.duration, 3.1);
    }

    #[test]
    fn an_unknown_visit_is_an_error() {
        let error = evaluate(&rectangle(drones(2)), &[vec![0], vec![1, 3]]).unwrap_err();
        assert_eq!(error.faults[0].path, "routes[1][1]");
    }
}
