//! Shortens the path of one route, from the depot and back, without neighbour lists.
//!
//! Problem: a tour along strips has many bad legs, and there is no time to find neighbours. Sources: 2-opt (Croes, A method
//! for solving traveling-salesman problems, Operations Research 1958); Or-opt (Or, thesis, Northwestern University 1976).
//! Changed: the best move of a leg or visit is sought among all legs in a window, without regard to what is near. A row of
//! distances in single precision takes a compiler's vector instructions and no branch, and so less time than a list of
//! neighbours. What it finds is done only if it is shorter in double precision as well: no path gets costlier. Windows are
//! limited, so that a pass over n visits is O(n).

use super::network::Network;
use crate::effort::Budget;

/// Legs on either side of a leg or visit that a move may reach, at most.
const WINDOW: usize = 256;
/// Places looked at between two looks at the clock.
const PLACES_PER_LOOK: usize = 256;
/// Numbers handled at once: two vectors of four, to hide the latency.
const LANES: usize = 8;
/// Coordinate of the places after the end of a path: farther than any visit, and finite when squared.
const FAR: f32 = 1e18;
/// What a move must gain, relative to the legs it takes out: above rounding, so that what is made is not made costlier.
const MIN_GAIN: f64 = 1e-9;
/// What must be gained in single precision to look closer.
const MIN_ROUGH_GAIN: f32 = 1e-5;

/// Coordinates of all visits, then of the depot, in single precision.
pub(super) struct Coordinates {
    /// First coordinates.
    pub xs: Vec<f32>,
    /// Second coordinates.
    pub ys: Vec<f32>,
}

impl Coordinates {
    /// Length of a tour of visits from the depot and back.
    pub fn tour_length(&self, tour: &[u32]) -> f32 {
        let depot = self.xs.len() - 1;
        let (mut from, mut sum) = (depot, 0.0);
        for to in tour.iter().map(|&visit| visit as usize).chain([depot]) {
            sum += length(self.xs[to] - self.xs[from], self.ys[to] - self.ys[from]);
            from = to;
        }
        sum
    }
}

/// Rows of distances, kept from one use to the next.
#[derive(Default)]
pub(super) struct Rows {
    /// Distances from one end of what moves to the places in the window.
    near: Vec<f32>,
    /// Distances from its other end.
    far: Vec<f32>,
}

/// A route with its depot at both ends, as arrays that are padded so that a row may run over the end.
pub(super) struct Path {
    /// The visits between two depots; not padded.
    nodes: Vec<u32>,
    /// Coordinates of each place, then [`FAR`].
    xs: Vec<f32>,
    ys: Vec<f32>,
    /// Length of the leg from each place to the next.
    legs: Vec<f32>,
}

impl Path {
    /// The path along `route`.
    pub fn new(places: &Coordinates, route: &[u32]) -> Self {
        let depot = places.xs.len() - 1;
        let mut nodes = Vec::with_capacity(route.len() + 2);
        nodes.push(depot as u32);
        nodes.extend_from_slice(route);
        nodes.push(depot as u32);
        let padded = |values: &[f32]| {
            let mut padded = Vec::with_capacity(nodes.len() + LANES);
            padded.extend(nodes.iter().map(|&node| values[node as usize]));
            padded.resize(nodes.len() + LANES, FAR);
            padded
        };
        let (xs, ys) = (padded(&places.xs), padded(&places.ys));
        let mut path = Self { legs: vec![0.0; xs.len()], nodes, xs, ys };
        path.measure_legs(0, path.nodes.len() - 1);
        path
    }

    /// The visits, in flying order.
    pub fn route(&self) -> &[u32] {
        &self.nodes[1..self.nodes.len() - 1]
    }

    /// Measures the legs from place `from` to place `to`.
    fn measure_legs(&mut self, from: usize, to: usize) {
        let (xs, ys) = (&self.xs[from..to], &self.ys[from..to]);
        let (next_xs, next_ys) = (&self.xs[from + 1..=to], &self.ys[from + 1..=to]);
        for ((((leg, x), y), next_x), next_y) in
            self.legs[from..to].iter_mut().zip(xs).zip(ys).zip(next_xs).zip(next_ys)
        {
            *leg = length(next_x - x, next_y - y);
        }
    }

