//! A plan in the time in which not even near neighbours can be found: sectors, toured along strips, smoothed and balanced.
//!
//! Problem: a fraction of a millisecond for several hundred visits. Sources: the sweep of Gillett and Miller, Operations
//! Research 1974, for the sectors; strips, Beardwood, Halton and Hammersley, Proc. Cambridge Philosophical Society 1959,
//! for the tours; the smoothing is that of [`super::smooth`]. Changed:
//! - Strips lie along the rows of the farm's grid, two in each, wherever it points to. On such a strip a tour goes
//!   from a visit to one beside it nearly always; a space-filling curve cuts rows and sectors anywhere.
//! - Sectors are balanced by the cost of their tours: once before smoothing, and then by visits at the borders that go to
//!   the next sector, to the cheapest place there.
//!
//! O(n log n) for n visits; after the sorting everything is O(n), and stops when the time is over.

use super::network::Network;
use super::order::{ends_by_cost, pseudo_angle};
use super::smooth::{Coordinates, Path, Rows};
use crate::effort::Budget;
use crate::geometry::{Point, cross, dot};

/// Visits that the pitch and the direction of the grid are taken from.
const NUM_SAMPLES: usize = 9;
/// Rows of the grid in a strip.
const ROWS_PER_STRIP: f32 = 2.0;
/// Rows in a strip of visits without a grid: √3 mean distances, the best width for random visits, are 3.7 times their median
/// nearest distance.
const ROWS_WITHOUT_GRID: f32 = 4.0;
/// Upper to lower quartile of the nearest distances, squared, from which there is no grid: 1 on a grid, 4.8 at random.
const MIN_SPREAD_WITHOUT_GRID: f64 = 2.0;
/// Rows and columns from one visit to the farthest, at most. A pitch that asks for more is that of a few close visits.
const MAX_ROWS: f64 = 16_384.0;
/// Steps per pitch in which visits along a strip are told apart.
const STEPS_PER_PITCH: f32 = 8.0;
/// Steps of [`pseudo_angle`] in which visits are told apart.
const STEPS_PER_QUADRANT: f64 = (1u32 << 30) as f64;
/// What moving visits must save where they are, in pitches. Cutting a corner of a grid saves 0.586 and brings nothing:
/// anywhere else they cost as much.
const MIN_SAVING: f32 = 0.6;
/// Visits that cross a border in one balancing, at most: keeps it O(n).
const MAX_CROSSINGS: usize = 64;
/// Balancings after each smoothing: as borders move by the mean cost of a visit, which the legs to the depot are part of, one
/// moves them too little.
const NUM_BALANCINGS: usize = 2;
/// What counts as shorter, relative to the longest route: above rounding.
const MIN_GAIN: f64 = 1e-12;
/// Visits that are smoothed and balanced once, though the time be over: that takes a tenth of a millisecond.
const MAX_SMALL: usize = 1000;
/// Visits that are moved in one piece, at most.
const MAX_PIECE: usize = 3;

/// Routes in the making, one for each sector around the depot.
pub(super) struct RoughPlan<'a> {
    network: &'a Network,
    places: Coordinates,
    /// Sorted by angle around the depot; the first follows the widest gap.
    visits: Vec<u32>,
    /// Ends of the sectors in `visits`, beginning with 0.
    ends: Vec<usize>,
    paths: Vec<Path>,
    rows: Rows,
    best: Best,
}

/// The routes with the cheapest longest one so far.
struct Best {
    longest: f64,
    routes: Vec<Vec<u32>>,
}

