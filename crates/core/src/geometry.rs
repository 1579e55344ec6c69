//! Points and planar constructions.

/// A point of the plane: metres in a farm's local frame, or the unitless square of a research farm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// East, or the first coordinate.
    pub x: f64,
    /// North, or the second coordinate.
    pub y: f64,
}

impl Point {
    /// The point `(x, y)`.
    #[must_use]
    pub const fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }

    /// Straight-line distance to `other`. Uses only correctly rounded operations: the same on every machine.
    #[must_use]
    pub fn distance(self, other: Self) -> f64 {
        let (dx, dy) = (self.x - other.x, self.y - other.y);
        (dx * dx + dy * dy).sqrt()
    }
}

impl std::ops::Sub for Point {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y)
    }
}

/// Scalar product of two vectors.
#[must_use]
pub fn dot(a: Point, b: Point) -> f64 {
    a.x * b.x + a.y * b.y
}

/// Twice the signed area of the triangle `a`, `b`, `c`: positive if they turn left (counter-clockwise).
#[must_use]
pub fn cross(a: Point, b: Point, c: Point) -> f64 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

/// The longer side of the axis-parallel box around the points; 0 for none.
#[must_use]
pub fn extent(points: impl Iterator<Item = Point>) -> f64 {
    let (mut low, mut high) =
        (Point::new(f64::INFINITY, f64::INFINITY), Point::new(f64::NEG_INFINITY, f64::NEG_INFINITY));
    for point in points {
        low = Point::new(low.x.min(point.x), low.y.min(point.y));
        high = Point::new(high.x.max(point.x), high.y.max(point.y));
    }
    (high.x - low.x).max(high.y - low.y).max(0.0)
}

/// Indices of the corners of the convex hull of `points`, counter-clockwise from the lowest of the leftmost points.
///
/// Points on an edge and repeated points are no corners: points on one line give its two ends, points in one place give
/// one index. Of points in one place the first stands for all. Andrew's monotone chain (Andrew, Another efficient
/// algorithm for convex hulls in two dimensions, Information Processing Letters 1979), O(n log n), and O(n) where the
/// points come sorted.
#[must_use]
pub fn convex_hull(points: &[Point]) -> Vec<usize> {
    convex_hull_within(points, 0.0)
}

/// [`convex_hull`] without the corners that rounding makes on a straight edge: a point within `tolerance` of the line
/// through its neighbours on the hull is no corner, and points within it of each other are in one place.
#[must_use]
pub fn convex_hull_within(points: &[Point], tolerance: f64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    // Adding zero makes -0.0 equal to 0.0.
    let key = |index: usize| (points[index].x + 0.0, points[index].y + 0.0);
    order.sort_by(|&a, &b| {
        let ((ax, ay), (bx, by)) = (key(a), key(b));
        ax.total_cmp(&bx).then(ay.total_cmp(&by)).then(a.cmp(&b))
    });
    let is_same_place = |one: usize, other: usize| {
        (points[one].x - points[other].x).abs() <= tolerance && (points[one].y - points[other].y).abs() <= tolerance
    };
    order.dedup_by(|later, earlier| is_same_place(*later, *earlier));
    // In a column of a grid only the lowest and the highest point can be corners.
    let mut num_kept = 0;
    for place in 0..order.len() {
        let x = points[order[place]].x;
        let is_between = num_kept > 0
            && points[order[num_kept - 1]].x == x
            && order.get(place + 1).is_some_and(|&next| points[next].x == x);
        order[num_kept] = order[place];
        num_kept += usize::from(!is_between);
    }
    order.truncate(num_kept);
    let mut hull = Vec::with_capacity(order.len() + 1);
    append_half_hull(points, order.iter().copied(), tolerance, &mut hull);
    if order.len() > 1 {
        hull.pop();
        append_half_hull(points, order.iter().rev().copied(), tolerance, &mut hull);
        hull.pop();
    }
    // The corner where the two halves meet was tested against neither.
    while hull.len() > 2 && is_flat_corner(points, [hull[hull.len() - 2], hull[hull.len() - 1], hull[0]], tolerance) {
        hull.pop();
    }
    hull
}

/// Appends the corners below the line from the first of the sorted points to the last, both included.
fn append_half_hull(points: &[Point], sorted: impl Iterator<Item = usize>, tolerance: f64, corners: &mut Vec<usize>) {
    let first = corners.len();
    for index in sorted {
        while let [.., before, last] = corners[first..]
            && is_flat_corner(points, [before, last, index], tolerance)
        {
            corners.pop();
        }
        corners.push(index);
    }
}

/// Whether the second of three points lies to the left of the line from the first to the third, or within reach of it.
fn is_flat_corner(points: &[Point], [before, corner, after]: [usize; 3], tolerance: f64) -> bool {
    let reach = tolerance * ((points[after].x - points[before].x).abs() + (points[after].y - points[before].y).abs());
    cross(points[before], points[corner], points[after]) <= reach
}