    /// 2-opt: legs a-b and c-d become a-c and b-d. For each leg in turn, the best such exchange with a later one, until the time
    /// is over.
    pub fn two_opt(&mut self, network: &Network, budget: &Budget<'_>, rows: &mut Rows) {
        let num_legs = self.nodes.len() - 1;
        rows.make_room(self.nodes.len());
        let mut is_near_known = false;
        for first in 0..num_legs.saturating_sub(2) {
            if first % PLACES_PER_LOOK == PLACES_PER_LOOK - 1 && budget.is_time_over() {
                return;
            }
            let start = first + 2;
            let width = (num_legs - start).min(WINDOW);
            let padded_width = width.next_multiple_of(LANES);
            if !is_near_known {
                self.measure(first, start, padded_width, &mut rows.near);
            }
            self.measure(first + 1, start + 1, padded_width, &mut rows.far);
            let legs = &self.legs[start..start + padded_width];
            let (near, far) = (&rows.near[..padded_width], &rows.far[..padded_width]);
            let added = least_sum(near, far, legs);
            let is_exchanged = added < self.legs[first] * (1.0 - MIN_ROUGH_GAIN)
                && place_of(added, near, far, legs)
                    .is_some_and(|place| place < width && self.exchange(network, first, start + place));
            // The next row starts where this one ends, unless the path has been turned round behind `first`.
            is_near_known = !is_exchanged;
            if is_near_known {
                std::mem::swap(&mut rows.near, &mut rows.far);
            }
        }
    }

    /// Exchanges the legs that begin at the two places, if that is cheaper.
    fn exchange(&mut self, network: &Network, first: usize, second: usize) -> bool {
        let leg = |from: usize, to: usize| network.leg(self.nodes[from], self.nodes[to]);
        let removed = leg(first, first + 1) + leg(second, second + 1);
        if removed - leg(first, second) - leg(first + 1, second + 1) <= MIN_GAIN * removed {
            return false;
        }
        self.reverse(first + 1, second);
        self.legs[first + 1..second].reverse();
        self.measure_legs(first, first + 1);
        self.measure_legs(second, second + 1);
        true
    }

    /// Or-opt: `size` visits in a row move to the best leg for them, either way round, if leaving saves more than `min_saving`
    /// where they are; until the time is over.
    pub fn or_opt(&mut self, network: &Network, budget: &Budget<'_>, size: usize, min_saving: f32, rows: &mut Rows) {
        rows.make_room(self.nodes.len());
        for start in 1..self.nodes.len().saturating_sub(size) {
            if start % PLACES_PER_LOOK == 0 && budget.is_time_over() {
                return;
            }
            let last = start + size - 1;
            let closed = length(self.xs[last + 1] - self.xs[start - 1], self.ys[last + 1] - self.ys[start - 1]);
            let saved = self.legs[start - 1] + self.legs[last] - closed;
            if saved <= min_saving {
                continue;
            }
            let from = (start - 1).saturating_sub(WINDOW);
            let to = (last + 1 + WINDOW).min(self.nodes.len() - 1);
            let width = to - from;
            self.measure(start, from, width + 1, &mut rows.near);
            if size > 1 {
                self.measure(last, from, width + 1, &mut rows.far);
            }
            let (near, far) = (&rows.near[..=width], &rows.far[..=width]);
            let far = if size > 1 { far } else { near };
            let mut best = (saved * (1.0 - MIN_ROUGH_GAIN), None);
            // The legs before the visits and the legs after them.
            for range in [0..start - 1 - from, last + 1 - from..width] {
                let (begin, end) = (range.start, range.end);
                let legs = &self.legs[from + begin..from + end];
                for is_turned in [false, true] {
                    let (one, other) = if is_turned { (far, near) } else { (near, far) };
                    let (one, other) = (&one[begin..end], &other[begin + 1..end + 1]);
                    let added = least_sum(one, other, legs);
                    if added < best.0 {
                        best =
                            (added, place_of(added, one, other, legs).map(|place| (from + begin + place, is_turned)));
                    }
                    if size == 1 {
                        break;
                    }
                }
            }
            if let Some((place, is_turned)) = best.1 {
                self.relocate(network, start, last, place, is_turned);
            }
        }
    }

