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
    corners: Vec<Vec<Corner>>,
    /// What was asked about the visit that is to change its route.
    asked: Vec<Question>,
    /// What was assigned since it was last kept.
    changes: Vec<Change>,
    /// Below this a cross product is rounding noise.
    tolerance: f64,
}

#[derive(Clone, Copy)]
struct Corner {
    visit: u32,
    point: Point,
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
            hulls.corners[route] = hulls.hull(part.iter().copied());
        }
        hulls
    }

    /// Whether no two hulls touch.
    pub fn are_apart(&self) -> bool {
        self.corners
            .iter()
            .enumerate()
            .all(|(index, one)| self.corners[..index].iter().all(|other| are_apart(one, other, self.tolerance)))
    }

    fn hull(&self, visits: impl Iterator<Item = u32>) -> Vec<Corner> {
        let (visits, points): (Vec<u32>, Vec<Point>) = visits.map(|visit| (visit, self.points[visit as usize])).unzip();
        convex_hull(&points).into_iter().map(|place| Corner { visit: visits[place], point: points[place] }).collect()
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
        let is_clear = |corners: &[Corner]| are_apart(spike, corners, self.tolerance);
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
        let is_hidden = |edge: usize| cross(corners[edge % size].point, corners[(edge + 1) % size].point, point) > 0.0;
        let mut starts = (0..size).filter(|&edge| is_hidden(edge) && !is_hidden(edge + size - 1));
        let mut grown = match (starts.next(), starts.next()) {
            (Some(start), None) => {
                let num_hidden = (start..start + size).take_while(|&edge| is_hidden(edge)).count();
                (start..=start + num_hidden).map(|place| corners[place % size]).collect()
            }
            // A hull without area, or rounding on a nearly straight border.
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
        let beyond = others.filter(|&member| cross(before.point, after.point, self.points[member as usize]) < 0.0);
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

/// Whether two convex polygons (corners counter-clockwise; points and segments too) have no point in common, not even one on
/// their borders.
fn are_apart(one: &[Corner], other: &[Corner], tolerance: f64) -> bool {
    if one.is_empty() || other.is_empty() {
        return true;
    }
    if one.len() < 3 && other.len() < 3 {
        let ends = [one[0], one[one.len() - 1], other[0], other[other.len() - 1]].map(|corner| corner.point);
        let axes = [(ends[0], ends[1]), (ends[2], ends[3]), (ends[0], ends[2])];
        if axes.into_iter().any(|(from, to)| has_gap_along(to - from, one, other, tolerance)) {
            return true;
        }
    }
    has_separating_edge(one, other, tolerance) || has_separating_edge(other, one, tolerance)
}

/// Whether `other` lies strictly outside the line along an edge of `one`.
fn has_separating_edge(one: &[Corner], other: &[Corner], tolerance: f64) -> bool {
    let mut from = one[one.len() - 1].point;
    one.iter().any(|to| {
        let is_separating = other.iter().all(|corner| cross(from, to.point, corner.point) < -tolerance);
        from = to.point;
        is_separating
    })
}

fn has_gap_along(axis: Point, one: &[Corner], other: &[Corner], tolerance: f64) -> bool {
    let range = |corners: &[Corner]| {
        corners
            .iter()
            .map(|corner| dot(axis, corner.point - one[0].point))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)))
    };
    let ((low, high), (other_low, other_high)) = (range(one), range(other));
    other_low > high + tolerance || low > other_high + tolerance
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::Problem;
    use crate::random::Random;
    use proptest::prelude::*;

    fn polygon(points: &[(f64, f64)]) -> Vec<Corner> {
        (0..).zip(points).map(|(visit, &(x, y))| Corner { visit, point: Point::new(x, y) }).collect()
    }

    #[test]
    fn polygons_segments_and_points_apart() {
        let square = polygon(&[(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)]);
        let is_apart_from_square = |points: &[(f64, f64)]| are_apart(&square, &polygon(points), 1e-9);
        assert!(is_apart_from_square(&[(3.0, 1.0)]));
        assert!(!is_apart_from_square(&[(2.0, 1.0)]));
        assert!(!is_apart_from_square(&[(3.0, 0.0), (0.0, 3.5)]));
        assert!(is_apart_from_square(&[(5.0, 0.0), (0.0, 5.0)]));
        assert!(is_apart_from_square(&[(2.5, 0.0), (4.0, 0.0)]));
        assert!(is_apart_from_square(&[]));
        let segment = polygon(&[(0.0, 0.0), (2.0, 0.0)]);
        assert!(are_apart(&segment, &polygon(&[(3.0, 0.0), (4.0, 0.0)]), 1e-9));
        assert!(!are_apart(&segment, &polygon(&[(1.0, 0.0), (4.0, 0.0)]), 1e-9));
        assert!(!are_apart(&segment, &polygon(&[(1.0, -1.0), (1.0, 1.0)]), 1e-9));
        assert!(!are_apart(&polygon(&[(1.0, 1.0)]), &polygon(&[(1.0, 1.0)]), 1e-9));
    }

    /// The corners as a set: where the list begins is of no meaning.
    fn sorted_corners(corners: &[Corner]) -> Vec<u32> {
        let mut visits: Vec<u32> = corners.iter().map(|corner| corner.visit).collect();
        visits.sort_unstable();
        visits
    }

    proptest! {
        #[test]
        fn admitted_changes_keep_hulls_apart_and_true_and_can_be_taken_back(
            places in prop::collection::hash_set((0u8..9, 0u8..9), 6..50), seed in 0u64..1000,
        ) {
            let mut points: Vec<Point> = places.iter().map(|&(x, y)| Point::new(x.into(), y.into())).collect();
            points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
            let problem = Problem::research(Point::new(-1.0, -1.0), &points, 3).unwrap();
            let network = Network::new(&problem);
            let parts: Vec<Vec<u32>> = (0..3)
                .map(|route| ((points.len() * route / 3) as u32..(points.len() * (route + 1) / 3) as u32).collect())
                .collect();
            let mut hulls = Hulls::new(&network, &parts);
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
                let fresh = Hulls::new(&network, &parts);
                prop_assert!(fresh.are_apart());
                for (one, other) in fresh.corners.iter().zip(&hulls.corners) {
                    prop_assert_eq!(sorted_corners(one), sorted_corners(other));
                }
            }
        }
    }
}
