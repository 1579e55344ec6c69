//! Keeps the convex hulls of routes apart while visits change their route.
//!
//! A visit can leave a route only where it is a corner of the route's hull, and then the hull it joins grows by one triangle:
//! what must be tested is that this triangle touches no other hull. Convex polygons are apart if a line along an edge of one
//! of them separates them (separating axes: Gottschalk, Lin and Manocha, SIGGRAPH 1996, section 5, in the plane).
//! O(visits of the route left + corners of all hulls) for a change, O(corners of the hull left) for most refusals.

use crate::geometry::{Point, convex_hull, cross, dot, extent};
use crate::search::{Airspace, Network, State};

/// The territory of every route: the hull of its visits.
pub(super) struct Hulls<'a> {
    points: &'a [Point],
    /// Route of each visit.
    routes: Vec<u32>,
    /// Visits of each route.
    members: Vec<Vec<u32>>,
    /// Place of each visit among the members of its route.
    places: Vec<u32>,
    /// Corners of each route's hull, counter-clockwise.
    corners: Vec<Vec<u32>>,
    /// What was asked about the visit that is to change its route.
    asked: Vec<Question>,
    /// What was assigned since it was last kept.
    changes: Vec<Change>,
    /// Below this a cross product is rounding noise.
    tolerance: f64,
}

struct Question {
    visit: u32,
    route: u32,
    answer: Option<NewCorners>,
}

struct NewCorners {
    left: Vec<u32>,
    joined: Vec<u32>,
}

struct Change {
    visit: u32,
    left_route: u32,
    old: NewCorners,
}

impl<'a> Hulls<'a> {
    /// Hulls of the parts, which hold every visit once.
    pub fn new(network: &'a Network, parts: &[Vec<u32>]) -> Self {
        let points = &network.points[..network.num_visits];
        let extent = extent(points.iter().copied());
        let mut hulls = Self {
            points,
            routes: vec![0; points.len()],
            members: vec![Vec::new(); network.num_routes],
            places: vec![0; points.len()],
            corners: vec![Vec::new(); network.num_routes],
            asked: Vec::new(),
            changes: Vec::new(),
            tolerance: 1e-12 * extent * extent,
        };
        for (route, part) in parts.iter().enumerate() {
            for &visit in part {
                hulls.join(visit, route as u32);
            }
            hulls.corners[route] = hulls.hull(part.clone());
        }
        hulls
    }

    /// Whether no two hulls touch.
    pub fn are_apart(&self) -> bool {
        let polygons: Vec<Vec<Point>> = self.corners.iter().map(|corners| self.positions(corners)).collect();
        polygons
            .iter()
            .enumerate()
            .all(|(index, one)| polygons[..index].iter().all(|other| are_apart(one, other, self.tolerance)))
    }

    fn positions(&self, visits: &[u32]) -> Vec<Point> {
        visits.iter().map(|&visit| self.points[visit as usize]).collect()
    }

    fn hull(&self, visits: Vec<u32>) -> Vec<u32> {
        convex_hull(&self.positions(&visits)).into_iter().map(|corner| visits[corner]).collect()
    }

    fn join(&mut self, visit: u32, route: u32) {
        self.routes[visit as usize] = route;
        self.places[visit as usize] = self.members[route as usize].len() as u32;
        self.members[route as usize].push(visit);
    }

    fn leave(&mut self, visit: u32) {
        let (route, place) = (self.routes[visit as usize] as usize, self.places[visit as usize] as usize);
        self.members[route].swap_remove(place);
        if let Some(&moved) = self.members[route].get(place) {
            self.places[moved as usize] = place as u32;
        }
    }

    /// Both hulls after `visit` has changed to `route`, if they would be apart from each other and the rest.
    fn corners_after(&self, visit: u32, route: u32) -> Option<NewCorners> {
        let left_route = self.routes[visit as usize] as usize;
        let place = self.corners[left_route].iter().position(|&corner| corner == visit)?;
        let mut joined = self.corners[route as usize].clone();
        joined.push(visit);
        let joined = self.hull(joined);
        let spike = self.spike(&joined, visit);
        let is_clear = |corners: &[u32]| are_apart(&spike, &self.positions(corners), self.tolerance);
        let others = self.corners.iter().enumerate().filter(|&(other, _)| other != left_route && other != route as usize);
        if !others.into_iter().all(|(_, corners)| is_clear(corners)) {
            return None;
        }
        let left = self.corners_without(left_route, place);
        is_clear(&left).then_some(NewCorners { left, joined })
    }

