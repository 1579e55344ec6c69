//! The attention model: a network that reads a farm and builds routes pond by pond.
//!
//! Problem: that of [`crate::search`], one shot, by a trained network. Source: Kool, van Hoof and Welling, Attention, Learn to
//! Solve Routing Problems!, ICLR 2019 (arXiv 1803.08475), sections 3 and 5, with which the paper compares HPP. Training is
//! not part of the core; weights come in as arrays. In reading order:
//!
//! 1. `features`: what the network sees of a farm, in eight symmetric views.
//! 2. `weights`: the trained tensors, checked and laid out.
//! 3. `softmax`: exponentials of many numbers at once.
//! 4. `encoder`: a vector for every pond from all ponds.
//! 5. `decoder`: one choice after the other, what is open to it and what it is told of the routes so far.
//!
//! Two variants ([`Variant`]): the paper's, and ours, which can never use more routes than there are drones.
//!
//! Complexity: O(n²) time and O(n) memory for n ponds. With the sizes of the trained models an encoding takes 0.65 million
//! multiplications for each pond and 768 for each pair of ponds, and a plan 384 for each choice and pond open to it.
//!
//! Reproducible: the same weights, farm, decoding and seed give the same routes on the same processor. Products of matrices
//! (`matrixmultiply`) use the widest instructions that a processor has, so the last bits of their single-precision sums
//! differ between processors, and where two choices are as good as equal, so may the routes.
//!
//! What we changed: farms beyond the unit square are scaled into it (`features`), the rest is arithmetic in another order.

mod decoder;
mod encoder;
mod features;
mod softmax;
mod weights;

use crate::error::{Faults, InvalidInput};
use crate::problem::Problem;
use crate::random::Random;
use crate::travel::leg_length;
use decoder::{Decoder, Rollout};
use encoder::encode;
use features::{Farm, Symmetry};
use ndarray::{Array2, ArrayD};
use std::collections::BTreeMap;
use weights::Weights;

/// What a model was trained for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// The capacitated problem as the paper uses it: at most `n / m + 1` ponds a route (`n` ponds, `m` drones), the least total
    /// length. Nothing limits the number of routes.
    Cvrp,
    /// At most one route per drone, the shortest longest route.
    MinMax,
}

/// Which weights a model has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Architecture {
    /// What it was trained for.
    pub variant: Variant,
    /// Numbers that stand for a pond.
    pub width: usize,
    /// Heads of each attention; a divisor of the width.
    pub num_heads: usize,
    /// Layers of the encoder.
    pub num_layers: usize,
    /// Hidden units of the feed-forward part of a layer.
    pub feed_forward_width: usize,
}

impl Architecture {
    const fn head_width(&self) -> usize {
        self.width / self.num_heads
    }

    /// What scores of a head are multiplied by.
    fn attention_scale(&self) -> f32 {
        1.0 / (self.head_width() as f32).sqrt()
    }
}

/// How routes are read from the network's probabilities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decoding {
    /// The likeliest choice at every step.
    Greedy,
    /// The best greedy plan of the farm's eight views: turned by quarters, mirrored or not (the instance augmentation of Kwon
    /// et al., POMO, NeurIPS 2020).
    Symmetries,
    /// The best of plans whose choices are drawn with the network's probabilities (Kool et al., section 5).
    Sampling {
        /// Plans drawn; at least 1.
        num_samples: usize,
    },
}

/// A trained network.
#[derive(Debug)]
pub struct Model {
    architecture: Architecture,
    weights: Weights,
}

impl Model {
    /// A network of the given weights, named and shaped as the trainer has them: `layers.0.query.weight`.
    ///
    /// # Errors
    /// [`InvalidInput`] with every size that has no meaning; or with every tensor that is missing, has another shape, holds a
    /// value that is not finite, or belongs to no part of the model.
    pub fn new(architecture: Architecture, tensors: BTreeMap<String, ArrayD<f32>>) -> Result<Self, InvalidInput> {
        Ok(Self { architecture, weights: Weights::new(&architecture, tensors)? })
    }

    /// Which weights it has.
    #[must_use]
    pub const fn architecture(&self) -> Architecture {
        self.architecture
    }

