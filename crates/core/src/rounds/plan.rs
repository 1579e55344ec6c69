//! The immutable result of planning a round: routes of trips, their schedule and what is wrong with them.

use crate::travel::Leg;

/// When one visit happens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundStop {
    /// Index of the visit in the round.
    pub visit: usize,
    /// When the drone arrives, in seconds.
    pub arrival: f64,
    /// When the service begins, in seconds.
    pub start: f64,
    /// When the drone leaves, in seconds.
    pub departure: f64,
    /// The leg by which it came.
    pub leg: Leg,
    /// Joules that the trip has taken when the drone leaves: legs, waits in the air, services.
    pub energy_used: f64,
    /// Joules of the way home from here, with its landing.
    pub energy_home: f64,
}

/// What a drone flies between two stays at the depot.
#[derive(Clone, Debug, PartialEq)]
pub struct Trip {
    /// The visits in flying order; never empty.
    pub stops: Vec<RoundStop>,
    /// When it takes off, in seconds: as late as its landing allows.
    pub departure: f64,
    /// When it lands, in seconds: as early as the trips before it allow.
    pub arrival: f64,
    /// The way home.
    pub last_leg: Leg,
    /// When the drone is ready for its next trip, in seconds; the landing, if there is none.
    pub ready: f64,
    /// Length from depot to depot.
    pub length: f64,
    /// Joules from take-off to landing.
    pub energy: f64,
    /// What its visits take of the capacity.
    pub load: f64,
}

/// Something a plan must not do.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RoundViolation {
    /// A visit that no trip makes.
    #[error("visit {visit} is not made")]
    Unserved {
        /// Index of the visit.
        visit: usize,
    },
    /// A visit made more than once.
    #[error("visit {visit} is made {num_times} times")]
    Repeated {
        /// Index of the visit.
        visit: usize,
        /// How often it is made.
        num_times: usize,
    },
    /// More routes than drones.
    #[error("{num_routes} routes for {num_drones} drones")]
    TooManyRoutes {
        /// Routes of the plan.
        num_routes: usize,
        /// Drones of the fleet.
        num_drones: usize,
    },
    /// A second trip of drones that fly one.
    #[error("route {route} has {num_trips} trips, a drone flies one")]
    TooManyTrips {
        /// Index of the route.
        route: usize,
        /// Its trips.
        num_trips: usize,
    },
    /// A trip with more load than its capacity.
    #[error("trip {trip} of route {route} takes {load}, it may take {capacity}")]
    OverCapacity {
        /// Index of the route.
        route: usize,
        /// Index of the trip in its route.
        trip: usize,
        /// Its load.
        load: f64,
        /// What it may take.
        capacity: f64,
    },
    /// A service that begins after its last window ends.
    #[error("visit {visit} begins {by} s too late")]
    Late {
        /// Index of the visit.
        visit: usize,
        /// By how many seconds.
        by: f64,
    },
    /// A trip that takes longer than it may.
    #[error("trip {trip} of route {route} takes {duration} s, the limit is {max_duration} s")]
    TooSlow {
        /// Index of the route.
        route: usize,
        /// Index of the trip in its route.
        trip: usize,
        /// Its duration in seconds.
        duration: f64,
        /// The limit in seconds.
        max_duration: f64,
    },
    /// A trip that is longer than it may be.
    #[error("trip {trip} of route {route} is {length} long, the limit is {max_length}")]
    TooLong {
        /// Index of the route.
        route: usize,
        /// Index of the trip in its route.
        trip: usize,
        /// Its length.
        length: f64,
        /// The limit.
        max_length: f64,
    },
    /// A trip that takes more energy than a battery may give.
    #[error("trip {trip} of route {route} takes {energy} J, a battery may give {usable_energy} J")]
    TooMuchEnergy {
        /// Index of the route.
        route: usize,
        /// Index of the trip in its route.
        trip: usize,
        /// Joules that it takes.
        energy: f64,
        /// Joules that it may take.
        usable_energy: f64,
    },
    /// A visit after which the way home takes more than the battery may still give, though the trip as a whole does not.
    #[error("from visit {visit} in trip {trip} of route {route} the way home lacks {by} J")]
    NoWayHome {
        /// Index of the route.
        route: usize,
        /// Index of the trip in its route.
        trip: usize,
        /// Index of the visit.
        visit: usize,
        /// Joules that are missing.
        by: f64,
    },
    /// A drone that comes home after the end of the shift.
    #[error("route {route} ends {by} s after the shift")]
    ShiftOver {
        /// Index of the route.
        route: usize,
        /// By how many seconds.
        by: f64,
    },
}

/// Routes of trips with their schedule, as [`crate::rounds::evaluate_round`] recomputes them.
#[derive(Clone, Debug, PartialEq)]
pub struct RoundPlan {
    /// The trips of each drone; none for one that does not fly.
    pub routes: Vec<Vec<Trip>>,
    /// What is wrong with it; empty for a feasible plan.
    pub violations: Vec<RoundViolation>,
}

impl RoundPlan {
    /// Whether nothing is wrong with it.
    #[must_use]
    pub fn is_feasible(&self) -> bool {
        self.violations.is_empty()
    }

    /// The sum of the lengths of all trips.
    #[must_use]
    pub fn total_length(&self) -> f64 {
        // The sum of nothing is -0.0.
        self.routes.iter().flatten().map(|trip| trip.length).sum::<f64>() + 0.0
    }

    /// When the last drone lands, in seconds.
    #[must_use]
    pub fn makespan(&self) -> f64 {
        self.routes.iter().flatten().map(|trip| trip.arrival).fold(0.0, f64::max)
    }

    /// Joules of all trips.
    #[must_use]
    pub fn total_energy(&self) -> f64 {
        self.routes.iter().flatten().map(|trip| trip.energy).sum::<f64>() + 0.0
    }
}
