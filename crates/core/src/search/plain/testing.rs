//! Farms and checks that the tests of several parts of the search need.

use super::network::Network;
use super::state::State;
use crate::effort::Budget;
use crate::generate::{Variant, generate};
use crate::geometry::Point;
use crate::problem::{Depot, Problem, VehicleType, Visit, WayHome};

pub(super) fn network_of(problem: &Problem) -> Network {
    let mut network = Network::new(problem);
    let neighbours = network.find_neighbours(&unlimited()).unwrap();
    network.set_neighbours(neighbours);
    network
}

/// Ponds around a depot, as in a research instance.
pub(super) fn research_network(depot: Point, ponds: &[Point], num_routes: usize) -> Network {
    network_of(&Problem::research(depot, ponds, num_routes).unwrap())
}

/// A farm with services and a speed. With stops, some ponds lie in one place, or at the depot, where a leg takes no time, and
/// drones take off and come home in a way of their own.
pub(super) fn farm_with_services(
    num_ponds: usize,
    num_routes: usize,
    seed: u64,
    services: &[f64],
    has_stops: bool,
) -> Network {
    let mut farm = generate(num_ponds, Variant::Authors, seed).unwrap();
    if has_stops {
        let lattice = |point: Point| Point::new((4.0 * point.x).round(), (4.0 * point.y).round());
        (farm.depot, farm.ponds) = (lattice(farm.depot), farm.ponds.into_iter().map(lattice).collect());
    }
    let visits = farm.ponds.iter().zip(services);
    let visits =
        visits.map(|(&position, &service_duration)| Visit { service_duration, ..Visit::at(position) }).collect();
    let stop = if has_stops { 0.5 } else { 0.0 };
    let vehicle_type = VehicleType {
        speed: 2.0,
        leg_stop_duration: stop,
        takeoff_duration: 2.0 * stop,
        way_home: has_stops.then_some(WayHome { speed: 3.0, fixed_duration: 0.8 }),
        ..VehicleType::unlimited(num_routes)
    };
    network_of(&Problem::new(Depot { position: farm.depot }, visits, vehicle_type).unwrap())
}

/// Routes of which visit `i` is on the one that `homes[i]` names, in their order.
pub(super) fn routes_of(homes: &[usize], num_routes: usize) -> Vec<Vec<u32>> {
    let mut routes = vec![Vec::new(); num_routes];
    for (visit, home) in homes.iter().enumerate() {
        routes[home % num_routes].push(visit as u32);
    }
    routes
}

pub(super) fn unlimited() -> Budget<'static> {
    Budget::new(None, None, None)
}

pub(super) fn assert_every_visit_once(network: &Network, state: &State) {
    let mut visits: Vec<u32> = state.routes(network).concat();
    visits.sort_unstable();
    assert_eq!(visits, (0..network.num_visits as u32).collect::<Vec<_>>());
}

pub(super) fn assert_costs_are_those_of_the_routes(network: &Network, state: &State) {
    for (route, &cost) in state.route_costs.iter().enumerate() {
        assert!((cost - network.route_cost(&state.route(network, route))).abs() < 1e-9);
    }
}
