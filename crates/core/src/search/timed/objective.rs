//! What is minimised: when the last drone lands, and a little what all of them fly; or only what they fly.

use super::network::Network;
use super::state::State;
use crate::search::options::Goal;

/// Weight of what the mean drone flies beside the last landing: without it, shortening any other route would not count.
const MEAN_WEIGHT: f64 = 0.02;

/// What a plan costs, in seconds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Objective {
    /// Whether it counts when the last drone lands.
    pub is_longest: bool,
    travel_weight: f64,
    turnaround: f64,
    /// No drone should land later, if that counts.
    pub target: f64,
    /// No drone may land later.
    pub cap: f64,
    /// What a visit of priority 1 costs that is not made: more than any plan.
    absent_cost: f64,
}

impl Objective {
    pub fn new(network: &Network<'_>, goal: Goal) -> Self {
        let is_longest = goal == Goal::Max;
        let visits = 0..network.num_visits as u32;
        let alone = |visit| {
            let both_ways = network.duration(network.depot(), visit) + network.duration(visit, network.depot());
            network.ends[0].out_duration + both_ways + network.ends[0].home_duration
        };
        let latest = |visit| {
            let begins = network.windows(visit).iter().map(|window| window.earliest);
            begins.fold(network.release(visit), f64::max)
        };
        let together: f64 =
            visits.clone().map(|visit| alone(visit) + network.service_duration(visit) + network.turnaround()).sum();
        let last_begin = visits.map(latest).fold(network.round.fleet().first_takeoff(network.ends.len()), f64::max);
        Self {
            is_longest,
            travel_weight: if is_longest { MEAN_WEIGHT / network.ends.len() as f64 } else { 1.0 },
            turnaround: if is_longest { network.turnaround() } else { 0.0 },
            target: f64::INFINITY,
            cap: f64::INFINITY,
            absent_cost: 2.0 * (together + last_begin).max(f64::MIN_POSITIVE),
        }
    }

    /// Only what is flown, while no drone may land later than in this plan.
    pub fn total_within(self, longest: f64) -> Self {
        Self { is_longest: false, travel_weight: 1.0, cap: longest * (1.0 + ROUNDING), ..self }
    }

    /// What a plan costs; infinite if a drone lands too late.
    pub fn value(&self, network: &Network<'_>, state: &State) -> f64 {
        let absent: f64 = state.bank.iter().map(|&visit| network.priority(visit)).sum();
        self.landing(network, state) + self.travel_weight * self.flown(state) + self.absent_cost * absent
    }

    /// By what plans are compared in the end: the priorities of what they leave out, the last landing, if that counts, and what is
    /// flown. The value, which guides the search, would take a later landing for less flying.
    pub fn rank(&self, network: &Network<'_>, state: &State) -> Rank {
        let absent = state.bank.iter().map(|&visit| network.priority(visit)).sum();
        Rank { absent, longest: self.landing(network, state), flown: self.flown(state) }
    }

    /// The last landing, if it counts; infinite if it is too late, also for a drone that waited for its place at the depot.
    fn landing(&self, network: &Network<'_>, state: &State) -> f64 {
        if !self.is_longest && self.cap.is_infinite() && !network.has_queue() {
            return 0.0;
        }
        let longest = last_landing(network, state);
        if longest > self.cap {
            f64::INFINITY
        } else if self.is_longest || longest.is_infinite() {
            longest
        } else {
            0.0
        }
    }

    /// A lower bound of the value of every plan that has the trips of this one, and more visits.
    pub fn least(&self, state: &State) -> f64 {
        let longest = if self.is_longest { state.longest() } else { 0.0 };
        longest + self.travel_weight * self.flown(state)
    }

    /// What the stay at the depot before one more trip costs.
    pub fn turnaround_cost(&self, turnaround: f64) -> f64 {
        if self.turnaround > 0.0 { turnaround } else { 0.0 }
    }

    fn flown(&self, state: &State) -> f64 {
        state.travel + self.turnaround * state.num_trips() as f64
    }
}

/// How good a plan is: less is better, the fields in falling order of importance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rank {
    absent: f64,
    pub longest: f64,
    flown: f64,
}

/// By how much sums of the same times differ at most, after many changes.
const ROUNDING: f64 = 1e-9;

impl Rank {
    /// Whether this is better than `other`, and not only by rounding.
    pub fn is_better(&self, other: &Self) -> bool {
        for (one, other) in [(self.absent, other.absent), (self.longest, other.longest)] {
            if (one - other).abs() > ROUNDING * other {
                return one < other;
            }
        }
        self.flown < other.flown * (1.0 - ROUNDING)
    }
}

/// When the last drone has landed for good, if drones that land wait for a place where they are turned round; infinite if one is
/// too late then for what follows.
pub(super) fn last_landing(network: &Network<'_>, state: &State) -> f64 {
    if !network.has_queue() {
        return state.longest();
    }
    let fleet = network.round.fleet();
    let mut pads_free = vec![f64::NEG_INFINITY; fleet.num_pads];
    let first = |(drone, route): (usize, &super::state::Route)| {
        let trip = &state.trips[*route.trips.first()? as usize];
        Some((trip.whole.end(fleet.first_takeoff(drone)).unwrap_or(f64::INFINITY), drone, 0))
    };
    // Landing, drone, and number of the trip that lands.
    let mut landings: Vec<(f64, usize, usize)> = state.routes.iter().enumerate().filter_map(first).collect();
    let mut longest = 0.0_f64;
    let earlier =
        |one: &(f64, usize, usize), other: &(f64, usize, usize)| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1));
    while let Some(index) = (0..landings.len()).min_by(|&one, &other| earlier(&landings[one], &landings[other])) {
        let (landing, drone, number) = landings[index];
        let trips = &state.routes[drone].trips;
        if number + 1 < trips.len() && landing.is_finite() {
            let by_time = |one: &&mut f64, other: &&mut f64| one.total_cmp(other);
            let Some(pad) = pads_free.iter_mut().min_by(by_time) else { break };
            *pad = landing.max(*pad) + network.turnaround();
            let next = state.trips[trips[number + 1] as usize].whole.end(*pad);
            landings[index] = (next.unwrap_or(f64::INFINITY), drone, number + 1);
        } else {
            longest = longest.max(landing);
            landings.swap_remove(index);
        }
    }
    if longest > network.round.fleet().shift.latest + super::segment::ROUNDING { f64::INFINITY } else { longest }
}