    /// Moves the visits at `start..=last` into the leg that begins at `place`, if that is cheaper.
    fn relocate(&mut self, network: &Network, start: usize, last: usize, place: usize, is_turned: bool) {
        let leg = |from: usize, to: usize| network.leg(self.nodes[from], self.nodes[to]);
        let (left, right) = if is_turned { (last, start) } else { (start, last) };
        let removed = leg(start - 1, start) + leg(last, last + 1) + leg(place, place + 1);
        let added = leg(start - 1, last + 1) + leg(place, left) + leg(right, place + 1);
        if removed - added <= MIN_GAIN * removed {
            return;
        }
        let range = if place < start { place + 1..last + 1 } else { start..place + 1 };
        let middle = if place < start { start } else { last + 1 } - range.start;
        if is_turned {
            self.reverse(start, last);
        }
        self.nodes[range.clone()].rotate_left(middle);
        self.xs[range.clone()].rotate_left(middle);
        self.ys[range.clone()].rotate_left(middle);
        self.measure_legs(range.start - 1, range.end);
    }

    /// Turns the places `first..=last` round; their legs stay.
    fn reverse(&mut self, first: usize, last: usize) {
        self.nodes[first..=last].reverse();
        self.xs[first..=last].reverse();
        self.ys[first..=last].reverse();
    }

    /// Takes out the visits that `is_kept` denies.
    pub fn retain(&mut self, is_kept: impl Fn(u32) -> bool) {
        let last = self.nodes.len() - 1;
        let mut num_kept = 1;
        for place in 1..=last {
            if place == last || is_kept(self.nodes[place]) {
                self.nodes[num_kept] = self.nodes[place];
                (self.xs[num_kept], self.ys[num_kept]) = (self.xs[place], self.ys[place]);
                num_kept += 1;
            }
        }
        self.nodes.truncate(num_kept);
        for values in [&mut self.xs, &mut self.ys] {
            values.truncate(num_kept);
            values.resize(num_kept + LANES, FAR);
        }
        self.legs.truncate(num_kept - 1);
        self.legs.resize(num_kept + LANES, 0.0);
        self.measure_legs(0, num_kept - 1);
    }

    /// Puts a visit where it lengthens the path least.
    pub fn insert(&mut self, places: &Coordinates, visit: u32, rows: &mut Rows) {
        let num_legs = self.nodes.len() - 1;
        rows.make_room(self.nodes.len() + 1);
        let (x, y) = (places.xs[visit as usize], places.ys[visit as usize]);
        measure_from(x, y, &self.xs[..=num_legs], &self.ys[..=num_legs], &mut rows.near);
        let (near, legs) = (&rows.near, &self.legs[..num_legs]);
        let added = least_sum(&near[..num_legs], &near[1..=num_legs], legs);
        let place = place_of(added, &near[..num_legs], &near[1..=num_legs], legs).unwrap_or(0) + 1;
        self.nodes.insert(place, visit);
        self.xs.insert(place, x);
        self.ys.insert(place, y);
        self.legs.insert(place, 0.0);
        self.measure_legs(place - 1, place + 1);
    }

    /// Distances from the place at `from` to `width` places from `start` on.
    fn measure(&self, from: usize, start: usize, width: usize, row: &mut [f32]) {
        let range = start..start + width;
        measure_from(self.xs[from], self.ys[from], &self.xs[range.clone()], &self.ys[range], row);
    }
}

impl Rows {
    /// Makes room for a path of `size` places.
    fn make_room(&mut self, size: usize) {
        if self.near.len() < size + LANES {
            self.near.resize(size + LANES, 0.0);
            self.far.resize(size + LANES, 0.0);
        }
    }
}

