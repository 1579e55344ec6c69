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
    /// Along a direction, not of unit length.
    Along(Point),
    /// By the angle at the depot, from the widest gap on.
    Around,
    /// By the angle at the depot, from this share of a turn on.
    AroundFrom(f64),
}

/// One cut: so many routes get the first part, the others the second.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    order: Order,
    num_first: usize,
}

/// Draws cuts.
pub(super) struct Draw<'a> {
    random: &'a mut Random,
    num_routes: usize,
    /// Whether ponds surround the depot, so that the first cut may begin at any angle.
    is_surrounded: bool,
}

impl<'a> Draw<'a> {
    pub fn new(network: &Network, random: &'a mut Random) -> Self {
        let offsets = network.points[..network.num_visits].iter().map(|&point| point - network.depot());
        let mut angles: Vec<(f64, u32)> = offsets.map(|offset| pseudo_angle(offset.x, offset.y)).zip(0..).collect();
        angles.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let first = place_after_widest_gap(&angles);
        let [before, after] = [first + angles.len() - 1, first].map(|place| angles[place % angles.len()].1);
        let points = &network.points;
        let is_surrounded = cross(network.depot(), points[before as usize], points[after as usize]) > 0.0;
        Self { random, num_routes: network.num_routes, is_surrounded }
    }

    fn order(&mut self, place: usize) -> Order {
        if self.random.uniform() < 0.5 {
            Order::Along(draw_direction(self.random))
        } else if place == 0 && self.is_surrounded {
            Order::AroundFrom(self.random.uniform())
        } else {
            Order::Around
        }
    }

    /// Cuts for one part per route: each is followed by those of its first part, then by those of its second.
    pub fn cuts(&mut self) -> Vec<Cut> {
        let mut cuts = Vec::with_capacity(self.num_routes - 1);
        let mut pending = vec![self.num_routes];
        while let Some(num_routes) = pending.pop() {
            if num_routes > 1 {
                let num_first = 1 + self.random.below(num_routes - 1);
                cuts.push(Cut { order: self.order(cuts.len()), num_first });
                pending.extend([num_routes - num_first, num_first]);
            }
        }
        cuts
    }
}

/// A direction drawn from all, by rejection: without trigonometry it is the same on every machine.
fn draw_direction(random: &mut Random) -> Point {
    loop {
        let drawn = Point::new(2.0 * random.uniform() - 1.0, 2.0 * random.uniform() - 1.0);
        if (0.01..=1.0).contains(&dot(drawn, drawn)) {
            return drawn;
        }
    }
}

/// A visit that stands for itself or for several nearby ones, as the cuts see it.
#[derive(Clone, Copy, Debug)]
struct Item {
    visit: u32,
    /// Position relative to the depot.
    offset: Point,
    /// Angle at the depot.
    angle: f64,
    /// What it adds to a tour.
    price: f64,
    /// Cost of the leg from the depot.
    depot_leg: f64,
}

/// A farm under the knife.
#[derive(Clone, Debug)]
pub(super) struct Cutter {
    /// Those of one part side by side.
    items: Vec<Item>,
    /// Where each part begins, and where the last one ends.
    ends: Vec<usize>,
    /// What each part's tour costs beside its items: the legs from and to the depot.
    approaches: Vec<f64>,
    keyed: Vec<(f64, u32)>,
    sorted: Vec<Item>,
}

impl Cutter {
    /// A visit costs its service and the mean leg to its two nearest neighbours. `visits` holds them all, neighbours close to
    /// each other; every `run_length` of them make one item.
    pub fn new(network: &Network, visits: &[u32], run_length: usize) -> Self {
        let price = |visit: u32| {
            let nearest = network.neighbours(visit).iter().take(2);
            let (sum, count) = nearest.fold((0.0, 0.0), |(sum, count), near| (sum + near.leg, count + 1.0));
            network.services[visit as usize] + sum / f64::max(count, 1.0)
        };
        let item = |run: &[u32]| {
            let visit = run[run.len() / 2];
            let offset = network.points[visit as usize] - network.depot();
            Item {
                visit,
                offset,
                angle: pseudo_angle(offset.x, offset.y),
                price: run.iter().map(|&visit| price(visit)).sum(),
                depot_leg: network.depot_legs[visit as usize],
            }
        };
        Self {
            items: visits.chunks(run_length).map(item).collect(),
            ends: Vec::new(),
            approaches: vec![0.0; network.num_routes],
            keyed: Vec::new(),
            sorted: Vec::new(),
        }
    }

