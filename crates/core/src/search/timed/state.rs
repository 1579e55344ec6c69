//! A plan under change: routes of trips, each a list of visits with the times of what lies before and behind each of them.
//!
//! A trip keeps the segment of every beginning and of every end, so that a visit between any two others is priced by two
//! joins. A route keeps when its drone is ready for each trip and what follows each landing, so that a trip that ends later is
//! known to leave the others in time without looking at them. O(length of the trip + trips of the route) for a change.

use super::network::Network;
use super::segment::Segment;

/// Where a visit is that no trip makes.
pub(super) const ABSENT: u32 = u32::MAX;

/// A trip, or an empty slot for one.
#[derive(Clone, Debug, Default)]
pub(super) struct Trip {
    pub visits: Vec<u32>,
    /// From the depot to the end of the service of each visit.
    pub before: Vec<Segment>,
    /// From the beginning of the service of each visit to the depot.
    pub behind: Vec<Segment>,
    pub route: u32,
    pub load: f64,
    /// No earlier take-off, by the releases of its visits.
    pub release: f64,
    pub length: f64,
}

/// The trips of one drone.
#[derive(Clone, Debug, Default)]
pub(super) struct Route {
    pub trips: Vec<u32>,
    /// When the drone is ready for each of them, and for one more.
    pub ready: Vec<f64>,
    /// What follows the landing of each of them.
    pub after: Vec<Segment>,
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

/// A step cannot go on: a trip that was shortened ends later, because legs cut to tenths may be longer by a detour, or a place
/// that was priced is late by rounding. The plan is as it was once the step is taken back.
#[derive(Clone, Copy, Debug)]
pub(super) struct OutOfTime;

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
    pub length: f64,
}

impl State {
    /// A plan without a trip.
    pub fn new(network: &Network<'_>) -> Self {
        let fleet = network.round.fleet();
        let route = Route { trips: Vec::new(), ready: vec![fleet.shift.earliest], after: Vec::new() };
        Self {
            trips: Vec::new(),
            routes: vec![route; fleet.num_drones.min(network.num_visits)],
            places: vec![Place { trip: ABSENT, index: 0, window: 0 }; network.num_visits],
            bank: (0..network.num_visits as u32).collect(),
            free: Vec::new(),
            length: 0.0,
        }
    }

