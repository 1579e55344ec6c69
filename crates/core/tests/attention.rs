//! The attention model on cases small enough to be worked out by hand, and what is said about broken weights.

mod attention_models;

use attention_models::{Tensors, random_tensors, tensors};
use ndarray::{Array2, ArrayD, IxDyn};
use pondhop_core::attention::{Architecture, Decoding, Model, Variant};
use pondhop_core::evaluate::evaluate;
use pondhop_core::geometry::Point;
use pondhop_core::plan::Violation;
use pondhop_core::problem::Problem;

const CLOSED: f32 = f32::NEG_INFINITY;

fn tiny(variant: Variant) -> Architecture {
    Architecture { variant, width: 1, num_heads: 1, num_layers: 1, feed_forward_width: 1 }
}

/// All weights are 0 but the given ones; the encoder passes embeddings on as they are.
fn tiny_model(variant: Variant, given: &[(&str, &[f32])]) -> Model {
    let mut tensors = tensors(&tiny(variant), |name| if name.ends_with("scale") { 1.0 } else { 0.0 });
    for &(name, values) in given {
        let tensor = tensors.get_mut(name).unwrap();
        let shape = tensor.raw_dim();
        *tensor = ArrayD::from_shape_vec(shape, values.to_vec()).unwrap();
    }
    Model::new(tiny(variant), tensors).unwrap()
}

fn problem(ponds: &[(f64, f64)], num_drones: usize) -> Problem {
    let ponds: Vec<Point> = ponds.iter().map(|&(x, y)| Point::new(x, y)).collect();
    Problem::research(Point::new(0.0, 0.0), &ponds, num_drones).unwrap()
}

fn assert_close(found: &Array2<f32>, expected: &[&[f32]]) {
    assert_eq!(found.nrows(), expected.len());
    for (found, expected) in found.rows().into_iter().zip(expected) {
        assert_eq!(found.len(), expected.len());
        for (found, &expected) in found.iter().zip(*expected) {
            assert!(*found == expected || (found - expected).abs() < 1e-5, "{found} instead of {expected}");
        }
    }
}

/// Embeddings: 1 for a pond, 0 for the depot. Values and keys of logits are the embeddings, keys of the glimpse are 0, so
/// the glimpse is the share of ponds among the open nodes, and it is a pond's logit before the bound.
fn shares(variant: Variant) -> Model {
    tiny_model(variant, &[("pond.bias", &[1.0]), ("node.weight", &[0.0, 1.0, 1.0]), ("glimpse.weight", &[1.0])])
}

#[test]
fn a_hand_computed_glimpse_and_logit() {
    let of_share = |share: f32| 10.0 * share.tanh();
    let ponds = [(1.0, 0.0), (1.0, 0.0), (0.0, 1.0)];
    let logits = shares(Variant::Cvrp).logits(&problem(&ponds, 2), &[vec![0, 2], vec![1]]).unwrap();
    // Capacity 3 / 2 + 1 = 2: after two ponds only the depot is open.
    assert_close(
        &logits,
        &[
            &[CLOSED, of_share(1.0), of_share(1.0), of_share(1.0)],
            &[0.0, CLOSED, of_share(2.0 / 3.0), of_share(2.0 / 3.0)],
            &[0.0, CLOSED, CLOSED, CLOSED],
            &[CLOSED, CLOSED, of_share(1.0), CLOSED],
        ],
    );
}

#[test]
fn a_hand_computed_query() {
    // Embeddings: the x coordinate. Query: mean embedding of depot and ponds + 2 · last embedding + 3 · capacity left.
    // Glimpse: attention of the query over keys and values, both the embeddings.
    let given: [(&str, &[f32]); 6] = [
        ("pond.weight", &[1.0, 0.0, 0.0]),
        ("depot.weight", &[1.0, 0.0]),
        ("fixed.weight", &[1.0]),
        ("step.weight", &[2.0, 3.0]),
        ("node.weight", &[1.0, 1.0, 1.0]),
        ("glimpse.weight", &[0.5]),
    ];
    let model = tiny_model(Variant::Cvrp, &given);
    let logits = model.logits(&problem(&[(0.5, 0.0), (1.0, 0.25)], 1), &[vec![0, 1]]).unwrap();
    let glimpse = |query: f32, open: &[f32]| {
        let weights: Vec<f32> = open.iter().map(|x| (query * x).exp()).collect();
        let sum: f32 = open.iter().zip(&weights).map(|(x, weight)| x * weight).sum();
        0.5 * sum / weights.iter().sum::<f32>()
    };
    let first = glimpse(0.5 + 0.0 + 3.0, &[0.5, 1.0]);
    let second = glimpse(0.5 + 2.0 * 0.5 + 3.0 * (2.0 / 3.0), &[0.0, 1.0]);
    let logit = |glimpse: f32, x: f32| 10.0 * (glimpse * x).tanh();
    assert_close(
        &logits,
        &[&[CLOSED, logit(first, 0.5), logit(first, 1.0)], &[logit(second, 0.0), CLOSED, logit(second, 1.0)]],
    );
}

