//! HPP, the HAUCS path planning algorithm: the paper's planner, step for step.
//!
//! Problem: fly back and forth over each drone's own part of the farm. Source: Davis, Mukherjee, Wills and Ouyang, Path
//! planning algorithms for robotic aquaculture monitoring (the paper), section 3; what the text leaves open is settled
//! by its authors' MATLAB code. The sweep of a convex polygon is that of Vasquez-Gomez, Marciano-Melchor, Valentin and
//! Herrera-Lozada, Coverage path planning for 2D convex regions, J. Intell. Robot. Syst. 2020 (doi
//! 10.1007/s10846-019-01024-y), which the paper reaches through Mukherjee's Optimal Coverage Algorithm. The steps:
//!
//! 1. `cluster`: k-means; a cluster that is no polygon is repaired.
//! 2. [`convex_hull_within`] of each cluster.
//! 3. [`ClosedPolygon::caliper_pairs`]: pairs of hull corners.
//! 4. [`ClosedPolygon::sweep_of_pair`], [`Sweeper::path`]: a back-and-forth path for each pair.
//! 5. [`cheapest_path`]: the cheapest of them, from the depot and back.
//! 6. [`order_along`]: the ponds in the order in which that path passes them.
//!
//! Complexity: O(n k) per k-means iteration, then per cluster of n ponds O(n log n + h (h + l)) for steps 2 to 5 and about
//! O(n) for step 6, with h corners of the hull and l sweep lines, about the root of n.
//!
//! Quirks of the code that decide the routes are kept: a closed counter-clockwise hull goes to a routine for open clockwise
//! ones ([`ClosedPolygon::caliper_pairs`]), and a leg parallel to an axis costs nothing (`flight_duration`). Changed:
//! - No pond is lost or visited twice. The code takes the ponds inside each hull, which misses those on slanted sides and
//!   takes some of other clusters; here the ponds of a cluster are those that k-means and the repair give it.
//! - Rounding decides nothing. In the code it decides whether a line meets the side it runs along and which legs are
//!   parallel to an axis; here a [`Tolerance`] of 1e-9 of the farm's side does. With [`Tolerance::EXACT`], steps 3 to 6
//!   follow the code to the last bit, but for the sum of turns (`Turned`).
//! - Nothing depends on units. The code has a unit square of 1000 units, 10 units/s and π/4 rad/s, so that a radian of turn
//!   costs as much as 1.27 % of the square's side. Here the longer side of the box around the ponds is 1000 units, which is
//!   0.5 to 0.95 of the unit square's side on the paper's farms (median 0.79). The pitch is not given but measured (`pitch`); on the paper's
//!   farms it is the same.

use crate::direction::fly_cheaper_way;
use crate::geometry::{Point, convex_hull_within, cross, dot, extent};
use crate::kmeans::{Clustering, kmeans};
use crate::problem::Problem;
use crate::random::Random;
use crate::sweep::{ClosedPolygon, Frame, Sweeper, Tolerance};
use std::f64::consts::{FRAC_PI_4, PI};

/// Ponds that make a polygon; a cluster with fewer takes ponds of its neighbours (paper, section 3).
const MIN_CLUSTER_SIZE: usize = 3;
/// The farm's side in the units of the method: the authors multiply the coordinates of their unit square by 1000.
const SIDE: f64 = 1000.0;
/// Ground speed in units per second.
const SPEED: f64 = 10.0;
/// Turn rate in radians per second.
const TURN_RATE: f64 = FRAC_PI_4;
/// Ponds whose nearest neighbours the pitch is taken from.
const MAX_PITCH_SAMPLE: usize = 32;

/// Corners of a sweep that there is room for from the start.
const MAX_USUAL_CORNERS: usize = 32;
/// Ponds that a strip holds on average at least: with fewer, looking at the strips costs more than it saves.
const MIN_PONDS_PER_STRIP: usize = 12;

/// What HPP did, for figures and for study.
#[derive(Clone, Debug, PartialEq)]
pub struct HppPlan {
    /// Distance between sweep lines, in the units of the problem; 0 where all ponds coincide.
    pub pitch: f64,
    /// One per route: at most as many as there are drones.
    pub clusters: Vec<Cluster>,
}

