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
    /// What the time on station takes from the battery, in joules.
    pub service_energy: f64,
}

impl Visit {
    /// A visit that takes no time and no energy, as in research instances.
    #[must_use]
    pub const fn at(position: Point) -> Self {
        Self { position, service_duration: 0.0, service_energy: 0.0 }
    }
}

/// How a drone comes home where its autopilot flies the last leg of a route in a way of its own (return to launch): at its
/// own speed, with a climb to a return height, a wait above home and a landing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WayHome {
    /// Ground speed in metres per second.
    pub speed: f64,
    /// Climb, wait and landing, in seconds, whatever the length of the leg.
    pub fixed_duration: f64,
}

/// What flying takes from a battery, and how much a route may take. All zero where nothing is known.
///
/// A leg draws constant power while it cruises and while it stops and starts; what has a fixed course (take-off, climb and
/// landing at home, the time on station of a visit) is given in joules.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Energy {
    /// Joules of the first take-off of a route.
    pub takeoff_energy: f64,
    /// Watts while a leg cruises.
    pub leg_power: f64,
    /// Watts while a leg stops and starts ([`VehicleType::leg_stop_duration`]).
    pub leg_stop_power: f64,
    /// Watts on the way home, climb, wait and landing aside; without effect where the last leg is flown like the others.
    pub way_home_power: f64,
    /// Joules of climb, wait and landing on the way home; likewise.
    pub way_home_fixed_energy: f64,
    /// Joules that a route may take; infinite where nothing limits it.
    pub usable_energy: f64,
}

impl Energy {
    /// Nothing is known: no figure, no limit.
    pub const UNKNOWN: Self = Self {
        takeoff_energy: 0.0,
        leg_power: 0.0,
        leg_stop_power: 0.0,
        way_home_power: 0.0,
        way_home_fixed_energy: 0.0,
        usable_energy: f64::INFINITY,
    };
}

/// A type of drone. The fleet of a problem is of one type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VehicleType {
    /// How many drones there are; a plan has at most that many routes.
    pub num_available: usize,
    /// Ground speed in metres per second.
    pub speed: f64,
    /// What stopping and starting adds to every leg, in seconds: 2.5 s for a multirotor that dips a probe at 5 m/s.
    pub leg_stop_duration: f64,
    /// What a route takes before its first leg, in seconds: the first take-off.
    pub takeoff_duration: f64,
    /// How the last leg is flown, where not like the others.
    pub way_home: Option<WayHome>,
    /// What flying takes from the battery.
    pub energy: Energy,
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
            takeoff_duration: 0.0,
            way_home: None,
            energy: Energy::UNKNOWN,
            max_length: f64::INFINITY,
            max_duration: f64::INFINITY,
        }
    }

    /// The same drones in a layer of their own.
    #[must_use]
    pub fn in_layer(&self, layer: Layer) -> Self {
        let way_home = self.way_home.map(|way_home| WayHome { fixed_duration: layer.way_home_duration, ..way_home });
        let energy = Energy {
            takeoff_energy: layer.takeoff_energy,
            way_home_fixed_energy: layer.way_home_energy,
            ..self.energy
        };
        Self { takeoff_duration: layer.takeoff_duration, way_home, energy, ..*self }
    }

    /// Whether the first and the last leg of a route take as long as any other of their length.
    #[must_use]
    pub fn has_plain_depot_legs(&self) -> bool {
        self.takeoff_duration == 0.0 && self.way_home.is_none()
    }
}

/// What the first and the last leg of one route take besides their length, where each drone flies them at a height of its
/// own; in place of what its vehicle type says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// As [`VehicleType::takeoff_duration`].
    pub takeoff_duration: f64,
    /// As [`WayHome::fixed_duration`].
    pub way_home_duration: f64,
    /// As [`Energy::takeoff_energy`].
    pub takeoff_energy: f64,
    /// As [`Energy::way_home_fixed_energy`].
    pub way_home_energy: f64,
}

/// A depot, the visits and the fleet: validated, immutable.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    depot: Depot,
    visits: Vec<Visit>,
    vehicle_type: VehicleType,
    layers: Vec<Layer>,
}