#[test]
fn a_hand_computed_encoder() {
    // A pond's x coordinate, 0.5 or 1, and the depot's, 0, go through one layer. Attention: queries and keys are 1 and the
    // embedding, so a node gathers the mean of the embeddings weighted by their exponentials, whatever its own.
    let given: [(&str, &[f32]); 12] = [
        ("pond.weight", &[1.0, 0.0, 0.0]),
        ("depot.weight", &[1.0, 0.0]),
        ("layers.0.query.weight", &[1.0]),
        ("layers.0.key.weight", &[2.0]),
        ("layers.0.value.weight", &[3.0]),
        ("layers.0.output.weight", &[0.5]),
        ("layers.0.attention_norm.scale", &[0.25]),
        ("layers.0.hidden.weight", &[-2.0]),
        ("layers.0.hidden.bias", &[1.0]),
        ("layers.0.contract.bias", &[0.125]),
        ("layers.0.contract.weight", &[4.0]),
        ("layers.0.feed_forward_norm.shift", &[-0.5]),
    ];
    let reading: [(&str, &[f32]); 2] = [("node.weight", &[0.0, 1.0, 1.0]), ("glimpse.weight", &[1.0])];
    let model = tiny_model(Variant::Cvrp, &[&given[..], &reading[..]].concat());
    let logits = model.logits(&problem(&[(0.5, 0.0), (1.0, 0.25)], 1), &[vec![0]]).unwrap();
    let inputs = [0.0_f32, 0.5, 1.0];
    let encoded = inputs.map(|input| {
        let weights = inputs.map(|other| (input * 2.0 * other).exp());
        let gathered: f32 = inputs.iter().zip(weights).map(|(other, weight)| 3.0 * other * weight).sum();
        let normalised = 0.25 * (input + 0.5 * gathered / weights.iter().sum::<f32>());
        normalised + 4.0 * (1.0 - 2.0 * normalised).max(0.0) + 0.125 - 0.5
    });
    let glimpse = (encoded[1] + encoded[2]) / 2.0;
    let logit = |node: usize| 10.0 * (glimpse * encoded[node]).tanh();
    assert_close(&logits, &[&[CLOSED, logit(1), logit(2)]]);
}

#[test]
fn minmax_shuns_distance_and_keeps_a_route_for_every_drone_at_most() {
    // Spacings 1, 1 and 2 in units of the map, their mean 4/3; the farthest pond is at 5.
    let model = tiny_model(Variant::MinMax, &[("distance_weight", &[2.0])]);
    let farm = problem(&[(2.0, 0.0), (3.0, 0.0), (5.0, 0.0)], 2);
    let logit = |distance: f32| -2.0 * (1.0 + distance / (4.0 / 3.0)).ln();
    assert_close(
        &model.logits(&farm, &[vec![0], vec![2, 1]]).unwrap(),
        &[
            &[CLOSED, logit(2.0), logit(3.0), logit(5.0)],
            &[logit(2.0), CLOSED, logit(1.0), logit(3.0)],
            &[CLOSED, CLOSED, logit(3.0), logit(5.0)],
            &[CLOSED, CLOSED, logit(2.0), CLOSED],
        ],
    );
    assert_eq!(model.plan(&farm, Decoding::Greedy, 1), [[0, 1, 2]]);
}

#[test]
fn minmax_sees_the_state_of_its_routes() {
    // Each state feature in its turn is the query; keys and values of the two ponds differ by their x, so the glimpse tells
    // the query. Farthest pond at 4, so that lengths are in quarters.
    let farm = problem(&[(4.0, 0.0), (-3.0, 0.0), (0.0, 2.0)], 2);
    let features = [
        [1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0],
        [1.0, 1.0, 1.0, 0.0, 2.0 / 3.0, 2.0 / 3.0, 2.0],
        [0.5, 0.0, 0.0, 2.0, 2.0 / 3.0, 4.0 / 3.0, -2.0],
    ];
    for feature in 0..7 {
        let mut step = [0.0; 8];
        step[1 + feature] = 1.0;
        let given: [(&str, &[f32]); 4] = [
            ("pond.weight", &[1.0, 0.0, 0.0, 0.0]),
            ("step.weight", &step),
            ("node.weight", &[1.0, 1.0, 1.0]),
            ("glimpse.weight", &[1.0]),
        ];
        let model = tiny_model(Variant::MinMax, &given);
        let logits = model.logits(&farm, &[vec![0], vec![1]]).unwrap();
        let expected = |step: usize, open: &[usize]| {
            let xs = [0.0, 1.0, -0.75, 0.0_f32];
            let query: f32 = features[step][feature];
            let weights: Vec<f32> = open.iter().map(|&node| (query * xs[node]).exp()).collect();
            let sum: f32 = open.iter().zip(&weights).map(|(&node, weight)| xs[node] * weight).sum();
            let glimpse = sum / weights.iter().sum::<f32>();
            let mut row = [CLOSED; 4];
            for &node in open {
                row[node] = 15.0 * (glimpse * xs[node]).tanh();
            }
            row
        };
        assert_close(&logits, &[&expected(0, &[1, 2, 3]), &expected(1, &[0, 2, 3]), &expected(2, &[2, 3])]);
    }
}