impl<'a> RoughPlan<'a> {
    /// Sectors toured along strips: the cheaper of the two directions of the grid, begun at the cheaper end. If the time is over
    /// before, there is one direction.
    pub fn new(network: &'a Network, budget: &Budget<'_>) -> Self {
        let (places, rows_per_strip) = places_on_grid(network);
        let visits = visits_by_angle(network);
        let mut strips = vec![Strips::new(&places.xs, &places.ys, rows_per_strip)];
        if visits.len() <= MAX_SMALL || !budget.is_time_over() {
            strips.push(Strips::new(&places.ys, &places.xs, rows_per_strip));
        }
        let shares = vec![1.0; network.num_routes];
        let ends = ends_by_cost(&[0, visits.len()], &[1.0], &shares);
        let lengths: Vec<f64> = strips[0]
            .tours(&sectors_of(&visits, &ends), &ends)
            .iter()
            .map(|tour| f64::from(places.tour_length(tour)))
            .collect();
        let ends = ends_by_cost(&ends, &lengths, &shares);
        let sector_of = sectors_of(&visits, &ends);
        let mut tours: Vec<Vec<Vec<u32>>> = strips.iter().map(|strips| strips.tours(&sector_of, &ends)).collect();
        let cheapest = |sector: usize| {
            let mut best = (f32::INFINITY, 0);
            for (direction, tours) in tours.iter().enumerate() {
                let length = places.tour_length(&tours[sector]);
                if length < best.0 {
                    best = (length, direction);
                }
            }
            let (length, direction) = best;
            let mut tour = std::mem::take(&mut tours[direction][sector]);
            strips[direction].turn_runs(&mut tour, 0, 1);
            if places.tour_length(&tour) > length {
                strips[direction].turn_runs(&mut tour, 0, 1);
            }
            Path::new(&places, &tour)
        };
        let paths = (0..ends.len() - 1).map(cheapest).collect();
        let best = Best { longest: f64::INFINITY, routes: Vec::new() };
        Self { network, visits, ends, paths, places, rows: Rows::default(), best }
    }

    /// Smooths and balances until that helps no more or the time is over, small farms at least a little; the best routes on the
    /// way.
    pub fn improved(mut self, budget: &Budget<'_>) -> Vec<Vec<u32>> {
        let unlimited = Budget::new(None, None, None);
        let is_small = self.visits.len() <= MAX_SMALL;
        let mut num_idle = 0;
        for (round, piece) in (1..=MAX_PIECE).cycle().enumerate() {
            let longest = self.best.longest;
            let least = if round == 0 && is_small { &unlimited } else { budget };
            for path in &mut self.paths {
                path.or_opt(self.network, least, piece, MIN_SAVING, &mut self.rows);
            }
            for path in &mut self.paths {
                if budget.is_time_over() {
                    break;
                }
                path.two_opt(self.network, budget, &mut self.rows);
            }
            let mut costs = self.keep_best();
            for _ in 0..NUM_BALANCINGS {
                if least.is_time_over() {
                    break;
                }
                self.balance(&costs);
                costs = self.keep_best();
            }
            num_idle = if self.best.longest < longest * (1.0 - MIN_GAIN) { 0 } else { num_idle + 1 };
            if budget.is_time_over() || num_idle == MAX_PIECE {
                break;
            }
        }
        self.best.routes
    }

    /// The costs of the routes, which are kept if the longest is the cheapest so far.
    fn keep_best(&mut self) -> Vec<f64> {
        let costs: Vec<f64> = self.paths.iter().map(|path| self.network.route_cost(path.route())).collect();
        let longest = costs.iter().copied().fold(0.0, f64::max);
        if longest < self.best.longest || self.best.routes.is_empty() {
            self.best = Best { longest, routes: self.paths.iter().map(|path| path.route().to_vec()).collect() };
        }
        costs
    }

    /// Moves the borders of the sectors to where each would have the same cost, and visits with them.
    fn balance(&mut self, costs: &[f64]) {
        let mut ends = ends_by_cost(&self.ends, costs, &vec![1.0; costs.len()]);
        for (end, &old) in ends.iter_mut().zip(&self.ends) {
            *end = (*end).clamp(old.saturating_sub(MAX_CROSSINGS), old + MAX_CROSSINGS);
        }
        let sector_of = sectors_of(&self.visits, &ends);
        for (sector, path) in (0..).zip(&mut self.paths) {
            path.retain(|visit| sector_of[visit as usize] == sector);
        }
        for (&end, &old) in ends.iter().zip(&self.ends) {
            for &visit in &self.visits[end.min(old)..end.max(old)] {
                let path = &mut self.paths[sector_of[visit as usize] as usize];
                // Where borders leap over whole sectors, a visit is between two pairs of them.
                if !path.route().contains(&visit) {
                    path.insert(&self.places, visit, &mut self.rows);
                }
            }
        }
        self.ends = ends;
    }
}

