//! Which side of a line a point lies on, without rounding, and the hulls and questions that follow from it.
//!
//! Problem: whether two hulls touch must be told right on every farm, also where ponds nearly coincide, nearly lie on a line, or
//! lie in groups that are far from each other: no one tolerance serves all of these.
//! Source: Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates, Discrete &
//! Computational Geometry 1997: a determinant in plain numbers with a bound of its rounding error, which decides nearly always;
//! else the same as a sum of numbers that do not overlap, which is exact. Changed: there is nothing between the two.

use crate::geometry::Point;
use std::borrow::Borrow;
use std::cmp::Ordering;

/// Rounding error of the determinant in plain numbers, relative to the sum of its two products (Shewchuk: ccwerrboundA).
const ERROR_BOUND: f64 = (3.0 + 8.0 * f64::EPSILON) * f64::EPSILON / 2.0;

/// On which side of the line from `a` to `b` the point `c` lies: `Greater` to the left, `Less` to the right, `Equal` on it.
/// Exact, unless products of coordinates are denormal numbers.
pub(super) fn side(a: Point, b: Point, c: Point) -> Ordering {
    let left = (a.x - c.x) * (b.y - c.y);
    let right = (a.y - c.y) * (b.x - c.x);
    let determinant = left - right;
    if determinant.abs() > ERROR_BOUND * (left.abs() + right.abs()) {
        return determinant.total_cmp(&0.0);
    }
    exact_side(a, b, c)
}

fn exact_side(a: Point, b: Point, c: Point) -> Ordering {
    let mut sum = Expansion::default();
    let (ax, ay) = (difference(a.x, c.x), difference(a.y, c.y));
    let (bx, by) = (difference(b.x, c.x), difference(b.y, c.y));
    for (one, other, sign) in [(ax, by, 1.0), (ay, bx, -1.0)] {
        for one in one {
            for other in other {
                let product = one * other;
                sum.add(sign * product);
                sum.add(sign * one.mul_add(other, -product));
            }
        }
    }
    sum.sign()
}

/// A difference as the sum of its rounded value and what rounding took from it.
fn difference(a: f64, b: f64) -> [f64; 2] {
    let rounded = a - b;
    let b_part = a - rounded;
    let a_part = rounded + b_part;
    [rounded, (a - a_part) + (b_part - b)]
}

/// A sum of numbers that do not overlap, the smallest first.
#[derive(Default)]
struct Expansion {
    terms: [f64; 16],
    num_terms: usize,
}

impl Expansion {
    /// Shewchuk's grow-expansion, without terms that are 0.
    fn add(&mut self, value: f64) {
        let (mut sum, mut num_kept) = (value, 0);
        for index in 0..self.num_terms {
            let term = self.terms[index];
            let rounded = sum + term;
            let term_part = rounded - sum;
            let sum_part = rounded - term_part;
            let error = (sum - sum_part) + (term - term_part);
            sum = rounded;
            if error != 0.0 {
                self.terms[num_kept] = error;
                num_kept += 1;
            }
        }
        if sum != 0.0 {
            self.terms[num_kept] = sum;
            num_kept += 1;
        }
        self.num_terms = num_kept;
    }

    fn sign(&self) -> Ordering {
        // The last term outweighs all before it. Adding 0 makes -0 equal to 0.
        let last = self.num_terms.checked_sub(1).map_or(0.0, |last| self.terms[last]);
        (last + 0.0).total_cmp(&0.0)
    }
}

/// Orders points from left to right, those above each other from below: along a line that is turned by next to nothing.
pub(super) fn compare(a: Point, b: Point) -> Ordering {
    (a.x + 0.0).total_cmp(&(b.x + 0.0)).then((a.y + 0.0).total_cmp(&(b.y + 0.0)))
}

/// Places in `points` of the corners of their hull, counter-clockwise from the leftmost; of points in one place the first
/// stands for all, and points on an edge are no corners. Andrew's monotone chain, O(n log n).
pub(super) fn hull(points: &[Point]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_unstable_by(|&a, &b| compare(points[a], points[b]).then(a.cmp(&b)));
    order.dedup_by(|later, earlier| compare(points[*later], points[*earlier]).is_eq());
    if order.len() < 3 {
        return order;
    }
    let mut corners: Vec<usize> = Vec::with_capacity(order.len() + 1);
    let append_half = |corners: &mut Vec<usize>, next: usize, first: usize| {
        while let [.., before, last] = corners[first..]
            && side(points[before], points[last], points[next]).is_le()
        {
            corners.pop();
        }
        corners.push(next);
    };
    order.iter().for_each(|&next| append_half(&mut corners, next, 0));
    corners.pop();
    let first = corners.len();
    order.iter().rev().for_each(|&next| append_half(&mut corners, next, first));
    corners.pop();
    corners
}

/// Whether two convex polygons (corners counter-clockwise, none on an edge; points and segments too) have no point in common,
/// not even one on their borders.
pub(super) fn are_apart<P: Borrow<Point>>(one: &[P], other: &[P]) -> bool {
    let (Some(first), Some(last), Some(other_first), Some(other_last)) =
        (one.first(), one.last(), other.first(), other.last())
    else {
        return true;
    };
    if one.len() < 3 && other.len() < 3 {
        return are_segments_apart((*first.borrow(), *last.borrow()), (*other_first.borrow(), *other_last.borrow()));
    }
    has_separating_edge(one, other) || has_separating_edge(other, one)
}

