//! What every plan of an attention model must be, and its logits against a plain forward pass in double precision.

mod attention_models;

use attention_models::{Tensors, random_tensors};
use pondhop_core::attention::{Architecture, Decoding, Model, Variant};
use pondhop_core::evaluate::evaluate;
use pondhop_core::generate::{Variant as FarmVariant, generate};
use pondhop_core::geometry::Point;
use pondhop_core::plan::Violation;
use pondhop_core::problem::Problem;
use proptest::prelude::*;

const VARIANTS: [Variant; 2] = [Variant::Cvrp, Variant::MinMax];

fn small(variant: Variant) -> Architecture {
    Architecture { variant, width: 12, num_heads: 3, num_layers: 2, feed_forward_width: 20 }
}

fn model(architecture: Architecture, seed: u64) -> Model {
    Model::new(architecture, random_tensors(&architecture, seed)).unwrap()
}

fn farm(num_ponds: usize, num_drones: usize) -> Problem {
    let farm = generate(num_ponds, FarmVariant::Authors, 3).unwrap();
    Problem::research(farm.depot, &farm.ponds, num_drones).unwrap()
}

/// The forward pass as the trainer's `model.py` has it, one node and one number at a time.
struct Oracle<'a> {
    architecture: Architecture,
    tensors: &'a Tensors,
    nodes: Vec<[f64; 2]>,
    embeddings: Vec<Vec<f64>>,
    /// Keys and values of the glimpse and keys of the logits side by side.
    projected: Vec<Vec<f64>>,
    /// The part of every query that follows from the mean embedding.
    fixed: Vec<f64>,
    spacing: f64,
    num_routes: usize,
}

impl<'a> Oracle<'a> {
    fn new(architecture: Architecture, tensors: &'a Tensors, problem: &Problem) -> Self {
        let places =
            std::iter::once(problem.depot().position).chain(problem.visits().iter().map(|visit| visit.position));
        let mut nodes: Vec<[f64; 2]> = places.map(|place| [place.x, place.y]).collect();
        if architecture.variant == Variant::MinMax {
            let depot = nodes[0];
            let radius = nodes.iter().map(|&node| distance(node, depot)).fold(0.0, f64::max);
            nodes.iter_mut().for_each(|node| *node = [(node[0] - depot[0]) / radius, (node[1] - depot[1]) / radius]);
        }
        let num_ponds = nodes.len() - 1;
        let nearest: Vec<f64> = (1..nodes.len())
            .map(|pond| {
                let others = (1..nodes.len()).filter(|&other| other != pond);
                others.map(|other| distance(nodes[pond], nodes[other])).fold(f64::INFINITY, f64::min)
            })
            .collect();
        let spacing = nearest.iter().sum::<f64>() / num_ponds as f64;
        let num_routes = problem.vehicle_type().num_available;
        let mut oracle = Self {
            architecture,
            tensors,
            nodes,
            embeddings: Vec::new(),
            projected: Vec::new(),
            fixed: Vec::new(),
            spacing,
            num_routes,
        };
        let nodes = &oracle.nodes;
        let features = |node: usize| match (architecture.variant, node) {
            (Variant::Cvrp, 0) => nodes[0].to_vec(),
            (Variant::Cvrp, _) => vec![nodes[node][0], nodes[node][1], 1.0 / oracle.capacity() as f64],
            (Variant::MinMax, 0) => vec![0.0, 0.0, 0.0, spacing],
            (Variant::MinMax, _) => {
                let [x, y] = nodes[node];
                vec![x, y, distance(nodes[node], nodes[0]), nearest[node - 1]]
            }
        };
        let name = |node: usize| if node == 0 { "depot" } else { "pond" };
        let mut embeddings: Vec<Vec<f64>> =
            (0..nodes.len()).map(|node| oracle.linear(name(node), &features(node))).collect();
        for layer in 0..architecture.num_layers {
            embeddings = oracle.layer(layer, &embeddings);
        }
        let mean: Vec<f64> = (0..architecture.width)
            .map(|index| embeddings.iter().map(|node| node[index]).sum::<f64>() / embeddings.len() as f64)
            .collect();
        oracle.fixed = oracle.linear("fixed", &mean);
        oracle.projected = embeddings.iter().map(|node| oracle.linear("node", node)).collect();
        oracle.embeddings = embeddings;
        oracle
    }

