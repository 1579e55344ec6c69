//! What is known about places: legs, services, windows, nearest neighbours.

use super::segment::Segment;
use crate::geometry::Point;
use crate::neighbours::{KdTree, Near};
use crate::problem::{Energy, VehicleType, WayHome};
use crate::rounds::{Round, Rounding, TimeWindow};
use crate::travel::{Leg, LegKind};
use std::sync::atomic::{AtomicU64, Ordering};

/// Visits whose legs are remembered at most; of more they are computed each time, because memory and caches are not large enough.
const MAX_REMEMBERED: usize = 2000;
/// Neighbours of a visit that are tried as places beside it, where visits have windows and where they have none.
const NUM_TIMED_NEIGHBOURS: usize = 40;
const NUM_NEIGHBOURS: usize = 16;
/// Near places among which the neighbours are looked for where visits have windows, and where there is only wind.
const NUM_TIMED_CANDIDATES: usize = 400;
const NUM_WINDY_CANDIDATES: usize = 48;
/// What waiting and coming too late add to the distance of two visits, a second each (PyVRP 0.6, Wouda, Lan and Kool 2024).
const WAIT_WEIGHT: f64 = 0.2;
const LATE_WEIGHT: f64 = 1.0;

/// What all trips of a drone take besides their legs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ends {
    /// Seconds of the take-off.
    pub out_duration: f64,
    /// Seconds of climb, wait and landing on the way home.
    pub home_duration: f64,
    /// Joules of both.
    pub energy: f64,
}

/// A leg to or from the depot as the search needs it.
#[derive(Clone, Copy, Debug)]
struct Way {
    duration: f64,
    energy: f64,
}

/// What legs between visits take, remembered once it was asked for: a search asks for few of all pairs, but for those often.
struct Remembered(Vec<AtomicU64>);

impl Remembered {
    fn new(num_visits: usize) -> Self {
        let num_pairs = if num_visits <= MAX_REMEMBERED { num_visits * num_visits } else { 0 };
        Self((0..num_pairs).map(|_| AtomicU64::new(0)).collect())
    }

    #[inline]
    fn get(&self, pair: usize, compute: impl FnOnce() -> f64) -> f64 {
        let Some(remembered) = self.0.get(pair) else { return compute() };
        // What takes nothing is computed each time.
        match remembered.load(Ordering::Relaxed) {
            0 => {
                let value = compute();
                remembered.store(value.to_bits(), Ordering::Relaxed);
                value
            }
            bits => f64::from_bits(bits),
        }
    }
}

/// What is asked of a visit all the time, kept close together.
#[derive(Clone, Copy, Debug)]
struct Figures {
    service_duration: f64,
    service_energy: f64,
    load: f64,
    release: f64,
    is_timed: bool,
}

/// A visit near another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Neighbour {
    pub visit: u32,
    /// Seconds to fly there, and from there.
    pub leg_to: f64,
    pub leg_from: f64,
}

/// A round as the search sees it: visits by index, the depot behind the last.
pub(super) struct Network<'a> {
    pub round: &'a Round,
    pub num_visits: usize,
    /// How drones fly, but for what [`Ends`] says.
    drone: VehicleType,
    /// What the trips of each drone take besides.
    pub ends: Vec<Ends>,
    /// Whether these are the same for all drones.
    pub are_ends_alike: bool,
    points: Vec<Point>,
    /// Whether legs are as long as they are, not cut to tenths.
    is_exact: bool,
    /// A little less than what a length unit takes, so that rounding never makes it more.
    seconds_per_length: f64,
    durations: Remembered,
    energies: Remembered,
    /// To the first visit of a trip and from the last, as flown there.
    out: Vec<Way>,
    home: Vec<Way>,
    neighbours: Vec<Neighbour>,
    num_neighbours: usize,
    visits: Vec<Figures>,
    windows: Vec<Vec<TimeWindow>>,
    /// Whether any visit has windows.
    pub has_windows: bool,
    /// Whether trips may use only so much energy, or be only so long.
    pub has_energy: bool,
    pub has_length: bool,
}