impl Problem {
    /// A problem of at least one visit and one drone.
    ///
    /// All that is computed from a problem stays finite: coordinates are at most 1e9 in size, speeds 1e-6 to 1e6 metres per
    /// second, durations at most 1e9 seconds, powers at most 1e9 watts and energies at most 1e12 joules.
    ///
    /// # Errors
    /// [`InvalidInput`] with every fault: no visit, no drone, a number out of its range, a limit that is not positive.
    pub fn new(depot: Depot, visits: Vec<Visit>, vehicle_type: VehicleType) -> Result<Self, InvalidInput> {
        let mut faults = Faults::default();
        check_position(&mut faults, "depot.position", depot.position);
        if visits.is_empty() {
            faults.add("visits", "there is no pond to visit", "give at least one pond");
        }
        for (index, visit) in visits.iter().enumerate() {
            check_position(&mut faults, &format!("visits[{index}].position"), visit.position);
            DURATION.check(&mut faults, || format!("visits[{index}].service_duration"), visit.service_duration);
            ENERGY.check(&mut faults, || format!("visits[{index}].service_energy"), visit.service_energy);
        }
        check_vehicle_type(&mut faults, &vehicle_type);
        faults.into_result(Self { depot, visits, vehicle_type, layers: Vec::new() })
    }

    /// The same problem where route i is flown in layer i, and routes beyond the last layer in the last. Planners plan for
    /// the vehicle type alone; only [`crate::evaluate`] asks which route is whose.
    ///
    /// # Errors
    /// [`InvalidInput`] if a number is out of its range, or drones have no way home of their own to fly in layers.
    pub fn with_layers(self, layers: Vec<Layer>) -> Result<Self, InvalidInput> {
        let mut faults = Faults::default();
        if !layers.is_empty() && self.vehicle_type.way_home.is_none() {
            faults.add(
                "layers",
                "drones have no way home of their own",
                "give the speed of the way home, or no layers",
            );
        }
        for (index, layer) in layers.iter().enumerate() {
            for (range, name, value) in [
                (DURATION, "takeoff_duration", layer.takeoff_duration),
                (DURATION, "way_home_duration", layer.way_home_duration),
                (ENERGY, "takeoff_energy", layer.takeoff_energy),
                (ENERGY, "way_home_energy", layer.way_home_energy),
            ] {
                range.check(&mut faults, || format!("layers[{index}].{name}"), value);
            }
        }
        faults.into_result(Self { layers, ..self })
    }

    /// The layers of the routes; empty where all fly as the vehicle type says.
    #[must_use]
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// The drone that flies a route of a plan, by the index of the route.
    #[must_use]
    pub fn drone_of(&self, route: usize) -> VehicleType {
        let layer = self.layers.get(route).or(self.layers.last());
        layer.map_or(self.vehicle_type, |&layer| self.vehicle_type.in_layer(layer))
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
            let message = format!("the coordinate is {value:?}");
            faults.add(format!("{path}.{axis}"), message, "give a finite number of at most 1e9");
        }
    }
}

/// The values that a quantity may have. The longest leg of 3e9 length units at the least speed takes 3e15 s, so sums over
/// any number of visits that memory holds are finite.
struct Range {
    quantity: &'static str,
    least: f64,
    most: f64,
    action: &'static str,
}

const SPEED: Range =
    Range { quantity: "speed", least: 1e-6, most: 1e6, action: "give a speed of 1e-6 to 1e6 metres per second" };
const DURATION: Range = Range { quantity: "duration", least: 0.0, most: 1e9, action: "give 0 to 1e9 seconds" };
const POWER: Range = Range { quantity: "power", least: 0.0, most: 1e9, action: "give 0 to 1e9 watts" };
const ENERGY: Range = Range { quantity: "energy", least: 0.0, most: 1e12, action: "give 0 to 1e12 joules" };

impl Range {
    fn check(&self, faults: &mut Faults, path: impl FnOnce() -> String, value: f64) {
        if !(self.least..=self.most).contains(&value) {
            faults.add(path(), format!("the {} is {value:?}", self.quantity), self.action);
        }
    }
}

