//! Clusters of nearby points: k-means, the first phase of the paper's planner.
//!
//! Problem: split points into `k` clusters so that the sum of squared distances to the cluster's mean is small.
//! Source: Lloyd, Least squares quantization in PCM, IEEE Trans. Information Theory 1982 (the iteration); Arthur and
//! Vassilvitskii, k-means++, SODA 2007 (the start). One start, at most 100 iterations, no balancing: what MATLAB's
//! `kmeans` does by default and the paper uses (section 3).
//! Complexity: O(n k) per iteration at worst and O(n + k) memory; points far from any border between clusters are passed
//! over (Hamerly, Making k-means even faster, SIAM Data Mining 2010), so that late iterations cost little more than O(n).
//! Changed: the means are updated by the points that moved, not summed afresh; an empty cluster keeps its mean, where
//! MATLAB moves it to the farthest point (it happens only where points coincide, and the planner repairs it).

use crate::geometry::Point;
use crate::random::Random;

/// Iterations after which the clusters are taken as they are.
const MAX_ITERATIONS: usize = 100;
/// Points handled at once, so that the compiler keeps them in vector registers.
const NUM_LANES: usize = 4;
/// Share of a distance that rounding may hide: a lead of less is none.
const ROUNDING: f64 = 1e-9;

/// Points split into clusters.
#[derive(Clone, Debug, PartialEq)]
pub struct Clustering {
    /// Cluster of each point.
    pub labels: Vec<usize>,
    /// Mean of each cluster; where a cluster is empty, the last mean it had.
    pub centroids: Vec<Point>,
}

/// The points in `min(num_clusters, number of points)` clusters. Ties go to the cluster of lower index.
///
/// # Panics
/// If there is no point or no cluster.
#[must_use]
pub fn kmeans(points: &[Point], num_clusters: usize, random: &mut Random) -> Clustering {
    assert!(!points.is_empty() && num_clusters > 0, "at least one point and one cluster");
    let mut centroids = spread_start(points, num_clusters.min(points.len()), random);
    let mut groups: Vec<Group> = points.chunks(NUM_LANES).map(Group::new).collect();
    let mut labels = Vec::with_capacity(groups.len() * NUM_LANES);
    for group in &mut groups {
        labels.extend(group.nearest(&centroids, 0.0));
    }
    labels.truncate(points.len());
    let mut sums = vec![(Point::default(), 0.0_f64); centroids.len()];
    for (point, &label) in points.iter().zip(&labels) {
        shift(&mut sums[label], *point, 1.0);
    }
    let mut travelled = 0.0;
    for _ in 1..MAX_ITERATIONS {
        travelled += update_means(&mut centroids, &sums);
        let mut has_moved = false;
        let chunks = points.chunks(NUM_LANES).zip(labels.chunks_mut(NUM_LANES));
        for (group, (points, labels)) in groups.iter_mut().zip(chunks) {
            if travelled < group.safe_until {
                continue;
            }
            let nearest = group.nearest(&centroids, travelled);
            for ((point, label), new) in points.iter().zip(labels).zip(nearest) {
                if *label != new {
                    has_moved = true;
                    shift(&mut sums[*label], *point, -1.0);
                    shift(&mut sums[new], *point, 1.0);
                    *label = new;
                }
            }
        }
        if !has_moved {
            break;
        }
    }
    Clustering { labels, centroids }
}

/// Moves every centroid to the mean of its points; the two longest of the moves together, which no difference between the
/// distances of a point to two centroids changes by more than.
fn update_means(centroids: &mut [Point], sums: &[(Point, f64)]) -> f64 {
    let (mut longest, mut second) = (0.0, 0.0);
    for (centroid, &(sum, count)) in centroids.iter_mut().zip(sums) {
        if count > 0.0 {
            let mean = Point::new(sum.x / count, sum.y / count);
            let moved = centroid.distance(mean);
            second = f64::max(second, f64::min(longest, moved));
            longest = f64::max(longest, moved);
            *centroid = mean;
        }
    }
    longest + second
}

/// Adds `count` copies of `point` to a sum.
fn shift((sum, total): &mut (Point, f64), point: Point, count: f64) {
    sum.x += count * point.x;
    sum.y += count * point.y;
    *total += count;
}

/// k-means++: the first centroid uniformly, each further one with probability proportional to the squared distance
/// to the nearest so far (Arthur and Vassilvitskii 2007, section 2.2). Where all points coincide with a centroid, the
/// first point is taken again.
fn spread_start(points: &[Point], num_clusters: usize, random: &mut Random) -> Vec<Point> {
    let mut centroids = vec![points[random.below(points.len())]];
    let mut squares = vec![f64::INFINITY; points.len()];
    while centroids.len() < num_clusters {
        let last = centroids[centroids.len() - 1];
        let mut total = 0.0;
        for (square, point) in squares.iter_mut().zip(points) {
            *square = square.min(squared_distance(*point, last));
            total += *square;
        }
        let mut remaining = random.uniform() * total;
        let chosen = squares.iter().position(|&square| {
            remaining -= square;
            remaining < 0.0
        });
        centroids.push(points[chosen.unwrap_or(0)]);
    }
    centroids
}