    /// Cuts by estimate, and returns what the costliest part's tour is likely to cost.
    pub fn cut_by_estimate(&mut self, cuts: &[Cut]) -> f64 {
        let nearest = self.items.iter().map(|item| item.depot_leg).fold(f64::INFINITY, f64::min);
        self.approaches.fill(2.0 * nearest);
        self.cut(cuts);
        self.learn_approaches();
        self.cut(cuts);
        self.learn_approaches();
        let parts = self.ends.windows(2).zip(&self.approaches);
        let costs = parts.map(|(part, approach)| approach + self.price(part[0], part[1]));
        costs.fold(0.0, f64::max)
    }

    /// Scales the prices of each part so that it would cost what its tour costs, and cuts again.
    pub fn cut_by_costs(&mut self, cuts: &[Cut], costs: &[f64]) {
        self.learn_approaches();
        for (part, cost) in costs.iter().enumerate() {
            let (first, end) = (self.ends[part], self.ends[part + 1]);
            let estimated = self.price(first, end);
            if estimated > 0.0 {
                let scale = (cost - self.approaches[part]) / estimated;
                self.items[first..end].iter_mut().for_each(|item| item.price *= scale);
            }
        }
        self.cut(cuts);
    }

    /// The visits of each part that are items.
    pub fn parts(&self) -> Vec<Vec<u32>> {
        let part = |ends: &[usize]| self.items[ends[0]..ends[1]].iter().map(|item| item.visit).collect();
        self.ends.windows(2).map(part).collect()
    }

    fn price(&self, first: usize, end: usize) -> f64 {
        self.items[first..end].iter().map(|item| item.price).sum()
    }

    fn learn_approaches(&mut self) {
        for (part, approach) in self.ends.windows(2).zip(&mut self.approaches) {
            let legs = self.items[part[0]..part[1]].iter().map(|item| item.depot_leg);
            *approach = 2.0 * legs.fold(f64::INFINITY, f64::min);
        }
    }

    /// Makes parts, one more than cuts and none empty, that are balanced by prices and approaches.
    fn cut(&mut self, cuts: &[Cut]) {
        self.ends.clear();
        self.ends.push(0);
        self.cut_range(0, self.items.len(), cuts);
    }

    fn cut_range(&mut self, first: usize, end: usize, cuts: &[Cut]) {
        let Some((cut, rest)) = cuts.split_first() else {
            self.ends.push(end);
            return;
        };
        self.sort(first, end, cut.order);
        let first_part = self.ends.len() - 1;
        let (before, after) = self.approaches[first_part..first_part + rest.len() + 2].split_at(cut.num_first);
        let place = first + balanced_place(&self.items[first..end], &self.keyed, before, after);
        let (first_cuts, second_cuts) = rest.split_at(cut.num_first - 1);
        self.cut_range(first, place, first_cuts);
        self.cut_range(place, end, second_cuts);
    }

    fn sort(&mut self, first: usize, end: usize, order: Order) {
        let items = &mut self.items[first..end];
        self.keyed.clear();
        let keys = items.iter().map(|item| match order {
            Order::Along(direction) => dot(item.offset, direction),
            Order::Around | Order::AroundFrom(_) => item.angle,
        });
        self.keyed.extend(keys.zip(0..));
        self.keyed.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        match order {
            Order::Along(_) => {}
            Order::Around => {
                let first = place_after_widest_gap(&self.keyed);
                self.keyed.rotate_left(first);
            }
            Order::AroundFrom(share) => {
                let first = self.keyed.partition_point(|entry| entry.0 < 4.0 * share);
                self.keyed.rotate_left(first);
            }
        }
        self.sorted.clear();
        self.sorted.extend(self.keyed.iter().map(|&(_, place)| items[place as usize]));
        items.copy_from_slice(&self.sorted);
    }
}

/// How many of the sorted items the first part gets, so that routes of both cost the same on average. Every route gets one, and
/// items with the same key are not parted where that can be.
fn balanced_place(items: &[Item], keyed: &[(f64, u32)], first_approaches: &[f64], second_approaches: &[f64]) -> usize {
    let (num_first, num_second) = (first_approaches.len(), second_approaches.len());
    let mut first: f64 = first_approaches.iter().sum();
    let mut second: f64 = second_approaches.iter().chain(items.iter().map(|item| &item.price)).sum();
    let (first_share, second_share) = (1.0 / num_first as f64, 1.0 / num_second as f64);
    let (mut best, mut best_value) = (num_first, f64::INFINITY);
    for (place, item) in (1..).zip(&items[..items.len() - num_second]) {
        first += item.price;
        second -= item.price;
        let value = f64::max(first * first_share, second * second_share);
        if place >= num_first && value < best_value && keyed[place - 1].0 != keyed[place].0 {
            (best, best_value) = (place, value);
        }
    }
    best
}
