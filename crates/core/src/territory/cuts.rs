//! Cuts a farm into as many parts as there are routes, each of about the same cost.
//!
//! Problem: split points into parts whose convex hulls do not overlap and whose tours through the depot cost the same.
//! Source: binary space partitioning (Fuchs, Kedem and Naylor, SIGGRAPH 1980) with cuts balanced by estimated tour costs; cuts
//! around the depot are the sweep of Gillett and Miller, Operations Research 1974.
//! A cut is a straight line in a given direction, or a ray from the depot. Straight cuts give parts whose hulls are apart; so
//! do rays where a part spans less than half a turn, which the caller has to check.
//! Complexity: O(n log n) for a level of cuts.

use crate::geometry::{Point, cross, dot};
use crate::random::Random;
use crate::search::{Network, place_after_widest_gap, pseudo_angle};

/// How a cut orders the ponds: it gives the first of them to its first part.
#[derive(Clone, Copy, Debug)]
enum Order {
    /// Along a direction.
    Along(Point),
    /// By the angle at the depot, from the widest gap on, or from this share of a turn on where the ponds surround the depot.
    Around(f64),
}

/// One cut: so many routes get the first part, the others the second.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    order: Order,
    num_first: usize,
}

/// Draws the cuts for `num_routes` parts: each is followed by those of its first part, then by those of its second.
pub(super) fn draw_cuts(num_routes: usize, random: &mut Random, cuts: &mut Vec<Cut>) {
    if num_routes < 2 {
        return;
    }
    let order = if random.uniform() < 0.5 { Order::Around(random.uniform()) } else { Order::Along(direction(random)) };
    let num_first = 1 + random.below(num_routes - 1);
    cuts.push(Cut { order, num_first });
    draw_cuts(num_first, random, cuts);
    draw_cuts(num_routes - num_first, random, cuts);
}

/// A direction drawn from all, by rejection: without trigonometry it is the same on every machine.
fn direction(random: &mut Random) -> Point {
    loop {
        let drawn = Point::new(2.0 * random.uniform() - 1.0, 2.0 * random.uniform() - 1.0);
        if (0.01..=1.0).contains(&dot(drawn, drawn)) {
            return drawn;
        }
    }
}

/// What parts cost, as far as it can be told without touring them.
#[derive(Clone, Debug)]
pub(super) struct Estimate {
    /// What each visit adds to a tour.
    prices: Vec<f64>,
    /// What each tour costs beside its visits: to the part and back.
    approaches: Vec<f64>,
}

impl Estimate {
    /// A visit costs its service and the mean leg to its two nearest neighbours; every approach is that of the nearest visit.
    pub fn new(network: &Network) -> Self {
        let price = |visit: u32| {
            let nearest = network.neighbours(visit).iter().take(2);
            let (sum, count) = nearest.fold((0.0, 0.0), |(sum, count), near| (sum + near.leg, count + 1.0));
            network.services[visit as usize] + sum / f64::max(count, 1.0)
        };
        let nearest = network.depot_legs.iter().copied().fold(f64::INFINITY, f64::min);
        Self {
            prices: (0..network.num_visits as u32).map(price).collect(),
            approaches: vec![2.0 * nearest; network.num_routes],
        }
    }

    /// Takes the approaches of the given parts, and returns what the costliest part then costs.
    pub fn learn_approaches(&mut self, network: &Network, parts: &[Vec<u32>]) -> f64 {
        let mut longest: f64 = 0.0;
        for (approach, part) in self.approaches.iter_mut().zip(parts) {
            let nearest = part.iter().map(|&visit| network.depot_legs[visit as usize]).fold(f64::INFINITY, f64::min);
            *approach = 2.0 * nearest;
            longest = longest.max(*approach + part.iter().map(|&visit| self.prices[visit as usize]).sum::<f64>());
        }
        longest
    }

