//! Nearest neighbours of points in the plane.

use crate::geometry::Point;

/// A k-d tree (Bentley, Multidimensional binary search trees used for associative searching, Communications of the ACM
/// 1975). Built in O(n log n) by medians, so that repeated and clustered points cost no more than others.
#[derive(Clone, Debug)]
pub struct KdTree {
    points: Vec<Point>,
    /// Indices of points: the median of a range splits it, by x on even levels and by y on odd ones.
    order: Vec<usize>,
}

impl KdTree {
    /// The tree of the given points.
    #[must_use]
    pub fn new(points: &[Point]) -> Self {
        let mut order: Vec<usize> = (0..points.len()).collect();
        split(points, &mut order, true);
        Self { points: points.to_vec(), order }
    }

    /// Indices of the `num_neighbours` points nearest to the point of index `from`, itself left out, with their squared
    /// distances, nearest first; all of them if there are fewer. O(log n + k²) expected for k neighbours.
    #[must_use]
    pub fn nearest(&self, from: usize, num_neighbours: usize) -> Vec<(f64, usize)> {
        let mut query = Query { from, num_neighbours, found: Vec::with_capacity(num_neighbours + 1) };
        if num_neighbours > 0 {
            self.search(&self.order, true, &mut query);
        }
        query.found
    }

    fn search(&self, range: &[usize], is_by_x: bool, query: &mut Query) {
        let middle = range.len() / 2;
        let Some(&median) = range.get(middle) else { return };
        let (here, place) = (self.points[median], self.points[query.from]);
        let (dx, dy) = (place.x - here.x, place.y - here.y);
        query.offer(dx * dx + dy * dy, median);
        let offset = if is_by_x { dx } else { dy };
        let (below, above) = (&range[..middle], &range[middle + 1..]);
        let (near, far) = if offset < 0.0 { (below, above) } else { (above, below) };
        self.search(near, !is_by_x, query);
        if offset * offset < query.reach() {
            self.search(far, !is_by_x, query);
        }
    }
}

fn split(points: &[Point], range: &mut [usize], is_by_x: bool) {
    if range.len() < 2 {
        return;
    }
    let middle = range.len() / 2;
    let key = |index: usize| if is_by_x { points[index].x } else { points[index].y };
    range.select_nth_unstable_by(middle, |&a, &b| key(a).total_cmp(&key(b)).then(a.cmp(&b)));
    let (below, above) = range.split_at_mut(middle);
    split(points, below, !is_by_x);
    split(points, &mut above[1..], !is_by_x);
}

struct Query {
    from: usize,
    num_neighbours: usize,
    found: Vec<(f64, usize)>,
}

impl Query {
    fn offer(&mut self, squared_distance: f64, index: usize) {
        if index == self.from || squared_distance >= self.reach() {
            return;
        }
        let place = self.found.partition_point(|&(other, _)| other <= squared_distance);
        self.found.insert(place, (squared_distance, index));
        self.found.truncate(self.num_neighbours);
    }

    /// Squared distance from which on nothing is of interest.
    fn reach(&self) -> f64 {
        if self.found.len() < self.num_neighbours { f64::INFINITY } else { self.found[self.num_neighbours - 1].0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn as_near_as_by_trying_all(places in prop::collection::vec((0u8..20, 0u8..20), 1..60), num in 0usize..12) {
            let points: Vec<Point> = places.iter().map(|&(x, y)| Point::new(x.into(), y.into())).collect();
            let tree = KdTree::new(&points);
            for from in 0..points.len() {
                let squared = |other: usize| {
                    let (dx, dy) = (points[from].x - points[other].x, points[from].y - points[other].y);
                    dx * dx + dy * dy
                };
                let mut all: Vec<f64> = (0..points.len()).filter(|&other| other != from).map(squared).collect();
                all.sort_by(f64::total_cmp);
                all.truncate(num);
                let found = tree.nearest(from, num);
                prop_assert!(found.iter().all(|&(distance, index)| index != from && distance == squared(index)));
                prop_assert_eq!(found.iter().map(|&(distance, _)| distance).collect::<Vec<f64>>(), all);
            }
        }
    }
}
