//! A plan under change: routes of trips, each a list of visits with the times of what lies before and behind each of them.
//!
//! A trip is a handful of sums, which a visit changes by two legs. Where some visit of it has windows it also keeps the segment
//! of every beginning and of every end, so that a visit between any two others is priced by two joins. A route keeps when its
//! drone is ready for each trip and what follows each landing, so that a trip that ends later is known to leave the others in
//! time without looking at them. O(length of the trip + trips of the route) for a change.

use super::network::Network;
use super::segment::{ROUNDING, Segment};

/// Where a visit is that no trip makes.
pub(super) const ABSENT: u32 = u32::MAX;

/// A trip, or an empty slot for one.
#[derive(Clone, Debug, Default)]
pub(super) struct Trip {
    pub visits: Vec<u32>,
    /// Seconds of the leg to each visit, and of the way home.
    pub legs: Vec<f64>,
    /// Joules of these; empty where nothing limits them.
    pub leg_energies: Vec<f64>,
    /// Seconds from take-off to the end of the service of each visit, without waits.
    pub clocks: Vec<f64>,
    /// From take-off to the end of the service of each visit; empty where no visit has windows.
    pub before: Vec<Segment>,
    /// From the beginning of the service of each visit to the landing; likewise.
    pub behind: Vec<Segment>,
    pub route: u32,
    /// Which trip of its route it is.
    pub number: u32,
    pub num_timed: u32,
    pub load: f64,
    /// No earlier take-off, by the releases of its visits.
    pub release: f64,
    /// Seconds of its legs, take-off and landing.
    pub travel: f64,
    /// The same and its services.
    pub busy: f64,
    /// Joules without waits, of the trip or of one that breaks off at its worst place; 0 where nothing limits them.
    pub energy: f64,
    /// Length; 0 where nothing limits it.
    pub length: f64,
    /// The times of the whole of it.
    pub whole: Segment,
}

impl Trip {
    /// The times of what lies before the visit at `index`, and of what begins with it.
    #[inline]
    pub fn parts(&self, index: usize, out_duration: f64, home_duration: f64) -> (Segment, Segment) {
        if self.num_timed > 0 {
            let before = if index == 0 { Segment::lasting(out_duration) } else { self.before[index - 1] };
            (before, self.behind.get(index).copied().unwrap_or(Segment::lasting(home_duration)))
        } else {
            let clock = if index == 0 { out_duration } else { self.clocks[index - 1] };
            (Segment::lasting(clock), Segment::lasting(self.busy - clock - self.legs[index]))
        }
    }
}

/// The trips of one drone.
#[derive(Clone, Debug, Default)]
pub(super) struct Route {
    pub trips: Vec<u32>,
    /// When the drone is ready for each of them, and for one more.
    pub ready: Vec<f64>,
    /// What follows the landing of each of them.
    pub after: Vec<Segment>,
    /// When it has landed for good; 0 if it does not fly.
    pub finish: f64,
}

/// Where a visit is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub trip: u32,
    pub index: u32,
    /// In which of its windows it is made.
    pub window: u8,
}

/// Trips and routes that a step changed.
#[derive(Debug, Default)]
pub(super) struct Touched {
    pub trips: Vec<u32>,
    pub routes: Vec<u32>,
}

impl Touched {
    pub fn add(&mut self, trip: u32, route: u32) {
        if !self.trips.contains(&trip) {
            self.trips.push(trip);
        }
        if !self.routes.contains(&route) {
            self.routes.push(route);
        }
    }

    /// What either of both names.
    pub fn extend(&mut self, other: &Self) {
        for (own, others) in [(&mut self.trips, &other.trips), (&mut self.routes, &other.routes)] {
            for &index in others {
                if !own.contains(&index) {
                    own.push(index);
                }
            }
        }
    }

    pub fn clear(&mut self) {
        self.trips.clear();
        self.routes.clear();
    }
}

/// A step cannot go on: a trip breaks a limit that it kept before it was shortened, because legs cut to tenths may be longer by a
/// detour, or a place that was priced is late by rounding. The plan is as it was once the step is taken back.
#[derive(Clone, Copy, Debug)]
pub(super) struct OverLimit;

/// A plan under change.
#[derive(Clone, Debug)]
pub(super) struct State {
    pub trips: Vec<Trip>,
    pub routes: Vec<Route>,
    pub places: Vec<Place>,
    /// Visits that no trip makes.
    pub bank: Vec<u32>,
    /// Slots for trips.
    pub free: Vec<u32>,
    /// Seconds of legs, take-offs and landings of all trips.
    pub travel: f64,
}