/// One drone's part of the farm.
#[derive(Clone, Debug, PartialEq)]
pub struct Cluster {
    /// The ponds, in flying order.
    pub route: Vec<usize>,
    /// The ponds at the corners of the convex hull, counter-clockwise; two where all lie on a line, one where they coincide.
    pub hull: Vec<usize>,
    /// Corners of the back-and-forth path that the route follows, without the depot.
    pub path: Vec<Point>,
}

/// The routes of HPP: pond indices in flying order, every pond exactly once, at most one route per drone, none empty.
///
/// Deterministic by `seed`, which starts the clustering.
#[must_use]
pub fn plan(problem: &Problem, seed: u64) -> Vec<Vec<usize>> {
    plan_clusters(problem, seed).clusters.into_iter().map(|cluster| cluster.route).collect()
}

/// [`plan`], with the hull and the sweep path of each route.
#[must_use]
pub fn plan_clusters(problem: &Problem, seed: u64) -> HppPlan {
    // Reckoned from one of the ponds, coordinates keep the digits that tell ponds apart wherever the farm lies.
    let origin = problem.visits()[0].position;
    let side = extent(problem.visits().iter().map(|visit| visit.position - origin));
    let unit = if side > 0.0 { side / SIDE } else { 1.0 };
    let enter = |position: Point| Point::new((position.x - origin.x) / unit, (position.y - origin.y) / unit);
    let leave = |point: Point| Point::new(origin.x + unit * point.x, origin.y + unit * point.y);
    let ponds: Vec<Point> = problem.visits().iter().map(|visit| enter(visit.position)).collect();
    let depot = enter(problem.depot().position);
    let tolerance = Tolerance::of_side(SIDE);
    let pitch = pitch(&ponds);
    let clusters = cluster(&ponds, problem.vehicle_type().num_available, tolerance, &mut Random::new(seed))
        .into_iter()
        .map(|members| {
            let own: Vec<Point> = members.iter().map(|&pond| ponds[pond]).collect();
            let corners = convex_hull_within(&own, tolerance.length);
            let hull: Vec<Point> = corners.iter().map(|&corner| own[corner]).collect();
            let path = cheapest_path(&hull, depot, pitch, tolerance);
            let order = order_along(&path, &own, pitch, tolerance);
            let global =
                |indices: Vec<usize>| -> Vec<usize> { indices.into_iter().map(|index| members[index]).collect() };
            let mut route = global(order);
            fly_cheaper_way(problem, &mut route);
            Cluster { route, hull: global(corners), path: path.corners.into_iter().map(leave).collect() }
        })
        .collect();
    HppPlan { pitch: pitch * unit, clusters }
}

/// The pitch of a farm, the distance between sweep lines: the median distance from a pond to the nearest in another place,
/// over at most 32 ponds spread evenly through the input; 0 where all ponds coincide.
///
/// On the paper's farms, grids with about a third of the points deleted, it is the spacing of the grid: of such points 98 %
/// have a neighbour next to them.
fn pitch(ponds: &[Point]) -> f64 {
    let num_sampled = ponds.len().min(MAX_PITCH_SAMPLE);
    let mut sorted = ponds.to_vec();
    sorted.sort_unstable_by(|one, other| one.x.total_cmp(&other.x));
    let mut squares: Vec<f64> =
        (0..num_sampled).map(|sample| nearest_square(&sorted, ponds[sample * ponds.len() / num_sampled])).collect();
    let (_, median, _) = squares.select_nth_unstable_by(num_sampled / 2, f64::total_cmp);
    if median.is_finite() { median.sqrt() } else { 0.0 }
}