    /// Scales the prices of each part so that its estimate is the cost of its tour; returns the costliest.
    pub fn learn_costs(&mut self, network: &Network, tours: &[Vec<u32>]) -> f64 {
        self.learn_approaches(network, tours);
        let mut longest: f64 = 0.0;
        for (approach, tour) in self.approaches.iter().zip(tours) {
            let cost = network.route_cost(tour);
            let estimated: f64 = tour.iter().map(|&visit| self.prices[visit as usize]).sum();
            if estimated > 0.0 {
                let scale = (cost - approach) / estimated;
                tour.iter().for_each(|&visit| self.prices[visit as usize] *= scale);
            }
            longest = longest.max(cost);
        }
        longest
    }
}

/// Makes parts out of cuts.
pub(super) struct Cutter<'a> {
    network: &'a Network,
    keyed: Vec<(f64, u32)>,
}

impl<'a> Cutter<'a> {
    pub fn new(network: &'a Network) -> Self {
        Self { network, keyed: Vec::with_capacity(network.num_visits) }
    }

    /// The parts, one more than cuts and none empty, that `estimate` holds to be balanced.
    pub fn parts(&mut self, cuts: &[Cut], estimate: &Estimate) -> Vec<Vec<u32>> {
        let mut visits: Vec<u32> = (0..self.network.num_visits as u32).collect();
        let mut parts = Vec::with_capacity(cuts.len() + 1);
        self.cut(&mut visits, cuts, estimate, &estimate.approaches, &mut parts);
        parts
    }

    fn cut(
        &mut self,
        visits: &mut [u32],
        cuts: &[Cut],
        estimate: &Estimate,
        approaches: &[f64],
        parts: &mut Vec<Vec<u32>>,
    ) {
        let Some((cut, rest)) = cuts.split_first() else {
            parts.push(visits.to_vec());
            return;
        };
        self.sort(visits, cut.order);
        let (first_cuts, second_cuts) = rest.split_at(cut.num_first - 1);
        let (first_approaches, second_approaches) = approaches.split_at(cut.num_first);
        let place = balanced_place(visits, &estimate.prices, first_approaches, second_approaches);
        let (first, second) = visits.split_at_mut(place);
        self.cut(first, first_cuts, estimate, first_approaches, parts);
        self.cut(second, second_cuts, estimate, second_approaches, parts);
    }

    fn sort(&mut self, visits: &mut [u32], order: Order) {
        let (points, depot) = (&self.network.points, self.network.depot());
        self.keyed.clear();
        self.keyed.extend(visits.iter().map(|&visit| {
            let offset = points[visit as usize] - depot;
            let key = match order {
                Order::Along(direction) => dot(offset, direction),
                Order::Around(_) => pseudo_angle(offset.x, offset.y),
            };
            (key, visit)
        }));
        self.keyed.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        if let Order::Around(share) = order {
            let first = place_after_widest_gap(&self.keyed);
            let (before, after) =
                (self.keyed[(first + self.keyed.len() - 1) % self.keyed.len()].1, self.keyed[first].1);
            let is_surrounded = cross(points[before as usize], depot, points[after as usize]) > 0.0;
            let first = if is_surrounded { (share * self.keyed.len() as f64) as usize } else { first };
            self.keyed.rotate_left(first);
        }
        for (visit, entry) in visits.iter_mut().zip(&self.keyed) {
            *visit = entry.1;
        }
    }
}

/// How many of the sorted visits the first part gets, so that routes of both cost the same on average. Every route gets one.
fn balanced_place(visits: &[u32], prices: &[f64], first_approaches: &[f64], second_approaches: &[f64]) -> usize {
    let (num_first, num_second) = (first_approaches.len(), second_approaches.len());
    let mut first: f64 = first_approaches.iter().sum();
    let mut second: f64 =
        second_approaches.iter().sum::<f64>() + visits.iter().map(|&visit| prices[visit as usize]).sum::<f64>();
    let (mut best, mut best_value) = (num_first, f64::INFINITY);
    for (place, &visit) in (1..).zip(&visits[..visits.len() - num_second]) {
        first += prices[visit as usize];
        second -= prices[visit as usize];
        let value = f64::max(first / num_first as f64, second / num_second as f64);
        if place >= num_first && value < best_value {
            (best, best_value) = (place, value);
        }
    }
    best
}
