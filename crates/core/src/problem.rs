//! What is to be planned: a depot, visits and a fleet; validated once, then immutable.

use crate::error::{Faults, InvalidInput};
use crate::geometry::Point;

/// Where every route starts and ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Depot {
    /// Where it is, in the frame of the visits.
    pub position: Point,
}

/// The task of sampling one pond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Visit {
    /// Where the drone samples.
    pub position: Point,
    /// Time on station, in seconds: from the end of the leg that arrives to the start of the leg that leaves.
    pub service_duration: f64,
}

impl Visit {
    /// A visit that takes no time, as in research instances.
    #[must_use]
    pub const fn at(position: Point) -> Self {
        Self { position, service_duration: 0.0 }
    }
}

/// A type of drone. The fleet of a problem is of one type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VehicleType {
    /// How many drones there are; a plan has at most that many routes.
    pub num_available: usize,
    /// Ground speed in metres per second.
    pub speed: f64,
    /// What stopping and starting adds to every leg, in seconds (3 s for a multirotor, `notes/flight.md`).
    pub leg_stop_duration: f64,
    /// Longest route a drone can fly, in length units; infinite where nothing limits it.
    pub max_length: f64,
    /// Longest time a drone can be under way, in seconds; infinite where nothing limits it.
    pub max_duration: f64,
}

impl VehicleType {
    /// `num_available` drones without limits at unit speed: durations are lengths, as in research instances.
    #[must_use]
    pub const fn unlimited(num_available: usize) -> Self {
        Self {
            num_available,
            speed: 1.0,
            leg_stop_duration: 0.0,
            max_length: f64::INFINITY,
            max_duration: f64::INFINITY,
        }
    }
}

/// A depot, the visits and the fleet: validated, immutable.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    depot: Depot,
    visits: Vec<Visit>,
    vehicle_type: VehicleType,
}

impl Problem {
    /// A problem of at least one visit and one drone, with finite coordinates.
    ///
    /// # Errors
    /// [`InvalidInput`] with every fault: no visit, no drone, a coordinate that is not finite or beyond 1e9, a duration
    /// that is negative or not finite, a speed or limit that is not positive.
    pub fn new(depot: Depot, visits: Vec<Visit>, vehicle_type: VehicleType) -> Result<Self, InvalidInput> {
        let mut faults = Faults::default();
        check_position(&mut faults, "depot.position", depot.position);
        if visits.is_empty() {
            faults.add("visits", "there is no pond to visit", "give at least one pond");
        }
        for (index, visit) in visits.iter().enumerate() {
            check_position(&mut faults, &format!("visits[{index}].position"), visit.position);
            check_duration(&mut faults, &format!("visits[{index}].service_duration"), visit.service_duration);
        }
        if vehicle_type.num_available == 0 {
            faults.add("vehicle_type.num_available", "there is no drone", "give at least one drone");
        }
        if !(vehicle_type.speed.is_finite() && vehicle_type.speed > 0.0) {
            let message = format!("the speed is {}", vehicle_type.speed);
            faults.add("vehicle_type.speed", message, "give a positive speed in metres per second");
        }
        check_duration(&mut faults, "vehicle_type.leg_stop_duration", vehicle_type.leg_stop_duration);
        for (name, limit) in [("max_length", vehicle_type.max_length), ("max_duration", vehicle_type.max_duration)] {
            if limit.is_nan() || limit <= 0.0 {
                let message = format!("the limit is {limit}");
                faults.add(format!("vehicle_type.{name}"), message, "give a positive limit, or infinity for none");
            }
        }
        faults.into_result(Self { depot, visits, vehicle_type })
    }

    /// A research instance: visits without service time, `num_routes` drones at unit speed without limits.
    ///
    /// # Errors
    /// As [`Problem::new`].
    pub fn research(depot: Point, ponds: &[Point], num_routes: usize) -> Result<Self, InvalidInput> {
        let visits = ponds.iter().map(|&position| Visit::at(position)).collect();
        Self::new(Depot { position: depot }, visits, VehicleType::unlimited(num_routes))
    }

    /// Where every route starts and ends.
    #[must_use]
    pub const fn depot(&self) -> Depot {
        self.depot
    }

    /// The visits; a visit is known by its index here.
    #[must_use]
    pub fn visits(&self) -> &[Visit] {
        &self.visits
    }

    /// The fleet.
    #[must_use]
    pub const fn vehicle_type(&self) -> VehicleType {
        self.vehicle_type
    }

    /// How many visits there are; at least 1.
    #[must_use]
    pub fn num_visits(&self) -> usize {
        self.visits.len()
    }
}

/// Beyond this a squared distance loses the digits that distinguish two ponds.
const MAX_COORDINATE: f64 = 1e9;

fn check_position(faults: &mut Faults, path: &str, position: Point) {
    for (axis, value) in [("x", position.x), ("y", position.y)] {
        if !value.is_finite() || value.abs() > MAX_COORDINATE {
            let message = format!("the coordinate is {value}");
            faults.add(format!("{path}.{axis}"), message, "give a finite number of at most 1e9");
        }
    }
}

fn check_duration(faults: &mut Faults, path: &str, duration: f64) {
    if !(duration.is_finite() && duration >= 0.0) {
        let message = format!("the duration is {duration}");
        faults.add(path, message, "give a duration of 0 seconds or more");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_fault_is_reported_at_once() {
        let visits = vec![
            Visit::at(Point::new(0.0, 1.0)),
            Visit { position: Point::new(f64::NAN, 2e9), service_duration: -1.0 },
        ];
        let vehicle_type = VehicleType { speed: 0.0, max_length: f64::NAN, ..VehicleType::unlimited(0) };
        let error = Problem::new(Depot { position: Point::new(0.0, f64::INFINITY) }, visits, vehicle_type).unwrap_err();
        let paths: Vec<&str> = error.faults.iter().map(|fault| fault.path.as_str()).collect();
        assert_eq!(
            paths,
            [
                "depot.position.y",
                "visits[1].position.x",
                "visits[1].position.y",
                "visits[1].service_duration",
                "vehicle_type.num_available",
                "vehicle_type.speed",
                "vehicle_type.max_length",
            ]
        );
        assert!(error.to_string().contains("give a positive speed"));
    }

    #[test]
    fn no_visit_is_a_fault() {
        let error = Problem::research(Point::default(), &[], 5).unwrap_err();
        assert_eq!(error.faults[0].path, "visits");
    }
}