    /// What `visit` adds to a hull: the triangle with its neighbours on the new hull.
    fn spike(&self, joined: &[u32], visit: u32) -> Vec<Point> {
        let place = joined.iter().position(|&corner| corner == visit).unwrap_or(0);
        let size = joined.len();
        let spike = [place + size - 1, place, place + 1].map(|corner| joined[corner % size]);
        self.positions(if size < 3 { joined } else { &spike })
    }

    /// The hull of a route without the corner at `place`.
    fn corners_without(&self, route: usize, place: usize) -> Vec<u32> {
        let corners = &self.corners[route];
        let (size, visit) = (corners.len(), corners[place]);
        let mut candidates: Vec<u32> = corners.iter().copied().filter(|&corner| corner != visit).collect();
        let others = self.members[route].iter().copied().filter(|&member| member != visit);
        if size < 3 {
            candidates = others.collect();
        } else {
            // Only what lies beyond the line between the corner's neighbours can become a corner.
            let [before, after] = [place + size - 1, place + 1].map(|corner| self.points[corners[corner % size] as usize]);
            candidates.extend(others.filter(|&member| cross(before, after, self.points[member as usize]) < 0.0));
        }
        self.hull(candidates)
    }
}

impl Airspace for Hulls<'_> {
    fn admits(&mut self, visit: u32, route: u32) -> bool {
        if self.routes[visit as usize] == route {
            return true;
        }
        if let Some(question) = self.asked.iter().find(|question| question.visit == visit && question.route == route) {
            return question.answer.is_some();
        }
        let answer = self.corners_after(visit, route);
        let is_admitted = answer.is_some();
        self.asked.push(Question { visit, route, answer });
        is_admitted
    }

    fn assign(&mut self, visit: u32, route: u32) {
        let left_route = self.routes[visit as usize];
        if left_route != route {
            let question = self.asked.iter_mut().find(|question| question.visit == visit && question.route == route);
            if let Some(new) = question.and_then(|question| question.answer.take()) {
                let old = NewCorners {
                    left: std::mem::replace(&mut self.corners[left_route as usize], new.left),
                    joined: std::mem::replace(&mut self.corners[route as usize], new.joined),
                };
                self.leave(visit);
                self.join(visit, route);
                self.changes.push(Change { visit, left_route, old });
            }
        }
        self.asked.clear();
    }

    fn keep(&mut self) {
        self.changes.clear();
    }

    fn undo(&mut self) {
        self.asked.clear();
        while let Some(Change { visit, left_route, old }) = self.changes.pop() {
            let joined_route = self.routes[visit as usize] as usize;
            self.corners[joined_route] = old.joined;
            self.corners[left_route as usize] = old.left;
            self.leave(visit);
            self.join(visit, left_route);
        }
    }

    fn load(&mut self, state: &State) {
        self.asked.clear();
        self.changes.clear();
        self.members.iter_mut().for_each(Vec::clear);
        for visit in 0..self.points.len() as u32 {
            self.join(visit, state.nodes[visit as usize].route);
        }
        for route in 0..self.members.len() {
            self.corners[route] = self.hull(self.members[route].clone());
        }
    }
}

/// Whether two convex polygons (corners counter-clockwise; points and segments too) have no point in common, not even one on
/// their borders.
fn are_apart(one: &[Point], other: &[Point], tolerance: f64) -> bool {
    if one.is_empty() || other.is_empty() {
        return true;
    }
    if one.len() < 3 && other.len() < 3 {
        let ends = [one[0], one[one.len() - 1], other[0], other[other.len() - 1]];
        let axes = [(ends[0], ends[1]), (ends[2], ends[3]), (ends[0], ends[2])];
        if axes.into_iter().any(|(from, to)| has_gap_along(to - from, one, other, tolerance)) {
            return true;
        }
    }
    has_separating_edge(one, other, tolerance) || has_separating_edge(other, one, tolerance)
}

/// Whether `other` lies strictly outside the line along an edge of `one`.
fn has_separating_edge(one: &[Point], other: &[Point], tolerance: f64) -> bool {
    let mut from = one[one.len() - 1];
    one.iter().any(|&to| {
        let is_separating = other.iter().all(|&place| cross(from, to, place) < -tolerance);
        from = to;
        is_separating
    })
}

fn has_gap_along(axis: Point, one: &[Point], other: &[Point], tolerance: f64) -> bool {
    let range = |points: &[Point]| {
        points.iter().map(|&point| dot(axis, point - one[0])).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| {
            (low.min(at), high.max(at))
        })
    };
    let ((low, high), (other_low, other_high)) = (range(one), range(other));
    other_low > high + tolerance || low > other_high + tolerance
}
