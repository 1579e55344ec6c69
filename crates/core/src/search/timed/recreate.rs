//! Puts the visits of the bank back, each where it costs least.
//!
//! Source: Christiaens and Vanden Berghe 2020, section 5.2, with the orders of its section 6.4 for time windows. Changed: places
//! are tried beside near neighbours, at both ends of some trips, and as a trip of its own; one in a hundred is passed over,
//! decided for a place and a step. Where it counts when the last drone lands, a place also costs by how much more than its own
//! time it delays its drone, and tenfold or a thousandfold what it delays it beyond the best known plan, as the lot falls. A
//! step ends as soon as it is sure to be rejected. O(visits of the bank x (neighbours + trips)).

use super::network::{Neighbour, Network};
use super::objective::Objective;
use super::segment::Segment;
use super::state::{ABSENT, OverLimit, Place, Route, State, Touched, is_flyable};
use crate::random::Random;

/// Share of places that are passed over, of 2⁶⁴.
const PLACE_BLINK: u64 = u64::MAX / 100;
/// Trips of which both ends are tried, besides those that are near, where visits have windows and where they have none; a random
/// run of them.
const MAX_TIMED_ENDS: usize = 12;
const MAX_ENDS: usize = 5;
/// Visits of the bank that are tried in one step besides those just taken out; a random run of them.
const MAX_BANK: usize = 8;
/// What a second beyond the target costs, beside the added time: the one or the other for every insertion.
const OVERFLOW_PRICES: [f64; 2] = [1000.0, 10.0];

/// By what the bank is ordered, with how often.
const ORDERS: [(Order, usize); 7] = [
    (Order::Random, 4),
    (Order::Load, 4),
    (Order::Far, 2),
    (Order::Near, 1),
    (Order::Narrow, 2),
    (Order::Early, 2),
    (Order::Late, 2),
];

#[derive(Clone, Copy, Debug)]
enum Order {
    Random,
    /// The largest loads first.
    Load,
    /// Those far from the depot first.
    Far,
    Near,
    /// Those with the narrowest windows first.
    Narrow,
    /// Those whose windows begin first.
    Early,
    /// Those whose windows end last.
    Late,
}

/// Where a visit would go.
#[derive(Clone, Copy, Debug)]
enum Target {
    In(Place),
    /// A trip of its own: window, route, number of the trip in the route.
    New(u8, u32, usize),
}

/// Buffers that live as long as the search.
#[derive(Debug, Default)]
pub(super) struct Recreate {
    queue: Vec<(f64, u32)>,
}

