//! Puts the visits of the bank back, each where it adds the least length.
//!
//! Source: Christiaens and Vanden Berghe 2020, section 5.2, with the orders of its section 6.4 for time windows. Changed: places
//! are tried beside near neighbours, at both ends of some trips, and as a trip of its own; one in a hundred is passed over,
//! decided for a place and a step. O(visits of the bank x (neighbours + trips)).

use super::network::Network;
use super::segment::{ROUNDING, Segment};
use super::state::{ABSENT, OutOfTime, Place, Route, State, Touched};
use crate::random::Random;

/// Share of places that are passed over, of 2⁶⁴.
const PLACE_BLINK: u64 = u64::MAX / 100;
/// Trips of which both ends are tried, besides those that are near; a random run of them.
const MAX_ENDS: usize = 12;
/// Visits of the bank that are tried in one step besides those just taken out; a random run of them.
const MAX_BANK: usize = 20;

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
    pub fn insert(
        &mut self,
        network: &Network<'_>,
        state: &mut State,
        num_new: usize,
        random: &mut Random,
        touched: &mut Touched,
    ) -> Result<(), OutOfTime> {
        self.order(network, state, num_new, random);
        for index in 0..self.queue.len() {
            let visit = self.queue[index].1;
            let mut best = Cheapest { network, state, visit, salt: random.bits(), price: f64::INFINITY, target: None };
            best.look(random);
            match best.target {
                Some(Target::In(place)) => state.put_in(network, visit, place, touched)?,
                Some(Target::New(window, route, index)) => {
                    state.open(network, visit, window, (route, index), touched)?;
                }
                None => {}
            }
        }
        Ok(())
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
                Order::Far => -network.leg(depot, visit),
                Order::Near => network.leg(depot, visit),
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
    visit: u32,
    salt: u64,
    price: f64,
    target: Option<Target>,
}

impl Cheapest<'_> {
    fn look(&mut self, random: &mut Random) {
        for &neighbour in self.network.neighbours(self.visit) {
            let Place { trip, index, .. } = self.state.places[neighbour as usize];
            if trip != ABSENT {
                self.consider(trip, index);
                self.consider(trip, index + 1);
            }
        }
        let num_slots = self.state.trips.len();
        if num_slots > 0 {
            let begin = random.below(num_slots);
            for offset in 0..num_slots.min(MAX_ENDS) {
                let trip = (begin + offset) % num_slots;
                let size = self.state.trips[trip].visits.len() as u32;
                if size > 0 {
                    self.consider(trip as u32, 0);
                    self.consider(trip as u32, size);
                }
            }
        }
        self.consider_new_trips();
    }

    fn passes_over(&self, trip: u32, index: u32) -> bool {
        let place = (u64::from(trip) << 32) | u64::from(index);
        (self.salt ^ place).wrapping_mul(0x9e37_79b9_7f4a_7c15) < PLACE_BLINK
    }

    /// The place before the visit that is at `index` of a trip, or behind its last.
    fn consider(&mut self, trip: u32, index: u32) {
        let Self { network, state, visit, .. } = *self;
        let slot = &state.trips[trip as usize];
        let (at, depot) = (index as usize, network.depot());
        let previous = if at == 0 { depot } else { slot.visits[at - 1] };
        let next = slot.visits.get(at).copied().unwrap_or(depot);
        let (leg_in, leg_out) = (network.leg(previous, visit), network.leg(visit, next));
        let added = leg_in + leg_out - network.leg(previous, next);
        if added >= self.price || slot.load + network.load(visit) > network.round.fleet().capacity {
            return;
        }
        let before = if at == 0 { Segment::NOTHING } else { slot.before[at - 1] };
        let behind = slot.behind.get(at).copied().unwrap_or(Segment::NOTHING);
        let route = &state.routes[slot.route as usize];
        let Some(number) = route.trips.iter().position(|&other| other == trip) else { return };
        let release = slot.release.max(network.release(visit));
        for window in 0..network.windows(visit).len() as u8 {
            let own = network.segment(visit, window);
            let whole = before
                .join(leg_in, own)
                .and_then(|head| head.join(leg_out, behind))
                .and_then(|whole| whole.not_before(release));
            if self.is_in_time(whole, route.ready[number], route.after[number]) && !self.passes_over(trip, index) {
                self.price = added;
                self.target = Some(Target::In(Place { trip, index, window }));
                return;
            }
        }
    }

    /// Whether a trip keeps its longest time, and what follows it its times.
    fn is_in_time(&self, whole: Option<Segment>, ready: f64, after: Segment) -> bool {
        let max_duration = self.network.round.fleet().max_trip_duration;
        whole
            .filter(|whole| whole.duration <= max_duration + ROUNDING)
            .and_then(|whole| whole.end(ready))
            .is_some_and(|end| after.end(end).is_some())
    }

    /// Trips of its own: before, between and behind those of each drone, or as the first of one that does not fly yet.
    fn consider_new_trips(&mut self) {
        let Self { network, state, visit, .. } = *self;
        let depot = network.depot();
        let (leg_out, leg_home) = (network.leg(depot, visit), network.leg(visit, depot));
        let added = leg_out + leg_home;
        if added >= self.price {
            return;
        }
        let fleet = network.round.fleet();
        let mut is_unused_tried = false;
        for (index, route) in state.routes.iter().enumerate() {
            let has_room = route.trips.is_empty() || fleet.turnaround.is_some();
            if !has_room || (route.trips.is_empty() && is_unused_tried) {
                continue;
            }
            is_unused_tried |= route.trips.is_empty();
            for number in 0..=route.trips.len() {
                if let Some(window) = self.window_of_trip(route, number, leg_out, leg_home) {
                    self.price = added;
                    self.target = Some(Target::New(window, index as u32, number));
                    return;
                }
            }
        }
    }

    /// The first window in which a trip of this visit alone can be flown as number `number` of a route.
    fn window_of_trip(&self, route: &Route, number: usize, leg_out: f64, leg_home: f64) -> Option<u8> {
        let Self { network, state, visit, .. } = *self;
        let after = match route.trips.get(number) {
            Some(&next) => state.followed_by(network, next, route.after[number])?,
            None => network.end_of_shift(),
        };
        (0..network.windows(visit).len() as u8).find(|&window| {
            let trip = Segment::NOTHING
                .join(leg_out, network.segment(visit, window))
                .and_then(|head| head.join(leg_home, Segment::NOTHING))
                .and_then(|whole| whole.not_before(network.release(visit)));
            self.is_in_time(trip, route.ready[number], after)
        })
    }
}