impl State {
    /// A plan without a trip.
    pub fn new(network: &Network<'_>) -> Self {
        let fleet = network.round.fleet();
        let route = |drone| Route { ready: vec![fleet.first_takeoff(drone)], ..Route::default() };
        Self {
            trips: Vec::new(),
            routes: (0..network.ends.len()).map(route).collect(),
            places: vec![Place { trip: ABSENT, index: 0, window: 0 }; network.num_visits],
            bank: (0..network.num_visits as u32).collect(),
            free: Vec::new(),
            travel: 0.0,
        }
    }

    /// Takes over the trips of a plan, as far as they keep their limits; what does not stays in the bank.
    pub fn adopt(&mut self, network: &Network<'_>, routes: &[Vec<Vec<usize>>]) {
        let mut touched = Touched::default();
        for (route, trips) in routes.iter().enumerate().take(self.routes.len()) {
            for visits in trips {
                let mut own = None;
                for &visit in visits {
                    let visit = visit as u32;
                    for window in 0..network.windows(visit).len() as u8 {
                        if self.places[visit as usize].trip != ABSENT {
                            break;
                        }
                        let made = match own {
                            Some(trip) => {
                                let index = self.trips[trip as usize].visits.len() as u32;
                                self.put_in(network, visit, Place { trip, index, window }, &mut touched)
                            }
                            None => {
                                let number = self.routes[route].trips.len();
                                self.open(network, visit, window, (route as u32, number), &mut touched)
                            }
                        };
                        // A trip that was left without a visit is closed again.
                        own = own.or(Some(self.places[visit as usize].trip)).filter(|&trip| trip != ABSENT);
                        if made.is_err() {
                            return;
                        }
                    }
                }
            }
        }
    }

    /// When the last drone has landed for good.
    pub fn longest(&self) -> f64 {
        self.routes.iter().fold(0.0, |longest, route| if route.finish > longest { route.finish } else { longest })
    }

    pub fn num_trips(&self) -> usize {
        self.trips.len() - self.free.len()
    }

    /// Takes over what `touched` names from a plan that differs nowhere else.
    pub fn copy_touched(&mut self, other: &Self, touched: &Touched) {
        if self.trips.len() < other.trips.len() {
            self.trips.resize(other.trips.len(), Trip::default());
        }
        for &route in &touched.routes {
            self.routes[route as usize].clone_from(&other.routes[route as usize]);
            // Trips that were not changed themselves may have got another number.
            for &trip in &other.routes[route as usize].trips {
                self.trips[trip as usize].number = other.trips[trip as usize].number;
            }
        }
        for &trip in touched.trips.iter().filter(|&&trip| (trip as usize) < other.trips.len()) {
            self.trips[trip as usize].copy(&other.trips[trip as usize]);
            for &visit in &other.trips[trip as usize].visits {
                self.places[visit as usize] = other.places[visit as usize];
            }
        }
        for &visit in &other.bank {
            self.places[visit as usize].trip = ABSENT;
        }
        self.trips.truncate(other.trips.len());
        self.bank.clone_from(&other.bank);
        self.free.clone_from(&other.free);
        self.travel = other.travel;
    }

    /// Takes `visit` out of its trip, whose times are then wrong until [`State::renew_all`].
    pub fn take_out(&mut self, network: &Network<'_>, visit: u32, touched: &mut Touched) {
        let Place { trip, .. } = self.places[visit as usize];
        let slot = &mut self.trips[trip as usize];
        touched.add(trip, slot.route);
        slot.remove(network, visit);
        self.places[visit as usize].trip = ABSENT;
        self.bank.push(visit);
    }

    /// Puts a visit of the bank into a trip, before the visit that is at `index`.
    pub fn put_in(
        &mut self,
        network: &Network<'_>,
        visit: u32,
        place: Place,
        touched: &mut Touched,
    ) -> Result<(), OverLimit> {
        let slot = &mut self.trips[place.trip as usize];
        touched.add(place.trip, slot.route);
        slot.insert(network, place.index as usize, visit);
        self.places[visit as usize] = place;
        self.bank.retain(|&other| other != visit);
        if self.renew_all(network, &[place.trip]).is_err() {
            // A limit that prices do not know of: it stays in the bank.
            self.take_out(network, visit, touched);
            self.renew_all(network, &[place.trip])?;
        }
        Ok(())
    }

    /// Opens a trip with one visit as number `index` of a route.
    pub fn open(
        &mut self,
        network: &Network<'_>,
        visit: u32,
        window: u8,
        (route, index): (u32, usize),
        touched: &mut Touched,
    ) -> Result<(), OverLimit> {
        let trip = self.free.pop().unwrap_or_else(|| {
            self.trips.push(Trip::default());
            self.trips.len() as u32 - 1
        });
        let slot = &mut self.trips[trip as usize];
        slot.route = route;
        slot.empty();
        self.routes[route as usize].trips.insert(index, trip);
        self.put_in(network, visit, Place { trip, index: 0, window }, touched)
    }

