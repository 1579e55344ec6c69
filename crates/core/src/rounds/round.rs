//! What is to be flown in one round: visits with windows, releases and loads, and drones that may fly several trips.

use crate::error::{Faults, InvalidInput};
use crate::geometry::Point;

/// When something may begin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeWindow {
    /// In seconds; not later than `latest`.
    pub earliest: f64,
    /// In seconds; infinite where nothing limits it.
    pub latest: f64,
}

impl TimeWindow {
    /// At any time.
    pub const ANY: Self = Self { earliest: 0.0, latest: f64::INFINITY };
}

/// The task of serving one place.
#[derive(Clone, Debug, PartialEq)]
pub struct RoundVisit {
    /// Where it is.
    pub position: Point,
    /// Time on station, in seconds.
    pub service_duration: f64,
    /// When the service may begin: in one of these; at any time if there are none.
    pub windows: Vec<TimeWindow>,
    /// No trip with this visit takes off before, in seconds.
    pub release: f64,
    /// What the visit takes of a trip's capacity.
    pub load: f64,
}

/// What a leg of length d counts, as length and as duration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rounding {
    /// d itself.
    #[default]
    Exact,
    /// d without all but its first decimal, the convention of the DIMACS challenge for Solomon's instances.
    Dimacs,
}

/// The drones, all alike: at unit speed from one depot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fleet {
    /// How many there are.
    pub num_drones: usize,
    /// The load that one trip may take.
    pub capacity: f64,
    /// Longest time of one trip, in seconds.
    pub max_trip_duration: f64,
    /// When drones may take off first, and must be back for good.
    pub shift: TimeWindow,
    /// Seconds at the depot between two trips of a drone; `None` if each flies one trip.
    pub turnaround: Option<f64>,
}

/// A depot, visits and drones: validated, immutable.
#[derive(Clone, Debug, PartialEq)]
pub struct Round {
    depot: Point,
    visits: Vec<RoundVisit>,
    fleet: Fleet,
    rounding: Rounding,
}

/// Beyond this a squared distance loses the digits that distinguish two places.
const MAX_NUMBER: f64 = 1e9;

impl Round {
    /// A round of at least one visit and one drone.
    ///
    /// # Errors
    /// [`InvalidInput`] with every fault: no visit, no drone, a number out of its range, a window that ends before it begins,
    /// a load that no trip may take.
    pub fn new(depot: Point, visits: Vec<RoundVisit>, fleet: Fleet, rounding: Rounding) -> Result<Self, InvalidInput> {
        let mut faults = Faults::default();
        check_position(&mut faults, "depot", depot);
        if visits.is_empty() {
            faults.add("visits", "there is nothing to visit", "give at least one visit");
        }
        check_fleet(&mut faults, &fleet);
        for (index, visit) in visits.iter().enumerate() {
            check_visit(&mut faults, &format!("visits[{index}]"), visit, &fleet);
        }
        faults.into_result(Self { depot, visits, fleet, rounding })
    }

    /// Where every trip starts and ends.
    #[must_use]
    pub const fn depot(&self) -> Point {
        self.depot
    }

    /// The visits; a visit is known by its index here.
    #[must_use]
    pub fn visits(&self) -> &[RoundVisit] {
        &self.visits
    }

    /// The drones.
    #[must_use]
    pub const fn fleet(&self) -> &Fleet {
        &self.fleet
    }

    /// Length of the leg between two places, which is its duration too.
    #[must_use]
    pub fn leg(&self, from: Point, to: Point) -> f64 {
        let length = from.distance(to);
        match self.rounding {
            Rounding::Exact => length,
            // Whole tenths are divided last, so that the nearest number to each is taken, as a reader of decimals does.
            Rounding::Dimacs => (10.0 * length).floor() / 10.0,
        }
    }
}

fn check_position(faults: &mut Faults, path: &str, position: Point) {
    for (axis, value) in [("x", position.x), ("y", position.y)] {
        if !(-MAX_NUMBER..=MAX_NUMBER).contains(&value) {
            let message = format!("the coordinate is {value:?}");
            faults.add(format!("{path}.{axis}"), message, "give a finite number of at most 1e9");
        }
    }
}

