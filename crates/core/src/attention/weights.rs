//! The tensors of a trained model, checked and laid out for inference.
//!
//! Names and shapes are those of the trainer (`model.py`), a weight being (outputs, inputs) there. What is fixed once training
//! ends is worked into the weights here: the scale of the attention into the queries, the scale of a batch normalisation into
//! the map before it, and the projection of the glimpse into the keys of the logits.

use super::{Architecture, Variant};
use crate::error::{Faults, InvalidInput};
use ndarray::{Array0, Array1, Array2, ArrayD, ArrayView2, Axis, Ix0, Ix1, Ix2, Slice, concatenate};
use std::collections::BTreeMap;
use std::ops::Range;

/// More than any model has; products of sizes up to here cannot overflow.
const MAX_WIDTH: usize = 1 << 16;
const MAX_LAYERS: usize = 100;

/// A map of node embeddings with a skip connection and batch normalisation around it: `scale · x + shift + map(x)`.
#[derive(Debug)]
pub(super) struct Skip {
    pub scale: Array1<f32>,
    pub shift: Array1<f32>,
    /// The last linear map before the normalisation, its scale worked in: (inputs, width).
    pub map: Array2<f32>,
}

/// A layer of the encoder.
#[derive(Debug)]
pub(super) struct Layer {
    /// Queries, keys and values side by side: (width, 3 width). Queries carry the scale of the attention.
    pub queries_keys_values: Array2<f32>,
    pub attention: Skip,
    /// (width, feed-forward width).
    pub hidden: Array2<f32>,
    pub hidden_bias: Array1<f32>,
    pub feed_forward: Skip,
}

/// A model's weights, as inference wants them: maps are (inputs, outputs).
#[derive(Debug)]
pub(super) struct Weights {
    pub depot: Array2<f32>,
    pub depot_bias: Array1<f32>,
    pub pond: Array2<f32>,
    pub pond_bias: Array1<f32>,
    pub layers: Vec<Layer>,
    /// From the mean embedding to every query: (width, width).
    pub fixed: Array2<f32>,
    /// From an embedding to the query of a step that starts there, to the key and the value of the glimpse, and to the key of
    /// the logit: (width, 4 width). Keys carry the scales of the products.
    pub nodes: Array2<f32>,
    /// From state features to the query: (features, width).
    pub state: Array2<f32>,
    /// How much the logits lose by the logarithm of distance; 0 where the variant has no such term.
    pub aversion: f32,
}

impl Weights {
    /// Checks the tensors against the architecture and lays them out.
    ///
    /// # Errors
    /// [`InvalidInput`] with every size that has no meaning; or with every tensor that is missing, has another shape, holds a
    /// value that is not finite, or belongs to no part of the model.
    pub fn new(architecture: &Architecture, tensors: BTreeMap<String, ArrayD<f32>>) -> Result<Self, InvalidInput> {
        check_sizes(architecture)?;
        let mut store = Store { tensors, faults: Faults::default() };
        let weights = store.weights(architecture);
        for name in store.tensors.keys() {
            let action = "give the tensors of this architecture and no others";
            store.faults.add(path_of(name), "the model has no such part", action);
        }
        store.faults.into_result(())?;
        Ok(weights.expect("a part is absent only if its tensor has a fault"))
    }
}

fn check_sizes(architecture: &Architecture) -> Result<(), InvalidInput> {
    let Architecture { width, num_heads, num_layers, feed_forward_width, .. } = *architecture;
    let mut faults = Faults::default();
    for (name, size, max_size) in [
        ("width", width, MAX_WIDTH),
        ("num_heads", num_heads, MAX_WIDTH),
        ("num_layers", num_layers, MAX_LAYERS),
        ("feed_forward_width", feed_forward_width, MAX_WIDTH),
    ] {
        if !(1..=max_size).contains(&size) {
            let message = format!("{size} is not within 1 and {max_size}");
            faults.add(name, message, "give the size that the model was trained with");
        }
    }
    if num_heads > 0 && !width.is_multiple_of(num_heads) {
        let message = format!("{num_heads} heads cannot share a width of {width}");
        faults.add("num_heads", message, "give the number that the model was trained with");
    }
    faults.into_result(())
}

fn path_of(name: &str) -> String {
    format!("tensors[{name:?}]")
}

/// Hands out tensors by name and notes what is wrong with them; what is left at the end belongs to nothing.
struct Store {
    tensors: BTreeMap<String, ArrayD<f32>>,
    faults: Faults,
}

