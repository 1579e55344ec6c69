//! What is known about places: legs, services, windows, nearest neighbours.

use super::segment::Segment;
use crate::geometry::Point;
use crate::rounds::{Round, TimeWindow};

/// Places with a table of legs at most; more are computed each time, because a larger table does not stay near the processor.
const MAX_TABLE: usize = 256;
/// Neighbours of a visit that are tried as places beside it.
pub(super) const NUM_NEIGHBOURS: usize = 40;
/// What waiting and coming too late add to the distance of two visits, a second each (PyVRP 0.6, Wouda, Lan and Kool 2024).
const WAIT_WEIGHT: f64 = 0.2;
const LATE_WEIGHT: f64 = 1.0;

/// A round as the search sees it: visits by index, the depot behind the last.
pub(super) struct Network<'a> {
    pub round: &'a Round,
    pub num_visits: usize,
    points: Vec<Point>,
    legs: Option<Vec<f64>>,
    neighbours: Vec<u32>,
    num_neighbours: usize,
    windows: Vec<Vec<TimeWindow>>,
}

impl<'a> Network<'a> {
    pub fn new(round: &'a Round) -> Self {
        let num_visits = round.visits().len();
        let mut points: Vec<Point> = round.visits().iter().map(|visit| visit.position).collect();
        points.push(round.depot());
        let legs = (points.len() <= MAX_TABLE).then(|| {
            points
                .iter()
                .flat_map(|&from| points.iter().map(move |&to| (from, to)))
                .map(|(from, to)| round.leg(from, to))
                .collect()
        });
        let windows = (round.visits().iter())
            .map(|visit| if visit.windows.is_empty() { vec![TimeWindow::ANY] } else { visit.windows.clone() })
            .collect();
        let num_neighbours = NUM_NEIGHBOURS.min(num_visits - 1);
        let mut network = Self { round, num_visits, points, legs, neighbours: Vec::new(), num_neighbours, windows };
        network.find_neighbours();
        network
    }

    /// For each visit those that are best flown right before or after it: near, and neither too early nor too late.
    fn find_neighbours(&mut self) {
        let mut found = Vec::with_capacity(self.num_visits * self.num_neighbours);
        let mut ranked: Vec<(f64, u32)> = Vec::with_capacity(self.num_visits);
        for visit in 0..self.num_visits as u32 {
            ranked.clear();
            let others = (0..self.num_visits as u32).filter(|&other| other != visit);
            ranked.extend(others.map(|other| (self.apartness(visit, other).min(self.apartness(other, visit)), other)));
            let by_rank = |one: &(f64, u32), other: &(f64, u32)| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1));
            if self.num_neighbours < ranked.len() {
                ranked.select_nth_unstable_by(self.num_neighbours, by_rank);
                ranked.truncate(self.num_neighbours);
            }
            ranked.sort_unstable_by(by_rank);
            found.extend(ranked.iter().map(|&(_, other)| other));
        }
        self.neighbours = found;
    }

    /// How far `other` is behind `visit`, in length and lost time.
    fn apartness(&self, visit: u32, other: u32) -> f64 {
        let (from, to) = (&self.windows[visit as usize], &self.windows[other as usize]);
        let way = self.round.visits()[visit as usize].service_duration + self.leg(visit, other);
        let wait = to[0].earliest - way - from[from.len() - 1].latest;
        let late = from[0].earliest + way - to[to.len() - 1].latest;
        self.leg(visit, other) + WAIT_WEIGHT * wait.max(0.0) + LATE_WEIGHT * late.max(0.0)
    }

    /// The depot as a place.
    pub fn depot(&self) -> u32 {
        self.num_visits as u32
    }

    #[inline]
    pub fn leg(&self, from: u32, to: u32) -> f64 {
        match &self.legs {
            Some(legs) => legs[from as usize * self.points.len() + to as usize],
            None => self.round.leg(self.points[from as usize], self.points[to as usize]),
        }
    }

    pub fn neighbours(&self, visit: u32) -> &[u32] {
        &self.neighbours[visit as usize * self.num_neighbours..][..self.num_neighbours]
    }

    pub fn windows(&self, visit: u32) -> &[TimeWindow] {
        &self.windows[visit as usize]
    }

    /// The times of one visit in one of its windows.
    #[inline]
    pub fn segment(&self, visit: u32, window: u8) -> Segment {
        let TimeWindow { earliest, latest } = self.windows[visit as usize][window as usize];
        Segment { duration: self.round.visits()[visit as usize].service_duration, earliest, latest }
    }

    /// What follows the last landing of a drone: nothing, if it is within the shift.
    pub fn end_of_shift(&self) -> Segment {
        Segment { latest: self.round.fleet().shift.latest, ..Segment::NOTHING }
    }

    /// Time at the depot between two trips; without effect where drones fly one.
    pub fn turnaround(&self) -> f64 {
        self.round.fleet().turnaround.unwrap_or(0.0)
    }

    pub fn load(&self, visit: u32) -> f64 {
        self.round.visits()[visit as usize].load
    }

    pub fn release(&self, visit: u32) -> f64 {
        self.round.visits()[visit as usize].release
    }
}