fn squared_distance(a: Point, b: Point) -> f64 {
    let (dx, dy) = (a.x - b.x, a.y - b.y);
    dx * dx + dy * dy
}

/// Neighbours in the input, which are handled at once; the last group is padded with copies of its first point.
struct Group {
    xs: [f64; NUM_LANES],
    ys: [f64; NUM_LANES],
    /// What the centroids may have travelled before another of them can be nearest to one of the points.
    safe_until: f64,
}

impl Group {
    fn new(points: &[Point]) -> Self {
        let lane = |lane: usize| *points.get(lane).unwrap_or(&points[0]);
        let (xs, ys) = (std::array::from_fn(|place| lane(place).x), std::array::from_fn(|place| lane(place).y));
        Self { xs, ys, safe_until: 0.0 }
    }

    /// The index of the nearest centroid of every point, after the centroids have travelled so far.
    fn nearest(&mut self, centroids: &[Point], travelled: f64) -> [usize; NUM_LANES] {
        let mut best = [f64::INFINITY; NUM_LANES];
        let mut second = [f64::INFINITY; NUM_LANES];
        let mut labels = [0_u64; NUM_LANES];
        for (label, centroid) in (0_u64..).zip(centroids) {
            for lane in 0..NUM_LANES {
                let (dx, dy) = (self.xs[lane] - centroid.x, self.ys[lane] - centroid.y);
                let square = dx * dx + dy * dy;
                let is_nearer = square < best[lane];
                let loser = if best[lane] > square { best[lane] } else { square };
                second[lane] = if loser < second[lane] { loser } else { second[lane] };
                best[lane] = if square < best[lane] { square } else { best[lane] };
                labels[lane] = if is_nearer { label } else { labels[lane] };
            }
        }
        let mut lead = f64::INFINITY;
        for lane in 0..NUM_LANES {
            let (best, second) = (best[lane].sqrt(), second[lane].sqrt());
            lead = lead.min((1.0 - ROUNDING) * second - best);
        }
        self.safe_until = travelled + lead;
        labels.map(|label| label as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_heaps_are_found() {
        let points: Vec<Point> = [0.0, 1.0, 2.0, 10.0, 11.0, 12.0].iter().map(|&x| Point::new(x, 0.0)).collect();
        for seed in 0..20 {
            let clustering = kmeans(&points, 2, &mut Random::new(seed));
            let first = clustering.labels[0];
            assert_eq!(clustering.labels, [first, first, first, 1 - first, 1 - first, 1 - first]);
            assert_eq!(clustering.centroids[first], Point::new(1.0, 0.0));
            assert_eq!(clustering.centroids[1 - first], Point::new(11.0, 0.0));
        }
    }

    #[test]
    fn every_point_is_nearest_to_its_own_mean() {
        let mut random = Random::new(3);
        let points: Vec<Point> = (0..203).map(|_| Point::new(random.uniform(), random.uniform())).collect();
        let clustering = kmeans(&points, 7, &mut random);
        for (label, centroid) in clustering.centroids.iter().enumerate() {
            let members: Vec<&Point> = points
                .iter()
                .zip(&clustering.labels)
                .filter(|(_, own)| **own == label)
                .map(|(point, _)| point)
                .collect();
            let count = members.len() as f64;
            let mean_x = members.iter().map(|point| point.x).sum::<f64>() / count;
            let mean_y = members.iter().map(|point| point.y).sum::<f64>() / count;
            assert!(centroid.distance(Point::new(mean_x, mean_y)) < 1e-12);
        }
        for (point, &label) in points.iter().zip(&clustering.labels) {
            let own = point.distance(clustering.centroids[label]);
            assert!(clustering.centroids.iter().all(|centroid| point.distance(*centroid) >= own));
        }
    }

    #[test]
    fn there_are_never_more_clusters_than_points() {
        let points = [Point::new(1.0, 1.0), Point::new(2.0, 2.0)];
        let clustering = kmeans(&points, 5, &mut Random::new(1));
        assert_eq!(clustering.centroids.len(), 2);
        assert_ne!(clustering.labels[0], clustering.labels[1]);
    }

    #[test]
    fn coinciding_points_share_a_cluster() {
        let points = [Point::new(1.0, 1.0); 9];
        assert_eq!(kmeans(&points, 3, &mut Random::new(1)).labels, [0; 9]);
    }
}
