//! Tensors of models that nobody trained, for tests and benches.

use ndarray::{ArrayD, IxDyn};
use pondhop_core::attention::{Architecture, Variant};
use pondhop_core::random::Random;
use std::collections::BTreeMap;

/// The tensors of a model by name.
pub type Tensors = BTreeMap<String, ArrayD<f32>>;

/// Every tensor of the architecture, its values from a function of its name.
pub fn tensors(architecture: &Architecture, mut value: impl FnMut(&str) -> f32) -> Tensors {
    let Architecture { variant, width, num_layers, feed_forward_width, .. } = *architecture;
    let (num_depot, num_pond, num_state) = match variant {
        Variant::Cvrp => (2, 3, 1),
        Variant::MinMax => (4, 4, 7),
    };
    let mut shapes: Vec<(String, Vec<usize>)> = [
        ("depot.weight", vec![width, num_depot]),
        ("depot.bias", vec![width]),
        ("pond.weight", vec![width, num_pond]),
        ("pond.bias", vec![width]),
        ("fixed.weight", vec![width, width]),
        ("node.weight", vec![3 * width, width]),
        ("step.weight", vec![width, width + num_state]),
        ("glimpse.weight", vec![width, width]),
    ]
    .map(|(name, shape)| (name.to_owned(), shape))
    .to_vec();
    if variant == Variant::MinMax {
        shapes.push(("distance_weight".to_owned(), vec![]));
    }
    for layer in 0..num_layers {
        for (part, shape) in [
            ("query.weight", vec![width, width]),
            ("key.weight", vec![width, width]),
            ("value.weight", vec![width, width]),
            ("output.weight", vec![width, width]),
            ("attention_norm.scale", vec![width]),
            ("attention_norm.shift", vec![width]),
            ("hidden.weight", vec![feed_forward_width, width]),
            ("hidden.bias", vec![feed_forward_width]),
            ("contract.weight", vec![width, feed_forward_width]),
            ("contract.bias", vec![width]),
            ("feed_forward_norm.scale", vec![width]),
            ("feed_forward_norm.shift", vec![width]),
        ] {
            shapes.push((format!("layers.{layer}.{part}"), shape));
        }
    }
    shapes
        .into_iter()
        .map(|(name, shape)| {
            let tensor = ArrayD::from_shape_simple_fn(IxDyn(&shape), || value(&name));
            (name, tensor)
        })
        .collect()
}

/// Values as large as a trained model has them: uniform, of variance 1 / inputs.
pub fn random_tensors(architecture: &Architecture, seed: u64) -> Tensors {
    let mut random = Random::new(seed);
    let bound = (3.0 / architecture.width as f64).sqrt();
    tensors(architecture, |name| {
        let value = bound * (2.0 * random.uniform() - 1.0);
        if name.ends_with("scale") || name == "distance_weight" { 1.0 + value as f32 } else { value as f32 }
    })
}