/// The squared distance to the nearest pond in another place; infinite if there is none. `sorted` is so by x.
fn nearest_square(sorted: &[Point], place: Point) -> f64 {
    let (west, east) = sorted.split_at(sorted.partition_point(|pond| pond.x < place.x));
    let mut nearest = f64::INFINITY;
    let mut is_farther_on = |pond: &Point| {
        let offset = *pond - place;
        if offset.x * offset.x >= nearest {
            return true;
        }
        let square = dot(offset, offset);
        if 0.0 < square && square < nearest {
            nearest = square;
        }
        false
    };
    // Both stop where the first coordinate alone is too far away.
    let _ = east.iter().any(&mut is_farther_on);
    let _ = west.iter().rev().any(&mut is_farther_on);
    nearest
}

/// Step 1: the cluster of each pond, by k-means on the ponds alone (paper, section 3: "clustering is accomplished using
/// k-means on the entire node set").
///
/// A cluster too small or too flat to form a polygon takes the nearest ponds of its neighbours (same section), as long as
/// the neighbour keeps a polygon of its own: with fewer than three ponds a drone, some clusters stay small.
fn cluster(ponds: &[Point], num_clusters: usize, tolerance: Tolerance, random: &mut Random) -> Vec<Vec<usize>> {
    let Clustering { mut labels, centroids } = kmeans(ponds, num_clusters, random);
    let mut members = members_of(&labels, centroids.len());
    for (label, &centroid) in centroids.iter().enumerate() {
        while !is_polygon(ponds, &members[label], tolerance)
            && let Some(taken) = pond_to_take(ponds, &labels, &members, label, centroid, tolerance)
        {
            labels[taken] = label;
            members = members_of(&labels, centroids.len());
        }
    }
    members.retain(|members| !members.is_empty());
    members
}

/// The ponds of each cluster, in input order.
fn members_of(labels: &[usize], num_clusters: usize) -> Vec<Vec<usize>> {
    let mut members: Vec<Vec<usize>> =
        (0..num_clusters).map(|_| Vec::with_capacity(2 * labels.len() / num_clusters)).collect();
    for (pond, &label) in labels.iter().enumerate() {
        members[label].push(pond);
    }
    members
}

/// Whether the ponds of a cluster span a polygon: at least three that do not lie on a line.
fn is_polygon(ponds: &[Point], members: &[usize], tolerance: Tolerance) -> bool {
    if members.len() < MIN_CLUSTER_SIZE {
        return false;
    }
    // Nearly always one of the ponds makes a triangle with the first two.
    let (first, second) = (ponds[members[0]], ponds[members[1]]);
    let makes_triangle = |&pond: &usize| {
        let third = ponds[pond];
        let longest_side = first.distance(second).max(first.distance(third)).max(second.distance(third));
        cross(first, second, third).abs() > 2.0 * tolerance.length * longest_side
    };
    if members[2..].iter().any(makes_triangle) {
        return true;
    }
    let positions: Vec<Point> = members.iter().map(|&pond| ponds[pond]).collect();
    convex_hull_within(&positions, tolerance.length).len() > 2
}

/// The pond nearest to the centroid of a cluster that is no polygon, of those that help and that their cluster can spare.
fn pond_to_take(
    ponds: &[Point],
    labels: &[usize],
    members: &[Vec<usize>],
    label: usize,
    centroid: Point,
    tolerance: Tolerance,
) -> Option<usize> {
    let own = &members[label];
    let helps =
        |pond: usize| own.len() < MIN_CLUSTER_SIZE || is_polygon(ponds, &[own.as_slice(), &[pond]].concat(), tolerance);
    let can_be_spared = |pond: usize| {
        let donor = &members[labels[pond]];
        let rest: Vec<usize> = donor.iter().copied().filter(|&other| other != pond).collect();
        rest.len() >= MIN_CLUSTER_SIZE && (is_polygon(ponds, &rest, tolerance) || !is_polygon(ponds, donor, tolerance))
    };
    let mut others: Vec<usize> = (0..ponds.len()).filter(|&pond| labels[pond] != label).collect();
    others.sort_by(|&a, &b| ponds[a].distance(centroid).total_cmp(&ponds[b].distance(centroid)));
    others.into_iter().find(|&pond| helps(pond) && can_be_spared(pond))
}

