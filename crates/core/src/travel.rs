//! What a leg costs, in calm air and in wind.
//!
//! A drone holds its ground speed as far as its airspeed allows: the wind triangle
//! (docs/explanation/rounds.md derives [`Air::speeds`]). The ground velocities that can be flown are the
//! intersection of two discs, which is convex, so times keep the triangle inequality.

use crate::geometry::Point;
use crate::problem::VehicleType;

/// Where in its route a leg lies; it may be flown in another way there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LegKind {
    /// From the depot to the first visit: the take-off belongs to it.
    First,
    /// From one visit to the next.
    Between,
    /// From the last visit to the depot: the way home, if the drones have one of their own.
    Last,
}

/// The air that drones fly through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Air {
    /// Velocity of the wind, in metres per second: where it blows to.
    pub wind: Point,
    /// The fastest that drones fly through the air, in metres per second; infinite where nothing limits it.
    pub max_airspeed: f64,
    /// Watts of level flight for each cubic metre per second of airspeed, beyond what a leg takes in calm air.
    pub drag_power: f64,
}

impl Air {
    /// No wind, and no limit.
    pub const CALM: Self = Self { wind: Point::new(0.0, 0.0), max_airspeed: f64::INFINITY, drag_power: 0.0 };

    /// The speed of the wind.
    #[must_use]
    pub fn wind_speed(&self) -> f64 {
        self.wind.distance(Point::default())
    }

    /// Whether a leg takes what it takes in calm air, whatever its direction.
    #[must_use]
    pub fn is_calm_at(&self, speed: f64) -> bool {
        self.wind == Point::default() && speed <= self.max_airspeed
    }

    /// The speed over ground and through the air with which a leg of (`dx`, `dy`) is flown at `speed` over ground, or slower if
    /// the airspeed is not enough; `None` if a drone makes no way against the wind.
    #[must_use]
    pub fn speeds(&self, dx: f64, dy: f64, speed: f64) -> Option<(f64, f64)> {
        let length = (dx * dx + dy * dy).sqrt();
        let along = (self.wind.x * dx + self.wind.y * dy) / length;
        let squared_wind = self.wind.x * self.wind.x + self.wind.y * self.wind.y;
        let squared_across = (squared_wind - along * along).max(0.0);
        let squared_most = self.max_airspeed * self.max_airspeed;
        if squared_across > squared_most {
            return None;
        }
        let ground_speed = speed.min(along + (squared_most - squared_across).sqrt());
        let squared_airspeed = (ground_speed - along) * (ground_speed - along) + squared_across;
        (ground_speed > 0.0).then(|| (ground_speed, squared_airspeed.sqrt()))
    }
}

/// What one leg comes to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Leg {
    /// In length units.
    pub length: f64,
    /// In seconds.
    pub duration: f64,
    /// In joules; 0 where nothing is known about it.
    pub energy: f64,
}

impl Leg {
    /// The leg from one place to another.
    #[must_use]
    pub fn new(from: Point, to: Point, kind: LegKind, vehicle_type: &VehicleType) -> Self {
        let length = leg_length(from, to);
        let duration = leg_duration(length, kind, vehicle_type);
        Self { length, duration, energy: leg_energy(length, kind, vehicle_type) }
    }

    /// The same through moving air; `None` if it cannot be flown.
    #[must_use]
    pub fn in_air(from: Point, to: Point, kind: LegKind, vehicle_type: &VehicleType, air: &Air) -> Option<Self> {
        let calm = Self::new(from, to, kind, vehicle_type);
        let speed = match (kind, vehicle_type.way_home) {
            (LegKind::Last, Some(way_home)) => way_home.speed,
            _ => vehicle_type.speed,
        };
        if calm.length == 0.0 || air.is_calm_at(speed) {
            return Some(calm);
        }
        let (ground_speed, airspeed) = air.speeds(to.x - from.x, to.y - from.y, speed)?;
        let power = match (kind, vehicle_type.way_home) {
            (LegKind::Last, Some(_)) => vehicle_type.energy.way_home_power,
            _ => vehicle_type.energy.leg_power,
        };
        let windy_power = power + air.drag_power * (airspeed * airspeed * airspeed - speed * speed * speed);
        let (calm_cruise, cruise) = (calm.length / speed, calm.length / ground_speed);
        Some(Self {
            length: calm.length,
            duration: calm.duration - calm_cruise + cruise,
            energy: calm.energy - calm_cruise * power + cruise * windy_power,
        })
    }
}