    /// Brings trips that were changed, and their routes, up to date; a trip without visits is closed.
    pub fn renew_all(&mut self, network: &Network<'_>, trips: &[u32]) -> Result<(), OverLimit> {
        for &trip in trips {
            self.renew_trip(network, trip)?;
        }
        // A route looks at all its trips, so that none of them may be out of date.
        for &trip in trips {
            self.renew_route(network, self.trips[trip as usize].route)?;
        }
        Ok(())
    }

    pub fn renew_trip(&mut self, network: &Network<'_>, trip: u32) -> Result<(), OverLimit> {
        let slot = &mut self.trips[trip as usize];
        self.travel -= slot.travel;
        if slot.visits.is_empty() {
            slot.travel = 0.0;
            self.routes[slot.route as usize].trips.retain(|&other| other != trip);
            self.free.push(trip);
            return Ok(());
        }
        for (index, &visit) in slot.visits.iter().enumerate() {
            let place = &mut self.places[visit as usize];
            (place.trip, place.index) = (trip, index as u32);
        }
        slot.sum_up(network);
        self.travel += slot.travel;
        slot.find_times(network, &self.places)?;
        if slot.is_within_limits(network) { Ok(()) } else { Err(OverLimit) }
    }

    pub fn renew_route(&mut self, network: &Network<'_>, route: u32) -> Result<(), OverLimit> {
        let mut own = std::mem::take(&mut self.routes[route as usize]);
        let result = self.time_route(network, route, &mut own);
        self.routes[route as usize] = own;
        result
    }

    /// Fills in when a drone is ready for its trips, and what follows each landing.
    fn time_route(&mut self, network: &Network<'_>, route: u32, own: &mut Route) -> Result<(), OverLimit> {
        let mut ready = network.round.fleet().first_takeoff(route as usize);
        own.ready.clear();
        own.ready.push(ready);
        own.finish = 0.0;
        for (number, &trip) in own.trips.iter().enumerate() {
            let slot = &mut self.trips[trip as usize];
            slot.number = number as u32;
            own.finish = slot.whole.end(ready).ok_or(OverLimit)?;
            ready = own.finish + network.turnaround();
            own.ready.push(ready);
        }
        own.after.clear();
        let mut after = network.end_of_shift();
        if own.finish > after.latest + ROUNDING {
            return Err(OverLimit);
        }
        for &trip in own.trips.iter().rev() {
            own.after.push(after);
            after = self.followed_by(network, trip, after).ok_or(OverLimit)?;
        }
        own.after.reverse();
        Ok(())
    }

    /// A stay at the depot, a trip, and what follows its landing.
    pub fn followed_by(&self, network: &Network<'_>, trip: u32, after: Segment) -> Option<Segment> {
        Segment::NOTHING.join(network.turnaround(), self.trips[trip as usize].whole)?.join(0.0, after)
    }
}

impl Trip {
    fn copy(&mut self, other: &Self) {
        let Self { visits, legs, leg_energies, clocks, before, behind, .. } = self;
        let (mut visits, mut legs) = (std::mem::take(visits), std::mem::take(legs));
        let (mut leg_energies, mut clocks) = (std::mem::take(leg_energies), std::mem::take(clocks));
        let (mut before, mut behind) = (std::mem::take(before), std::mem::take(behind));
        visits.clone_from(&other.visits);
        legs.clone_from(&other.legs);
        leg_energies.clone_from(&other.leg_energies);
        clocks.clone_from(&other.clocks);
        before.clone_from(&other.before);
        behind.clone_from(&other.behind);
        *self = Self { visits, legs, leg_energies, clocks, before, behind, ..*other };
    }

    fn empty(&mut self) {
        self.visits.clear();
        self.legs.clear();
        self.leg_energies.clear();
        self.travel = 0.0;
    }

    /// Puts a visit before the one at `index`; the sums are not up to date then.
    fn insert(&mut self, network: &Network<'_>, index: usize, visit: u32) {
        let depot = network.depot();
        let previous = if index == 0 { depot } else { self.visits[index - 1] };
        let next = self.visits.get(index).copied().unwrap_or(depot);
        self.visits.insert(index, visit);
        let insert = |legs: &mut Vec<f64>, leg_in, leg_out| match legs.get_mut(index) {
            Some(leg) => {
                *leg = leg_in;
                legs.insert(index + 1, leg_out);
            }
            None => legs.extend([leg_in, leg_out]),
        };
        insert(&mut self.legs, network.duration(previous, visit), network.duration(visit, next));
        if network.has_energy {
            insert(&mut self.leg_energies, network.energy(previous, visit), network.energy(visit, next));
        }
    }