#[inline]
fn length(x: f32, y: f32) -> f32 {
    (x * x + y * y).sqrt()
}

fn measure_from(x: f32, y: f32, xs: &[f32], ys: &[f32], row: &mut [f32]) {
    for ((distance, other_x), other_y) in row[..xs.len()].iter_mut().zip(xs).zip(ys) {
        *distance = length(other_x - x, other_y - y);
    }
}

/// The least of `one + other - legs`. Lane by lane, which compilers turn into vector instructions.
fn least_sum(one: &[f32], other: &[f32], legs: &[f32]) -> f32 {
    let mut least = [f32::INFINITY; LANES];
    let ((ones, one_rest), (others, other_rest), (chunks, rest)) =
        (one.as_chunks::<LANES>(), other.as_chunks::<LANES>(), legs.as_chunks::<LANES>());
    for ((one, other), legs) in ones.iter().zip(others).zip(chunks) {
        for lane in 0..LANES {
            let sum = one[lane] + other[lane] - legs[lane];
            least[lane] = if sum < least[lane] { sum } else { least[lane] };
        }
    }
    for (lane, ((one, other), leg)) in one_rest.iter().zip(other_rest).zip(rest).enumerate() {
        let sum = one + other - leg;
        least[lane] = if sum < least[lane] { sum } else { least[lane] };
    }
    for half in [LANES / 2, LANES / 4, LANES / 8] {
        for lane in 0..half {
            least[lane] = if least[lane + half] < least[lane] { least[lane + half] } else { least[lane] };
        }
    }
    least[0]
}