/// Smooths routes without neighbour lists, each on its own, until that helps no more or the time is over.
pub(crate) fn smooth_routes(network: &Network, budget: &Budget<'_>, routes: &mut [Vec<u32>]) {
    let (places, _) = places_on_grid(network);
    let mut rows = Rows::default();
    let mut paths: Vec<(Path, f64)> = routes.iter().map(|route| (Path::new(&places, route), f64::INFINITY)).collect();
    let mut is_shorter = true;
    while is_shorter && !budget.is_time_over() {
        is_shorter = false;
        for (path, cost) in &mut paths {
            (1..=MAX_PIECE).for_each(|piece| path.or_opt(network, budget, piece, MIN_SAVING, &mut rows));
            path.two_opt(network, budget, &mut rows);
            let new_cost = network.route_cost(path.route());
            is_shorter |= new_cost < *cost * (1.0 - MIN_GAIN);
            *cost = new_cost;
        }
    }
    for (route, (path, _)) in routes.iter_mut().zip(&paths) {
        route.copy_from_slice(path.route());
    }
}

/// The sector of each visit.
fn sectors_of(visits: &[u32], ends: &[usize]) -> Vec<u32> {
    let mut sectors = vec![0; visits.len()];
    for (sector, range) in (0..).zip(ends.windows(2)) {
        for &visit in &visits[range[0]..range[1]] {
            sectors[visit as usize] = sector;
        }
    }
    sectors
}

fn visits_by_angle(network: &Network) -> Vec<u32> {
    let depot = network.depot();
    let step_of = |point: &Point| (pseudo_angle(point.x - depot.x, point.y - depot.y) * STEPS_PER_QUADRANT) as u32;
    let points = &network.points[..network.num_visits];
    let mut keys: Vec<u64> = points.iter().zip(0..).map(|(point, visit)| key(step_of(point), visit)).collect();
    keys.sort_unstable();
    let step = |place: usize| keys[place] >> 32;
    let last = keys.len() - 1;
    let full_turn = (4.0 * STEPS_PER_QUADRANT) as u64;
    let mut widest = (step(0) + full_turn - step(last), 0);
    for place in 1..keys.len() {
        widest = widest.max((step(place) - step(place - 1), place));
    }
    keys.rotate_left(widest.1);
    keys.into_iter().map(|key| key as u32).collect()
}

/// Sorts by `step`, then by `visit`; its lower half is the visit.
fn key(step: u32, visit: u32) -> u64 {
    u64::from(step) << 32 | u64::from(visit)
}

/// All visits and the depot, in pitches along the rows of the grid and across them; and the rows that a strip should have.
///
/// The pitch is the median distance from a sampled visit to the nearest in another place, the rows point from that visit to
/// its neighbour. Visits without a grid have rows as well, to no harm.
fn places_on_grid(network: &Network) -> (Coordinates, f32) {
    let visits = &network.points[..network.num_visits];
    let num_samples = visits.len().min(NUM_SAMPLES);
    let sample = |index: usize| visits[index * visits.len() / num_samples];
    let mut squares: Vec<(f64, usize)> =
        (0..num_samples).map(|index| (nearest_square(sample(index), visits), index)).collect();
    squares.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let (square, index) = squares[num_samples / 2];
    let origin = sample(index);
    let pitch = square.sqrt();
    let row = visits.iter().map(|&visit| visit - origin).find(|&offset| dot(offset, offset) == square);
    let row = row.map_or(Point::new(1.0, 0.0), |offset| Point::new(offset.x / pitch, offset.y / pitch));
    let reach = visits.iter().map(|visit| visit.distance(origin)).fold(0.0, f64::max);
    let unit = if reach > 0.0 { pitch.min(reach).max(reach * 2.0 / MAX_ROWS) } else { 1.0 };
    let place = |point: &Point| {
        let offset = *point - origin;
        ((dot(offset, row) / unit) as f32, (cross(Point::default(), row, offset) / unit) as f32)
    };
    let (xs, ys) = network.points[..=network.num_visits].iter().map(place).unzip();
    let spread = squares[3 * num_samples / 4].0 / squares[num_samples / 4].0;
    let rows_per_strip = if spread < MIN_SPREAD_WITHOUT_GRID { ROWS_PER_STRIP } else { ROWS_WITHOUT_GRID };
    (Coordinates { xs, ys }, rows_per_strip)
}

/// Squared distance from a place to the nearest point in another place; infinite if there is none.
fn nearest_square(place: Point, points: &[Point]) -> f64 {
    // Four at once, each on its own.
    let mut nearest = [f64::INFINITY; 4];
    for chunk in points.chunks(nearest.len()) {
        for (nearest, &point) in nearest.iter_mut().zip(chunk) {
            let offset = point - place;
            let square = dot(offset, offset);
            let square = if square > 0.0 { square } else { f64::INFINITY };
            *nearest = if square < *nearest { square } else { *nearest };
        }
    }
    nearest.into_iter().fold(f64::INFINITY, f64::min)
}

