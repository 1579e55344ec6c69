//! Moves whole trips between drones: into another route, or in exchange for a trip of it.
//!
//! Most of what balances a round of many trips: a ruin takes some ten visits, a trip has twenty or thirty. Source of the idea:
//! measured (docs/explanation/search.md, "Rounds with windows and trips"). O(trips of two routes).

use super::network::Network;
use super::state::{OverLimit, State, Touched};
use crate::random::Random;

/// Share of moves that start at the drone that lands last.
const LAST_SHARE: f64 = 0.8;
/// Share of moves that exchange two trips.
const EXCHANGE_SHARE: f64 = 0.5;

/// Moves a random trip, or exchanges it; returns whether there was one to move.
pub(super) fn move_trip(
    network: &Network<'_>,
    state: &mut State,
    random: &mut Random,
    touched: &mut Touched,
) -> Result<bool, OverLimit> {
    let num_routes = state.routes.len();
    let from = if random.uniform() < LAST_SHARE { last_to_land(state) } else { random.below(num_routes) };
    if state.routes[from].trips.is_empty() {
        return Ok(false);
    }
    let number = random.below(state.routes[from].trips.len());
    // Within one route trips change places.
    let to = random.below(num_routes);
    let trip = state.routes[from].trips.remove(number);
    touched.add(trip, from as u32);
    touched.add(trip, to as u32);
    let is_one_each = network.round.fleet().turnaround.is_none();
    let is_exchange =
        to != from && !state.routes[to].trips.is_empty() && (is_one_each || random.uniform() < EXCHANGE_SHARE);
    if is_exchange {
        let other_number = random.below(state.routes[to].trips.len());
        let other = std::mem::replace(&mut state.routes[to].trips[other_number], trip);
        touched.add(other, to as u32);
        let place = random.below(state.routes[from].trips.len() + 1);
        state.routes[from].trips.insert(place, other);
        assign(network, state, other, from)?;
    } else {
        let place = random.below(state.routes[to].trips.len() + 1);
        state.routes[to].trips.insert(place, trip);
    }
    assign(network, state, trip, to)?;
    state.renew_route(network, from as u32)?;
    state.renew_route(network, to as u32)?;
    Ok(true)
}

fn assign(network: &Network<'_>, state: &mut State, trip: u32, route: usize) -> Result<(), OverLimit> {
    let slot = &mut state.trips[trip as usize];
    let old = std::mem::replace(&mut slot.route, route as u32);
    // Drones in other layers take other times to take off and land.
    if network.ends[old as usize] == network.ends[route] { Ok(()) } else { state.renew_trip(network, trip) }
}

fn last_to_land(state: &State) -> usize {
    let finish = |route: &usize| state.routes[*route].finish;
    (0..state.routes.len()).max_by(|one, other| finish(one).total_cmp(&finish(other))).unwrap_or(0)
}