#[test]
fn cvrp_may_use_more_routes_than_there_are_drones() {
    // Where nothing tells the nodes apart the first open one is chosen: the depot after every pond.
    let farm = problem(&[(1.0, 0.0), (0.0, 1.0), (1.0, 1.0)], 2);
    let routes = tiny_model(Variant::Cvrp, &[]).plan(&farm, Decoding::Greedy, 1);
    assert_eq!(routes, [[0], [1], [2]]);
    let plan = evaluate(&farm, &routes).unwrap();
    assert_eq!(plan.violations, [Violation::TooManyRoutes { num_routes: 3, num_available: 2 }]);
}

#[test]
fn a_route_of_cvrp_ends_with_its_capacity() {
    let ponds: Vec<(f64, f64)> = (0..7).map(|index| (f64::from(index) / 8.0, 0.5)).collect();
    // 7 / 3 + 1 = 3 ponds a route.
    let routes = shares(Variant::Cvrp).plan(&problem(&ponds, 3), Decoding::Greedy, 1);
    assert_eq!(routes, [vec![0, 1, 2], vec![3, 4, 5], vec![6]]);
}

#[test]
fn logits_are_for_routes_that_the_model_can_build() {
    let farm = problem(&[(1.0, 0.0), (0.0, 1.0), (1.0, 1.0)], 1);
    let model = shares(Variant::MinMax);
    for (routes, path) in [
        (vec![vec![0, 0]], "routes[0][1]"),
        (vec![vec![0], vec![1]], "routes[1]"),
        (vec![vec![0, 3]], "routes[0][1]"),
        (vec![vec![usize::MAX]], "routes[0][0]"),
        (vec![vec![], vec![0]], "routes[1]"),
    ] {
        let error = model.logits(&farm, &routes).unwrap_err();
        assert_eq!(error.faults[0].path, path);
    }
    assert_eq!(model.logits(&farm, &[]).unwrap().dim(), (0, 4));
}

fn paths(architecture: Architecture, tensors: Tensors) -> Vec<String> {
    Model::new(architecture, tensors).unwrap_err().faults.into_iter().map(|fault| fault.path).collect()
}

#[test]
fn every_fault_of_the_weights_is_named_at_once() {
    let architecture =
        Architecture { variant: Variant::MinMax, width: 8, num_heads: 2, num_layers: 2, feed_forward_width: 16 };
    let mut tensors = random_tensors(&architecture, 1);
    tensors.remove("layers.1.key.weight");
    tensors.insert("layers.2.key.weight".into(), ArrayD::zeros(IxDyn(&[8, 8])));
    tensors.insert("step.weight".into(), ArrayD::zeros(IxDyn(&[8, 9])));
    tensors.insert("distance_weight".into(), ArrayD::zeros(IxDyn(&[1])));
    tensors.get_mut("layers.0.hidden.bias").unwrap()[[3]] = f32::NAN;
    assert_eq!(
        paths(architecture, tensors),
        [
            "tensors[\"layers.0.hidden.bias\"]",
            "tensors[\"layers.1.key.weight\"]",
            "tensors[\"step.weight\"]",
            "tensors[\"distance_weight\"]",
            "tensors[\"layers.2.key.weight\"]",
        ]
    );
}

#[test]
fn sizes_that_mean_nothing_are_named_at_once() {
    let architecture =
        Architecture { variant: Variant::Cvrp, width: 9, num_heads: 2, num_layers: 0, feed_forward_width: 1 << 20 };
    assert_eq!(paths(architecture, Tensors::new()), ["num_layers", "feed_forward_width", "num_heads"]);
    let architecture = Architecture { width: 0, num_heads: 0, ..architecture };
    assert_eq!(paths(architecture, Tensors::new())[..2], ["width", "num_heads"]);
}
