//! How well a plan keeps the drones apart: shared territory and crossing legs.
//!
//! The paper values routes "assigned based on area" for "the natural airspace deconfliction that results" (section 4);
//! these are its measures. They look at places, not at times: two drones that cross at different times count.
//!
//! - Overlap. A route's territory is the convex hull of its ponds. The plane is cut into vertical slabs at every corner of
//!   a hull and every crossing of two hull edges. Inside a slab no two edges cross, so the length of a vertical line that
//!   at least two hulls cover is linear in x, and its value at the middle times the width is the area. O(h² + s m log m)
//!   for h corners of m hulls and s slabs.
//! - Crossings. Sweep and prune: legs sorted by their left end, each tested against those that still reach as far right.
//!   O(n a) for n legs of which a reach over the same x: about √n where legs join neighbouring ponds.

use crate::error::InvalidInput;
use crate::evaluate::check_indices;
use crate::geometry::{Point, convex_hull, cross, signed_area};
use crate::problem::Problem;

/// How well a plan keeps the drones apart.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Separation {
    /// Area inside the convex hulls of the ponds of at least two routes, as a share of the area of the hull of all ponds.
    pub overlap: f64,
    /// Pairs of crossing legs of different routes, legs from and to the depot left aside.
    pub num_crossings: usize,
    /// Pairs of crossing legs of different routes, of which at least one starts or ends at the depot.
    pub num_depot_leg_crossings: usize,
}

/// Measures how well `routes` (visit indices in flying order, the depot implied at both ends) keep apart.
///
/// Two legs cross if the ends of each lie on different sides of the other. An end on the line of the other leg counts as
/// right of it, so a route that passes through another's leg at one of its ponds crosses once. Legs with a common end do
/// not cross, nor do legs along the same line.
///
/// # Errors
/// [`InvalidInput`] if a route names a visit that does not exist.
pub fn separation(problem: &Problem, routes: &[Vec<usize>]) -> Result<Separation, InvalidInput> {
    check_indices(problem, routes)?;
    let positions = |visits: &[usize]| visits.iter().map(|&visit| problem.visits()[visit].position).collect();
    let routes: Vec<Vec<Point>> = routes.iter().map(|visits| positions(visits)).collect();
    let farm: Vec<Point> = problem.visits().iter().map(|visit| visit.position).collect();
    let farm_area = hull_area(&farm);
    // Where all ponds lie on one line there is no area to share.
    // The sum of nothing is -0.0.
    let overlap = if farm_area > 0.0 { area_covered_twice(&routes) / farm_area + 0.0 } else { 0.0 };
    let (num_crossings, num_depot_leg_crossings) = count_crossings(problem.depot().position, &routes);
    Ok(Separation { overlap, num_crossings, num_depot_leg_crossings })
}

fn hull_area(points: &[Point]) -> f64 {
    signed_area(&convex_hull(points).into_iter().map(|corner| points[corner]).collect::<Vec<Point>>())
}

/// A convex hull with an area inside: its lower and upper corners, both in ascending order of x, ends included.
struct Hull {
    lower: Vec<Point>,
    upper: Vec<Point>,
}

impl Hull {
    fn new(points: &[Point]) -> Option<Self> {
        let corners: Vec<Point> = convex_hull(points).into_iter().map(|corner| points[corner]).collect();
        if corners.len() < 3 {
            return None;
        }
        let last = corners.iter().map(|corner| corner.x).fold(f64::NEG_INFINITY, f64::max);
        let rightmost = corners.iter().position(|corner| corner.x == last)?;
        let lower = corners[..=rightmost].to_vec();
        let upper = corners[..1].iter().chain(corners[rightmost..].iter().rev()).copied().collect();
        Some(Self { lower, upper })
    }

    fn edges(&self) -> impl Iterator<Item = (Point, Point)> + '_ {
        self.lower.windows(2).chain(self.upper.windows(2)).map(|edge| (edge[0], edge[1]))
    }

    /// Where the vertical line at `x` enters and leaves.
    fn column(&self, x: f64) -> Option<(f64, f64)> {
        Some((height_at(&self.lower, x)?, height_at(&self.upper, x)?))
    }
}

/// Height at `x` of a chain of points in ascending order of x.
fn height_at(chain: &[Point], x: f64) -> Option<f64> {
    let after = chain.partition_point(|corner| corner.x <= x);
    let (from, to) = (chain.get(after.checked_sub(1)?)?, chain.get(after)?);
    Some(from.y + (x - from.x) / (to.x - from.x) * (to.y - from.y))
}

fn area_covered_twice(routes: &[Vec<Point>]) -> f64 {
    let hulls: Vec<Hull> = routes.iter().filter_map(|ponds| Hull::new(ponds)).collect();
    let slab_ends = slab_ends(&hulls);
    slab_ends.windows(2).map(|slab| (slab[1] - slab[0]) * length_covered_twice(&hulls, 0.5 * (slab[0] + slab[1]))).sum()
}