fn check_vehicle_type(faults: &mut Faults, vehicle_type: &VehicleType) {
    let VehicleType { num_available, speed, leg_stop_duration, takeoff_duration, way_home, energy, .. } = *vehicle_type;
    if num_available == 0 {
        faults.add("vehicle_type.num_available", "there is no drone", "give at least one drone");
    }
    let way_home_path = |name: &str| format!("vehicle_type.way_home.{name}");
    SPEED.check(faults, || "vehicle_type.speed".into(), speed);
    DURATION.check(faults, || "vehicle_type.leg_stop_duration".into(), leg_stop_duration);
    DURATION.check(faults, || "vehicle_type.takeoff_duration".into(), takeoff_duration);
    if let Some(WayHome { speed, fixed_duration }) = way_home {
        SPEED.check(faults, || way_home_path("speed"), speed);
        DURATION.check(faults, || way_home_path("fixed_duration"), fixed_duration);
    }
    for (range, name, value) in [
        (ENERGY, "takeoff_energy", energy.takeoff_energy),
        (POWER, "leg_power", energy.leg_power),
        (POWER, "leg_stop_power", energy.leg_stop_power),
        (POWER, "way_home_power", energy.way_home_power),
        (ENERGY, "way_home_fixed_energy", energy.way_home_fixed_energy),
    ] {
        range.check(faults, || format!("vehicle_type.energy.{name}"), value);
    }
    for (name, limit) in [
        ("energy.usable_energy", energy.usable_energy),
        ("max_length", vehicle_type.max_length),
        ("max_duration", vehicle_type.max_duration),
    ] {
        if limit.is_nan() || limit <= 0.0 {
            let message = format!("the limit is {limit:?}");
            faults.add(format!("vehicle_type.{name}"), message, "give a positive limit, or infinity for none");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_fault_is_reported_at_once() {
        let visits = vec![
            Visit::at(Point::new(0.0, 1.0)),
            Visit { position: Point::new(f64::NAN, 2e9), service_duration: -1.0, service_energy: f64::INFINITY },
        ];
        let vehicle_type = VehicleType {
            speed: 0.0,
            way_home: Some(WayHome { speed: 1e-300, fixed_duration: 1e308 }),
            energy: Energy { leg_power: -1.0, usable_energy: 0.0, ..Energy::UNKNOWN },
            max_length: f64::NAN,
            ..VehicleType::unlimited(0)
        };
        let error = Problem::new(Depot { position: Point::new(0.0, f64::INFINITY) }, visits, vehicle_type).unwrap_err();
        let paths: Vec<&str> = error.faults.iter().map(|fault| fault.path.as_str()).collect();
        assert_eq!(
            paths,
            [
                "depot.position.y",
                "visits[1].position.x",
                "visits[1].position.y",
                "visits[1].service_duration",
                "visits[1].service_energy",
                "vehicle_type.num_available",
                "vehicle_type.speed",
                "vehicle_type.way_home.speed",
                "vehicle_type.way_home.fixed_duration",
                "vehicle_type.energy.leg_power",
                "vehicle_type.energy.usable_energy",
                "vehicle_type.max_length",
            ]
        );
        assert!(error.to_string().contains("give a speed of 1e-6"));
    }

    #[test]
    fn numbers_whose_sums_would_not_be_finite_are_faults() {
        let visit = Visit::at(Point::new(1.0, 1.0));
        let drone = VehicleType::unlimited(1);
        let fault_of = |visit: Visit, vehicle_type: VehicleType| {
            let error = Problem::new(Depot { position: Point::default() }, vec![visit], vehicle_type).unwrap_err();
            error.faults.into_iter().map(|fault| fault.path).collect::<Vec<String>>()
        };
        for speed in [1e-300, 5e-324, 1e7, f64::NAN, -1.0] {
            assert_eq!(fault_of(visit, VehicleType { speed, ..drone }), ["vehicle_type.speed"]);
        }
        for x in [f64::NAN, f64::NEG_INFINITY, 1e10, -1e300] {
            assert_eq!(fault_of(Visit::at(Point::new(x, 0.0)), drone), ["visits[0].position.x"]);
        }
        let long = Visit { service_duration: 1e308, ..visit };
        assert_eq!(fault_of(long, drone), ["visits[0].service_duration"]);
        let takeoff_duration = 1e308;
        assert_eq!(fault_of(visit, VehicleType { takeoff_duration, ..drone }), ["vehicle_type.takeoff_duration"]);
    }

    #[test]
    fn no_visit_is_a_fault() {
        let error = Problem::research(Point::default(), &[], 5).unwrap_err();
        assert_eq!(error.faults[0].path, "visits");
    }
}