impl Recreate {
    /// Puts back the last `num_new` visits of the bank, and some of the others, where they have a place; the rest stays there.
    /// Returns false, with some still in the bank, once the plan is sure to cost more than `threshold`.
    #[allow(clippy::too_many_arguments)]
    pub fn insert(
        &mut self,
        network: &Network<'_>,
        state: &mut State,
        num_new: usize,
        objective: &Objective,
        threshold: f64,
        random: &mut Random,
        touched: &mut Touched,
    ) -> Result<bool, OverLimit> {
        self.order(network, state, num_new, random);
        for index in 0..self.queue.len() {
            let visit = self.queue[index].1;
            let salt = random.bits();
            let overflow_price = OVERFLOW_PRICES[(salt >> 63) as usize];
            let mut best =
                Cheapest { network, state, objective, visit, salt, overflow_price, price: f64::INFINITY, target: None };
            best.look(random);
            match best.target {
                Some(Target::In(place)) => state.put_in(network, visit, place, touched)?,
                Some(Target::New(window, route, index)) => {
                    state.open(network, visit, window, (route, index), touched)?;
                }
                None => {}
            }
            if objective.least(state) > threshold {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn order(&mut self, network: &Network<'_>, state: &State, num_new: usize, random: &mut Random) {
        let mut draw = random.below(ORDERS.iter().map(|&(_, weight)| weight).sum());
        let mut order = Order::Random;
        for (other, weight) in ORDERS {
            if draw < weight {
                order = other;
                break;
            }
            draw -= weight;
        }
        let (old, new) = state.bank.split_at(state.bank.len() - num_new);
        let first = if old.len() > MAX_BANK { random.below(old.len() - MAX_BANK + 1) } else { 0 };
        let tried = old[first..].iter().take(MAX_BANK).chain(new);
        self.queue.clear();
        for &visit in tried {
            let windows = network.windows(visit);
            let depot = network.depot();
            let key = match order {
                Order::Random => random.uniform(),
                Order::Load => -network.load(visit),
                Order::Far => -network.duration(depot, visit),
                Order::Near => network.duration(depot, visit),
                Order::Narrow => windows.iter().map(|window| window.latest - window.earliest).sum(),
                Order::Early => windows[0].earliest,
                Order::Late => -windows[windows.len() - 1].latest,
            };
            self.queue.push((key, visit));
        }
        self.queue.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
    }
}

/// The cheapest place so far.
struct Cheapest<'a> {
    network: &'a Network<'a>,
    state: &'a State,
    objective: &'a Objective,
    visit: u32,
    salt: u64,
    overflow_price: f64,
    price: f64,
    target: Option<Target>,
}

impl Cheapest<'_> {
    fn look(&mut self, random: &mut Random) {
        let is_timed = self.network.is_timed(self.visit);
        for &Neighbour { visit: neighbour, leg_to, leg_from } in self.network.neighbours(self.visit) {
            let Place { trip, index, .. } = self.state.places[neighbour as usize];
            if trip == ABSENT {
                continue;
            }
            let legs = &self.state.trips[trip as usize].legs;
            let (leg_before, leg_after) = (legs[index as usize], legs[index as usize + 1]);
            // A place whose other end is nearer was tried from there, so the other leg is about as long; in time nearer ends may
            // be no neighbours.
            let is_pruned = !is_timed
                && 2.0 * leg_to.min(leg_from) - if leg_before > leg_after { leg_before } else { leg_after }
                    >= self.price;
            if !is_pruned {
                self.consider(trip, index, None, Some(leg_to));
                self.consider(trip, index + 1, Some(leg_from), None);
            }
        }
        let num_slots = self.state.trips.len();
        if num_slots > 0 {
            let begin = random.below(num_slots);
            for offset in 0..num_slots.min(if is_timed { MAX_TIMED_ENDS } else { MAX_ENDS }) {
                let trip = (begin + offset) % num_slots;
                let size = self.state.trips[trip].visits.len() as u32;
                if size > 0 {
                    self.consider(trip as u32, 0, None, None);
                    self.consider(trip as u32, size, None, None);
                }
            }
        }
        self.consider_new_trips();
    }

    fn passes_over(&self, trip: u32, index: u32) -> bool {
        let place = (u64::from(trip) << 32) | u64::from(index);
        (self.salt ^ place).wrapping_mul(0x9e37_79b9_7f4a_7c15) < PLACE_BLINK
    }

    /// The place before the visit that is at `index` of a trip, or behind its last; the legs are told where they are known.
    fn consider(&mut self, trip: u32, index: u32, leg_in: Option<f64>, leg_out: Option<f64>) {
        let Self { network, state, visit, .. } = *self;
        let slot = &state.trips[trip as usize];
        let (at, depot) = (index as usize, network.depot());
        let previous = if at == 0 { depot } else { slot.visits[at - 1] };
        let next = slot.visits.get(at).copied().unwrap_or(depot);
        let least_in = leg_in.unwrap_or_else(|| network.least_duration(previous, visit));
        let least_out = leg_out.unwrap_or_else(|| network.least_duration(visit, next));
        if least_in + least_out - slot.legs[at] >= self.price {
            return;
        }
        let leg_in = leg_in.unwrap_or_else(|| network.duration(previous, visit));
        let leg_out = leg_out.unwrap_or_else(|| network.duration(visit, next));
        let added = leg_in + leg_out - slot.legs[at];
        if added >= self.price || slot.load + network.load(visit) > network.round.fleet().capacity {
            return;
        }
        let busy = slot.busy + added + network.service_duration(visit);
        let route = &state.routes[slot.route as usize];
        let (ready, after) = (route.ready[slot.number as usize], route.after[slot.number as usize]);
        let release = slot.release.max(network.release(visit));
        let is_timed = slot.num_timed > 0 || network.is_timed(visit);
        for window in self.windows_in_turn() {
            let whole = if is_timed {
                let ends = network.ends[slot.route as usize];
                let (before, behind) = slot.parts(at, ends.out_duration, ends.home_duration);
                let head = before.join(leg_in, network.segment(visit, window));
                head.and_then(|head| head.join(leg_out, behind))
            } else {
                Some(Segment::lasting(busy))
            };
            let Some(whole) = whole.and_then(|whole| whole.not_before(release)) else { continue };
            let Some(finish) = self.finish(whole, ready, after) else { continue };
            let price = added + self.delay_price(finish, route.finish, busy - slot.busy);
            if price < self.price
                && !self.passes_over(trip, index)
                && self.is_within_limits(trip, previous, next, whole, busy)
            {
                self.price = price;
                self.target = Some(Target::In(Place { trip, index, window }));
                if !self.objective.is_longest {
                    return;
                }
            }
        }
    }

    /// The windows of the visit, from a random one on: the first that fits may be in the way of others.
    fn windows_in_turn(&self) -> impl Iterator<Item = u8> + use<> {
        let num_windows = self.network.windows(self.visit).len() as u64;
        let first = if num_windows > 1 { self.salt % num_windows } else { 0 };
        (0..num_windows).map(move |window| ((first + window) % num_windows) as u8)
    }

    /// Whether a trip with the visit between two others, and with these times, is within the limits of a trip.
    #[inline]
    fn is_within_limits(&self, trip: u32, previous: u32, next: u32, whole: Segment, busy: f64) -> bool {
        let Self { network, visit, .. } = *self;
        let slot = &self.state.trips[trip as usize];
        let vehicle_type = &network.round.fleet().vehicle_type;
        if network.has_length {
            let added = network.length(previous, visit) + network.length(visit, next) - network.length(previous, next);
            if slot.length + added > vehicle_type.max_length {
                return false;
            }
        }
        let mut energy = 0.0;
        if network.has_energy {
            let legs = network.energy(previous, visit) + network.energy(visit, next) - network.energy(previous, next);
            energy = slot.energy + legs + network.service_energy(visit);
        }
        is_flyable(network, whole, busy, energy)
    }

    /// When the drone lands for good after a trip of these times and what follows it; `None` if something is too late.
    #[inline]
    fn finish(&self, whole: Segment, ready: f64, after: Segment) -> Option<f64> {
        whole.end(ready).and_then(|end| after.end(end)).filter(|&finish| finish <= self.objective.cap)
    }

    /// What it costs that a drone lands later for good, beyond the time that the visit itself takes.
    #[inline]
    fn delay_price(&self, finish: f64, old_finish: f64, own: f64) -> f64 {
        if !self.objective.is_longest {
            return 0.0;
        }
        let delay = (finish - old_finish - own).max(0.0);
        let overflow = (finish - self.objective.target.max(old_finish)).max(0.0);
        delay + self.overflow_price * overflow
    }

    /// Trips of its own: before, between and behind those of each drone, or as the first of one that does not fly yet.
    fn consider_new_trips(&mut self) {
        let Self { network, state, visit, .. } = *self;
        let depot = network.depot();
        let (leg_out, leg_home) = (network.duration(depot, visit), network.duration(visit, depot));
        let fleet = network.round.fleet();
        if leg_out + leg_home >= self.price
            || (network.has_length
                && network.length(depot, visit) + network.length(visit, depot) > fleet.vehicle_type.max_length)
        {
            return;
        }
        // Drones that do not fly yet differ by their layers alone; those that take off first come first.
        let mut tried = None;
        for (index, route) in state.routes.iter().enumerate() {
            let is_unused = route.trips.is_empty();
            if !(is_unused || fleet.turnaround.is_some()) || (is_unused && tried == Some(network.ends[index])) {
                continue;
            }
            if is_unused {
                tried = Some(network.ends[index]);
            }
            // Where nothing has its time, trips may as well follow each other in any order.
            let first = if network.has_windows { 0 } else { route.trips.len() };
            for number in first..=route.trips.len() {
                self.consider_new_trip(route, index, number, leg_out, leg_home);
                // A trip of its own costs the same whenever it is flown, and whoever flies it.
                let is_found = matches!(self.target, Some(Target::New(..)));
                if is_found && !self.objective.is_longest && network.are_ends_alike {
                    return;
                }
            }
        }
    }

    /// The windows in which a trip of this visit alone can be flown as number `number` of a route.
    fn consider_new_trip(&mut self, route: &Route, index: usize, number: usize, leg_out: f64, leg_home: f64) {
        let Self { network, state, visit, .. } = *self;
        let ends = network.ends[index];
        let legs = ends.out_duration + leg_out + leg_home + ends.home_duration;
        let turnaround = if route.trips.is_empty() { 0.0 } else { network.turnaround() };
        let (service, depot) = (network.service_duration(visit), network.depot());
        let own = legs + self.objective.turnaround_cost(turnaround);
        if own >= self.price {
            return;
        }
        let mut energy = 0.0;
        if network.has_energy {
            energy = ends.energy
                + network.energy(depot, visit)
                + network.service_energy(visit)
                + network.energy(visit, depot);
        }
        let after = match route.trips.get(number) {
            Some(&next) => state.followed_by(network, next, route.after[number]),
            None => Some(network.end_of_shift()),
        };
        let Some(after) = after else { return };
        for window in self.windows_in_turn() {
            let whole = Segment::lasting(ends.out_duration)
                .join(leg_out, network.segment(visit, window))
                .and_then(|head| head.join(leg_home, Segment::lasting(ends.home_duration)))
                .and_then(|whole| whole.not_before(network.release(visit)));
            let Some(whole) = whole else { continue };
            let Some(finish) = self.finish(whole, route.ready[number], after) else { continue };
            let price = own + self.delay_price(finish, route.finish, legs + service + turnaround);
            if price < self.price && is_flyable(network, whole, legs + service, energy) {
                self.price = price;
                self.target = Some(Target::New(window, index as u32, number));
            }
        }
    }
}
