//! The plans that a search begins with, each from another cut of the farm.

use super::airspace::SharedAirspace;
use super::anneal::Chain;
use super::construct::Cuts;
use super::context::Search;
use super::improve::improve_routes;
use crate::random::Random;

/// How far the shares of the sectors of a start are from equal, at most: wide enough for other petals to win.
const SHARE_SPREAD: f64 = 0.3;

/// Makes the starts of one thread, one after the other.
pub(super) struct Starts<'a> {
    search: &'a Search<'a>,
    cuts: &'a Cuts<'a>,
    thread: usize,
    num_made: usize,
    /// Whether half the starts are cut at random instead of along sectors.
    pub has_random_cuts: bool,
}

impl<'a> Starts<'a> {
    pub fn new(search: &'a Search<'a>, cuts: &'a Cuts<'a>, thread: usize) -> Self {
        Self { search, cuts, thread, num_made: 0, has_random_cuts: false }
    }

    /// The next start: equal sectors first, then sectors of random shares, two in turn with two random cuts if there are any.
    pub fn make(&mut self) -> Chain<SharedAirspace> {
        let Search { network, budget, options } = *self.search;
        let index = self.num_made;
        self.num_made += 1;
        let stream = (index * options.num_threads + self.thread) as u64;
        let mut random = Random::new(self.search.seed(stream));
        let mut routes = if self.has_random_cuts && index % 4 >= 2 {
            let mut visits: Vec<u32> = (0..network.num_visits as u32).collect();
            self.cuts.cut_at_random(&mut visits, network.num_routes, &mut random)
        } else {
            let spread = if stream == 0 { 0.0 } else { SHARE_SPREAD };
            let shares: Vec<f64> =
                (0..network.num_routes).map(|_| 1.0 + spread * (2.0 * random.uniform() - 1.0)).collect();
            self.cuts.routes(&shares)
        };
        improve_routes(network, budget, &mut routes);
        self.search.chain_from(&routes, stream)
    }
}
