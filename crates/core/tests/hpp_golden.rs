//! Steps 3 to 6 of HPP against traces of its authors' MATLAB code, run under Octave: hull in, pairs and order out.
//!
//! `data/hpp_traces.json` holds 18 farms, of the authors (50 ponds, Apache-2.0) and of our generator (300 ponds), with what their
//! code made of each cluster. They are met with [`Tolerance::EXACT`] only: that code lets rounding decide which legs are
//! parallel to an axis and cost nothing.
//! Two of the 90 orders hang on the last bit of a fused multiplication and addition, which we do not use.

use pondhop_core::geometry::Point;
use pondhop_core::hpp::{cheapest_path, order_along};
use pondhop_core::sweep::{ClosedPolygon, Tolerance};
use serde::Deserialize;
use std::collections::BTreeSet;

/// The side of the authors' unit square in their units.
const SIDE: f64 = 1000.0;

#[derive(Deserialize)]
struct Trace {
    farm: Farm,
    clusters: Vec<TracedCluster>,
}

#[derive(Deserialize)]
struct TracedCluster {
    /// Closed: the first corner is repeated at the end.
    hull: Vec<[f64; 2]>,
    /// 1-based rows of `hull`.
    pairs: Vec<[usize; 2]>,
    order: Vec<usize>,
}

#[derive(Deserialize)]
struct Farm {
    depot: [f64; 2],
    ponds: Vec<[f64; 2]>,
    spacing: f64,
}

fn scaled([x, y]: [f64; 2]) -> Point {
    Point::new(x * SIDE, y * SIDE)
}

/// The pitch to the last bit: the files round the spacing, but some hull coordinate is a power of two of it.
fn traced_pitch(clusters: &[TracedCluster], rounded: f64) -> f64 {
    let coordinates = clusters.iter().flat_map(|cluster| cluster.hull.iter().flatten());
    coordinates
        .map(|&coordinate| (coordinate, (coordinate / rounded).round()))
        .find(|&(_, multiple)| multiple >= 1.0 && (multiple as u64).is_power_of_two())
        .map(|(coordinate, multiple)| coordinate / multiple)
        .expect("a hull coordinate that is a power of two of the pitch")
}

#[test]
fn the_authors_pairs_and_orders_are_reproduced() {
    let traces: Vec<Trace> =
        serde_json::from_str(include_str!("data/hpp_traces.json")).expect("traces as they were made");
    let (mut num_clusters, mut num_pairs_equal, mut num_orders_equal) = (0, 0, 0);
    for Trace { farm, clusters } in &traces {
        let pitch = traced_pitch(clusters, farm.spacing * SIDE);
        for traced in clusters {
            let rows: Vec<Point> = traced.hull.iter().map(|&[x, y]| Point::new(x, y)).collect();
            let hull = &rows[..rows.len() - 1];
            let pairs = ClosedPolygon::new(hull, Tolerance::EXACT).caliper_pairs();
            let pairs: Vec<[usize; 2]> = pairs.into_iter().map(|(i, j)| [i + 1, j + 1]).collect();
            let path = cheapest_path(hull, scaled(farm.depot), pitch, Tolerance::EXACT);
            let members: Vec<usize> = BTreeSet::from_iter(traced.order.iter().copied()).into_iter().collect();
            let ponds: Vec<Point> = members.iter().map(|&pond| scaled(farm.ponds[pond])).collect();
            let order = order_along(&path, &ponds, pitch, Tolerance::EXACT);
            let order: Vec<usize> = order.into_iter().map(|index| members[index]).collect();
            num_clusters += 1;
            num_pairs_equal += usize::from(pairs == traced.pairs);
            num_orders_equal += usize::from(order == traced.order);
        }
    }
    assert_eq!((num_clusters, num_pairs_equal), (90, 90));
    assert!(num_orders_equal >= 88, "{num_orders_equal} of 90 orders are the authors'");
}
