//! Keeps the convex hulls of routes apart while visits change their route.
//!
//! A visit can leave a route only where it is a corner of the route's hull, and then the hull it joins grows by one triangle:
//! what must be tested is that this triangle touches no other hull. All that is asked is answered without rounding
//! (`exact`). Visits in one place stay on one route: the hulls of two would have that place in common.
//! O(visits of the route left + corners of all hulls) for a change, O(corners of the hull left) for most refusals.

use super::exact::{are_apart, hull, side};
use crate::geometry::Point;
use crate::search::{Airspace, State};
use std::borrow::Borrow;

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
    corners: Vec<Vec<Corner>>,
    /// What was asked about the visit that is to change its route.
    asked: Vec<Question>,
    /// What was assigned since it was last kept.
    changes: Vec<Change>,
}

#[derive(Clone, Copy)]
struct Corner {
    visit: u32,
    point: Point,
}

impl Borrow<Point> for Corner {
    fn borrow(&self) -> &Point {
        &self.point
    }
}

struct Question {
    visit: u32,
    route: u32,
    answer: Option<NewCorners>,
}

struct NewCorners {
    left: Vec<Corner>,
    joined: Vec<Corner>,
}

struct Change {
    visit: u32,
    left_route: u32,
    old: NewCorners,
}

impl<'a> Hulls<'a> {
    /// Hulls of the parts of as many routes, which hold every visit once, of `points`.
    pub fn new(points: &'a [Point], num_routes: usize, parts: &[Vec<u32>]) -> Self {
        let mut hulls = Self {
            points,
            routes: vec![0; points.len()],
            members: vec![Vec::new(); num_routes],
            places: vec![0; points.len()],
            corners: vec![Vec::new(); num_routes],
            asked: Vec::new(),
            changes: Vec::new(),
        };
        for (route, part) in parts.iter().enumerate() {
            for &visit in part {
                hulls.join(visit, route as u32);
            }
            hulls.corners[route] = hulls.hull(part.iter().copied());
        }
        hulls
    }

    /// Whether no two hulls touch.
    pub fn are_apart(&self) -> bool {
        self.corners
            .iter()
            .enumerate()
            .all(|(index, one)| self.corners[..index].iter().all(|other| are_apart(one, other)))
    }

    fn hull(&self, visits: impl Iterator<Item = u32>) -> Vec<Corner> {
        let (visits, points): (Vec<u32>, Vec<Point>) = visits.map(|visit| (visit, self.points[visit as usize])).unzip();
        hull(&points).into_iter().map(|place| Corner { visit: visits[place], point: points[place] }).collect()
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
        let left_route = self.routes[visit as usize];
        let place = self.corners[left_route as usize].iter().position(|corner| corner.visit == visit)?;
        let joined = self.corners_with(route, visit)?;
        let spike: &[Corner] = match joined[..] {
            [after, .., before, corner] => &[before, corner, after],
            _ => &joined,
        };
        let is_clear = |corners: &[Corner]| are_apart(spike, corners);
        let mut others = (0..).zip(&self.corners).filter(|&(other, _)| other != left_route && other != route);
        if !others.all(|(_, corners)| is_clear(corners)) {
            return None;
        }
        let left = self.corners_without(left_route, place);
        is_clear(&left).then_some(NewCorners { left, joined })
    }

    /// The hull of a route with a visit outside it, which comes last; none if the visit is inside.
    fn corners_with(&self, route: u32, visit: u32) -> Option<Vec<Corner>> {
        let corners = &self.corners[route as usize];
        let (size, point) = (corners.len(), self.points[visit as usize]);
        // Sides of a point or a segment, which has an edge there and an edge back, hide nothing that is beyond its ends.
        let is_hidden = |edge: usize| side(corners[edge % size].point, corners[(edge + 1) % size].point, point).is_gt();
        let mut starts = (0..size).filter(|&edge| is_hidden(edge) && !is_hidden(edge + size - 1));
        let mut grown = match (starts.next(), starts.next()) {
            (Some(start), None) => {
                let num_hidden = (start..start + size).take_while(|&edge| is_hidden(edge)).count();
                (start..=start + num_hidden).map(|place| corners[place % size]).collect()
            }
            // A hull without area.
            _ => {
                let hull = self.hull(corners.iter().map(|corner| corner.visit).chain([visit]));
                let place = hull.iter().position(|corner| corner.visit == visit)?;
                let size = hull.len();
                (place + 1..place + size).map(|place| hull[place % size]).collect::<Vec<Corner>>()
            }
        };
        grown.push(Corner { visit, point });
        Some(grown)
    }