/// Step 5: the seconds from the depot along the corners and back: all legs, and all turns between a start and an end that
/// head east (Vasquez-Gomez et al.: the time cost of a path).
///
/// Quirk kept: a corner that differs from the drone's position in only one coordinate is passed over, so that legs parallel
/// to an axis cost nothing, and the next leg is reckoned from where the drone was before.
///
/// Infinite as soon as it is certain to exceed `limit`.
fn flight_duration(depot: Point, corners: impl Iterator<Item = Point>, tolerance: Tolerance, limit: f64) -> f64 {
    let east = Point::new(1.0, 0.0);
    let (mut position, mut direction) = (depot, east);
    let (mut turned, mut length) = (Turned::default(), 0.0);
    let limit_length = limit * SPEED * (1.0 + 1e-12);
    for corner in corners.chain([depot]) {
        let leg = corner - position;
        if leg.x.abs() > tolerance.length && leg.y.abs() > tolerance.length {
            let leg_length = dot(leg, leg).sqrt();
            let heading = Point::new(leg.x / leg_length, leg.y / leg_length);
            turned.add(direction, heading);
            length += leg_length;
            if turned.half_turns * (PI * SPEED / TURN_RATE) + length > limit_length {
                return f64::INFINITY;
            }
            (position, direction) = (corner, heading);
        }
    }
    turned.add(direction, east);
    turned.angle() / TURN_RATE + length / SPEED
}

/// A sum of angles in [0, π], without a trigonometric function for each: whole half turns, and the direction of the product
/// of unit complex numbers in the upper half plane.
struct Turned {
    half_turns: f64,
    rest: Point,
}

impl Default for Turned {
    fn default() -> Self {
        Self { half_turns: 0.0, rest: Point::new(1.0, 0.0) }
    }
}

impl Turned {
    /// Adds the angle between two directions of unit length.
    fn add(&mut self, from: Point, to: Point) {
        let (cosine, sine) = (dot(from, to), cross(Point::default(), from, to).abs());
        // Nearly all turns of a sweep are right angles.
        if cosine.abs() <= 1e-9 {
            self.half_turns += 0.5;
            return;
        }
        let (x, y) = (self.rest.x * cosine - self.rest.y * sine, self.rest.x * sine + self.rest.y * cosine);
        let is_beyond = y < 0.0 || (y == 0.0 && x < 0.0);
        self.half_turns += f64::from(u8::from(is_beyond));
        self.rest = if is_beyond { Point::new(-x, -y) } else { Point::new(x, y) };
    }

    fn angle(&self) -> f64 {
        self.half_turns * PI + self.rest.y.atan2(self.rest.x)
    }
}

/// A back-and-forth path and the frame in which its legs are vertical and horizontal.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepPath {
    /// The frame.
    pub frame: Frame,
    /// The corners in the frame of the farm.
    pub corners: Vec<Point>,
}

/// Steps 3 to 5: the cheapest back-and-forth path over a hull, tried for every pair of [`ClosedPolygon::caliper_pairs`]
/// in both directions.
///
/// `hull` is as [`convex_hull_within`] gives it. A hull without area is its own path: from end to end.
#[must_use]
pub fn cheapest_path(hull: &[Point], depot: Point, pitch: f64, tolerance: Tolerance) -> SweepPath {
    let polygon = ClosedPolygon::new(hull, tolerance);
    let pairs = if hull.len() < 3 { Vec::new() } else { polygon.caliper_pairs() };
    let mut best = SweepPath { frame: Frame::UNTURNED, corners: hull.to_vec() };
    let mut best_duration = f64::INFINITY;
    let mut tried = Vec::with_capacity(pairs.len());
    let mut sweeper = Sweeper::new(hull.len(), pitch, tolerance);
    let mut local = Vec::with_capacity(hull.len());
    let (mut path, mut corners) = (Vec::with_capacity(MAX_USUAL_CORNERS), Vec::with_capacity(MAX_USUAL_CORNERS));
    for pair in pairs {
        let sweep = polygon.sweep_of_pair(pair);
        if tried.contains(&sweep) {
            continue;
        }
        tried.push(sweep);
        let frame = polygon.frame(sweep);
        local.clear();
        local.extend(hull.iter().map(|&corner| frame.enter(corner)));
        sweeper.path(&local, sweep.starts_up, &mut path);
        corners.clear();
        corners.extend(path.iter().map(|&corner| frame.leave(corner)));
        let forward = flight_duration(depot, corners.iter().copied(), tolerance, best_duration);
        let backward = flight_duration(depot, corners.iter().rev().copied(), tolerance, forward.min(best_duration));
        // Sums of the same terms in different order: equal ones differ by rounding.
        let is_forward = forward < backward - tolerance.length;
        let duration = if is_forward { forward } else { backward };
        if duration < best_duration - tolerance.length {
            best_duration = duration;
            if !is_forward {
                corners.reverse();
            }
            best.frame = frame;
            std::mem::swap(&mut best.corners, &mut corners);
        }
    }
    best
}