    /// Takes over what `touched` names from a plan that differs nowhere else.
    pub fn copy_touched(&mut self, other: &Self, touched: &Touched) {
        if self.trips.len() < other.trips.len() {
            self.trips.resize(other.trips.len(), Trip::default());
        }
        for &route in &touched.routes {
            self.routes[route as usize].clone_from(&other.routes[route as usize]);
        }
        for &trip in touched.trips.iter().filter(|&&trip| (trip as usize) < other.trips.len()) {
            self.trips[trip as usize].clone_from(&other.trips[trip as usize]);
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
        self.length = other.length;
    }

    /// Takes `visit` out of its trip, whose times are then wrong until [`State::renew_all`].
    pub fn take_out(&mut self, visit: u32, touched: &mut Touched) {
        let Place { trip, .. } = self.places[visit as usize];
        let slot = &mut self.trips[trip as usize];
        touched.add(trip, slot.route);
        slot.visits.retain(|&other| other != visit);
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
    ) -> Result<(), OutOfTime> {
        let slot = &mut self.trips[place.trip as usize];
        touched.add(place.trip, slot.route);
        slot.visits.insert(place.index as usize, visit);
        self.places[visit as usize] = place;
        self.bank.retain(|&other| other != visit);
        self.renew_all(network, &[place.trip])
    }

    /// Opens a trip with one visit as number `index` of a route.
    pub fn open(
        &mut self,
        network: &Network<'_>,
        visit: u32,
        window: u8,
        (route, index): (u32, usize),
        touched: &mut Touched,
    ) -> Result<(), OutOfTime> {
        let trip = self.free.pop().unwrap_or_else(|| {
            self.trips.push(Trip::default());
            self.trips.len() as u32 - 1
        });
        let slot = &mut self.trips[trip as usize];
        slot.route = route;
        slot.length = 0.0;
        slot.visits.clear();
        self.routes[route as usize].trips.insert(index, trip);
        self.put_in(network, visit, Place { trip, index: 0, window }, touched)
    }

    /// Brings trips that were changed, and their routes, up to date; a trip without visits is closed.
    pub fn renew_all(&mut self, network: &Network<'_>, trips: &[u32]) -> Result<(), OutOfTime> {
        for &trip in trips {
            self.renew_trip(network, trip)?;
        }
        // A route looks at all its trips, so that none of them may be out of date.
        for &trip in trips {
            self.renew_route(network, self.trips[trip as usize].route)?;
        }
        Ok(())
    }

    fn renew_trip(&mut self, network: &Network<'_>, trip: u32) -> Result<(), OutOfTime> {
        let slot = &mut self.trips[trip as usize];
        self.length -= slot.length;
        let route = slot.route;
        if slot.visits.is_empty() {
            slot.length = 0.0;
            self.routes[route as usize].trips.retain(|&other| other != trip);
            self.free.push(trip);
        } else {
            let depot = network.depot();
            let (mut previous, mut whole) = (depot, Segment::NOTHING);
            (slot.load, slot.release, slot.length) = (0.0, 0.0, 0.0);
            slot.before.clear();
            for (index, &visit) in slot.visits.iter().enumerate() {
                let place = &mut self.places[visit as usize];
                (place.trip, place.index) = (trip, index as u32);
                let leg = network.leg(previous, visit);
                whole = whole.join(leg, network.segment(visit, place.window)).ok_or(OutOfTime)?;
                slot.before.push(whole);
                slot.load += network.load(visit);
                slot.release = slot.release.max(network.release(visit));
                slot.length += leg;
                previous = visit;
            }
            slot.length += network.leg(previous, depot);
            let (mut next, mut whole) = (depot, Segment::NOTHING);
            slot.behind.clear();
            for &visit in slot.visits.iter().rev() {
                let own = network.segment(visit, self.places[visit as usize].window);
                whole = own.join(network.leg(visit, next), whole).ok_or(OutOfTime)?;
                slot.behind.push(whole);
                next = visit;
            }
            slot.behind.reverse();
            self.length += slot.length;
        }
        Ok(())
    }

    /// The times of a whole trip.
    pub fn whole(&self, network: &Network<'_>, trip: u32) -> Option<Segment> {
        let trip = &self.trips[trip as usize];
        let way_out = Segment::NOTHING.join(network.leg(network.depot(), trip.visits[0]), trip.behind[0]);
        way_out?.not_before(trip.release)
    }

    fn renew_route(&mut self, network: &Network<'_>, route: u32) -> Result<(), OutOfTime> {
        let mut own = std::mem::take(&mut self.routes[route as usize]);
        let result = self.time_route(network, &mut own);
        self.routes[route as usize] = own;
        result
    }

    /// Fills in when a drone is ready for its trips, and what follows each landing.
    fn time_route(&self, network: &Network<'_>, own: &mut Route) -> Result<(), OutOfTime> {
        let fleet = network.round.fleet();
        let mut ready = fleet.shift.earliest;
        own.ready.clear();
        own.ready.push(ready);
        for &trip in &own.trips {
            ready = self.whole(network, trip).and_then(|whole| whole.end(ready)).ok_or(OutOfTime)?;
            ready += network.turnaround();
            own.ready.push(ready);
        }
        own.after.clear();
        let mut after = network.end_of_shift();
        for &trip in own.trips.iter().rev() {
            own.after.push(after);
            after = self.followed_by(network, trip, after).ok_or(OutOfTime)?;
        }
        own.after.reverse();
        Ok(())
    }

    /// A stay at the depot, a trip, and what follows its landing.
    pub fn followed_by(&self, network: &Network<'_>, trip: u32, after: Segment) -> Option<Segment> {
        Segment::NOTHING.join(network.turnaround(), self.whole(network, trip)?)?.join(0.0, after)
    }
}
