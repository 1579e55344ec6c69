//! What is to be flown in one round: visits with windows, releases and loads, and drones that may fly several trips.

use crate::error::{Faults, InvalidInput};
use crate::geometry::Point;
use crate::problem::{Depot, Layer, Problem, VehicleType, Visit};
use crate::travel::{Air, Leg, LegKind, leg_duration, leg_energy, leg_length};

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
    /// Where it is, how long it takes, and what it takes from the battery.
    pub visit: Visit,
    /// When the service may begin: in one of these; at any time if there are none.
    pub windows: Vec<TimeWindow>,
    /// No trip with this visit takes off before, in seconds.
    pub release: f64,
    /// What the visit takes of a trip's capacity.
    pub load: f64,
    /// What it is worth beside others where not all can be made; positive.
    pub priority: f64,
}

impl RoundVisit {
    /// A visit at any time, without load.
    #[must_use]
    pub const fn at_any_time(visit: Visit) -> Self {
        Self { visit, windows: Vec::new(), release: 0.0, load: 0.0, priority: 1.0 }
    }
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

/// The drones, all alike, from one depot.
#[derive(Clone, Debug, PartialEq)]
pub struct Fleet {
    /// How many there are and how they fly; the limits of energy, length and time are those of one trip.
    pub vehicle_type: VehicleType,
    /// How drone i takes off and comes home, in place of what its type says; drones beyond the last layer fly in the last. May
    /// be empty.
    pub layers: Vec<Layer>,
    /// The air they fly through.
    pub air: Air,
    /// The load that one trip may take.
    pub capacity: f64,
    /// When the first drone may take off, and when all must be back for good.
    pub shift: TimeWindow,
    /// Seconds by which each drone may take off after the one before it.
    pub takeoff_interval: f64,
    /// Seconds at the depot between two trips of a drone; `None` if each flies one trip.
    pub turnaround: Option<f64>,
    /// How many drones the depot can turn round at once; the others wait, in the order of their landings.
    pub num_pads: usize,
}

impl Fleet {
    /// Drones that fly one trip each, at any time, in calm air.
    #[must_use]
    pub const fn of(vehicle_type: VehicleType) -> Self {
        Self {
            vehicle_type,
            layers: Vec::new(),
            air: Air::CALM,
            capacity: f64::INFINITY,
            shift: TimeWindow::ANY,
            takeoff_interval: 0.0,
            turnaround: None,
            num_pads: usize::MAX,
        }
    }

    /// How drone `index` flies.
    #[must_use]
    pub fn drone(&self, index: usize) -> VehicleType {
        match self.layers.get(index).or(self.layers.last()) {
            Some(&layer) => self.vehicle_type.in_layer(layer),
            None => self.vehicle_type,
        }
    }