    fn capacity(&self) -> usize {
        (self.nodes.len() - 1) / self.num_routes + 1
    }

    fn linear(&self, name: &str, input: &[f64]) -> Vec<f64> {
        let weight = &self.tensors[&format!("{name}.weight")];
        let bias = self.tensors.get(&format!("{name}.bias"));
        (0..weight.shape()[0])
            .map(|output| {
                let terms = input.iter().enumerate().map(|(index, value)| f64::from(weight[[output, index]]) * value);
                terms.sum::<f64>() + bias.map_or(0.0, |bias| f64::from(bias[[output]]))
            })
            .collect()
    }

    fn normalised(&self, name: &str, input: &[f64], added: &[f64]) -> Vec<f64> {
        let (scale, shift) = (&self.tensors[&format!("{name}.scale")], &self.tensors[&format!("{name}.shift")]);
        (0..input.len())
            .map(|index| (input[index] + added[index]) * f64::from(scale[[index]]) + f64::from(shift[[index]]))
            .collect()
    }

    fn attend(&self, query: &[f64], keys: &[Vec<f64>], values: &[Vec<f64>], open: &[usize]) -> Vec<f64> {
        let head_width = self.architecture.width / self.architecture.num_heads;
        let mut gathered = vec![0.0; query.len()];
        for head in 0..self.architecture.num_heads {
            let range = head * head_width..(head + 1) * head_width;
            let score =
                |&node: &usize| dot(&query[range.clone()], &keys[node][range.clone()]) / (head_width as f64).sqrt();
            let weights: Vec<f64> = open.iter().map(|node| score(node).exp()).collect();
            for index in range.clone() {
                let sum: f64 = open.iter().zip(&weights).map(|(&node, weight)| weight * values[node][index]).sum();
                gathered[index] = sum / weights.iter().sum::<f64>();
            }
        }
        gathered
    }

    fn layer(&self, layer: usize, nodes: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let name = |part: &str| format!("layers.{layer}.{part}");
        let map = |part: &str| nodes.iter().map(|node| self.linear(&name(part), node)).collect::<Vec<_>>();
        let (queries, keys, values) = (map("query"), map("key"), map("value"));
        let all: Vec<usize> = (0..nodes.len()).collect();
        nodes
            .iter()
            .zip(queries)
            .map(|(node, query)| {
                let attended = self.linear(&name("output"), &self.attend(&query, &keys, &values, &all));
                let node = self.normalised(&name("attention_norm"), node, &attended);
                let hidden: Vec<f64> = self.linear(&name("hidden"), &node).iter().map(|value| value.max(0.0)).collect();
                self.normalised(&name("feed_forward_norm"), &node, &self.linear(&name("contract"), &hidden))
            })
            .collect()
    }

    /// Logits of the open nodes from a node in a state.
    fn logits(&self, last: usize, state: &[f64], open: &[usize]) -> Vec<f64> {
        let width = self.architecture.width;
        let step = self.linear("step", &[&self.embeddings[last][..], state].concat());
        let query: Vec<f64> = self.fixed.iter().zip(step).map(|(fixed, step)| fixed + step).collect();
        let part = |index: usize| -> Vec<Vec<f64>> {
            self.projected.iter().map(|node| node[index * width..(index + 1) * width].to_vec()).collect()
        };
        let glimpse = self.linear("glimpse", &self.attend(&query, &part(0), &part(1), open));
        let keys = part(2);
        open.iter()
            .map(|&node| {
                let bound = if self.architecture.variant == Variant::Cvrp { 10.0 } else { 15.0 };
                let logit = bound * (dot(&glimpse, &keys[node]) / (width as f64).sqrt()).tanh();
                let distance = distance(self.nodes[last], self.nodes[node]);
                match self.tensors.get("distance_weight") {
                    Some(weight) => logit - f64::from(weight[[]]) * (distance / self.spacing).ln_1p(),
                    None => logit,
                }
            })
            .collect()
    }

