//! The one truth about a plan: everything recomputed from the problem and bare routes.
//!
//! This module judges all planners, so it shares no code with any of them beyond what a leg is ([`crate::travel`]).
//! O(n) for n visits.

use crate::error::{Faults, InvalidInput};
use crate::geometry::Point;
use crate::plan::{Plan, Route, Stop, Violation};
use crate::problem::Problem;
use crate::travel::{leg_duration, leg_length};

/// How far beyond a limit rounding may carry a length or duration before it counts as a violation, relative to the limit.
const TOLERANCE: f64 = 1e-9;

/// Flies `routes` (visit indices in flying order, the depot implied at both ends) and reports lengths, schedule and
/// violations. Empty routes are dropped.
///
/// # Errors
/// [`InvalidInput`] if a route names a visit that does not exist. A plan that breaks a rule is not an error: see
/// [`Plan::violations`].
pub fn evaluate(problem: &Problem, routes: &[Vec<usize>]) -> Result<Plan, InvalidInput> {
    check_indices(problem, routes)?;
    let flown: Vec<Route> =
        routes.iter().filter(|visits| !visits.is_empty()).map(|visits| fly(problem, visits)).collect();
    let mut violations = count_violations(problem, &flown);
    violations.extend(limit_violations(problem, &flown));
    Ok(Plan { routes: flown, violations })
}

pub(crate) fn check_indices(problem: &Problem, routes: &[Vec<usize>]) -> Result<(), InvalidInput> {
    let mut faults = Faults::default();
    for (route, visits) in routes.iter().enumerate() {
        for (place, &visit) in visits.iter().enumerate() {
            if visit >= problem.num_visits() {
                let message = format!("there is no visit {visit}");
                let action = format!("give an index of 0 to {}", problem.num_visits() - 1);
                faults.add(format!("routes[{route}][{place}]"), message, &action);
            }
        }
    }
    faults.into_result(())
}

fn fly(problem: &Problem, visits: &[usize]) -> Route {
    let vehicle_type = problem.vehicle_type();
    let depot = problem.depot().position;
    let (mut position, mut length, mut clock) = (depot, 0.0, 0.0);
    let mut advance = |to: Point| {
        let leg = leg_length(position, to);
        position = to;
        length += leg;
        leg_duration(leg, &vehicle_type)
    };
    let mut stops = Vec::with_capacity(visits.len());
    for &index in visits {
        let visit = problem.visits()[index];
        let arrival = clock + advance(visit.position);
        clock = arrival + visit.service_duration;
        stops.push(Stop { visit: index, arrival, departure: clock });
    }
    clock += advance(depot);
    Route { stops, length, duration: clock }
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
    }
    violations
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{Depot, VehicleType, Visit};

    /// Depot at the corner of a 30 m x 40 m rectangle, ponds at the other three corners, 10 s each.
    fn rectangle(vehicle_type: VehicleType) -> Problem {
        let corner = |x, y| Visit { position: Point::new(x, y), service_duration: 10.0 };
        let visits = vec![corner(30.0, 0.0), corner(30.0, 40.0), corner(0.0, 40.0)];
        Problem::new(Depot { position: Point::new(0.0, 0.0) }, visits, vehicle_type).unwrap()
    }

    fn drones(num_available: usize) -> VehicleType {
        VehicleType { speed: 5.0, leg_stop_duration: 3.0, ..VehicleType::unlimited(num_available) }
    }

    #[test]
    fn a_hand_computed_plan() {
        let plan = evaluate(&rectangle(drones(2)), &[vec![0, 1], vec![], vec![2]]).unwrap();
        assert!(plan.is_feasible());
        assert_eq!(plan.routes.len(), 2);
        // 30 + 40 + 50 m; (6+3) + 10 + (8+3) + 10 + (10+3) s.
        assert_eq!(plan.routes[0].length, 120.0);
        assert_eq!(plan.routes[0].stops[0], Stop { visit: 0, arrival: 9.0, departure: 19.0 });
        assert_eq!(plan.routes[0].stops[1], Stop { visit: 1, arrival: 30.0, departure: 40.0 });
        assert_eq!(plan.routes[0].duration, 53.0);
        assert_eq!(plan.routes[1].length, 80.0);
        assert_eq!((plan.max_route_length(), plan.total_length(), plan.makespan()), (120.0, 200.0, 53.0));
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
    fn an_unknown_visit_is_an_error() {
        let error = evaluate(&rectangle(drones(2)), &[vec![0], vec![1, 3]]).unwrap_err();
        assert_eq!(error.faults[0].path, "routes[1][1]");
    }
}