    /// The hull of a route without the corner at `place`.
    fn corners_without(&self, route: u32, place: usize) -> Vec<Corner> {
        let corners = &self.corners[route as usize];
        let (size, visit) = (corners.len(), corners[place].visit);
        let others = self.members[route as usize].iter().copied().filter(|&member| member != visit);
        if size < 3 {
            return self.hull(others);
        }
        // Only what lies beyond the line between the corner's neighbours can become a corner.
        let (before, after) = (corners[(place + size - 1) % size], corners[(place + 1) % size]);
        let beyond = others.filter(|&member| side(before.point, after.point, self.points[member as usize]).is_lt());
        let kept = (place + 1..place + size).map(|kept| corners[kept % size]);
        let mut beyond = beyond.peekable();
        if beyond.peek().is_none() {
            return kept.collect();
        }
        self.hull(kept.map(|corner| corner.visit).chain(beyond))
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
            self.corners[route] = self.hull(self.members[route].iter().copied());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::territory::exact::compare;
    use proptest::prelude::*;

    /// The places of the corners as a set: where the list begins, and which of visits in one place it names, is of no meaning.
    fn sorted_corners(corners: &[Corner]) -> Vec<Point> {
        let mut points: Vec<Point> = corners.iter().map(|corner| corner.point).collect();
        points.sort_by(|&a, &b| compare(a, b));
        points
    }

    proptest! {
        #[test]
        fn admitted_changes_keep_hulls_apart_and_true_and_can_be_taken_back(
            places in prop::collection::vec((0u8..9, 0u8..9), 6..50), seed in 0u64..1000,
        ) {
            let mut points: Vec<Point> = places.iter().map(|&(x, y)| Point::new(x.into(), y.into())).collect();
            points.sort_by(|&a, &b| compare(a, b));
            let visits: Vec<u32> = (0..points.len() as u32).collect();
            // Visits in one place side by side, three places at least.
            let by_place: Vec<&[u32]> =
                visits.chunk_by(|&a, &b| compare(points[a as usize], points[b as usize]).is_eq()).collect();
            prop_assume!(by_place.len() >= 3);
            let parts: Vec<Vec<u32>> = (0..3)
                .map(|route| by_place[by_place.len() * route / 3..by_place.len() * (route + 1) / 3].concat())
                .collect();
            let mut hulls = Hulls::new(&points, 3, &parts);
            prop_assert!(hulls.are_apart());
            let mut random = Random::new(seed);
            for round in 0..20 {
                let before = hulls.routes.clone();
                for _ in 0..20 {
                    let (visit, route) = (random.below(points.len()) as u32, random.below(3) as u32);
                    if hulls.admits(visit, route) {
                        hulls.assign(visit, route);
                    }
                }
                if round % 2 == 0 {
                    hulls.keep();
                } else {
                    hulls.undo();
                    prop_assert_eq!(&before, &hulls.routes);
                }
                let mut parts = vec![Vec::new(); 3];
                for (visit, &route) in hulls.routes.iter().enumerate() {
                    parts[route as usize].push(visit as u32);
                }
                let fresh = Hulls::new(&points, 3, &parts);
                prop_assert!(fresh.are_apart());
                for (one, other) in fresh.corners.iter().zip(&hulls.corners) {
                    prop_assert_eq!(sorted_corners(one), sorted_corners(other));
                }
            }
        }
    }
}