fn check_number(faults: &mut Faults, path: String, value: f64) {
    if !(0.0..=MAX_NUMBER).contains(&value) {
        faults.add(path, format!("the number is {value:?}"), "give 0 to 1e9");
    }
}

fn check_limit(faults: &mut Faults, path: &str, value: f64) {
    if value.is_nan() || value <= 0.0 {
        faults.add(path, format!("the limit is {value:?}"), "give a positive limit, or infinity for none");
    }
}

fn check_window(faults: &mut Faults, path: &str, window: TimeWindow) {
    check_number(faults, format!("{path}.earliest"), window.earliest);
    if window.latest.is_nan() || window.latest < window.earliest {
        let message = format!("the window ends at {:?} and begins at {:?}", window.latest, window.earliest);
        faults.add(path, message, "give an end that is not before the beginning");
    }
}

fn check_fleet(faults: &mut Faults, fleet: &Fleet) {
    if fleet.num_drones == 0 {
        faults.add("fleet.num_drones", "there is no drone", "give at least one drone");
    }
    check_limit(faults, "fleet.capacity", fleet.capacity);
    check_limit(faults, "fleet.max_trip_duration", fleet.max_trip_duration);
    check_window(faults, "fleet.shift", fleet.shift);
    if let Some(turnaround) = fleet.turnaround {
        check_number(faults, "fleet.turnaround".to_owned(), turnaround);
    }
}

fn check_visit(faults: &mut Faults, path: &str, visit: &RoundVisit, fleet: &Fleet) {
    check_position(faults, &format!("{path}.position"), visit.position);
    check_number(faults, format!("{path}.service_duration"), visit.service_duration);
    check_number(faults, format!("{path}.release"), visit.release);
    check_number(faults, format!("{path}.load"), visit.load);
    for (index, &window) in visit.windows.iter().enumerate() {
        check_window(faults, &format!("{path}.windows[{index}]"), window);
    }
    if visit.load > fleet.capacity {
        let message = format!("the load is {}, and a trip may take {}", visit.load, fleet.capacity);
        faults.add(format!("{path}.load"), message, "give a smaller load, or a larger capacity");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn visit(x: f64, y: f64) -> RoundVisit {
        RoundVisit { position: Point::new(x, y), service_duration: 1.0, windows: Vec::new(), release: 0.0, load: 1.0 }
    }

    const FLEET: Fleet = Fleet {
        num_drones: 1,
        capacity: 2.0,
        max_trip_duration: f64::INFINITY,
        shift: TimeWindow::ANY,
        turnaround: None,
    };

    #[test]
    fn every_fault_is_told_at_once() {
        let wrong = RoundVisit {
            windows: vec![TimeWindow::ANY, TimeWindow { earliest: 5.0, latest: 4.0 }],
            load: 3.0,
            release: -1.0,
            ..visit(f64::NAN, 0.0)
        };
        let fleet = Fleet { num_drones: 0, max_trip_duration: f64::NAN, turnaround: Some(-1.0), ..FLEET };
        let error = Round::new(Point::new(2e9, 0.0), vec![visit(0.0, 0.0), wrong], fleet, Rounding::Exact).unwrap_err();
        let paths: Vec<&str> = error.faults.iter().map(|fault| fault.path.as_str()).collect();
        assert_eq!(
            paths,
            [
                "depot.x",
                "fleet.num_drones",
                "fleet.max_trip_duration",
                "fleet.turnaround",
                "visits[1].position.x",
                "visits[1].release",
                "visits[1].windows[1]",
                "visits[1].load",
            ]
        );
    }

    #[test]
    fn legs_are_cut_to_tenths_where_the_convention_says_so() {
        let round = |rounding| Round::new(Point::new(0.0, 0.0), vec![visit(1.0, 1.0)], FLEET, rounding).unwrap();
        let leg = |rounding| round(rounding).leg(Point::new(0.0, 0.0), Point::new(1.0, 1.0));
        assert_eq!((leg(Rounding::Exact), leg(Rounding::Dimacs)), (2.0_f64.sqrt(), 1.4));
    }
}