    /// Takes a visit out; the sums are not up to date then.
    fn remove(&mut self, network: &Network<'_>, visit: u32) {
        let Some(index) = self.visits.iter().position(|&other| other == visit) else { return };
        let depot = network.depot();
        self.visits.remove(index);
        if self.visits.is_empty() {
            self.legs.clear();
            self.leg_energies.clear();
            return;
        }
        let previous = if index == 0 { depot } else { self.visits[index - 1] };
        let next = self.visits.get(index).copied().unwrap_or(depot);
        self.legs.remove(index);
        self.legs[index] = network.duration(previous, next);
        if network.has_energy {
            self.leg_energies.remove(index);
            self.leg_energies[index] = network.energy(previous, next);
        }
    }

    /// Brings the sums up to date.
    fn sum_up(&mut self, network: &Network<'_>) {
        let ends = network.ends[self.route as usize];
        (self.load, self.release, self.num_timed) = (0.0, 0.0, 0);
        self.clocks.clear();
        let (mut clock, mut service) = (ends.out_duration, 0.0);
        for (&visit, &leg) in self.visits.iter().zip(&self.legs) {
            let own_service = network.service_duration(visit);
            clock += leg + own_service;
            service += own_service;
            self.clocks.push(clock);
            self.load += network.load(visit);
            self.release = self.release.max(network.release(visit));
            self.num_timed += u32::from(network.is_timed(visit));
        }
        self.busy = clock + self.legs[self.visits.len()] + ends.home_duration;
        self.travel = self.busy - service;
        self.energy = if network.has_energy { self.most_energy(network) } else { 0.0 };
        self.length = if network.has_length { self.whole_length(network) } else { 0.0 };
    }

    /// What the trip takes, or one that breaks off at its worst place: from every visit the drone can fly home at once.
    fn most_energy(&self, network: &Network<'_>) -> f64 {
        let (mut energy, mut most) = (network.ends[self.route as usize].energy, 0.0_f64);
        for (&visit, &leg) in self.visits.iter().zip(&self.leg_energies) {
            energy += leg + network.service_energy(visit);
            most = most.max(energy + network.energy(visit, network.depot()));
        }
        most
    }

    fn whole_length(&self, network: &Network<'_>) -> f64 {
        let from = std::iter::once(network.depot()).chain(self.visits.iter().copied());
        let to = self.visits.iter().copied().chain([network.depot()]);
        from.zip(to).map(|(from, to)| network.length(from, to)).sum()
    }

    /// Brings the times up to date.
    fn find_times(&mut self, network: &Network<'_>, places: &[Place]) -> Result<(), OverLimit> {
        self.before.clear();
        self.behind.clear();
        if self.num_timed == 0 {
            self.whole = Segment::lasting(self.busy).not_before(self.release).ok_or(OverLimit)?;
            return Ok(());
        }
        let ends = network.ends[self.route as usize];
        let own = |visit: u32| network.segment(visit, places[visit as usize].window);
        let mut whole = Segment::lasting(ends.out_duration);
        for (&visit, &leg) in self.visits.iter().zip(&self.legs) {
            whole = whole.join(leg, own(visit)).ok_or(OverLimit)?;
            self.before.push(whole);
        }
        let mut whole = Segment::lasting(ends.home_duration);
        for (&visit, &leg) in self.visits.iter().zip(&self.legs[1..]).rev() {
            whole = own(visit).join(leg, whole).ok_or(OverLimit)?;
            self.behind.push(whole);
        }
        self.behind.reverse();
        let whole = Segment::lasting(ends.out_duration).join(self.legs[0], whole).ok_or(OverLimit)?;
        self.whole = whole.not_before(self.release).ok_or(OverLimit)?;
        Ok(())
    }

    fn is_within_limits(&self, network: &Network<'_>) -> bool {
        let fleet = network.round.fleet();
        self.load <= fleet.capacity
            && self.length <= fleet.vehicle_type.max_length
            && is_flyable(network, self.whole, self.busy, self.energy)
    }
}

/// Whether a trip of these times is within the longest time and the energy of one; what it waits in the air takes energy.
#[inline]
pub(super) fn is_flyable(network: &Network<'_>, whole: Segment, busy: f64, energy: f64) -> bool {
    let vehicle_type = &network.round.fleet().vehicle_type;
    let wait_energy = (whole.duration - busy).max(0.0) * vehicle_type.energy.leg_stop_power;
    whole.duration <= vehicle_type.max_duration + ROUNDING
        && (!network.has_energy || energy + wait_energy <= vehicle_type.energy.usable_energy * (1.0 + 1e-10))
}
