//! Orders of points: around a place, along a curve; and where an order is cut.

use crate::geometry::Point;

/// Ends of new sectors, each with its share of the cost, were cost spread evenly within each old sector.
pub(super) fn ends_by_cost(old_ends: &[usize], old_costs: &[f64], shares: &[f64]) -> Vec<usize> {
    let cost_of_a_share = old_costs.iter().sum::<f64>() / shares.iter().sum::<f64>();
    let mut ends = vec![0];
    let (mut sum, mut goal) = (0.0, shares[0] * cost_of_a_share);
    for (range, cost) in old_ends.windows(2).zip(old_costs) {
        let size = range[1] - range[0];
        for place in 0..size {
            sum += cost / size as f64;
            if sum >= goal && ends.len() < shares.len() {
                goal += shares[ends.len()] * cost_of_a_share;
                ends.push(range[0] + place + 1);
            }
        }
    }
    ends.resize(shares.len() + 1, old_ends[old_ends.len() - 1]);
    ends
}

/// Grows with the angle of `(x, y)` from 0 to 4, without trigonometry: the same on every machine.
pub(crate) fn pseudo_angle(x: f64, y: f64) -> f64 {
    let norm = x.abs() + y.abs();
    if norm == 0.0 {
        return 0.0;
    }
    let ratio = x / norm;
    if y >= 0.0 { 1.0 - ratio } else { 3.0 + ratio }
}

/// The place in a list sorted by [`pseudo_angle`] that follows the widest gap between two of them.
pub(crate) fn place_after_widest_gap(keyed: &[(f64, u32)]) -> usize {
    let last = keyed.len() - 1;
    let (mut place, mut widest) = (0, keyed[0].0 + 4.0 - keyed[last].0);
    for (index, pair) in keyed.windows(2).enumerate() {
        if pair[1].0 - pair[0].0 > widest {
            (place, widest) = (index + 1, pair[1].0 - pair[0].0);
        }
    }
    place
}

/// Place of each point along a Hilbert curve over the bounding square.
pub(crate) fn curve_keys(points: &[Point]) -> Vec<u32> {
    let (mut low, mut high) = (points[0], points[0]);
    for point in points {
        low = Point::new(low.x.min(point.x), low.y.min(point.y));
        high = Point::new(high.x.max(point.x), high.y.max(point.y));
    }
    let side = (high.x - low.x).max(high.y - low.y).max(f64::MIN_POSITIVE);
    let scale = f64::from(CURVE_SIDE - 1) / side;
    points
        .iter()
        .map(|point| curve_key(((point.x - low.x) * scale) as u32, ((point.y - low.y) * scale) as u32))
        .collect()
}

/// Cells along one side of the Hilbert curve.
const CURVE_SIDE: u32 = 1 << 16;

/// Position of a cell on the Hilbert curve.
fn curve_key(mut x: u32, mut y: u32) -> u32 {
    let mut key = 0;
    let mut side = CURVE_SIDE / 2;
    while side > 0 {
        let (right, upper) = (u32::from(x & side > 0), u32::from(y & side > 0));
        key += side * side * ((3 * right) ^ upper);
        if upper == 0 {
            if right == 1 {
                x = !x & (CURVE_SIDE - 1);
                y = !y & (CURVE_SIDE - 1);
            }
            std::mem::swap(&mut x, &mut y);
        }
        side >>= 1;
    }
    key
}
