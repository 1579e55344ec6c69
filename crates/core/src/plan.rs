//! The immutable result of planning: routes, their schedule and what is wrong with them.

use crate::travel::Leg;

/// When one visit of a route happens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Index of the visit in the problem.
    pub visit: usize,
    /// The leg that leads to it; the take-off belongs to the first of a route.
    pub leg: Leg,
    /// Seconds after the start of the route when the drone arrives.
    pub arrival: f64,
    /// Seconds after the start of the route when the drone leaves.
    pub departure: f64,
    /// Joules that the time on station takes.
    pub service_energy: f64,
}

/// What one drone flies: depot, stops in flying order, depot.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    /// The visits in flying order; never empty.
    pub stops: Vec<Stop>,
    /// The leg from the last stop to the depot.
    pub last_leg: Leg,
    /// Length from depot to depot, in length units.
    pub length: f64,
    /// Seconds from depot to depot: take-off, legs, service and landing.
    pub duration: f64,
    /// Joules from depot to depot; 0 where nothing is known about it.
    pub energy: f64,
}

impl Route {
    /// Indices of the visits in flying order.
    pub fn visits(&self) -> impl ExactSizeIterator<Item = usize> + '_ {
        self.stops.iter().map(|stop| stop.visit)
    }

    /// The legs in flying order, one more than there are stops.
    pub fn legs(&self) -> impl Iterator<Item = Leg> + '_ {
        self.stops.iter().map(|stop| stop.leg).chain([self.last_leg])
    }
}

/// Something a plan must not do.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Violation {
    /// A visit that no route makes.
    #[error("pond {visit} is not visited")]
    Unserved {
        /// Index of the visit.
        visit: usize,
    },
    /// A visit made more than once.
    #[error("pond {visit} is visited {num_times} times")]
    Repeated {
        /// Index of the visit.
        visit: usize,
        /// How often it is made.
        num_times: usize,
    },
    /// More routes than drones.
    #[error("{num_routes} routes for {num_available} drones")]
    TooManyRoutes {
        /// Routes of the plan.
        num_routes: usize,
        /// Drones of the fleet.
        num_available: usize,
    },
    /// A route longer than a drone can fly.
    #[error("route {route} is {length} long, the limit is {max_length}")]
    TooLong {
        /// Index of the route.
        route: usize,
        /// Its length.
        length: f64,
        /// The limit.
        max_length: f64,
    },
    /// A route that takes longer than a drone can be under way.
    #[error("route {route} takes {duration} s, the limit is {max_duration} s")]
    TooSlow {
        /// Index of the route.
        route: usize,
        /// Its duration in seconds.
        duration: f64,
        /// The limit in seconds.
        max_duration: f64,
    },
    /// A route that takes more energy than a drone may use.
    #[error("route {route} takes {energy} J, a drone may use {usable_energy} J")]
    TooMuchEnergy {
        /// Index of the route.
        route: usize,
        /// Its energy in joules.
        energy: f64,
        /// The limit in joules.
        usable_energy: f64,
    },
}

/// Routes with their schedule, as [`crate::evaluate::evaluate`] recomputes them.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// One route a drone that flies, in the order given.
    pub routes: Vec<Route>,
    /// What is wrong with it; empty for a feasible plan.
    pub violations: Vec<Violation>,
}

impl Plan {
    /// Whether nothing is wrong with it.
    #[must_use]
    pub fn is_feasible(&self) -> bool {
        self.violations.is_empty()
    }

    /// The longest route in length units: the paper's metric.
    #[must_use]
    pub fn max_route_length(&self) -> f64 {
        self.routes.iter().map(|route| route.length).fold(0.0, f64::max)
    }

    /// The sum of all route lengths.
    #[must_use]
    pub fn total_length(&self) -> f64 {
        // The sum of nothing is -0.0.
        self.routes.iter().map(|route| route.length).sum::<f64>() + 0.0
    }

    /// The longest route in seconds.
    #[must_use]
    pub fn makespan(&self) -> f64 {
        self.routes.iter().map(|route| route.duration).fold(0.0, f64::max)
    }

    /// The visits that no route makes.
    #[must_use]
    pub fn unserved(&self) -> Vec<usize> {
        let unserved = |violation: &Violation| match *violation {
            Violation::Unserved { visit } => Some(visit),
            _ => None,
        };
        self.violations.iter().filter_map(unserved).collect()
    }
}
