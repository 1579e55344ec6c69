//! Shortens the tour of one route by 2-opt and Or-opt over neighbour lists.
//!
//! Source: Bentley, Fast Algorithms for Geometric Traveling Salesman Problems, ORSA J. Computing 1992: neighbour lists,
//! don't-look bits kept as a queue, reversal of the shorter side. Tours are arrays here, unlike in [`super::state`], because
//! 2-opt turns paths round.

use super::network::Network;
use crate::effort::Budget;

/// Neighbours tried per visit: on a lattice, the ring of eight and two more.
const NUM_TRIED: usize = 10;
/// Place of a visit that is not on this tour.
const ELSEWHERE: u32 = u32::MAX;
/// Visits looked at, and moves made, between two looks at the clock.
const VISITS_PER_LOOK: usize = 32;
/// What a move must gain, relative to the sum of all legs that come and go. Rounding makes the difference of such sums wrong by
/// three to five units in the last place of the sum, 1e-15 of it: what gains more makes the tour shorter in truth, so that no
/// moves can undo each other, and the last one comes after finitely many. A tolerance that follows the short legs alone does not
/// bound that: the error comes from the long ones.
const MIN_GAIN: f64 = 1e-12;

/// Room for the places of the nodes of one tour at a time: made once, because it is as large as the farm.
pub(crate) struct Room {
    /// Place of every node on the tour, or [`ELSEWHERE`].
    position: Vec<u32>,
    is_queued: Vec<bool>,
}

impl Room {
    pub fn new(network: &Network) -> Self {
        let num_nodes = network.points.len();
        Self { position: vec![ELSEWHERE; num_nodes], is_queued: vec![false; num_nodes] }
    }
}

struct Tour<'a> {
    network: &'a Network,
    order: &'a mut [u32],
    position: &'a mut [u32],
    queue: Vec<u32>,
    is_queued: &'a mut [bool],
}

/// Improves each route on its own by 2-opt and Or-opt, and stops between two moves when the time is over.
pub(crate) fn improve_routes(network: &Network, budget: &Budget<'_>, routes: &mut [Vec<u32>]) {
    let mut room = Room::new(network);
    for visits in routes {
        let queue = visits.iter().rev().copied().collect();
        improve_route(network, budget, visits, queue, &mut room);
    }
}

/// Improves one route, from the visits of it that are in `queue`. Returns whether it did anything.
pub(crate) fn improve_route(
    network: &Network,
    budget: &Budget<'_>,
    visits: &mut Vec<u32>,
    queue: Vec<u32>,
    room: &mut Room,
) -> bool {
    let depot = network.num_visits as u32;
    visits.push(depot);
    let has_moved = improve_tour(network, budget, visits, queue, room);
    let place = visits.iter().position(|&node| node == depot).unwrap_or(0);
    visits.rotate_left(place);
    visits.remove(0);
    has_moved
}

/// Improves `order`, visits and one depot copy as a closed tour, until no 2-opt or Or-opt move among near neighbours shortens
/// it or the time is over. Looks at `queue` first, the last of it first, and else only at what its moves touch: all visits that
/// such a move might begin at. Returns whether it did anything.
fn improve_tour(network: &Network, budget: &Budget<'_>, order: &mut [u32], queue: Vec<u32>, room: &mut Room) -> bool {
    if order.len() < 5 || budget.is_time_over() {
        return false;
    }
    for (place, &node) in order.iter().enumerate() {
        room.position[node as usize] = place as u32;
    }
    for &visit in &queue {
        room.is_queued[visit as usize] = true;
    }
    let mut tour = Tour { network, order, position: &mut room.position, queue, is_queued: &mut room.is_queued };
    let (mut num_looked_at, mut has_moved) = (0usize, false);
    while let Some(visit) = tour.queue.pop() {
        tour.is_queued[visit as usize] = false;
        let mut is_over = false;
        loop {
            num_looked_at += 1;
            is_over |= num_looked_at.is_multiple_of(VISITS_PER_LOOK) && budget.is_time_over();
            if is_over || !(tour.two_opt(visit) || tour.or_opt(visit)) {
                break;
            }
            has_moved = true;
        }
        if is_over {
            break;
        }
    }
    for &node in tour.order.iter() {
        tour.position[node as usize] = ELSEWHERE;
        tour.is_queued[node as usize] = false;
    }
    has_moved
}