/// Step 6: the order in which a path passes the ponds, as indices into `ponds` (paper, section 3: "the route is then
/// assigned to follow the optimal back-and-forth pattern as closely as possible").
///
/// Each leg takes the ponds not yet taken that lie within half a pitch before its start and beyond its end and within √3/2
/// of a pitch to either side: sorted along the coordinate axis that is nearest to the leg's direction, equal ones in input
/// order; along the first axis, by the second coordinate too. Ponds that no leg takes come last, in input order.
#[must_use]
pub fn order_along(path: &SweepPath, ponds: &[Point], pitch: f64, tolerance: Tolerance) -> Vec<usize> {
    let mut order = Vec::with_capacity(ponds.len());
    let mut strips = Strips::new(ponds.iter().map(|&pond| path.frame.enter(pond)).zip(0..).collect(), pitch);
    let mut passed = Vec::with_capacity(ponds.len());
    let (margin_along, margin_across) =
        (pitch / 2.0 + tolerance.length, pitch * 3.0_f64.sqrt() / 2.0 + tolerance.length);
    for leg in path.corners.windows(2) {
        let direction = leg[1] - leg[0];
        if direction.x.abs() <= tolerance.length && direction.y.abs() <= tolerance.length {
            continue;
        }
        let (start, end) = (path.frame.enter(leg[0]), path.frame.enter(leg[1]));
        let is_vertical = (end.y - start.y).abs() > (end.x - start.x).abs();
        let (margin_x, margin_y) =
            if is_vertical { (margin_across, margin_along) } else { (margin_along, margin_across) };
        let low = Point::new(start.x.min(end.x) - margin_x, start.y.min(end.y) - margin_y);
        let high = Point::new(start.x.max(end.x) + margin_x, start.y.max(end.y) + margin_y);
        passed.clear();
        strips.take(low, high, &mut passed);
        sort_along(direction, ponds, &mut passed, tolerance);
        order.extend(passed.iter().map(|&(.., pond)| pond));
    }
    order.extend(strips.into_rest());
    order
}

/// Ponds by the strip a pitch wide that they lie in, so that a leg looks at those near it only.
struct Strips {
    left: f64,
    strips_per_length: f64,
    /// In the order of the strips, and within a strip in that of the input.
    ponds: Vec<(Point, usize)>,
    /// Where each strip begins and ends in `ponds`.
    ranges: Vec<(usize, usize)>,
}