fn slab_ends(hulls: &[Hull]) -> Vec<f64> {
    let mut ends: Vec<f64> = hulls.iter().flat_map(Hull::edges).flat_map(|(from, to)| [from.x, to.x]).collect();
    for (index, hull) in hulls.iter().enumerate() {
        for other in &hulls[index + 1..] {
            for edge in hull.edges() {
                ends.extend(other.edges().filter_map(|other_edge| crossing_x(edge, other_edge)));
            }
        }
    }
    ends.sort_by(f64::total_cmp);
    ends.dedup();
    ends
}

/// Where two edges, both from left to right, cross.
fn crossing_x(one: (Point, Point), other: (Point, Point)) -> Option<f64> {
    if one.1.x <= other.0.x || other.1.x <= one.0.x {
        return None;
    }
    let (before, after) = (cross(one.0, one.1, other.0), cross(one.0, one.1, other.1));
    // Where the edges do not reach each other the cut is needless but harmless.
    ((before > 0.0) != (after > 0.0)).then(|| other.0.x + before / (before - after) * (other.1.x - other.0.x))
}

fn length_covered_twice(hulls: &[Hull], x: f64) -> f64 {
    let columns = hulls.iter().filter_map(|hull| hull.column(x));
    let mut ends: Vec<(f64, i32)> = columns.flat_map(|(low, high)| [(low, 1), (high, -1)]).collect();
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut depth, mut covered) = (0, 0.0);
    for pair in ends.windows(2) {
        depth += pair[0].1;
        if depth >= 2 {
            covered += pair[1].0 - pair[0].0;
        }
    }
    covered
}

#[derive(Clone, Copy)]
struct Leg {
    from: Point,
    to: Point,
    route: usize,
    is_at_depot: bool,
}

impl Leg {
    fn left(&self) -> f64 {
        self.from.x.min(self.to.x)
    }

    fn right(&self) -> f64 {
        self.from.x.max(self.to.x)
    }
}

/// Crossings of legs of different routes: without and with a leg of the depot.
fn count_crossings(depot: Point, routes: &[Vec<Point>]) -> (usize, usize) {
    let mut legs = legs(depot, routes);
    legs.sort_by(|a, b| a.left().total_cmp(&b.left()));
    let tolerance = sidedness_tolerance(&legs);
    let mut reaching: Vec<Leg> = Vec::new();
    let (mut num_inner, mut num_at_depot) = (0, 0);
    for leg in legs {
        reaching.retain(|other| other.right() >= leg.left());
        for other in reaching.iter().filter(|other| other.route != leg.route) {
            if do_cross(&leg, other, tolerance) {
                if leg.is_at_depot || other.is_at_depot {
                    num_at_depot += 1;
                } else {
                    num_inner += 1;
                }
            }
        }
        reaching.push(leg);
    }
    (num_inner, num_at_depot)
}

fn legs(depot: Point, routes: &[Vec<Point>]) -> Vec<Leg> {
    let mut legs = Vec::new();
    for (route, ponds) in routes.iter().enumerate() {
        let Some((&first, &last)) = ponds.first().zip(ponds.last()) else { continue };
        legs.push(Leg { from: depot, to: first, route, is_at_depot: true });
        legs.extend(ponds.windows(2).map(|pair| Leg { from: pair[0], to: pair[1], route, is_at_depot: false }));
        legs.push(Leg { from: last, to: depot, route, is_at_depot: true });
    }
    legs
}

/// Below this a cross product is rounding noise: ponds of a grid lie on one line although their coordinates are rounded.
fn sidedness_tolerance(legs: &[Leg]) -> f64 {
    let origin = legs.first().map_or_else(Point::default, |leg| leg.from);
    let extent = legs.iter().map(|leg| origin.distance(leg.to)).fold(0.0, f64::max);
    1e-12 * extent * extent
}

