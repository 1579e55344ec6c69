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
//! 4. [`ClosedPolygon::sweep_of_pair`], [`sweep_path`]: a back-and-forth path for each pair.
//! 5. [`cheapest_path`]: the cheapest of them, from the depot and back.
//! 6. [`order_along`]: the ponds in the order in which that path passes them.
//!
//! Complexity: O(n k) per k-means iteration, then per cluster of n ponds O(n log n + h² l) for steps 2 to 5 and O(n l) for
//! step 6, with h corners of the hull and l sweep lines, about the root of n.
//!
//! Quirks of the code that decide the routes are kept: a closed counter-clockwise hull goes to a routine for open clockwise
//! ones ([`ClosedPolygon::caliper_pairs`]), and a leg parallel to an axis costs nothing (`flight_duration`). Changed:
//! - No pond is lost or visited twice. The code takes the ponds inside each hull, which misses those on slanted sides and
//!   takes some of other clusters; here the ponds of a cluster are those that k-means and the repair give it.
//! - Rounding decides nothing. In the code it decides whether a line meets the side it runs along and which legs are
//!   parallel to an axis; here a [`Tolerance`] of 1e-9 of the farm's side does. With [`Tolerance::EXACT`], steps 3 to 6
//!   follow the code to the last bit.
//! - Nothing depends on units. The code has a unit square of 1000 units, 10 units/s and π/4 rad/s, so that a radian of turn
//!   costs as much as 1.27 % of the square's side. Here the longer side of the box around the ponds is 1000 units, which is
//!   0.5 to 0.95 of the unit square's side on the paper's farms (median 0.79). The pitch is not given but measured (`pitch`); on the paper's
//!   farms it is the same.

use crate::geometry::{Point, convex_hull_within, cross, dot, extent};
use crate::kmeans::{Clustering, kmeans};
use crate::problem::Problem;
use crate::random::Random;
use crate::sweep::{ClosedPolygon, Frame, Tolerance, sweep_path};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

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
            let global = |indices: Vec<usize>| indices.into_iter().map(|index| members[index]).collect();
            Cluster { route: global(order), hull: global(corners), path: path.corners.into_iter().map(leave).collect() }
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
    let mut squares: Vec<f64> =
        (0..num_sampled).map(|sample| nearest_square(ponds, ponds[sample * ponds.len() / num_sampled])).collect();
    let (_, median, _) = squares.select_nth_unstable_by(num_sampled / 2, f64::total_cmp);
    if median.is_finite() { median.sqrt() } else { 0.0 }
}

/// The squared distance to the nearest pond in another place; infinite if there is none.
fn nearest_square(ponds: &[Point], place: Point) -> f64 {
    // Four minima side by side, so that no comparison waits for the one before.
    let mut nearest = [f64::INFINITY; 4];
    for group in ponds.chunks(nearest.len()) {
        for (nearest, pond) in nearest.iter_mut().zip(group) {
            let offset = *pond - place;
            let square = dot(offset, offset);
            let square = if square > 0.0 { square } else { f64::INFINITY };
            *nearest = if square < *nearest { square } else { *nearest };
        }
    }
    nearest.into_iter().fold(f64::INFINITY, f64::min)
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
    let (mut turned, mut length) = (0.0, 0.0);
    let limit_length = limit * SPEED * (1.0 + 1e-12);
    for corner in corners.chain([depot]) {
        let leg = corner - position;
        if leg.x.abs() > tolerance.length && leg.y.abs() > tolerance.length {
            turned += turn(direction, leg);
            length += dot(leg, leg).sqrt();
            if turned * (SPEED / TURN_RATE) + length > limit_length {
                return f64::INFINITY;
            }
            (position, direction) = (corner, leg);
        }
    }
    (turned + turn(direction, east)) / TURN_RATE + length / SPEED
}

/// The angle between two directions, in [0, π].
fn turn(from: Point, to: Point) -> f64 {
    let (sine, cosine) = (cross(Point::default(), from, to).abs(), dot(from, to));
    // Nearly all turns of a sweep are right angles.
    if cosine.abs() <= 1e-9 * sine { FRAC_PI_2 } else { sine.atan2(cosine) }
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
    let (mut local, mut path, mut corners) = (Vec::new(), Vec::new(), Vec::new());
    for pair in pairs {
        let sweep = polygon.sweep_of_pair(pair);
        if tried.contains(&sweep) {
            continue;
        }
        tried.push(sweep);
        let frame = polygon.frame(sweep);
        local.clear();
        local.extend(hull.iter().map(|&corner| frame.enter(corner)));
        sweep_path(&local, pitch, sweep.starts_up, tolerance, &mut path);
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
    let mut order = vec![0; ponds.len()];
    let mut num_ordered = 0;
    let mut remaining: Vec<(usize, Point)> = ponds.iter().map(|&pond| path.frame.enter(pond)).enumerate().collect();
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
        let (left, right) = (start.x.min(end.x) - margin_x, start.x.max(end.x) + margin_x);
        let (bottom, top) = (start.y.min(end.y) - margin_y, start.y.max(end.y) + margin_y);
        let first = num_ordered;
        let mut num_kept = 0;
        // Both are written and one is counted: which of the two it is cannot be predicted.
        for place in 0..remaining.len() {
            let (index, pond) = remaining[place];
            let is_passed = (left <= pond.x) & (pond.x <= right) & (bottom <= pond.y) & (pond.y <= top);
            order[num_ordered] = index;
            num_ordered += usize::from(is_passed);
            remaining[num_kept] = (index, pond);
            num_kept += usize::from(!is_passed);
        }
        remaining.truncate(num_kept);
        sort_along(direction, ponds, &mut order[first..num_ordered], tolerance);
    }
    for (place, (index, _)) in order[num_ordered..].iter_mut().zip(remaining) {
        *place = index;
    }
    order
}

/// Sorts indices of ponds along the coordinate axis nearest to a direction; of two equally near, the counter-clockwise one.
fn sort_along(direction: Point, ponds: &[Point], indices: &mut [usize], tolerance: Tolerance) {
    let by_x = |a: usize, b: usize| ponds[a].x.total_cmp(&ponds[b].x);
    let by_y = |a: usize, b: usize| ponds[a].y.total_cmp(&ponds[b].y);
    let snap = |value: f64| if value.abs() <= tolerance.length { 0.0 } else { value };
    // Left of the diagonal that leads up, and above the one that leads down.
    let (left, above) = (snap(direction.y - direction.x), snap(direction.y + direction.x));
    if left < 0.0 && above >= 0.0 {
        indices.sort_by(|&a, &b| by_x(a, b).then(by_y(a, b)));
    } else if left >= 0.0 && above > 0.0 {
        indices.sort_by(|&a, &b| by_y(a, b));
    } else if left > 0.0 {
        indices.sort_by(|&a, &b| by_x(b, a));
    } else {
        indices.sort_by(|&a, &b| by_y(b, a));
    }
}
