//! What a leg costs.

use crate::geometry::Point;
use crate::problem::VehicleType;

/// Length of the leg from one place to another: the straight line.
#[must_use]
pub fn leg_length(from: Point, to: Point) -> f64 {
    from.distance(to)
}

/// Seconds that a leg of `length` takes: cruise at ground speed, and the time lost in stopping and starting
/// (`t = d/v + 3 s` of a multirotor, measured on a simulated ArduCopter). A leg of no length takes no time: the drone
/// stays where it is.
#[must_use]
pub fn leg_duration(length: f64, vehicle_type: &VehicleType) -> f64 {
    if length == 0.0 { 0.0 } else { length / vehicle_type.speed + vehicle_type.leg_stop_duration }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leg_takes_cruise_and_stop() {
        let vehicle_type = VehicleType { speed: 5.0, leg_stop_duration: 3.0, ..VehicleType::unlimited(1) };
        assert_eq!(leg_duration(60.0, &vehicle_type), 15.0);
        assert_eq!(leg_duration(0.0, &vehicle_type), 0.0);
    }
}