impl Strips {
    fn new(ponds: Vec<(Point, usize)>, pitch: f64) -> Self {
        let (left, right) = ponds
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(left, right), (pond, _)| (left.min(pond.x), right.max(pond.x)));
        let max_num_strips = ponds.len().div_ceil(MIN_PONDS_PER_STRIP);
        let width = pitch.max((right - left) / max_num_strips as f64);
        let strips_per_length = if width > 0.0 { 1.0 / width } else { 0.0 };
        let num_strips = ((right - left) * strips_per_length) as usize + 1;
        let mut strips = Self { left, strips_per_length, ranges: vec![(0, ponds.len()); num_strips], ponds };
        if num_strips > 1 {
            strips.sort();
        }
        strips
    }

    /// Counting sort: from input order to that of the strips.
    fn sort(&mut self) {
        self.ranges.fill((0, 0));
        for place in 0..self.ponds.len() {
            let strip = self.strip(self.ponds[place].0.x);
            self.ranges[strip].1 += 1;
        }
        let mut begin = 0;
        for range in &mut self.ranges {
            let end = begin + range.1;
            *range = (begin, begin);
            begin = end;
        }
        for pond in self.ponds.clone() {
            let strip = self.strip(pond.0.x);
            self.ponds[self.ranges[strip].1] = pond;
            self.ranges[strip].1 += 1;
        }
    }

    fn strip(&self, x: f64) -> usize {
        (((x - self.left) * self.strips_per_length) as usize).min(self.ranges.len() - 1)
    }

    /// Moves the ponds in an axis-parallel box to `passed`.
    fn take(&mut self, low: Point, high: Point, passed: &mut Vec<(f64, f64, usize)>) {
        for strip in self.strip(low.x)..=self.strip(high.x) {
            let (begin, end) = self.ranges[strip];
            let mut kept = begin;
            for place in begin..end {
                let (pond, index) = self.ponds[place];
                if (low.x <= pond.x) & (pond.x <= high.x) & (low.y <= pond.y) & (pond.y <= high.y) {
                    passed.push((0.0, 0.0, index));
                } else {
                    self.ponds[kept] = (pond, index);
                    kept += 1;
                }
            }
            self.ranges[strip].1 = kept;
        }
    }

    /// The ponds that were not taken, in input order.
    fn into_rest(self) -> Vec<usize> {
        let mut rest: Vec<usize> =
            self.ranges.iter().flat_map(|&(begin, end)| &self.ponds[begin..end]).map(|&(_, index)| index).collect();
        rest.sort_unstable();
        rest
    }
}

/// Sorts ponds along the coordinate axis nearest to a direction; of two equally near, the counter-clockwise one.
///
/// The two keys of each pond are overwritten.
fn sort_along(direction: Point, ponds: &[Point], passed: &mut [(f64, f64, usize)], tolerance: Tolerance) {
    let snap = |value: f64| if value.abs() <= tolerance.length { 0.0 } else { value };
    // Left of the diagonal that leads up, and above the one that leads down.
    let (left, above) = (snap(direction.y - direction.x), snap(direction.y + direction.x));
    let key: fn(Point) -> (f64, f64) = if left < 0.0 && above >= 0.0 {
        |pond| (pond.x, pond.y)
    } else if left >= 0.0 && above > 0.0 {
        |pond| (pond.y, 0.0)
    } else if left > 0.0 {
        |pond| (-pond.x, 0.0)
    } else {
        |pond| (-pond.y, 0.0)
    };
    for (first, second, pond) in passed.iter_mut() {
        (*first, *second) = key(ponds[*pond]);
    }
    // Farms often list ponds column by column: what is flown down is then sorted already.
    if left > 0.0 && above <= 0.0 || left <= 0.0 && above < 0.0 {
        passed.reverse();
    }
    passed.sort_unstable_by(|one, other| {
        one.0.total_cmp(&other.0).then_with(|| one.1.total_cmp(&other.1)).then_with(|| one.2.cmp(&other.2))
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_add_up_to_the_sum_of_their_angles() {
        // No turn, half turns, right angles on both sides of one, and angles whose sum passes two turns.
        let headings_deg = [0.0, 0.0, 180.0, 0.0, 90.0, 0.0, 30.0, 200.0, 10.0, 190.0, 10.0, -70.0, 45.0, -135.0, 44.0];
        let headings: Vec<Point> = headings_deg
            .iter()
            .map(|degrees: &f64| degrees.to_radians())
            .map(|angle| Point::new(angle.cos(), angle.sin()))
            .collect();
        let mut turned = Turned::default();
        let mut sum_deg = 0.0;
        for (place, legs) in headings.windows(2).enumerate() {
            turned.add(legs[0], legs[1]);
            let difference_deg = f64::abs(headings_deg[place + 1] - headings_deg[place]);
            sum_deg += f64::min(difference_deg, 360.0 - difference_deg);
            assert!((turned.angle().to_degrees() - sum_deg).abs() < 1e-9, "after turn {place}");
        }
    }
}
