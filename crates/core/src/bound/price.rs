//! What a bound counts of a route.

use crate::problem::VehicleType;
use crate::travel::{LegKind, leg_duration};

/// What a bound counts of a route, at least: legs by their length, and the time on station.
///
/// Every leg costs no less the longer it is, and no more than a way of several legs: then no route grows by leaving visits out,
/// or by being split in two.
pub(super) trait Price {
    /// From one visit to another.
    fn between(&self, length: f64) -> f64;
    /// From the depot to the first visit.
    fn first(&self, length: f64) -> f64;
    /// From the last visit to the depot.
    fn last(&self, length: f64) -> f64;
    /// For being at a visit.
    fn service(&self, duration: f64) -> f64;
    /// From a visit to the depot, by way of others or not.
    fn home(&self, length: f64) -> f64 {
        self.last(length)
    }
}

/// Lengths.
pub(super) struct Lengths;

impl Price for Lengths {
    fn between(&self, length: f64) -> f64 {
        length
    }

    fn first(&self, length: f64) -> f64 {
        length
    }

    fn last(&self, length: f64) -> f64 {
        length
    }

    fn service(&self, _duration: f64) -> f64 {
        0.0
    }
}

/// Seconds. Where drones come home more slowly than they fly, a way of several legs home may be faster than the straight one:
/// it is taken at the speed of the others, without a stop.
pub(super) struct Durations(pub VehicleType);

impl Price for Durations {
    fn between(&self, length: f64) -> f64 {
        leg_duration(length, LegKind::Between, &self.0)
    }

    fn first(&self, length: f64) -> f64 {
        leg_duration(length, LegKind::First, &self.0)
    }

    fn last(&self, length: f64) -> f64 {
        match self.0.way_home {
            Some(way_home) if way_home.speed < self.0.speed => length / self.0.speed + way_home.fixed_duration,
            _ => leg_duration(length, LegKind::Last, &self.0),
        }
    }

    fn service(&self, duration: f64) -> f64 {
        duration
    }

    fn home(&self, length: f64) -> f64 {
        // Straight home, or to the depot with one stop and home from there.
        let stop = self.0.leg_stop_duration;
        leg_duration(length, LegKind::Last, &self.0).min(self.last(length) + stop)
    }
}