impl<'a> Network<'a> {
    pub fn new(round: &'a Round) -> Self {
        let fleet = round.fleet();
        let num_visits = round.visits().len();
        // Each drone in a layer of its own may be the best for some visit; of those that are alike the first are.
        let num_drones = fleet.vehicle_type.num_available.min(num_visits + fleet.layers.len());
        let mut points: Vec<Point> = round.visits().iter().map(|visit| visit.visit.position).collect();
        points.push(round.depot());
        let windows: Vec<Vec<TimeWindow>> = (round.visits().iter())
            .map(|visit| if visit.windows.is_empty() { vec![TimeWindow::ANY] } else { visit.windows.clone() })
            .collect();
        let has_windows = windows.iter().any(|windows| windows[..] != [TimeWindow::ANY]);
        let most = if has_windows { NUM_TIMED_NEIGHBOURS } else { NUM_NEIGHBOURS };
        let ends: Vec<Ends> = (0..num_drones).map(|drone| ends_of(&fleet.drone(drone))).collect();
        let has_energy = fleet.vehicle_type.energy.usable_energy.is_finite();
        let mut network = Self {
            round,
            num_visits,
            drone: without_ends(&fleet.vehicle_type),
            are_ends_alike: ends.iter().all(|other| *other == ends[0]),
            ends,
            points,
            is_exact: round.rounding() == Rounding::Exact,
            seconds_per_length: (1.0 - 1e-12) / fleet.vehicle_type.speed,
            durations: Remembered::new(num_visits),
            energies: Remembered::new(if has_energy { num_visits } else { 0 }),
            out: Vec::new(),
            home: Vec::new(),
            neighbours: Vec::new(),
            num_neighbours: most.min(num_visits - 1),
            visits: round
                .visits()
                .iter()
                .zip(&windows)
                .map(|(visit, windows)| Figures {
                    service_duration: visit.visit.service_duration,
                    service_energy: visit.visit.service_energy,
                    load: visit.load,
                    release: visit.release,
                    is_timed: windows[..] != [TimeWindow::ANY],
                })
                .collect(),
            windows,
            has_windows,
            has_energy,
            has_length: fleet.vehicle_type.max_length.is_finite(),
        };
        let places = 0..num_visits as u32;
        network.out = places.clone().map(|visit| network.way(network.depot(), visit, LegKind::First)).collect();
        network.home = places.map(|visit| network.way(visit, network.depot(), LegKind::Last)).collect();
        network.find_neighbours();
        network
    }

    fn way(&self, from: u32, to: u32, kind: LegKind) -> Way {
        let Leg { duration, energy, .. } =
            self.round.leg(self.points[from as usize], self.points[to as usize], kind, &self.drone);
        Way { duration, energy }
    }