impl Store {
    /// All parts, absent if one of them has a fault: every tensor is looked at before any part is put together.
    fn weights(&mut self, architecture: &Architecture) -> Option<Weights> {
        let Architecture { variant, width, num_layers, .. } = *architecture;
        let depot = self.map("depot.weight", variant.num_depot_features(), width);
        let depot_bias = self.vector("depot.bias", width);
        let pond = self.map("pond.weight", variant.num_pond_features(), width);
        let pond_bias = self.vector("pond.bias", width);
        let layers: Vec<Option<Layer>> = (0..num_layers).map(|index| self.layer(architecture, index)).collect();
        let fixed = self.map("fixed.weight", width, width);
        let node = self.map("node.weight", width, 3 * width);
        let step = self.map("step.weight", width + variant.num_state_features(), width);
        let glimpse = self.map("glimpse.weight", width, width);
        let aversion = match variant {
            Variant::Cvrp => Some(0.0),
            Variant::MinMax => self.number("distance_weight"),
        };
        let (node, step) = (node?, step?);
        let (queries, state) = step.view().split_at(Axis(0), width);
        let keys = &columns(&node, 0..width) * architecture.attention_scale();
        let values = columns(&node, width..2 * width);
        // A key of the logits times the map of a glimpse is the mapped key times the glimpse.
        let logit_keys = columns(&node, 2 * width..3 * width).dot(&glimpse?.t()) / (width as f32).sqrt();
        Some(Weights {
            depot: depot?,
            depot_bias: depot_bias?,
            pond: pond?,
            pond_bias: pond_bias?,
            layers: layers.into_iter().collect::<Option<Vec<Layer>>>()?,
            fixed: fixed?,
            nodes: beside(&[queries, keys.view(), values, logit_keys.view()]),
            state: state.to_owned(),
            aversion: aversion?,
        })
    }

    fn layer(&mut self, architecture: &Architecture, index: usize) -> Option<Layer> {
        let Architecture { width, feed_forward_width, .. } = *architecture;
        let name = |part: &str| format!("layers.{index}.{part}");
        let queries = self.map(&name("query.weight"), width, width);
        let keys = self.map(&name("key.weight"), width, width);
        let values = self.map(&name("value.weight"), width, width);
        let output = self.map(&name("output.weight"), width, width);
        let attention = self.skip(&name("attention_norm"), output, Some(Array1::zeros(width)), width);
        let hidden = self.map(&name("hidden.weight"), width, feed_forward_width);
        let hidden_bias = self.vector(&name("hidden.bias"), feed_forward_width);
        let contract = self.map(&name("contract.weight"), feed_forward_width, width);
        let contract_bias = self.vector(&name("contract.bias"), width);
        let feed_forward = self.skip(&name("feed_forward_norm"), contract, contract_bias, width);
        let queries = queries? * architecture.attention_scale();
        Some(Layer {
            queries_keys_values: beside(&[queries.view(), keys?.view(), values?.view()]),
            attention: attention?,
            hidden: hidden?,
            hidden_bias: hidden_bias?,
            feed_forward: feed_forward?,
        })
    }

    /// `scale · (x + map(x) + bias) + shift` with the scale multiplied out.
    fn skip(&mut self, norm: &str, map: Option<Array2<f32>>, bias: Option<Array1<f32>>, width: usize) -> Option<Skip> {
        let scale = self.vector(&format!("{norm}.scale"), width);
        let shift = self.vector(&format!("{norm}.shift"), width);
        let scale = scale?;
        Some(Skip { map: map? * &scale, shift: shift? + &scale * &bias?, scale })
    }

    /// A linear map as (inputs, outputs).
    fn map(&mut self, name: &str, num_inputs: usize, num_outputs: usize) -> Option<Array2<f32>> {
        let weight = self.take(name, &[num_outputs, num_inputs])?.into_dimensionality::<Ix2>().ok()?;
        Some(weight.t().as_standard_layout().into_owned())
    }

    fn vector(&mut self, name: &str, len: usize) -> Option<Array1<f32>> {
        self.take(name, &[len])?.into_dimensionality::<Ix1>().ok()
    }

    fn number(&mut self, name: &str) -> Option<f32> {
        self.take(name, &[])?.into_dimensionality::<Ix0>().ok().map(Array0::into_scalar)
    }

    fn take(&mut self, name: &str, shape: &[usize]) -> Option<ArrayD<f32>> {
        let message = match self.tensors.remove(name) {
            None => "the tensor is missing".to_owned(),
            Some(tensor) if tensor.shape() != shape => format!("the shape is {:?}, not {shape:?}", tensor.shape()),
            Some(tensor) if tensor.iter().all(|value| value.is_finite()) => return Some(tensor),
            Some(tensor) => {
                let num_broken = tensor.iter().filter(|value| !value.is_finite()).count();
                format!("{num_broken} of {} values are not finite", tensor.len())
            }
        };
        self.faults.add(path_of(name), message, "give the tensors as the trainer wrote them");
        None
    }
}

/// Some columns of a matrix.
pub(super) fn columns(matrix: &Array2<f32>, range: Range<usize>) -> ArrayView2<'_, f32> {
    matrix.slice_axis(Axis(1), Slice::from(range))
}

fn beside(parts: &[ArrayView2<'_, f32>]) -> Array2<f32> {
    concatenate(Axis(1), parts).expect("maps of one input")
}