    /// Follows routes; returns the open nodes and their logits at every choice.
    fn follow(&self, routes: &[Vec<usize>]) -> Vec<(Vec<usize>, Vec<f64>)> {
        let num_ponds = self.nodes.len() - 1;
        let (mut visited, mut choices) = (vec![false; num_ponds + 1], Vec::new());
        let (mut longest, mut current, mut num_left, mut last) = (0.0_f64, 0.0, num_ponds, 0);
        for (closed, route) in routes.iter().enumerate() {
            for (place, node) in route.iter().map(|visit| visit + 1).chain([0]).enumerate() {
                if num_left == 0 {
                    return choices;
                }
                let is_full = self.architecture.variant == Variant::Cvrp && place == self.capacity();
                let may_return =
                    place > 0 && (self.architecture.variant == Variant::Cvrp || closed + 1 < self.num_routes);
                let mut open: Vec<usize> = (1..=num_ponds).filter(|&pond| !visited[pond] && !is_full).collect();
                open.extend(may_return.then_some(0));
                let home = distance(self.nodes[last], self.nodes[0]);
                let left = (self.num_routes - closed.min(self.num_routes - 1)) as f64;
                let state = match self.architecture.variant {
                    Variant::Cvrp => vec![1.0 - place as f64 / self.capacity() as f64],
                    Variant::MinMax => vec![
                        left / self.num_routes as f64,
                        current,
                        home,
                        longest,
                        num_left as f64 / num_ponds as f64,
                        num_left as f64 / left / (num_ponds as f64 / self.num_routes as f64),
                        current + home - longest,
                    ],
                };
                let logits = self.logits(last, &state, &open);
                choices.push((open, logits));
                current += distance(self.nodes[last], self.nodes[node]);
                visited[node] = true;
                (last, num_left) = (node, num_left - usize::from(node > 0));
            }
            longest = longest.max(current);
            current = 0.0;
        }
        choices
    }
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[test]
fn logits_are_those_of_a_plain_forward_pass() {
    // With 700 ponds the weights of a head do not fit one block of rows.
    for (width, num_heads, num_layers, feed_forward_width, num_ponds, num_drones) in [
        (12, 3, 2, 20, 9, 2),
        (16, 1, 1, 5, 40, 4),
        (128, 8, 3, 512, 30, 5),
        (21, 7, 2, 33, 90, 1),
        (6, 6, 3, 8, 700, 3),
    ] {
        for variant in VARIANTS {
            let architecture = Architecture { variant, width, num_heads, num_layers, feed_forward_width };
            let tensors = random_tensors(&architecture, 7);
            let problem = farm(num_ponds, num_drones);
            let model = Model::new(architecture, tensors.clone()).unwrap();
            // A drawn plan goes where a greedy one does not.
            let routes = model.plan(&problem, Decoding::Sampling { num_samples: 1 }, 5);
            let logits = model.logits(&problem, &routes).unwrap();
            let expected = Oracle::new(architecture, &tensors, &problem).follow(&routes);
            assert_eq!(logits.nrows(), expected.len());
            for (row, (open, expected)) in logits.rows().into_iter().zip(&expected) {
                assert_eq!(row.iter().filter(|logit| logit.is_finite()).count(), open.len());
                for (&node, &expected) in open.iter().zip(expected) {
                    let difference = (f64::from(row[node]) - expected).abs();
                    assert!(difference < 1e-3, "{architecture:?}: {} instead of {expected}", row[node]);
                }
            }
        }
    }
}

#[test]
fn greedy_takes_the_greatest_logit_at_every_choice() {
    for variant in VARIANTS {
        let model = model(small(variant), 2);
        let problem = farm(60, 4);
        let routes = model.plan(&problem, Decoding::Greedy, 1);
        let mut chosen =
            routes.iter().flat_map(|route| [0].into_iter().chain(route.iter().map(|visit| visit + 1))).skip(1);
        for row in model.logits(&problem, &routes).unwrap().rows() {
            let greatest = row.iter().copied().fold(f32::NEG_INFINITY, f32::max);
            assert_eq!(row[chosen.next().unwrap()], greatest);
        }
    }
}

#[test]
fn draws_follow_the_probabilities() {
    // The first pond of the first route, drawn often, against the softmax of its logits.
    let model = model(small(Variant::Cvrp), 3);
    let problem = farm(5, 1);
    let logits = model.logits(&problem, &[vec![0]]).unwrap();
    let weights: Vec<f64> = logits.row(0).iter().map(|&logit| f64::from(logit).exp()).collect();
    let mut counts = [0_u32; 6];
    for seed in 0..4000 {
        counts[model.plan(&problem, Decoding::Sampling { num_samples: 1 }, seed)[0][0] + 1] += 1;
    }
    for (count, weight) in counts.iter().zip(&weights) {
        let expected = weight / weights.iter().sum::<f64>();
        // Four standard deviations.
        assert!((f64::from(*count) / 4000.0 - expected).abs() < 4.0 * (0.25_f64 / 4000.0).sqrt());
    }
}

#[test]
fn draws_repeat_by_seed_and_more_of_them_are_never_worse() {
    let problem = farm(40, 4);
    for variant in VARIANTS {
        let model = model(small(variant), 4);
        let plan = |num_samples: usize, seed: u64| model.plan(&problem, Decoding::Sampling { num_samples }, seed);
        assert_eq!(plan(5, 1), plan(5, 1));
        assert_ne!(plan(1, 1), plan(1, 2));
        let cost = |routes: &[Vec<usize>]| {
            let plan = evaluate(&problem, routes).unwrap();
            if variant == Variant::Cvrp { plan.total_length() } else { plan.max_route_length() }
        };
        let costs: Vec<f64> = [1, 2, 8, 32].iter().map(|&num_samples| cost(&plan(num_samples, 3))).collect();
        assert!(costs.windows(2).all(|pair| pair[1] <= pair[0]) && costs[3] < costs[0], "{costs:?}");
    }
}

#[test]
fn weights_beyond_reason_still_give_plans() {
    // Products overflow, and every logit is not a number.
    for variant in VARIANTS {
        let mut tensors = random_tensors(&small(variant), 1);
        tensors.values_mut().for_each(|tensor| tensor.mapv_inplace(|value| value * 1e30));
        let model = Model::new(small(variant), tensors).unwrap();
        for decoding in [Decoding::Greedy, Decoding::Symmetries, Decoding::Sampling { num_samples: 3 }] {
            assert_served(&model, &farm(30, 3), decoding, 1);
        }
    }
}

/// Every pond once, no empty route, and for the min-max variant at most one route per drone.
fn assert_served(model: &Model, problem: &Problem, decoding: Decoding, seed: u64) -> Vec<Vec<usize>> {
    let routes = model.plan(problem, decoding, seed);
    assert!(routes.iter().all(|route| !route.is_empty()));
    let plan = evaluate(problem, &routes).unwrap();
    let is_allowed = |violation: &Violation| {
        model.architecture().variant == Variant::Cvrp && matches!(violation, Violation::TooManyRoutes { .. })
    };
    assert!(plan.violations.iter().all(is_allowed), "{:?}", plan.violations);
    routes
}

fn decodings() -> impl Strategy<Value = Decoding> {
    prop_oneof![
        Just(Decoding::Greedy),
        Just(Decoding::Symmetries),
        (1..4usize).prop_map(|num_samples| Decoding::Sampling { num_samples }),
    ]
}

/// Multiples of 1/64 in the unit square, which mirroring and turning leave exact; some coincide.
fn places() -> impl Strategy<Value = Vec<Point>> {
    let place = (0..=64u8, 0..=64u8).prop_map(|(x, y)| Point::new(f64::from(x) / 64.0, f64::from(y) / 64.0));
    prop::collection::vec(place, 2..40)
}

fn problem_of(places: &[Point], num_drones: usize, map: impl Fn(Point) -> Point) -> Problem {
    let places: Vec<Point> = places.iter().map(|&place| map(place)).collect();
    Problem::research(places[0], &places[1..], num_drones).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn every_pond_once_on_any_farm(
        ponds in prop::collection::vec((-3..4i8, -3..4i8), 1..50), scale in prop_oneof![Just(0.0), Just(1e-200), Just(0.1), Just(1e8)],
        num_drones in prop_oneof![1..7usize, Just(1000), Just(usize::MAX)], decoding in decodings(), seed in any::<u64>(),
    ) {
        let ponds: Vec<Point> = ponds.iter().map(|&(x, y)| Point::new(scale * f64::from(x), scale * f64::from(y))).collect();
        let problem = Problem::research(Point::new(scale, -scale), &ponds, num_drones).unwrap();
        for variant in VARIANTS {
            let model = model(small(variant), seed % 5);
            let routes = assert_served(&model, &problem, decoding, seed);
            prop_assert_eq!(routes, model.plan(&problem, decoding, seed));
        }
    }

    #[test]
    fn the_best_of_eight_symmetries_is_as_long_however_the_farm_lies(places in places(), num_drones in 1..6usize, seed in 0..5u64) {
        for variant in VARIANTS {
            let model = model(small(variant), seed);
            let cost = |map: &dyn Fn(Point) -> Point| {
                let problem = problem_of(&places, num_drones, map);
                let plan = evaluate(&problem, &model.plan(&problem, Decoding::Symmetries, 1)).unwrap();
                if variant == Variant::Cvrp { plan.total_length() } else { plan.max_route_length() }
            };
            let as_it_is = cost(&|place| place);
            let turns: [&dyn Fn(Point) -> Point; 3] = [
                &|place| Point::new(1.0 - place.y, place.x),
                &|place| Point::new(1.0 - place.x, 1.0 - place.y),
                &|place| Point::new(place.y, 1.0 - place.x),
            ];
            let mirrors: [&dyn Fn(Point) -> Point; 2] = [&|place| Point::new(place.y, place.x), &|place| Point::new(1.0 - place.x, place.y)];
            for map in turns.into_iter().chain(mirrors) {
                prop_assert!((cost(map) - as_it_is).abs() < 1e-9, "{} instead of {}", cost(map), as_it_is);
            }
        }
    }

    #[test]
    fn scale_and_place_of_a_farm_change_no_route(places in places(), num_drones in 1..6usize, seed in 0..5u64) {
        for variant in VARIANTS {
            let model = model(small(variant), seed);
            let plan = |shift: f64, scale: f64| {
                let problem = problem_of(&places, num_drones, |place| Point::new(shift + scale * place.x, shift + scale * place.y));
                model.plan(&problem, Decoding::Greedy, 1)
            };
            // Powers of two, so that nothing is rounded. Beyond the unit square both variants see the same farm anywhere.
            prop_assert_eq!(plan(2.0, 1.0), plan(-256.0, 1024.0));
            if variant == Variant::MinMax {
                prop_assert_eq!(plan(2.0, 1.0), plan(0.0, 1.0));
            }
        }
    }
}
