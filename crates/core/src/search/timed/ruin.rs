//! Takes strings of neighbouring visits out of neighbouring trips.
//!
//! Source: Christiaens and Vanden Berghe, Slack Induction by String Removals for Vehicle Routing Problems, Transportation
//! Science 2020, section 5.1, with the average of ten removed visits and strings of at most ten that they propose. Strings
//! are cut from trips. O(visits removed + length of the trips).

use super::network::Network;
use super::state::{ABSENT, OverLimit, State, Touched};
use crate::random::Random;

const MEAN_REMOVED: f64 = 10.0;
const MAX_STRING: f64 = 10.0;
/// Share of strings from whose middle some visits are kept.
const SPLIT_SHARE: f64 = 0.5;
/// Share of ruins that take out a whole trip, where there are many, and from how many trips the smallest is taken.
const WHOLE_SHARE: f64 = 0.02;
const NUM_DRAWN: usize = 4;
/// Fewer trips are rarely one too many, and steps are better spent otherwise.
const MANY_TRIPS: usize = 16;
/// Chance of keeping one more visit in the middle of a split string, turned round (beta of the source).
const SPLIT_STOP: f64 = 0.99;

/// Buffers that live as long as the search.
#[derive(Debug, Default)]
pub(super) struct Ruin {
    ruined: Vec<u32>,
    cut: Vec<u32>,
}

impl Ruin {
    /// Takes out one string through a random visit and others through its neighbours, each from a trip of its own. What is
    /// taken out lies in the bank.
    pub fn remove(
        &mut self,
        network: &Network<'_>,
        state: &mut State,
        random: &mut Random,
        touched: &mut Touched,
    ) -> Result<(), OverLimit> {
        self.ruined.clear();
        let has_many = network.round.fleet().turnaround.is_some() && state.num_trips() >= MANY_TRIPS;
        if has_many && random.uniform() < WHOLE_SHARE {
            self.remove_trip(network, state, random, touched);
            return state.renew_all(network, &self.ruined);
        }
        let num_trips = state.num_trips();
        let mean_size = network.num_visits as f64 / num_trips.max(1) as f64;
        let max_string = mean_size.clamp(1.0, MAX_STRING);
        let num_strings = (random.uniform() * (4.0 * MEAN_REMOVED / (1.0 + max_string) - 1.0) + 1.0) as usize;
        let seed = random.below(network.num_visits) as u32;
        for visit in std::iter::once(seed).chain(network.neighbours(seed).iter().map(|neighbour| neighbour.visit)) {
            if self.ruined.len() >= num_strings {
                break;
            }
            let trip = state.places[visit as usize].trip;
            if trip != ABSENT && !self.ruined.contains(&trip) {
                self.ruined.push(trip);
                self.remove_string(network, state, visit, max_string, random, touched);
            }
        }
        state.renew_all(network, &self.ruined)
    }

    /// Takes out the smallest of a few random trips, as a whole: what counts most is how many trips there are.
    fn remove_trip(&mut self, network: &Network<'_>, state: &mut State, random: &mut Random, touched: &mut Touched) {
        let drawn = (0..NUM_DRAWN).map(|_| random.below(state.trips.len().max(1)));
        let size = |trip: &usize| state.trips.get(*trip).map_or(0, |trip| trip.visits.len());
        let Some(trip) = drawn.filter(|trip| size(trip) > 0).min_by_key(size) else { return };
        self.cut.clear();
        self.cut.extend_from_slice(&state.trips[trip].visits);
        self.ruined.push(trip as u32);
        for &visit in &self.cut {
            state.take_out(network, visit, touched);
        }
    }

    fn remove_string(
        &mut self,
        network: &Network<'_>,
        state: &mut State,
        through: u32,
        max_string: f64,
        random: &mut Random,
        touched: &mut Touched,
    ) {
        let place = state.places[through as usize];
        let visits = &state.trips[place.trip as usize].visits;
        let size = visits.len();
        let length = ((random.uniform() * max_string.min(size as f64) + 1.0) as usize).min(size);
        let mut num_kept = 0;
        if length > 1 && length < size && random.uniform() < SPLIT_SHARE {
            num_kept = 1;
            while length + num_kept < size && random.uniform() > SPLIT_STOP {
                num_kept += 1;
            }
        }
        // A window of the trip that holds the visit; the visits that are kept lie somewhere within.
        let window = length + num_kept;
        let index = place.index as usize;
        let lowest = (index + 1).saturating_sub(window);
        let highest = index.min(size - window);
        let first = lowest + random.below(highest - lowest + 1);
        let head = if num_kept == 0 { length } else { 1 + random.below(length - 1) };
        self.cut.clear();
        self.cut.extend_from_slice(&visits[first..first + head]);
        self.cut.extend_from_slice(&visits[first + head + num_kept..first + window]);
        for &visit in &self.cut {
            state.take_out(network, visit, touched);
        }
    }
}
