//! What a leg costs.

use crate::geometry::Point;
use crate::problem::VehicleType;

/// Where in its route a leg lies; it may be flown in another way there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LegKind {
    /// From the depot to the first visit: the take-off belongs to it.
    First,
    /// From one visit to the next.
    Between,
    /// From the last visit to the depot: the way home, if the drones have one of their own.
    Last,
}

/// What one leg comes to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Leg {
    /// In length units.
    pub length: f64,
    /// In seconds.
    pub duration: f64,
    /// In joules; 0 where nothing is known about it.
    pub energy: f64,
}

impl Leg {
    /// The leg from one place to another.
    #[must_use]
    pub fn new(from: Point, to: Point, kind: LegKind, vehicle_type: &VehicleType) -> Self {
        let length = leg_length(from, to);
        let duration = leg_duration(length, kind, vehicle_type);
        Self { length, duration, energy: leg_energy(length, kind, vehicle_type) }
    }
}

/// Length of the leg from one place to another: the straight line.
#[must_use]
pub fn leg_length(from: Point, to: Point) -> f64 {
    from.distance(to)
}

/// Seconds that a leg of `length` takes: cruise at ground speed, and the time lost in stopping and starting (`t = d/v + stop`
/// of a multirotor, measured on a simulated ArduCopter). A leg of no length takes no time: the drone stays where it is. A
/// first leg begins with the take-off. A way home of the drones' own is flown at its speed and has a fixed part, also where
/// it has no length: the autopilot climbs and lands all the same.
#[must_use]
pub fn leg_duration(length: f64, kind: LegKind, vehicle_type: &VehicleType) -> f64 {
    let between = if length == 0.0 { 0.0 } else { length / vehicle_type.speed + vehicle_type.leg_stop_duration };
    match (kind, vehicle_type.way_home) {
        (LegKind::First, _) => vehicle_type.takeoff_duration + between,
        (LegKind::Last, Some(way_home)) => length / way_home.speed + way_home.fixed_duration,
        (LegKind::Between | LegKind::Last, _) => between,
    }
}

/// Joules that a leg of `length` takes: the phases of [`leg_duration`], each at its power.
#[must_use]
pub fn leg_energy(length: f64, kind: LegKind, vehicle_type: &VehicleType) -> f64 {
    let energy = &vehicle_type.energy;
    let stop = vehicle_type.leg_stop_duration * energy.leg_stop_power;
    let between = if length == 0.0 { 0.0 } else { length / vehicle_type.speed * energy.leg_power + stop };
    match (kind, vehicle_type.way_home) {
        (LegKind::First, _) => energy.takeoff_energy + between,
        (LegKind::Last, Some(way_home)) => {
            length / way_home.speed * energy.way_home_power + energy.way_home_fixed_energy
        }
        (LegKind::Between | LegKind::Last, _) => between,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{Energy, WayHome};

    #[test]
    fn a_leg_takes_cruise_and_stop() {
        let vehicle_type = VehicleType { speed: 5.0, leg_stop_duration: 3.0, ..VehicleType::unlimited(1) };
        for kind in [LegKind::First, LegKind::Between, LegKind::Last] {
            assert_eq!(leg_duration(60.0, kind, &vehicle_type), 15.0);
            // The drone need not stop where it is already; where it is not, it must, however near that is.
            assert_eq!(leg_duration(0.0, kind, &vehicle_type), 0.0);
            assert_eq!(leg_duration(0.5, kind, &vehicle_type), 3.1);
            assert_eq!(leg_energy(60.0, kind, &vehicle_type), 0.0);
        }
    }

    #[test]
    fn a_route_takes_off_and_comes_home_in_the_autopilots_way() {
        let energy = Energy {
            takeoff_energy: 2280.0,
            leg_power: 357.0,
            leg_stop_power: 354.0,
            way_home_power: 385.0,
            way_home_fixed_energy: 15_000.0,
            usable_energy: f64::INFINITY,
        };
        let way_home = Some(WayHome { speed: 10.0, fixed_duration: 44.0 });
        let vehicle_type = VehicleType {
            speed: 5.0,
            leg_stop_duration: 2.5,
            takeoff_duration: 9.0,
            way_home,
            energy,
            ..VehicleType::unlimited(1)
        };
        let durations = |length: f64| {
            [LegKind::First, LegKind::Between, LegKind::Last].map(|kind| leg_duration(length, kind, &vehicle_type))
        };
        // 9 s, 60 m at 5 m/s and 2.5 s; 60 m at 10 m/s and 44 s.
        assert_eq!(durations(60.0), [23.5, 14.5, 50.0]);
        assert_eq!(durations(0.0), [9.0, 0.0, 44.0]);
        let energies = |length: f64| {
            [LegKind::First, LegKind::Between, LegKind::Last].map(|kind| leg_energy(length, kind, &vehicle_type))
        };
        // 12 s x 357 W + 2.5 s x 354 W = 5169 J; 6 s x 385 W = 2310 J.
        assert_eq!(energies(60.0), [2280.0 + 5169.0, 5169.0, 2310.0 + 15_000.0]);
        assert_eq!(energies(0.0), [2280.0, 0.0, 15_000.0]);
        // Without a way home of their own the drones come back as they fly between ponds.
        let plain = VehicleType { way_home: None, ..vehicle_type };
        assert_eq!(leg_duration(60.0, LegKind::Last, &plain), 14.5);
        assert_eq!(leg_energy(60.0, LegKind::Last, &plain), 5169.0);
    }
}