/// Length of the leg from one place to another: the straight line.
#[must_use]
pub fn leg_length(from: Point, to: Point) -> f64 {
    from.distance(to)
}

/// Seconds that a leg of `length` takes: cruise at ground speed, and the time lost in stopping and starting (`t = d/v + stop`
/// of a multirotor, measured on a simulated ArduCopter). A leg of no length takes no time: the drone stays where it is. A
/// first leg begins with the take-off. A way home of the drones' own is flown at its speed and has a fixed part, also where
/// it has no length: the autopilot climbs and lands all the same.
#[must_use]
pub fn leg_duration(length: f64, kind: LegKind, vehicle_type: &VehicleType) -> f64 {
    let between = if length == 0.0 { 0.0 } else { length / vehicle_type.speed + vehicle_type.leg_stop_duration };
    match (kind, vehicle_type.way_home) {
        (LegKind::First, _) => vehicle_type.takeoff_duration + between,
        (LegKind::Last, Some(way_home)) => length / way_home.speed + way_home.fixed_duration,
        (LegKind::Between | LegKind::Last, _) => between,
    }
}

/// Joules that a leg of `length` takes: the phases of [`leg_duration`], each at its power.
#[must_use]
pub fn leg_energy(length: f64, kind: LegKind, vehicle_type: &VehicleType) -> f64 {
    let energy = &vehicle_type.energy;
    let stop = vehicle_type.leg_stop_duration * energy.leg_stop_power;
    let between = if length == 0.0 { 0.0 } else { length / vehicle_type.speed * energy.leg_power + stop };
    match (kind, vehicle_type.way_home) {
        (LegKind::First, _) => energy.takeoff_energy + between,
        (LegKind::Last, Some(way_home)) => {
            length / way_home.speed * energy.way_home_power + energy.way_home_fixed_energy
        }
        (LegKind::Between | LegKind::Last, _) => between,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{Energy, WayHome};

    #[test]
    fn a_leg_takes_cruise_and_stop() {
        let vehicle_type = VehicleType { speed: 5.0, leg_stop_duration: 3.0, ..VehicleType::unlimited(1) };
        for kind in [LegKind::First, LegKind::Between, LegKind::Last] {
            assert_eq!(leg_duration(60.0, kind, &vehicle_type), 15.0);
            // The drone need not stop where it is already; where it is not, it must, however near that is.
            assert_eq!(leg_duration(0.0, kind, &vehicle_type), 0.0);
            assert_eq!(leg_duration(0.5, kind, &vehicle_type), 3.1);
            assert_eq!(leg_energy(60.0, kind, &vehicle_type), 0.0);
        }
    }

    #[test]
    fn a_leg_in_wind_is_a_hand_computed_one() {
        // 8 m/s from the west, 10 m/s over ground, at most 12 through the air, 3 s a stop; P = 354 + 0.032 V^3.
        let energy = Energy { leg_power: 354.0 + 32.0, leg_stop_power: 354.0, ..Energy::UNKNOWN };
        let vehicle_type = VehicleType { speed: 10.0, leg_stop_duration: 3.0, energy, ..VehicleType::unlimited(1) };
        let air = Air { wind: Point::new(8.0, 0.0), max_airspeed: 12.0, drag_power: 0.032 };
        let (depot, east, north) = (Point::default(), Point::new(80.0, 0.0), Point::new(0.0, 80.0));
        let leg = |from, to, air| Leg::in_air(from, to, LegKind::Between, &vehicle_type, &air);
        let (out, home) = (leg(depot, east, air).unwrap(), leg(east, depot, air).unwrap());
        let across = leg(depot, north, air).unwrap();
        assert!((out.duration - 11.0).abs() < 1e-9 && (home.duration - 23.0).abs() < 1e-9);
        assert!((out.energy - (8.0 * 354.256 + 3.0 * 354.0)).abs() < 1e-9);
        assert!((home.energy - (20.0 * 409.296 + 3.0 * 354.0)).abs() < 1e-9);
        assert!((across.duration - (80.0 / 80.0_f64.sqrt() + 3.0)).abs() < 1e-9);
        // As strong as the drone is fast: neither across nor against it.
        let strong = Air { wind: Point::new(12.0, 0.0), ..air };
        assert_eq!((leg(depot, north, strong), leg(east, depot, strong)), (None, None));
        assert!(leg(depot, east, strong).is_some());
        // In calm air nothing changes, unless the drone is slower through the air than it should be over ground.
        let calm = Leg::new(depot, east, LegKind::Between, &vehicle_type);
        assert_eq!(leg(depot, east, Air { wind: Point::default(), ..air }), Some(calm));
        let slow = Air { wind: Point::default(), max_airspeed: 8.0, ..air };
        assert_eq!(leg(depot, east, slow).unwrap().duration, 13.0);
    }

    proptest::proptest! {
        /// No way round is shorter in time.
        #[test]
        fn times_in_wind_keep_the_triangle_inequality(
            (wind_x, wind_y) in (-8.0..8.0, -8.0..8.0),
            places in proptest::array::uniform3((-100.0..100.0, -100.0..100.0)),
        ) {
            let vehicle_type = VehicleType { speed: 9.0, leg_stop_duration: 2.0, ..VehicleType::unlimited(1) };
            let air = Air { wind: Point::new(wind_x, wind_y), max_airspeed: 12.0, drag_power: 0.0 };
            let [a, b, c] = places.map(|(x, y)| Point::new(x, y));
            let time = |from, to| Leg::in_air(from, to, LegKind::Between, &vehicle_type, &air).unwrap().duration;
            proptest::prop_assert!(time(a, c) <= time(a, b) + time(b, c) + 1e-9);
        }
    }

    #[test]
    fn a_route_takes_off_and_comes_home_in_the_autopilots_way() {
        let energy = Energy {
            takeoff_energy: 2280.0,
            leg_power: 357.0,
            leg_stop_power: 354.0,
            way_home_power: 385.0,
            way_home_fixed_energy: 15_000.0,
            usable_energy: f64::INFINITY,
        };
        let way_home = Some(WayHome { speed: 10.0, fixed_duration: 44.0 });
        let vehicle_type = VehicleType {
            speed: 5.0,
            leg_stop_duration: 2.5,
            takeoff_duration: 9.0,
            way_home,
            energy,
            ..VehicleType::unlimited(1)
        };
        let durations = |length: f64| {
            [LegKind::First, LegKind::Between, LegKind::Last].map(|kind| leg_duration(length, kind, &vehicle_type))
        };
        // 9 s, 60 m at 5 m/s and 2.5 s; 60 m at 10 m/s and 44 s.
        assert_eq!(durations(60.0), [23.5, 14.5, 50.0]);
        assert_eq!(durations(0.0), [9.0, 0.0, 44.0]);
        let energies = |length: f64| {
            [LegKind::First, LegKind::Between, LegKind::Last].map(|kind| leg_energy(length, kind, &vehicle_type))
        };
        // 12 s x 357 W + 2.5 s x 354 W = 5169 J; 6 s x 385 W = 2310 J.
        assert_eq!(energies(60.0), [2280.0 + 5169.0, 5169.0, 2310.0 + 15_000.0]);
        assert_eq!(energies(0.0), [2280.0, 0.0, 15_000.0]);
        // Without a way home of their own the drones come back as they fly between ponds.
        let plain = VehicleType { way_home: None, ..vehicle_type };
        assert_eq!(leg_duration(60.0, LegKind::Last, &plain), 14.5);
        assert_eq!(leg_energy(60.0, LegKind::Last, &plain), 5169.0);
    }
}