    /// Plans routes: visit indices in flying order, every visit once, none empty. Of several plans, [`Variant::Cvrp`] takes the
    /// one of least total length and [`Variant::MinMax`] the one whose longest route is shortest.
    ///
    /// `seed` draws the samples of [`Decoding::Sampling`] and changes nothing else.
    #[must_use]
    pub fn plan(&self, problem: &Problem, decoding: Decoding, seed: u64) -> Vec<Vec<usize>> {
        let farm = Farm::new(self.architecture.variant, problem);
        match decoding {
            Decoding::Greedy => self.decoder(&farm, Symmetry::NONE).rollout().run(Rollout::likeliest),
            Decoding::Symmetries => {
                let views =
                    Symmetry::all().map(|symmetry| self.decoder(&farm, symmetry).rollout().run(Rollout::likeliest));
                self.best(problem, views)
            }
            Decoding::Sampling { num_samples } => {
                let decoder = self.decoder(&farm, Symmetry::NONE);
                let mut random = Random::new(seed);
                let samples =
                    (0..num_samples.max(1)).map(|_| decoder.rollout().run(|rollout| rollout.drawn(&mut random)));
                self.best(problem, samples)
            }
        }
    }

    /// The logits of every choice that leads to the given routes, (choices, visits + 1), to compare networks with: the
    /// depot's first, then the visits', minus infinity where a choice was not open. A choice is a visit, or the return to the
    /// depot between two routes.
    ///
    /// # Errors
    /// [`InvalidInput`] at the first place where the routes go on with what was not open.
    pub fn logits(&self, problem: &Problem, routes: &[Vec<usize>]) -> Result<Array2<f32>, InvalidInput> {
        let farm = Farm::new(self.architecture.variant, problem);
        let decoder = self.decoder(&farm, Symmetry::NONE);
        let mut rollout = decoder.rollout();
        let mut logits = Vec::new();
        for (route, visits) in routes.iter().enumerate() {
            let returns = (route > 0).then(|| (0, format!("routes[{route}]"), "no further route may begin".to_owned()));
            let visits = visits.iter().enumerate().map(|(place, &visit)| {
                (visit.saturating_add(1), format!("routes[{route}][{place}]"), format!("visit {visit} is not open"))
            });
            for (node, path, message) in returns.into_iter().chain(visits) {
                let Some(slot) = rollout.open_slot(node) else {
                    let mut faults = Faults::default();
                    faults.add(path, message, "give routes that this model can build");
                    return faults.into_result(Array2::zeros((0, 0)));
                };
                logits.extend(rollout.logits_of_nodes());
                rollout.choose(slot);
            }
        }
        let num_nodes = problem.num_visits() + 1;
        let num_choices = logits.len() / num_nodes;
        Ok(Array2::from_shape_vec((num_choices, num_nodes), logits).expect("a logit for every node and choice"))
    }

    fn decoder(&self, farm: &Farm, symmetry: Symmetry) -> Decoder<'_> {
        let view = farm.view(symmetry);
        let nodes = encode(&self.weights, self.architecture.num_heads, &view);
        Decoder::new(&self.architecture, &self.weights, view, &nodes)
    }

    fn best(&self, problem: &Problem, plans: impl Iterator<Item = Vec<Vec<usize>>>) -> Vec<Vec<usize>> {
        let cost = |routes: &Vec<Vec<usize>>| {
            let lengths = routes.iter().map(|route| route_length(problem, route));
            let (longest, total) =
                lengths.fold((0.0, 0.0), |(longest, total), length| (length.max(longest), total + length));
            match self.architecture.variant {
                Variant::Cvrp => (total, longest),
                Variant::MinMax => (longest, total),
            }
        };
        let costed = plans.map(|routes| (cost(&routes), routes));
        let better = |a: &((f64, f64), _), b: &((f64, f64), _)| a.0.0.total_cmp(&b.0.0).then(a.0.1.total_cmp(&b.0.1));
        costed.min_by(better).map(|(_, routes)| routes).unwrap_or_default()
    }
}

fn route_length(problem: &Problem, route: &[usize]) -> f64 {
    let depot = problem.depot().position;
    let places = route.iter().map(|&visit| problem.visits()[visit].position).chain([depot]);
    places.fold((0.0, depot), |(length, from), to| (length + leg_length(from, to), to)).0
}