/// Corners of the intersection of two convex polygons, both given by their corners counter-clockwise; empty if they have no
/// point in common. Where they only touch, the result has no area. Sutherland and Hodgman, Reentrant polygon clipping,
/// Communications of the ACM 1974; O(k l) for k and l corners.
#[must_use]
pub fn convex_intersection(one: &[Point], other: &[Point]) -> Vec<Point> {
    let mut clipped = one.to_vec();
    for (corner, &from) in other.iter().enumerate() {
        let to = other[(corner + 1) % other.len()];
        let mut kept = Vec::with_capacity(clipped.len() + 1);
        for (place, &here) in clipped.iter().enumerate() {
            let before = clipped[(place + clipped.len() - 1) % clipped.len()];
            let (side_before, side_here) = (cross(from, to, before), cross(from, to, here));
            if (side_before > 0.0 && side_here < 0.0) || (side_before < 0.0 && side_here > 0.0) {
                let share = side_before / (side_before - side_here);
                kept.push(Point::new(before.x + share * (here.x - before.x), before.y + share * (here.y - before.y)));
            }
            if side_here >= 0.0 {
                kept.push(here);
            }
        }
        clipped = kept;
    }
    clipped
}

/// Area inside a simple polygon given by its corners, not closed: positive if they are counter-clockwise.
#[must_use]
pub fn signed_area(corners: &[Point]) -> f64 {
    let Some(&origin) = corners.first() else { return 0.0 };
    0.5 * corners.windows(2).map(|edge| cross(origin, edge[0], edge[1])).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn points(coordinates: &[(f64, f64)]) -> Vec<Point> {
        coordinates.iter().map(|&(x, y)| Point::new(x, y)).collect()
    }

    #[test]
    fn the_hull_of_a_square_has_four_corners() {
        let square = points(&[(1.0, 1.0), (0.0, 2.0), (2.0, 0.0), (0.0, 0.0), (1.0, 0.0), (2.0, 2.0), (0.0, 0.0)]);
        assert_eq!(convex_hull(&square), [3, 2, 5, 1]);
    }

    #[test]
    fn degenerate_hulls() {
        assert!(convex_hull(&[]).is_empty());
        assert_eq!(convex_hull(&points(&[(3.0, 1.0)])), [0]);
        assert_eq!(convex_hull(&points(&[(3.0, 1.0), (3.0, 1.0), (3.0, 1.0)])), [0]);
        assert_eq!(convex_hull(&points(&[(2.0, 2.0), (0.0, 0.0), (1.0, 1.0), (3.0, 3.0)])), [1, 3]);
        assert_eq!(convex_hull(&points(&[(0.0, 0.0), (-0.0, 1.0), (0.0, 2.0)])), [0, 2]);
    }

    #[test]
    fn the_area_of_a_rectangle_has_the_sign_of_its_orientation() {
        let mut rectangle = points(&[(1.0, 1.0), (4.0, 1.0), (4.0, 3.0), (1.0, 3.0)]);
        assert_eq!(signed_area(&rectangle), 6.0);
        rectangle.reverse();
        assert_eq!(signed_area(&rectangle), -6.0);
    }

    #[test]
    fn convex_intersections_by_hand() {
        let square = points(&[(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)]);
        let triangle = points(&[(2.0, 2.0), (8.0, 2.0), (2.0, 8.0)]);
        let far = points(&[(5.0, 0.0), (6.0, 0.0), (6.0, 1.0)]);
        // The corner [2, 4] x [2, 4] of the square: the line x + y = 10 passes outside it.
        assert_eq!(signed_area(&convex_intersection(&square, &triangle)), 4.0);
        assert_eq!(signed_area(&convex_intersection(&triangle, &square)), 4.0);
        assert!(convex_intersection(&square, &far).is_empty());
    }

    proptest! {
        #[test]
        fn a_hull_is_convex_and_holds_every_point(coordinates in prop::collection::vec((0u8..12, 0u8..12), 0..40)) {
            // Small whole numbers: many repeated and collinear points, and exact arithmetic.
            let cloud: Vec<Point> = coordinates.iter().map(|&(x, y)| Point::new(x.into(), y.into())).collect();
            let hull = convex_hull(&cloud);
            prop_assert_eq!(hull.is_empty(), cloud.is_empty());
            if hull.len() >= 3 {
                for (place, &corner) in hull.iter().enumerate() {
                    let next = hull[(place + 1) % hull.len()];
                    let after = hull[(place + 2) % hull.len()];
                    prop_assert!(cross(cloud[corner], cloud[next], cloud[after]) > 0.0);
                    prop_assert!(cloud.iter().all(|&point| cross(cloud[corner], cloud[next], point) >= 0.0));
                }
            }
        }
    }
}
