//! Takes strings of neighbouring visits out of neighbouring routes.
//!
//! Source: Christiaens and Vanden Berghe, Slack Induction by String Removals for Vehicle Routing Problems, Transportation
//! Science 2020, section 5.1, with the average of ten removed visits and strings of at most ten that they propose. Changed:
//! half of the seeds lie on the longest route, because no other change can shorten it. O(visits removed).

use super::network::Network;
use super::state::{ABSENT, State, Touched};
use crate::random::Random;

const MEAN_REMOVED: f64 = 10.0;
const MAX_STRING: f64 = 10.0;
/// Share of strings from whose middle some visits are kept.
const SPLIT_SHARE: f64 = 0.5;
/// Chance of keeping one more visit in the middle of a split string, turned round (beta of the source).
const SPLIT_STOP: f64 = 0.99;

/// Strings removed in one step: buffers that live as long as the search.
#[derive(Debug, Default)]
pub(super) struct Ruin {
    /// What the last call took out.
    pub removed: Vec<u32>,
    ruined_routes: Vec<u32>,
}

impl Ruin {
    /// Takes out one string through `seed` and others through its neighbours, each from a route of its own.
    pub fn remove(
        &mut self,
        network: &Network,
        state: &mut State,
        seed: u32,
        random: &mut Random,
        touched: &mut Touched,
    ) {
        self.removed.clear();
        self.ruined_routes.clear();
        let mean_size = network.num_visits as f64 / network.num_routes as f64;
        let max_string = mean_size.clamp(1.0, MAX_STRING);
        let max_strings = 4.0 * MEAN_REMOVED / (1.0 + max_string) - 1.0;
        let num_strings = (random.uniform() * max_strings + 1.0) as usize;
        self.remove_one(network, state, seed, max_string, random, touched);
        for neighbour in network.neighbours(seed) {
            if self.ruined_routes.len() >= num_strings {
                break;
            }
            let route = state.nodes[neighbour.node as usize].route;
            if route != ABSENT && !self.ruined_routes.contains(&route) {
                self.remove_one(network, state, neighbour.node, max_string, random, touched);
            }
        }
    }

    fn remove_one(
        &mut self,
        network: &Network,
        state: &mut State,
        through: u32,
        max_string: f64,
        random: &mut Random,
        touched: &mut Touched,
    ) {
        let route = state.nodes[through as usize].route;
        let size = state.route_sizes[route as usize] as usize;
        self.ruined_routes.push(route);
        let length = (random.uniform() * max_string.min(size as f64) + 1.0) as usize;
        let length = length.min(size);
        let num_kept = if length > 1 && length < size && random.uniform() < SPLIT_SHARE {
            let mut num_kept = 1;
            while length + num_kept < size && random.uniform() > SPLIT_STOP {
                num_kept += 1;
            }
            num_kept
        } else {
            0
        };
        let first = Self::first_of_window(network, state, through, length + num_kept, random);
        if num_kept == 0 {
            state.remove_string(network, first, length, &mut self.removed, touched);
            return;
        }
        let head = 1 + random.below(length - 1);
        let mut second = first;
        for _ in 0..head + num_kept {
            second = state.nodes[second as usize].next;
        }
        state.remove_string(network, first, head, &mut self.removed, touched);
        state.remove_string(network, second, length - head, &mut self.removed, touched);
    }

    /// First visit of a random window of `length` visits that contains `through`; windows that would run over the end of the
    /// route are moved back.
    fn first_of_window(network: &Network, state: &State, through: u32, length: usize, random: &mut Random) -> u32 {
        let is_depot = |node: u32| node as usize >= network.num_visits;
        let num_before = random.below(length);
        let mut num_after = length - 1 - num_before;
        let mut last = through;
        while num_after > 0 {
            let next = state.nodes[last as usize].next;
            if is_depot(next) {
                break;
            }
            last = next;
            num_after -= 1;
        }
        let mut first = through;
        for _ in 0..num_before + num_after {
            let previous = state.nodes[first as usize].previous;
            if is_depot(previous) {
                break;
            }
            first = previous;
        }
        first
    }
}