    /// When drone `index` may take off first.
    #[must_use]
    pub fn first_takeoff(&self, index: usize) -> f64 {
        self.shift.earliest + index as f64 * self.takeoff_interval
    }
}

/// A depot, visits and drones: validated, immutable.
#[derive(Clone, Debug, PartialEq)]
pub struct Round {
    depot: Point,
    visits: Vec<RoundVisit>,
    fleet: Fleet,
    rounding: Rounding,
}

/// Times, loads and priorities of more are no sensible ones.
const MAX_NUMBER: f64 = 1e9;

impl Round {
    /// A round of at least one visit and one drone.
    ///
    /// # Errors
    /// [`InvalidInput`] with every fault: what [`Problem::new`] finds, a window that ends before it begins, a load that no trip
    /// may take, a wind that drones make no way against.
    pub fn new(depot: Point, visits: Vec<RoundVisit>, fleet: Fleet, rounding: Rounding) -> Result<Self, InvalidInput> {
        let mut faults = Faults::default();
        let bare = visits.iter().map(|visit| visit.visit).collect();
        let problem = Problem::new(Depot { position: depot }, bare, fleet.vehicle_type)
            .and_then(|problem| problem.with_layers(fleet.layers.clone()));
        if let Err(error) = problem {
            faults.extend(error);
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

    /// What a leg counts.
    #[must_use]
    pub const fn rounding(&self) -> Rounding {
        self.rounding
    }

    /// The leg between two places, as a drone of this kind flies it.
    ///
    /// # Panics
    /// Never: a round whose drones make no way against the wind is no valid one.
    #[must_use]
    pub fn leg(&self, from: Point, to: Point, kind: LegKind, drone: &VehicleType) -> Leg {
        match self.rounding {
            Rounding::Exact => Leg::in_air(from, to, kind, drone, &self.fleet.air).unwrap_or(Leg {
                length: leg_length(from, to),
                duration: f64::INFINITY,
                energy: f64::INFINITY,
            }),
            Rounding::Dimacs => {
                // Whole tenths are divided last, so that the nearest number to each is taken, as a reader of decimals does.
                let length = (10.0 * leg_length(from, to)).floor() / 10.0;
                let (duration, energy) = (leg_duration(length, kind, drone), leg_energy(length, kind, drone));
                Leg { length, duration, energy }
            }
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
    check_limit(faults, "fleet.capacity", fleet.capacity);
    check_window(faults, "fleet.shift", fleet.shift);
    check_number(faults, "fleet.takeoff_interval".to_owned(), fleet.takeoff_interval);
    if let Some(turnaround) = fleet.turnaround {
        check_number(faults, "fleet.turnaround".to_owned(), turnaround);
    }
    if fleet.num_pads == 0 {
        faults.add("fleet.num_pads", "there is no place to land", "give at least one");
    }
    check_air(faults, &fleet.air);
}

fn check_air(faults: &mut Faults, air: &Air) {
    check_number(faults, "fleet.air.drag_power".to_owned(), air.drag_power);
    check_limit(faults, "fleet.air.max_airspeed", air.max_airspeed);
    let wind_speed = air.wind_speed();
    if !wind_speed.is_finite() {
        faults.add("fleet.air.wind", "the wind is no finite velocity", "give its speed and where it blows from");
    } else if wind_speed >= air.max_airspeed {
        let message = format!(
            "the wind blows with {wind_speed:.1} m/s, and the drones fly at most {:.1} m/s through the air: they would not come \
             back against it",
            air.max_airspeed
        );
        faults.add("fleet.air.wind", message, "wait for less wind, or give drones that fly faster");
    }
}

fn check_visit(faults: &mut Faults, path: &str, visit: &RoundVisit, fleet: &Fleet) {
    check_number(faults, format!("{path}.release"), visit.release);
    check_number(faults, format!("{path}.load"), visit.load);
    check_limit(faults, &format!("{path}.priority"), visit.priority);
    if visit.priority > MAX_NUMBER {
        faults.add(format!("{path}.priority"), format!("the priority is {:?}", visit.priority), "give at most 1e9");
    }
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
    use crate::problem::WayHome;

    fn visit(x: f64, y: f64) -> RoundVisit {
        RoundVisit { load: 1.0, ..RoundVisit::at_any_time(Visit::at(Point::new(x, y))) }
    }

    fn fleet(num_drones: usize) -> Fleet {
        Fleet { capacity: 2.0, ..Fleet::of(VehicleType::unlimited(num_drones)) }
    }

    #[test]
    fn every_fault_is_told_at_once() {
        let wrong = RoundVisit {
            windows: vec![TimeWindow::ANY, TimeWindow { earliest: 5.0, latest: 4.0 }],
            load: 3.0,
            release: -1.0,
            priority: 0.0,
            ..visit(f64::NAN, 0.0)
        };
        let mut fleet = Fleet { turnaround: Some(-1.0), takeoff_interval: f64::NAN, num_pads: 0, ..fleet(0) };
        fleet.vehicle_type.max_duration = f64::NAN;
        fleet.air = Air { wind: Point::new(3.0, 4.0), max_airspeed: 5.0, drag_power: -1.0 };
        let error = Round::new(Point::new(2e9, 0.0), vec![visit(0.0, 0.0), wrong], fleet, Rounding::Exact).unwrap_err();
        let paths: Vec<&str> = error.faults.iter().map(|fault| fault.path.as_str()).collect();
        assert_eq!(
            paths,
            [
                "depot.position.x",
                "visits[1].position.x",
                "vehicle_type.num_available",
                "vehicle_type.max_duration",
                "fleet.takeoff_interval",
                "fleet.turnaround",
                "fleet.num_pads",
                "fleet.air.drag_power",
                "fleet.air.wind",
                "visits[1].release",
                "visits[1].priority",
                "visits[1].windows[1]",
                "visits[1].load",
            ]
        );
        assert!(error.to_string().contains("blows with 5.0 m/s"));
    }

    #[test]
    fn legs_are_cut_to_tenths_where_the_convention_says_so() {
        let leg = |rounding| {
            let round = Round::new(Point::new(0.0, 0.0), vec![visit(1.0, 1.0)], fleet(1), rounding).unwrap();
            round.leg(Point::new(0.0, 0.0), Point::new(1.0, 1.0), LegKind::Between, &round.fleet().drone(0)).duration
        };
        assert_eq!((leg(Rounding::Exact), leg(Rounding::Dimacs)), (2.0_f64.sqrt(), 1.4));
    }

    #[test]
    fn drones_take_off_one_after_the_other_each_in_its_layer() {
        let way_home = Some(WayHome { speed: 10.0, fixed_duration: 40.0 });
        let layer = |takeoff_duration| Layer {
            takeoff_duration,
            way_home_duration: 44.0,
            takeoff_energy: 0.0,
            way_home_energy: 0.0,
        };
        let fleet = Fleet {
            layers: vec![layer(9.0), layer(11.0)],
            takeoff_interval: 20.0,
            shift: TimeWindow { earliest: 5.0, latest: 1e4 },
            ..Fleet::of(VehicleType { way_home, ..VehicleType::unlimited(3) })
        };
        assert_eq!([0, 1, 2].map(|drone| fleet.first_takeoff(drone)), [5.0, 25.0, 45.0]);
        assert_eq!([0, 1, 2].map(|drone| fleet.drone(drone).takeoff_duration), [9.0, 11.0, 11.0]);
        assert_eq!(fleet.drone(2).way_home, Some(WayHome { speed: 10.0, fixed_duration: 44.0 }));
    }
}
