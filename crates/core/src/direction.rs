//! Which way round a route is flown.
//!
//! Planners treat a route as a ring: it costs the same both ways. Where drones come home in a way of their own
//! ([`crate::problem::WayHome`]) it does not: the way home may be faster or slower than the way out, so it matters at which
//! end of the ring the depot is nearer. Planners leave that choice to [`fly_cheaper_way`], the one place that makes it.

use crate::problem::Problem;
use crate::travel::{LegKind, leg_duration, leg_length};

/// Turns a route round if it takes less time the other way; where both ways take as long, it stays as it is.
///
/// Only the first and the last leg differ, so the route then takes at most the mean of both ways. That mean is what the search
/// minimises and holds against the limit of time.
pub fn fly_cheaper_way(problem: &Problem, route: &mut [usize]) {
    let vehicle_type = problem.vehicle_type();
    let (Some(_), [first, .., last]) = (vehicle_type.way_home, &*route) else { return };
    let depot_leg = |visit: usize, kind| {
        let length = leg_length(problem.depot().position, problem.visits()[visit].position);
        leg_duration(length, kind, &vehicle_type)
    };
    let ends_cost = |first, last| depot_leg(first, LegKind::First) + depot_leg(last, LegKind::Last);
    if ends_cost(*last, *first) < ends_cost(*first, *last) {
        route.reverse();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::problem::{Depot, VehicleType, Visit, WayHome};

    /// Ponds 10, 20 and 30 east of the depot; drones fly at 1 and come home at `speed`.
    fn line(way_home: Option<WayHome>) -> Problem {
        let visits = (1..=3).map(|x| Visit::at(Point::new(10.0 * f64::from(x), 0.0))).collect();
        let vehicle_type = VehicleType { way_home, ..VehicleType::unlimited(2) };
        Problem::new(Depot { position: Point::default() }, visits, vehicle_type).unwrap()
    }

    #[test]
    fn the_long_depot_leg_is_flown_at_the_higher_speed() {
        let flown = |way_home, route: &[usize]| {
            let mut route = route.to_vec();
            fly_cheaper_way(&line(way_home), &mut route);
            route
        };
        let home_at = |speed| Some(WayHome { speed, fixed_duration: 5.0 });
        for route in [[0, 1, 2], [2, 1, 0]] {
            assert_eq!(flown(home_at(2.0), &route), [0, 1, 2]);
            assert_eq!(flown(home_at(0.5), &route), [2, 1, 0]);
            assert_eq!(flown(home_at(1.0), &route), route);
            assert_eq!(flown(None, &route), route);
        }
        assert_eq!(flown(home_at(2.0), &[1]), [1]);
        assert!(flown(home_at(2.0), &[]).is_empty());
    }
}
