//! Nearest neighbours of points in the plane.

use crate::geometry::Point;

/// Points in a leaf at most: fewer cost steps down the tree, more cost distances.
const MAX_LEAF: usize = 8;

/// A k-d tree (Bentley, Multidimensional binary search trees used for associative searching, Communications of the ACM
/// 1975) with small leaves. Built in O(n log n) by medians, so that repeated and clustered points cost no more than others.
#[derive(Clone, Debug)]
pub struct KdTree {
    /// Points with their indices; the median of a range splits it, by x on even levels and by y on odd ones.
    entries: Vec<(Point, u32)>,
    /// Place in `entries` of each point.
    places: Vec<u32>,
}

/// A point near another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Near {
    /// Square of its distance.
    pub squared_distance: f64,
    /// Its index.
    pub index: u32,
}

impl KdTree {
    /// The tree of the given points.
    ///
    /// # Panics
    /// If there are 2³² points or more.
    #[must_use]
    pub fn new(points: &[Point]) -> Self {
        assert!(u32::try_from(points.len()).is_ok(), "a tree holds fewer than 2^32 points");
        let mut entries: Vec<(Point, u32)> = points.iter().copied().zip(0..).collect();
        split(&mut entries, true);
        let mut places = vec![0; points.len()];
        for (place, entry) in entries.iter().enumerate() {
            places[entry.1 as usize] = place as u32;
        }
        Self { entries, places }
    }

    /// Fills `found` with the `num_neighbours` points nearest to the point of index `from`, itself left out, nearest first;
    /// with all of them if there are fewer. O(log n + k²) expected for k neighbours.
    pub fn nearest(&self, from: usize, num_neighbours: usize, found: &mut Vec<Near>) {
        found.clear();
        if num_neighbours == 0 {
            return;
        }
        let (place, index) = self.entries[self.places[from] as usize];
        let mut query = Query { place, index, num_neighbours, reach: f64::INFINITY, found };
        search(&self.entries, true, &mut query);
    }
}

fn split(range: &mut [(Point, u32)], is_by_x: bool) {
    if range.len() <= MAX_LEAF {
        return;
    }
    let middle = range.len() / 2;
    range.select_nth_unstable_by(middle, |a, b| {
        let (first, second) = if is_by_x { (a.0.x, b.0.x) } else { (a.0.y, b.0.y) };
        first.total_cmp(&second).then(a.1.cmp(&b.1))
    });
    let (below, above) = range.split_at_mut(middle);
    split(below, !is_by_x);
    split(&mut above[1..], !is_by_x);
}

struct Query<'a> {
    place: Point,
    index: u32,
    num_neighbours: usize,
    /// Squared distance from which on nothing is of interest.
    reach: f64,
    found: &'a mut Vec<Near>,
}

fn search(range: &[(Point, u32)], is_by_x: bool, query: &mut Query<'_>) {
    if range.len() <= MAX_LEAF {
        for &(point, index) in range {
            query.offer(point, index);
        }
        return;
    }
    let middle = range.len() / 2;
    let (below, above) = (&range[..middle], &range[middle + 1..]);
    let (median, index) = range[middle];
    query.offer(median, index);
    let offset = if is_by_x { query.place.x - median.x } else { query.place.y - median.y };
    let (near, far) = if offset < 0.0 { (below, above) } else { (above, below) };
    search(near, !is_by_x, query);
    if offset * offset < query.reach {
        search(far, !is_by_x, query);
    }
}

impl Query<'_> {
    fn offer(&mut self, point: Point, index: u32) {
        let (dx, dy) = (point.x - self.place.x, point.y - self.place.y);
        let squared_distance = dx * dx + dy * dy;
        if squared_distance >= self.reach || index == self.index {
            return;
        }
        let near = Near { squared_distance, index };
        if self.found.len() < self.num_neighbours {
            self.found.push(near);
        }
        let mut place = self.found.len() - 1;
        while place > 0 && self.found[place - 1].squared_distance > squared_distance {
            self.found[place] = self.found[place - 1];
            place -= 1;
        }
        self.found[place] = near;
        if self.found.len() == self.num_neighbours {
            self.reach = self.found[self.num_neighbours - 1].squared_distance;
        }
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
            let mut found = Vec::new();
            for from in 0..points.len() {
                let squared = |other: usize| {
                    let (dx, dy) = (points[from].x - points[other].x, points[from].y - points[other].y);
                    dx * dx + dy * dy
                };
                let mut all: Vec<f64> = (0..points.len()).filter(|&other| other != from).map(squared).collect();
                all.sort_by(f64::total_cmp);
                all.truncate(num);
                tree.nearest(from, num, &mut found);
                for near in &found {
                    prop_assert!(near.index as usize != from && near.squared_distance == squared(near.index as usize));
                }
                prop_assert_eq!(found.iter().map(|near| near.squared_distance).collect::<Vec<f64>>(), all);
            }
        }
    }
}