/// The visits along strips of the farm.
struct Strips {
    /// Strip by strip, in each in the same direction.
    visits: Vec<u32>,
    /// The strip of each visit.
    strips: Vec<u32>,
}

impl Strips {
    fn new(along: &[f32], across: &[f32], rows_per_strip: f32) -> Self {
        let num_visits = along.len() - 1;
        let (along, across) = (&along[..num_visits], &across[..num_visits]);
        let lowest = |values: &[f32]| values.iter().copied().fold(f32::INFINITY, f32::min);
        let (first, lowest_row) = (lowest(along), lowest(across));
        let strips: Vec<u32> = across.iter().map(|row| ((row - lowest_row + 0.5) / rows_per_strip) as u32).collect();
        let step_of = |place: f32| ((place - first) * STEPS_PER_PITCH) as u32;
        let mut keys: Vec<u64> = (0..)
            .zip(along)
            .zip(&strips)
            .map(|((visit, &place), &strip)| key(strip << STRIP_SHIFT | step_of(place), visit))
            .collect();
        keys.sort_unstable();
        Self { visits: keys.into_iter().map(|key| key as u32).collect(), strips }
    }

    /// A tour of each sector: to and fro along its strips.
    fn tours(&self, sectors: &[u32], ends: &[usize]) -> Vec<Vec<u32>> {
        let mut tours: Vec<Vec<u32>> = ends.windows(2).map(|range| Vec::with_capacity(range[1] - range[0])).collect();
        for &visit in &self.visits {
            tours[sectors[visit as usize] as usize].push(visit);
        }
        tours.iter_mut().for_each(|tour| self.turn_runs(tour, 1, 2));
        tours
    }

    /// Turns round what lies on each strip, from strip number `first` on every `step`-th.
    fn turn_runs(&self, tour: &mut [u32], first: usize, step: usize) {
        let is_same = |one: &u32, other: &u32| self.strips[*one as usize] == self.strips[*other as usize];
        tour.chunk_by_mut(is_same).skip(first).step_by(step).for_each(<[u32]>::reverse);
    }
}