fn do_cross(one: &Leg, other: &Leg, tolerance: f64) -> bool {
    let are_apart = one.from.y.min(one.to.y) > other.from.y.max(other.to.y)
        || one.from.y.max(one.to.y) < other.from.y.min(other.to.y);
    let have_common_end = [other.from, other.to].iter().any(|&end| end == one.from || end == one.to);
    let is_left_of = |leg: &Leg, place: Point| cross(leg.from, leg.to, place) > tolerance;
    !are_apart
        && !have_common_end
        && is_left_of(one, other.from) != is_left_of(one, other.to)
        && is_left_of(other, one.from) != is_left_of(other, one.to)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::convex_intersection;
    use proptest::prelude::*;

    fn measured(depot: (f64, f64), routes: &[&[(f64, f64)]]) -> Separation {
        let ponds: Vec<Point> = routes.concat().into_iter().map(|(x, y)| Point::new(x, y)).collect();
        let problem = Problem::research(Point::new(depot.0, depot.1), &ponds, routes.len()).unwrap();
        let mut visits = 0..ponds.len();
        let indices: Vec<Vec<usize>> = routes.iter().map(|route| visits.by_ref().take(route.len()).collect()).collect();
        separation(&problem, &indices).unwrap()
    }

    fn square(low: f64, high: f64) -> [(f64, f64); 4] {
        [(low, low), (high, low), (high, high), (low, high)]
    }

    #[test]
    fn overlap_of_two_squares() {
        // Squares of area 16 that share 2 x 2; the hull of both is a 6 x 6 square without two corners of area 2.
        let separation = measured((0.0, -1.0), &[&square(0.0, 4.0), &square(2.0, 6.0)]);
        assert!((separation.overlap - 4.0 / 32.0).abs() < 1e-12);
    }

    #[test]
    fn an_area_covered_three_times_counts_once() {
        let separation = measured((0.0, -1.0), &[&square(0.0, 4.0), &square(1.0, 3.0), &square(1.0, 3.0)]);
        assert!((separation.overlap - 0.25).abs() < 1e-12);
    }

    #[test]
    fn territories_apart_or_without_area_do_not_overlap() {
        assert_eq!(measured((0.0, 0.0), &[&square(0.0, 1.0), &square(2.0, 3.0)]).overlap, 0.0);
        assert_eq!(measured((0.0, 0.0), &[&square(0.0, 4.0), &[(1.0, 1.0), (2.0, 2.0)], &[]]).overlap, 0.0);
        assert_eq!(measured((0.0, 0.0), &[&[(1.0, 1.0)], &[(1.0, 1.0)]]), Separation::default());
    }

    #[test]
    fn crossings_by_hand() {
        // Two legs like an X above the depot; the legs home of the second route cross the first route's leg home.
        let separation = measured((0.0, 0.0), &[&[(-1.0, 2.0), (1.0, 4.0)], &[(1.0, 2.0), (-1.0, 4.0)]]);
        assert_eq!((separation.num_crossings, separation.num_depot_leg_crossings), (1, 2));
        // The same ponds without the X.
        let separation = measured((0.0, 0.0), &[&[(-1.0, 2.0), (-1.0, 4.0)], &[(1.0, 2.0), (1.0, 4.0)]]);
        assert_eq!((separation.num_crossings, separation.num_depot_leg_crossings), (0, 0));
    }

    #[test]
    fn passing_through_a_leg_at_a_pond_is_one_crossing() {
        let across = [(-1.0, 5.0), (0.0, 4.0), (1.0, 3.0)];
        let separation = measured((9.0, 9.0), &[&[(-2.0, 4.0), (2.0, 4.0)], &across]);
        assert_eq!(separation.num_crossings, 1);
    }

    #[test]
    fn legs_along_one_line_do_not_cross() {
        let row = |from: i32, to: i32| [(f64::from(from) * 0.1, 0.3), (f64::from(to) * 0.1, 0.3)];
        assert_eq!(measured((0.0, 0.0), &[&row(1, 7), &row(3, 9)]).num_crossings, 0);
    }

    #[test]
    fn an_unknown_visit_is_an_error() {
        let problem = Problem::research(Point::default(), &[Point::new(1.0, 0.0)], 1).unwrap();
        assert_eq!(separation(&problem, &[vec![1]]).unwrap_err().faults[0].path, "routes[0][0]");
    }

    fn place() -> impl Strategy<Value = (f64, f64)> {
        (0.0..1.0, 0.0..1.0)
    }

    proptest! {
        #[test]
        fn two_routes_overlap_in_the_intersection_of_their_hulls(
            one in prop::collection::vec(place(), 3..20), other in prop::collection::vec(place(), 3..20),
        ) {
            let hull = |ponds: &[(f64, f64)]| {
                let points: Vec<Point> = ponds.iter().map(|&(x, y)| Point::new(x, y)).collect();
                convex_hull(&points).into_iter().map(|corner| points[corner]).collect::<Vec<Point>>()
            };
            let shared = signed_area(&convex_intersection(&hull(&one), &hull(&other)));
            let farm = signed_area(&hull(&[one.clone(), other.clone()].concat()));
            prop_assert!((measured((0.0, 0.0), &[&one, &other]).overlap - shared / farm).abs() < 1e-9);
        }

        #[test]
        fn the_sweep_finds_the_crossings_of_all_pairs(
            routes in prop::collection::vec(prop::collection::vec(place(), 1..12), 1..5),
        ) {
            let points: Vec<Vec<Point>> = routes
                .iter()
                .map(|route| route.iter().map(|&(x, y)| Point::new(x, y)).collect())
                .collect();
            let legs = legs(Point::default(), &points);
            let mut num_crossings = 0;
            for (index, leg) in legs.iter().enumerate() {
                let others = legs[..index].iter().filter(|other| other.route != leg.route);
                num_crossings += others.filter(|other| do_cross(leg, other, 0.0)).count();
            }
            let (num_inner, num_at_depot) = count_crossings(Point::default(), &points);
            prop_assert_eq!(num_inner + num_at_depot, num_crossings);
        }
    }
}