/// Whether `other` lies strictly outside the line along an edge of `one`: separating axes (Gottschalk, Lin and Manocha, SIGGRAPH
/// 1996, section 5, in the plane).
fn has_separating_edge<P: Borrow<Point>>(one: &[P], other: &[P]) -> bool {
    let mut from: Point = *one[one.len() - 1].borrow();
    one.iter().any(|to| {
        let to = *to.borrow();
        let is_separating = other.iter().all(|corner| side(from, to, *corner.borrow()).is_lt());
        from = to;
        is_separating
    })
}

fn are_segments_apart(one: (Point, Point), other: (Point, Point)) -> bool {
    let of_other = [side(one.0, one.1, other.0), side(one.0, one.1, other.1)];
    let of_one = [side(other.0, other.1, one.0), side(other.0, other.1, one.1)];
    if of_other.into_iter().chain(of_one).all(Ordering::is_eq) {
        let [one, other] =
            [one, other].map(|ends| if compare(ends.0, ends.1).is_le() { ends } else { (ends.1, ends.0) });
        return compare(one.1, other.0).is_lt() || compare(other.1, one.0).is_lt();
    }
    let is_beside = |sides: [Ordering; 2]| sides[0] == sides[1] && sides[0].is_ne();
    is_beside(of_other) || is_beside(of_one)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn points(places: &[(f64, f64)]) -> Vec<Point> {
        places.iter().map(|&(x, y)| Point::new(x, y)).collect()
    }

    #[test]
    fn polygons_segments_and_points_apart() {
        let square = points(&[(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)]);
        let is_apart_from_square = |places: &[(f64, f64)]| {
            let other = points(places);
            assert_eq!(are_apart(&square, &other), are_apart(&other, &square));
            are_apart(&square, &other)
        };
        assert!(is_apart_from_square(&[(3.0, 1.0)]));
        assert!(!is_apart_from_square(&[(2.0, 1.0)]));
        assert!(is_apart_from_square(&[(2.0 + 4.0 * f64::EPSILON, 1.0)]));
        assert!(!is_apart_from_square(&[(3.0, 0.0), (0.0, 3.5)]));
        assert!(is_apart_from_square(&[(5.0, 0.0), (0.0, 5.0)]));
        assert!(is_apart_from_square(&[(2.5, 0.0), (4.0, 0.0)]));
        assert!(!is_apart_from_square(&[(0.5, 0.5), (1.0, 0.5), (0.5, 1.0)]));
        assert!(is_apart_from_square(&[]));
        let segment = points(&[(0.0, 0.0), (2.0, 0.0)]);
        assert!(are_apart(&segment, &points(&[(3.0, 0.0), (4.0, 0.0)])));
        assert!(!are_apart(&segment, &points(&[(1.0, 0.0), (4.0, 0.0)])));
        assert!(!are_apart(&segment, &points(&[(1.0, -1.0), (1.0, 1.0)])));
        assert!(are_apart(&segment, &points(&[(1.0, 1.0), (1.0, 0.5)])));
        assert!(are_apart(&segment, &points(&[(3.0, 0.0)])) && !are_apart(&segment, &points(&[(1.0, 0.0)])));
        assert!(are_apart(&points(&[(1.0, 0.1)]), &segment));
        let point = points(&[(1.0, 1.0)]);
        assert!(!are_apart(&point, &point) && are_apart(&point, &points(&[(1.0, 1.0 + f64::EPSILON)])));
    }

    #[test]
    fn a_hull_has_no_corner_on_an_edge_and_one_for_each_place() {
        let square = points(&[(1.0, 1.0), (0.0, 2.0), (2.0, 0.0), (0.0, 0.0), (1.0, 0.0), (2.0, 2.0), (0.0, 0.0)]);
        assert_eq!(hull(&square), [3, 2, 5, 1]);
        assert!(hull(&[]).is_empty());
        assert_eq!(hull(&points(&[(3.0, 1.0), (3.0, 1.0)])), [0]);
        assert_eq!(hull(&points(&[(2.0, 2.0), (0.0, 0.0), (1.0, 1.0), (3.0, 3.0)])), [1, 3]);
    }

    /// Whole numbers of up to 54 bits, times a power of two: the determinant fits into 128 bits.
    fn whole() -> impl Strategy<Value = i64> {
        prop_oneof![-3_i64..4, (1_i64 << 53) - 4..(1_i64 << 53), -(1_i64 << 53)..(1_i64 << 53)]
    }

    proptest! {
        #[test]
        fn sides_are_exact(places in prop::collection::vec((whole(), whole()), 2), share in 0_i64..5, nudge in (-1_i64..2, -1_i64..2)) {
            let [(ax, ay), (bx, by)] = places[..] else { unreachable!() };
            // On the line through the others, or next to it.
            let along = |a: i64, b: i64, nudge: i64| (a + (b - a) / 4 * share + nudge).clamp(-(1 << 53), 1 << 53);
            let (cx, cy) = (along(ax, bx, nudge.0), along(ay, by, nudge.1));
            let point = |x: i64, y: i64| Point::new(x as f64 * 2.0_f64.powi(-40), y as f64 * 2.0_f64.powi(-40));
            let wide = i128::from;
            let left = (wide(ax) - wide(cx)) * (wide(by) - wide(cy));
            let right = (wide(ay) - wide(cy)) * (wide(bx) - wide(cx));
            prop_assert_eq!(side(point(ax, ay), point(bx, by), point(cx, cy)), left.cmp(&right));
        }
    }
}