impl Tour<'_> {
    fn next(&self, visit: u32) -> u32 {
        let place = self.position[visit as usize] as usize + 1;
        self.order[if place == self.order.len() { 0 } else { place }]
    }

    fn previous(&self, visit: u32) -> u32 {
        let place = self.position[visit as usize] as usize;
        self.order[if place == 0 { self.order.len() - 1 } else { place - 1 }]
    }

    fn push(&mut self, nodes: &[u32]) {
        for &visit in nodes {
            if (visit as usize) < self.network.num_visits && !self.is_queued[visit as usize] {
                self.is_queued[visit as usize] = true;
                self.queue.push(visit);
            }
        }
    }

    /// a-b, c-d become a-c, b-d, on either side of `a`.
    fn two_opt(&mut self, a: u32) -> bool {
        let network = self.network;
        for forward in [true, false] {
            let b = if forward { self.next(a) } else { self.previous(a) };
            let leg_ab = network.leg(a, b);
            for neighbour in network.neighbours(a).iter().take(NUM_TRIED) {
                if neighbour.leg >= leg_ab {
                    break;
                }
                let c = neighbour.node;
                if self.position[c as usize] == ELSEWHERE {
                    continue;
                }
                let d = if forward { self.next(c) } else { self.previous(c) };
                let (removed, added) = (leg_ab + network.leg(c, d), neighbour.leg + network.leg(b, d));
                if removed - added > MIN_GAIN * (removed + added) {
                    if forward {
                        self.reverse(b, c)
                    } else {
                        self.reverse(c, b)
                    };
                    self.push(&[a, b, c, d]);
                    return true;
                }
            }
        }
        false
    }

    /// The one to three visits from `a` on (either way) move between a near neighbour and one of its neighbours on the tour.
    fn or_opt(&mut self, a: u32) -> bool {
        let network = self.network;
        let size = self.order.len();
        for forward in [true, false] {
            let step = |tour: &Self, visit| if forward { tour.next(visit) } else { tour.previous(visit) };
            let before = if forward { self.previous(a) } else { self.next(a) };
            let leg_before = network.leg(before, a);
            let mut end = a;
            for length in 1..=3usize.min(size - 3) {
                if length > 1 {
                    end = step(self, end);
                }
                let after = step(self, end);
                let (opened, closing) = (leg_before + network.leg(end, after), network.leg(before, after));
                let removed = opened - closing;
                for neighbour in network.neighbours(a).iter().take(NUM_TRIED) {
                    if neighbour.leg >= removed {
                        break;
                    }
                    let c = neighbour.node;
                    if self.position[c as usize] == ELSEWHERE || self.is_within(c, a, length, forward) {
                        continue;
                    }
                    // `a` lands beside `c`, `end` beside the neighbour of `c` on the other side.
                    for d in [self.next(c), self.previous(c)] {
                        if self.is_within(d, a, length, forward) {
                            continue;
                        }
                        let (inserted, replaced) = (neighbour.leg + network.leg(end, d), network.leg(c, d));
                        let gain = removed - (inserted - replaced);
                        if gain > MIN_GAIN * (opened + closing + inserted + replaced) {
                            self.move_segment(a, end, length, forward, c, d);
                            self.push(&[before, after, a, end, c, d]);
                            return true;
                        }
                    }
                }
            }
        }
        false
    }

    /// Whether `visit` is one of the `length` visits from `a` on.
    fn is_within(&self, visit: u32, a: u32, length: usize, forward: bool) -> bool {
        let size = self.order.len();
        let (from, place) = (self.position[a as usize] as usize, self.position[visit as usize] as usize);
        let offset = if forward { (place + size - from) % size } else { (from + size - place) % size };
        offset < length
    }

    /// Moves the segment a..end between the adjacent `c` and `d`, `a` beside `c`: as three reversals at most.
    fn move_segment(&mut self, a: u32, end: u32, length: usize, forward: bool, c: u32, d: u32) {
        let size = self.order.len();
        let (first, last) = if forward { (a, end) } else { (end, a) };
        // Shift everything between the segment and its new place by `length`, along the shorter way round.
        let start = self.position[first as usize] as usize;
        let (c_place, d_place) = (self.position[c as usize] as usize, self.position[d as usize] as usize);
        let c_is_left = (c_place + 1) % size == d_place;
        let left = if c_is_left { c_place } else { d_place };
        let segment: [u32; 3] = std::array::from_fn(|offset| self.order[(start + offset.min(length - 1)) % size]);
        debug_assert_eq!(segment[length - 1], last);
        // Visits between the segment's end and `left`, going up; or between `left` and the segment's start.
        let up = (left + size - (start + length - 1) % size) % size;
        let down = (start + size - left - 1) % size;
        let first_free = if up <= down {
            for offset in 0..up {
                let visit = self.order[(start + length + offset) % size];
                self.put((start + offset) % size, visit);
            }
            (start + up) % size
        } else {
            for offset in 1..=down {
                let visit = self.order[(start + size - offset) % size];
                self.put((start + length + size - offset) % size, visit);
            }
            (left + 1) % size
        };
        // `a` must end beside `c`.
        let keeps_direction = (segment[0] == a) == c_is_left;
        for offset in 0..length {
            let visit = if keeps_direction { segment[offset] } else { segment[length - 1 - offset] };
            self.put((first_free + offset) % size, visit);
        }
    }

    fn put(&mut self, place: usize, visit: u32) {
        self.order[place] = visit;
        self.position[visit as usize] = place as u32;
    }

    /// Reverses the path first..last, or what lies outside it if that is shorter: the same cyclic tour.
    fn reverse(&mut self, first: u32, last: u32) {
        let size = self.order.len();
        let (mut low, mut high) = (self.position[first as usize] as usize, self.position[last as usize] as usize);
        let mut inside = (high + size - low) % size + 1;
        if 2 * inside > size {
            (low, high) = ((high + 1) % size, (low + size - 1) % size);
            inside = size - inside;
        }
        for _ in 0..inside / 2 {
            let (one, other) = (self.order[low], self.order[high]);
            self.put(low, other);
            self.put(high, one);
            low = if low + 1 == size { 0 } else { low + 1 };
            high = if high == 0 { size - 1 } else { high - 1 };
        }
    }
}