/// Where [`least_sum`] found `sum`; `None` if all sums were infinite or not numbers.
fn place_of(sum: f32, one: &[f32], other: &[f32], legs: &[f32]) -> Option<usize> {
    let is_here = |place: &usize| one[*place] + other[*place] - legs[*place] == sum;
    let (ones, others, chunks) =
        (one.as_chunks::<LANES>().0, other.as_chunks::<LANES>().0, legs.as_chunks::<LANES>().0);
    let has_sum = |((one, other), legs): ((&[f32; LANES], &[f32; LANES]), &[f32; LANES])| {
        let mut num_found = [0; LANES];
        for lane in 0..LANES {
            num_found[lane] = i32::from(one[lane] + other[lane] - legs[lane] == sum);
        }
        num_found.iter().sum::<i32>() > 0
    };
    let chunk = ones.iter().zip(others).zip(chunks).position(has_sum).unwrap_or(chunks.len());
    (chunk * LANES..legs.len()).find(is_here)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::problem::Problem;
    use crate::search::plain::testing::unlimited;
    use proptest::prelude::*;

    fn network(points: &[(f64, f64)]) -> (Network, Coordinates) {
        let ponds: Vec<Point> = points.iter().map(|&(x, y)| Point::new(x, y)).collect();
        let network = Network::new(&Problem::research(Point::new(0.0, 0.0), &ponds, 1).unwrap());
        let places = network.points.iter().map(|point| (point.x as f32, point.y as f32)).unzip();
        (network, Coordinates { xs: places.0, ys: places.1 })
    }

    fn sorted(mut visits: Vec<u32>) -> Vec<u32> {
        visits.sort_unstable();
        visits
    }

    #[test]
    fn two_opt_uncrosses_a_square() {
        let (network, places) = network(&[(0.0, 1.0), (1.0, 0.0), (1.0, 1.0)]);
        let mut path = Path::new(&places, &[0, 1, 2]);
        path.two_opt(&network, &unlimited(), &mut Rows::default());
        assert_eq!(network.route_cost(path.route()), 4.0);
    }

    #[test]
    fn or_opt_takes_visits_to_the_leg_they_lie_on() {
        // There along y = 0, back along y = 1; one, two or three visits of the way there are made on the way back.
        for size in 1..=3usize {
            let there = (1..=9).filter(|x| !(4..4 + size).contains(x)).map(|x| (x as f64, 0.0));
            let back = (1..=9).rev().map(|x| (x as f64, 1.0));
            let late = (4..4 + size).map(|x| (x as f64, 0.0));
            let points: Vec<(f64, f64)> = there.chain(back).collect();
            let place = 9 - size + 9 - 5;
            let points: Vec<(f64, f64)> =
                points[..place].iter().copied().chain(late).chain(points[place..].iter().copied()).collect();
            let (network, places) = network(&points);
            let route: Vec<u32> = (0..points.len() as u32).collect();
            let mut path = Path::new(&places, &route);
            path.or_opt(&network, &unlimited(), size, 0.1, &mut Rows::default());
            assert!(network.route_cost(path.route()) < network.route_cost(&route) - 1.0, "{:?}", path.route());
            assert_eq!(sorted(path.route().to_vec()), route);
        }
    }

    #[test]
    fn a_visit_is_inserted_where_it_is_cheapest() {
        let (_, places) = network(&[(2.0, 0.0), (4.0, 0.0), (4.0, 3.0), (3.0, 0.5)]);
        let mut path = Path::new(&places, &[0, 1, 2]);
        path.insert(&places, 3, &mut Rows::default());
        assert_eq!(path.route(), [0, 3, 1, 2]);
        path.retain(|visit| visit != 0);
        assert_eq!(path.route(), [3, 1, 2]);
        path.retain(|_| false);
        path.insert(&places, 2, &mut Rows::default());
        assert_eq!(path.route(), [2]);
    }

    #[test]
    fn long_paths_are_smoothed_within_the_window() {
        let points: Vec<(f64, f64)> = (0..1000).map(|index| (f64::from(index * 37 % 1000), 0.0)).collect();
        let (network, places) = network(&points);
        let route: Vec<u32> = (0..1000).collect();
        let mut path = Path::new(&places, &route);
        path.two_opt(&network, &unlimited(), &mut Rows::default());
        path.or_opt(&network, &unlimited(), 2, 0.0, &mut Rows::default());
        assert!(network.route_cost(path.route()) < 0.5 * network.route_cost(&route));
        assert_eq!(sorted(path.route().to_vec()), route);
    }

    proptest! {
        #[test]
        fn no_pass_makes_a_path_costlier_or_loses_a_visit(
            points in prop_oneof![
                prop::collection::vec((-3.0..3.0f64, -3.0..3.0f64), 1..80),
                prop::collection::vec((0..5u8, 0..4u8).prop_map(|(x, y)| (x.into(), y.into())), 1..80),
                prop::collection::vec((1e5..1.1e5f64, Just(7e6)), 1..40),
            ],
            passes in prop::collection::vec(0..4usize, 1..6), min_saving in 0.0..1.0f32,
        ) {
            let (network, places) = network(&points);
            let route: Vec<u32> = (0..points.len() as u32).collect();
            let (mut path, mut rows) = (Path::new(&places, &route), Rows::default());
            let mut cost = network.route_cost(&route);
            for pass in passes {
                if pass == 0 {
                    path.two_opt(&network, &unlimited(), &mut rows);
                } else {
                    path.or_opt(&network, &unlimited(), pass, min_saving, &mut rows);
                }
                let smoothed = network.route_cost(path.route());
                prop_assert!(smoothed <= cost * (1.0 + 1e-12));
                cost = smoothed;
            }
            prop_assert_eq!(sorted(path.route().to_vec()), route);
        }

        #[test]
        fn the_least_sum_and_its_place(terms in prop::collection::vec((0..9u8, 0..9u8, 0..9u8), 0..50)) {
            let column = |of: fn(&(u8, u8, u8)) -> u8| terms.iter().map(|term| f32::from(of(term))).collect::<Vec<f32>>();
            let (one, other, legs) = (column(|term| term.0), column(|term| term.1), column(|term| term.2));
            let sums: Vec<f32> = (0..terms.len()).map(|place| one[place] + other[place] - legs[place]).collect();
            let least = least_sum(&one, &other, &legs);
            prop_assert_eq!(least, sums.iter().copied().fold(f32::INFINITY, f32::min));
            prop_assert_eq!(place_of(least, &one, &other, &legs), sums.iter().position(|&sum| sum == least));
        }
    }
}