    /// For each visit those that are best flown right before or after it: near, and neither too early nor too late.
    fn find_neighbours(&mut self) {
        let tree = KdTree::new(&self.points[..self.num_visits]);
        // In wind the nearest in time need not be the nearest in space.
        let num_candidates = if self.has_windows { NUM_TIMED_CANDIDATES } else { NUM_WINDY_CANDIDATES };
        let mut found = Vec::with_capacity(self.num_visits * self.num_neighbours);
        let (mut near, mut ranked): (Vec<Near>, Vec<(f64, u32)>) = (Vec::new(), Vec::new());
        for visit in 0..self.num_visits as u32 {
            tree.nearest(visit as usize, num_candidates.min(self.num_visits - 1), &mut near);
            let rank = |near: &Near| self.apartness(visit, near.index).min(self.apartness(near.index, visit));
            ranked.clear();
            ranked.extend(near.iter().map(|near| (rank(near), near.index)));
            let by_rank = |one: &(f64, u32), other: &(f64, u32)| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1));
            if self.num_neighbours < ranked.len() {
                ranked.select_nth_unstable_by(self.num_neighbours, by_rank);
                ranked.truncate(self.num_neighbours);
            }
            ranked.sort_unstable_by(by_rank);
            found.extend(ranked.iter().map(|&(_, other)| Neighbour {
                visit: other,
                leg_to: self.duration(visit, other),
                leg_from: self.duration(other, visit),
            }));
        }
        self.neighbours = found;
    }

    /// How far `other` is behind `visit`, in length and lost time.
    fn apartness(&self, visit: u32, other: u32) -> f64 {
        let (from, to) = (&self.windows[visit as usize], &self.windows[other as usize]);
        let way = self.service_duration(visit) + self.duration(visit, other);
        let wait = to[0].earliest - way - from[from.len() - 1].latest;
        let late = from[0].earliest + way - to[to.len() - 1].latest;
        self.duration(visit, other) + WAIT_WEIGHT * wait.max(0.0) + LATE_WEIGHT * late.max(0.0)
    }

    /// The depot as a place.
    pub fn depot(&self) -> u32 {
        self.num_visits as u32
    }

    /// Seconds of a leg, without what [`Ends`] says.
    #[inline]
    pub fn duration(&self, from: u32, to: u32) -> f64 {
        if to == self.depot() {
            return self.home[from as usize].duration;
        }
        if from == self.depot() {
            return self.out[to as usize].duration;
        }
        let pair = from as usize * self.num_visits + to as usize;
        self.durations.get(pair, || self.way(from, to, LegKind::Between).duration)
    }

    /// No leg between these places takes less: what it takes in calm air, which is found without memory. Only where legs are exact.
    #[inline]
    pub fn least_duration(&self, from: u32, to: u32) -> f64 {
        if to == self.depot() {
            return self.home[from as usize].duration;
        }
        if from == self.depot() {
            return self.out[to as usize].duration;
        }
        if !self.is_exact {
            return 0.0;
        }
        let length = self.points[from as usize].distance(self.points[to as usize]);
        if length == 0.0 { 0.0 } else { length * self.seconds_per_length + self.drone.leg_stop_duration }
    }

    /// Joules of a leg, without what [`Ends`] says.
    #[inline]
    pub fn energy(&self, from: u32, to: u32) -> f64 {
        if to == self.depot() {
            return self.home[from as usize].energy;
        }
        if from == self.depot() {
            return self.out[to as usize].energy;
        }
        let pair = from as usize * self.num_visits + to as usize;
        self.energies.get(pair, || self.way(from, to, LegKind::Between).energy)
    }

    /// Length of a leg.
    pub fn length(&self, from: u32, to: u32) -> f64 {
        let ends = (self.points[from as usize], self.points[to as usize]);
        self.round.leg(ends.0, ends.1, LegKind::Between, &self.drone).length
    }

    pub fn neighbours(&self, visit: u32) -> &[Neighbour] {
        &self.neighbours[visit as usize * self.num_neighbours..][..self.num_neighbours]
    }

    pub fn windows(&self, visit: u32) -> &[TimeWindow] {
        &self.windows[visit as usize]
    }

    /// Whether it matters when a visit is made.
    #[inline]
    pub fn is_timed(&self, visit: u32) -> bool {
        self.visits[visit as usize].is_timed
    }

    /// The times of one visit in one of its windows.
    #[inline]
    pub fn segment(&self, visit: u32, window: u8) -> Segment {
        let TimeWindow { earliest, latest } = self.windows[visit as usize][window as usize];
        Segment { duration: self.service_duration(visit), earliest, latest }
    }

    pub fn service_duration(&self, visit: u32) -> f64 {
        self.visits[visit as usize].service_duration
    }

    pub fn service_energy(&self, visit: u32) -> f64 {
        self.visits[visit as usize].service_energy
    }

    /// What follows the last landing of a drone: nothing, if it is within the shift.
    pub fn end_of_shift(&self) -> Segment {
        Segment { latest: self.round.fleet().shift.latest, ..Segment::NOTHING }
    }

    /// Time at the depot between two trips; without effect where drones fly one.
    pub fn turnaround(&self) -> f64 {
        self.round.fleet().turnaround.unwrap_or(0.0)
    }

    /// Whether drones may have to wait for each other at the depot.
    pub fn has_queue(&self) -> bool {
        self.round.fleet().turnaround.is_some() && self.round.fleet().num_pads < self.ends.len()
    }

    pub fn load(&self, visit: u32) -> f64 {
        self.visits[visit as usize].load
    }

    pub fn release(&self, visit: u32) -> f64 {
        self.visits[visit as usize].release
    }

    pub fn priority(&self, visit: u32) -> f64 {
        self.round.visits()[visit as usize].priority
    }
}

fn without_ends(vehicle_type: &VehicleType) -> VehicleType {
    VehicleType {
        takeoff_duration: 0.0,
        way_home: vehicle_type.way_home.map(|way_home| WayHome { fixed_duration: 0.0, ..way_home }),
        energy: Energy { takeoff_energy: 0.0, way_home_fixed_energy: 0.0, ..vehicle_type.energy },
        ..*vehicle_type
    }
}

fn ends_of(drone: &VehicleType) -> Ends {
    let home_energy = if drone.way_home.is_some() { drone.energy.way_home_fixed_energy } else { 0.0 };
    Ends {
        out_duration: drone.takeoff_duration,
        home_duration: drone.way_home.map_or(0.0, |way_home| way_home.fixed_duration),
        energy: drone.energy.takeoff_energy + home_energy,
    }
}