/// Where the strip is in a sort key: above the steps of [`MAX_ROWS`].
const STRIP_SHIFT: u32 = 18;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Variant, generate};
    use crate::problem::{Depot, Problem, VehicleType, Visit};
    use proptest::prelude::*;

    fn network(depot: Point, ponds: &[Point], num_routes: usize) -> Network {
        Network::new(&Problem::research(depot, ponds, num_routes).unwrap())
    }

    fn longest(network: &Network, routes: &[Vec<u32>]) -> f64 {
        routes.iter().map(|route| network.route_cost(route)).fold(0.0, f64::max)
    }

    fn routes_of(plan: &RoughPlan<'_>) -> Vec<Vec<u32>> {
        plan.paths.iter().map(|path| path.route().to_vec()).collect()
    }

    fn is_partition(routes: &[Vec<u32>], num_visits: usize) -> bool {
        let mut visits = routes.concat();
        visits.sort_unstable();
        visits.into_iter().eq(0..num_visits as u32)
    }

    /// A rectangle of ponds, turned so that its sides have slope 3/4.
    fn turned_grid(num_columns: usize, num_rows: usize) -> Vec<Point> {
        let places = (0..num_columns).flat_map(|column| (0..num_rows).map(move |row| (column as f64, row as f64)));
        places.map(|(x, y)| Point::new(4.0 * x - 3.0 * y, 3.0 * x + 4.0 * y)).collect()
    }

    #[test]
    fn the_grid_is_found_whichever_way_it_points() {
        let ponds = turned_grid(7, 5);
        let (places, rows_per_strip) = places_on_grid(&network(Point::default(), &ponds, 1));
        assert_eq!(rows_per_strip, ROWS_PER_STRIP);
        let is_whole = |value: &f32| (value - value.round()).abs() < 1e-5;
        assert!(places.xs.iter().chain(&places.ys).all(is_whole), "{:?} {:?}", places.xs, places.ys);
    }

    #[test]
    fn a_strip_of_two_rows_is_toured_without_a_detour() {
        let network = network(Point::new(-3.0, -4.0), &turned_grid(12, 2), 1);
        let routes = RoughPlan::new(&network, &Budget::new(None, None, None)).improved(&Budget::new(None, None, None));
        // 23 legs of one pitch, and one from the depot and back each.
        let bound = 23.0 * 5.0 + 2.0 * network.depot_legs.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(longest(&network, &routes) <= 1.05 * bound);
    }

    #[test]
    fn smoothing_and_balancing_pay() {
        for seed in 1..6 {
            let farm = generate(300, Variant::Authors, seed).unwrap();
            let network = network(farm.depot, &farm.ponds, 5);
            let plan = RoughPlan::new(&network, &Budget::new(None, None, None));
            let strips = longest(&network, &routes_of(&plan));
            let out_of_time = || 1.0;
            let hasty = plan.improved(&Budget::new(None, Some(&out_of_time), None));
            let patient =
                RoughPlan::new(&network, &Budget::new(None, None, None)).improved(&Budget::new(None, None, None));
            let [hasty, patient] = [hasty, patient].map(|routes| longest(&network, &routes));
            assert!(hasty < 0.95 * strips && patient < 0.95 * hasty, "{strips} {hasty} {patient}");
        }
    }

    #[test]
    fn balancing_evens_out_what_service_makes_uneven() {
        // All the service is in the east.
        let visits = turned_grid(20, 10).into_iter().map(|position| Visit {
            service_duration: if position.x > 30.0 { 30.0 } else { 0.0 },
            ..Visit::at(position)
        });
        let depot = Depot { position: Point::new(30.0, 0.0) };
        let network = Network::new(&Problem::new(depot, visits.collect(), VehicleType::unlimited(4)).unwrap());
        let plan = RoughPlan::new(&network, &Budget::new(None, None, None));
        let before = longest(&network, &routes_of(&plan));
        let routes = plan.improved(&Budget::new(None, None, None));
        let mean = routes.iter().map(|route| network.route_cost(route)).sum::<f64>() / 4.0;
        assert!(longest(&network, &routes) < 0.7 * before);
        assert!(longest(&network, &routes) < 1.1 * mean);
    }

    #[test]
    fn ponds_at_hopeless_distances_still_get_a_plan() {
        let near: Vec<Point> = (0..40).map(|index| Point::new(f64::from(index) * 1e-12, 0.0)).collect();
        let mixed: Vec<Point> = near.iter().copied().chain([Point::new(1e9, 1e9), Point::new(-1e9, 3e8)]).collect();
        for (ponds, depot) in
            [(&near, Point::new(1e9, 0.0)), (&mixed, Point::default()), (&mixed, Point::new(1e9, 0.0))]
        {
            let network = network(depot, ponds, 3);
            let routes =
                RoughPlan::new(&network, &Budget::new(None, None, None)).improved(&Budget::new(None, None, None));
            assert!(is_partition(&routes, ponds.len()));
        }
    }

    proptest! {
        #[test]
        fn every_visit_once_and_never_worse(
            places in prop_oneof![
                prop::collection::vec((-3.0..3.0f64, -3.0..3.0f64), 1..90),
                prop::collection::vec((0..4u8, 0..3u8).prop_map(|(x, y)| (x.into(), y.into())), 1..90),
                prop::collection::vec((-5.0..5.0f64, Just(1.0)), 1..50),
                prop::collection::vec(Just((2.0, 1.0)), 1..20),
            ],
            num_routes in 1..12usize, num_looks in 0..6u32,
        ) {
            let ponds: Vec<Point> = places.iter().map(|&(x, y)| Point::new(x, y)).collect();
            let network = network(Point::new(1.0, 1.0), &ponds, num_routes);
            let plan = RoughPlan::new(&network, &Budget::new(None, None, None));
            let before = routes_of(&plan);
            prop_assert!(is_partition(&before, ponds.len()));
            let looks = std::sync::atomic::AtomicU32::new(0);
            let clock = || f64::from(looks.fetch_add(1, std::sync::atomic::Ordering::Relaxed)) / f64::from(num_looks);
            let routes = plan.improved(&Budget::new(None, Some(&clock), None));
            prop_assert!(is_partition(&routes, ponds.len()) && routes.len() <= num_routes);
            prop_assert!(longest(&network, &routes) <= longest(&network, &before) * (1.0 + 1e-9));
        }
    }
}
