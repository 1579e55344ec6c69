//! Steps 3 to 6 of HPP against traces of its authors' MATLAB code, run under Octave: hull in, pairs and order out.
//!
//! The traces lie beside the repository, in `../shared/data`; without them the test says so and passes.

use pondhop_core::geometry::Point;
use pondhop_core::hpp::{cheapest_path, order_along};
use pondhop_core::sweep::{ClosedPolygon, Tolerance};
use serde::Deserialize;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The authors' unit square in their units.
const SIDE: f64 = 1000.0;

#[derive(Deserialize)]
struct Trace {
    instance: usize,
    clusters: Vec<TracedCluster>,
}

#[derive(Deserialize)]
struct TracedCluster {
    /// Closed: the first corner is repeated at the end.
    hull: Vec<[f64; 2]>,
    /// 1-based rows of `hull`.
    pairs: Vec<[usize; 2]>,
    path: Vec<[f64; 2]>,
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

fn read<T: for<'a> Deserialize<'a>>(path: &Path) -> T {
    let text = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The pitch to the last bit: the files round the spacing, but some hull coordinate is a power of two of it.
fn traced_pitch(trace: &Trace, rounded: f64) -> f64 {
    let coordinates = trace.clusters.iter().flat_map(|cluster| cluster.hull.iter().flatten());
    coordinates
        .filter_map(|&coordinate| {
            let multiple = (coordinate / rounded).round();
            (multiple >= 1.0 && (multiple as u64).is_power_of_two()).then_some(coordinate / multiple)
        })
        .next()
        .expect("a hull coordinate that is a power of two of the pitch")
}

#[test]
fn the_authors_pairs_and_orders_are_reproduced() {
    let data = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    if !data.is_dir() {
        eprintln!("skipped: no traces in {}", data.display());
        return;
    }
    let (mut num_clusters, mut num_pairs_equal, mut num_orders_equal) = (0, 0, 0);
    for name in ["authors50", "farms300"] {
        let farms: Vec<Farm> = read(&data.join(format!("instances/{name}.json")));
        let traces: Vec<Trace> = read(&data.join(format!("golden/hpp_trace_{name}.json")));
        for trace in &traces {
            let farm = &farms[trace.instance];
            let pitch = traced_pitch(trace, farm.spacing * SIDE);
            let tolerance = if std::env::var("TOL").is_ok() { Tolerance::of_side(SIDE) } else { Tolerance::EXACT };
            for (index, traced) in trace.clusters.iter().enumerate() {
                let hull: Vec<Point> = traced.hull.iter().map(|&[x, y]| Point::new(x, y)).collect();
                let corners = &hull[..hull.len() - 1];
                let pairs: Vec<[usize; 2]> = ClosedPolygon::new(corners, tolerance)
                    .caliper_pairs()
                    .iter()
                    .map(|&(i, j)| [i + 1, j + 1])
                    .collect();

                let path = cheapest_path(corners, scaled(farm.depot), pitch, tolerance);
                let members: Vec<usize> = BTreeSet::from_iter(traced.order.iter().copied()).into_iter().collect();
                let ponds: Vec<Point> = members.iter().map(|&pond| scaled(farm.ponds[pond])).collect();
                let order: Vec<usize> =
                    order_along(&path, &ponds, pitch, tolerance).into_iter().map(|index| members[index]).collect();
                num_clusters += 1;
                num_pairs_equal += usize::from(pairs == traced.pairs);
                num_orders_equal += usize::from(order == traced.order);
                if pairs != traced.pairs || order != traced.order {
                    eprintln!(
                        "{name}[{}] cluster {index}: pairs {} order {}\n path {:?}\n   vs {:?}",
                        trace.instance,
                        pairs == traced.pairs,
                        order == traced.order,
                        path.corners.iter().map(|p| [p.x.round(), p.y.round()]).collect::<Vec<_>>(),
                        traced.path.iter().map(|p| [p[0].round(), p[1].round()]).collect::<Vec<_>>()
                    );
                }
            }
        }
    }
    eprintln!("{num_clusters} {num_pairs_equal} {num_orders_equal}");
    assert_eq!((num_clusters, num_pairs_equal), (90, 90));
    assert!(num_orders_equal >= 88, "{num_orders_equal} of 90 orders");
}
