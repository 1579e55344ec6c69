//! The decoder: one choice after the other (Kool et al., section 3.2 and appendix C.1).
//!
//! A choice is asked of the network by a query made of the mean embedding, the node where the drone is and the state of the
//! routes. Multi-head attention of the query over the open nodes gathers a glimpse; the product of the glimpse with an open
//! node's key, bounded, is the node's logit. [`Variant::MinMax`] takes a learned multiple of the logarithm of the
//! distance off it, and closes the depot to a drone that no other would follow, so that it never uses a route too many.
//!
//! Visited ponds are taken out of the arrays instead of being masked, so a step costs O(open nodes): n² / 2 pairs in all.
//! Linear maps of nodes are applied once per farm (`Weights::nodes`).

use super::features::{View, capacity};
use super::softmax::{exp_relative, tanh};
use super::weights::{Weights, columns};
use super::{Architecture, Variant};
use crate::random::Random;
use ndarray::{Array2, ArrayView2, Axis};
use std::ops::Range;

impl Variant {
    /// How far logits reach before distance is taken off (Kool et al., equation 7, who have 10). Farther for routes that
    /// are few and long: one unlikely choice spoils them, so samples must be more decided.
    const fn logit_bound(self) -> f32 {
        match self {
            Self::Cvrp => 10.0,
            Self::MinMax => 15.0,
        }
    }
}

/// A farm, encoded: what all its rollouts start from.
#[derive(Debug)]
pub(super) struct Decoder<'a> {
    architecture: &'a Architecture,
    weights: &'a Weights,
    view: View,
    /// The query of a step that starts at a node, without the state: (nodes, width).
    queries: Array2<f32>,
    keys: Columns,
    values: Array2<f32>,
    logit_keys: Columns,
}

impl<'a> Decoder<'a> {
    /// Of the embeddings of depot and ponds: (nodes, width).
    pub fn new(architecture: &'a Architecture, weights: &'a Weights, view: View, nodes: &Array2<f32>) -> Self {
        let width = architecture.width;
        let projected = nodes.dot(&weights.nodes);
        let part = |index: usize| columns(&projected, index * width..(index + 1) * width);
        let mean = nodes.sum_axis(Axis(0)) / nodes.nrows() as f32;
        Self {
            queries: &part(0) + &mean.dot(&weights.fixed),
            keys: Columns::new(part(1)),
            values: part(2).as_standard_layout().into_owned(),
            logit_keys: Columns::new(part(3)),
            architecture,
            weights,
            view,
        }
    }

    /// A drone at the depot, every pond open.
    pub fn rollout(&self) -> Rollout<'_> {
        let num_nodes = self.queries.nrows();
        let width = self.architecture.width;
        Rollout {
            decoder: self,
            nodes: (0..num_nodes).collect(),
            xs: self.view.xs.clone(),
            ys: self.view.ys.clone(),
            keys: self.keys.clone(),
            values: self.values.iter().copied().collect(),
            logit_keys: self.logit_keys.clone(),
            place: Place { node: 0, x: self.view.xs[0], y: self.view.ys[0] },
            num_in_route: 0,
            num_closed: 0,
            current: 0.0,
            longest: 0.0,
            query: vec![0.0; width],
            attention: vec![0.0; self.keys.padded_len()],
            glimpse: vec![0.0; width],
            logits: vec![0.0; self.keys.padded_len()],
        }
    }
}

/// Columns of numbers that are worked on at once.
const LANES: usize = 16;

/// A matrix whose columns are the nodes, in blocks of [`LANES`] columns, so that a product with a vector runs over memory in
/// order and over several columns at once.
#[derive(Clone, Debug)]
struct Columns {
    num_rows: usize,
    /// Row by row of one block of columns after the other.
    blocks: Vec<[f32; LANES]>,
}

impl Columns {
    fn new(transposed: ArrayView2<'_, f32>) -> Self {
        let (num_columns, num_rows) = transposed.dim();
        let mut blocks = vec![[0.0; LANES]; num_columns.div_ceil(LANES) * num_rows];
        for (column, values) in transposed.rows().into_iter().enumerate() {
            let begin = column / LANES * num_rows;
            for (block, &value) in blocks[begin..].iter_mut().zip(values) {
                block[column % LANES] = value;
            }
        }
        Self { num_rows, blocks }
    }

    fn padded_len(&self) -> usize {
        self.blocks.len() / self.num_rows * LANES
    }

    /// `products[column] = vector · column` over the given rows, for the first `num_columns` columns and some beyond.
    fn multiply(&self, rows: Range<usize>, vector: &[f32], num_columns: usize, products: &mut [f32]) {
        let (chunks, _) = products.as_chunks_mut::<LANES>();
        let blocks = self.blocks.chunks_exact(self.num_rows).take(num_columns.div_ceil(LANES));
        for (product, block) in chunks.iter_mut().zip(blocks) {
            let mut sums = [0.0; LANES];
            for (factor, row) in vector.iter().zip(&block[rows.clone()]) {
                for (sum, value) in sums.iter_mut().zip(row) {
                    *sum += factor * value;
                }
            }
            *product = sums;
        }
    }

    fn copy_column(&mut self, from: usize, to: usize) {
        let (source, target) = (from / LANES * self.num_rows, to / LANES * self.num_rows);
        for row in 0..self.num_rows {
            self.blocks[target + row][to % LANES] = self.blocks[source + row][from % LANES];
        }
    }
}

/// Where the drone is.
#[derive(Clone, Copy, Debug)]
struct Place {
    node: usize,
    x: f32,
    y: f32,
}

/// Routes in the making. Its arrays have a slot for the depot, which is slot 0, and one for each pond that is not visited.
#[derive(Debug)]
pub(super) struct Rollout<'a> {
    decoder: &'a Decoder<'a>,
    /// The node in each slot.
    nodes: Vec<usize>,
    xs: Vec<f32>,
    ys: Vec<f32>,
    keys: Columns,
    values: Vec<f32>,
    logit_keys: Columns,
    place: Place,
    /// Ponds visited since the depot.
    num_in_route: usize,
    /// Routes that are finished.
    num_closed: usize,
    /// Length flown since the depot.
    current: f32,
    /// The longest of the finished routes.
    longest: f32,
    query: Vec<f32>,
    attention: Vec<f32>,
    glimpse: Vec<f32>,
    logits: Vec<f32>,
}

impl Rollout<'_> {
    /// Chooses until every pond is visited; returns visit indices in flying order.
    pub fn run(mut self, mut choice: impl FnMut(&mut Self) -> usize) -> Vec<Vec<usize>> {
        let mut routes = vec![Vec::new()];
        while self.nodes.len() > 1 {
            let open = self.open();
            let slot = if open.len() == 1 { open.start } else { choice(&mut self) };
            match (self.nodes[slot], routes.last_mut()) {
                (0, _) | (_, None) => routes.push(Vec::new()),
                (node, Some(route)) => route.push(node - 1),
            }
            self.choose(slot);
        }
        routes
    }

    /// The open slot of greatest logit; of equal ones that of the first node.
    pub fn likeliest(&mut self) -> usize {
        let open = self.find_logits();
        let mut best = open.start;
        for slot in open {
            let is_first = self.logits[slot] == self.logits[best] && self.nodes[slot] < self.nodes[best];
            if self.logits[slot] > self.logits[best] || is_first {
                best = slot;
            }
        }
        best
    }

    /// An open slot, drawn with the probability that the network gives it.
    pub fn drawn(&mut self, random: &mut Random) -> usize {
        let open = self.find_logits();
        let weights = &mut self.logits[open.clone()];
        let threshold = random.uniform() as f32 * exp_relative(weights);
        let mut sum = 0.0;
        let passed = |weight: &&f32| {
            sum += **weight;
            sum <= threshold
        };
        // Rounding of the sum must not choose past the last open slot.
        (open.start + weights.iter().take_while(passed).count()).min(open.end - 1)
    }

    /// The slot of a node if it is open.
    pub fn open_slot(&self, node: usize) -> Option<usize> {
        self.open().find(|&slot| self.nodes[slot] == node)
    }

    /// The logits of all nodes, minus infinity for those that are not open.
    pub fn logits_of_nodes(&mut self) -> Vec<f32> {
        let open = self.find_logits();
        let mut logits = vec![f32::NEG_INFINITY; self.decoder.queries.nrows()];
        for slot in open {
            logits[self.nodes[slot]] = self.logits[slot];
        }
        logits
    }

    /// Flies to the node in a slot.
    pub fn choose(&mut self, slot: usize) {
        self.current += self.distance_to(slot);
        self.place = Place { node: self.nodes[slot], x: self.xs[slot], y: self.ys[slot] };
        if slot == 0 {
            self.longest = self.longest.max(self.current);
            self.current = 0.0;
            self.num_closed += 1;
            self.num_in_route = 0;
        } else {
            self.num_in_route += 1;
            self.take_out(slot);
        }
    }

    /// Puts the last slot into the place of the given one.
    fn take_out(&mut self, slot: usize) {
        self.nodes.swap_remove(slot);
        self.xs.swap_remove(slot);
        self.ys.swap_remove(slot);
        let last = self.nodes.len();
        let width = self.query.len();
        self.keys.copy_column(last, slot);
        self.logit_keys.copy_column(last, slot);
        self.values.copy_within(last * width..(last + 1) * width, slot * width);
    }

    /// The slots that may be chosen; never empty while a pond is left.
    fn open(&self) -> Range<usize> {
        let num_slots = self.nodes.len();
        let num_routes = self.decoder.view.num_routes;
        match self.decoder.architecture.variant {
            Variant::Cvrp => {
                let num_ponds = self.decoder.queries.nrows() - 1;
                let is_full = self.num_in_route >= capacity(num_ponds, num_routes);
                usize::from(self.num_in_route == 0)..if is_full { 1 } else { num_slots }
            }
            Variant::MinMax => {
                let may_return = self.num_in_route > 0 && self.num_closed + 1 < num_routes;
                usize::from(!may_return)..num_slots
            }
        }
    }

    /// What the query is told of the routes so far.
    fn state(&self) -> Vec<f32> {
        let num_ponds = self.decoder.queries.nrows() - 1;
        let num_routes = self.decoder.view.num_routes;
        match self.decoder.architecture.variant {
            Variant::Cvrp => vec![1.0 - self.num_in_route as f32 / capacity(num_ponds, num_routes) as f32],
            Variant::MinMax => {
                let num_routes_left = (num_routes - self.num_closed) as f32;
                let num_ponds_left = (self.nodes.len() - 1) as f32;
                let (num_ponds, num_routes) = (num_ponds as f32, num_routes as f32);
                let home = self.distance_to(0);
                vec![
                    num_routes_left / num_routes,
                    self.current,
                    home,
                    self.longest,
                    num_ponds_left / num_ponds,
                    num_ponds_left / num_routes_left * (num_routes / num_ponds),
                    self.current + home - self.longest,
                ]
            }
        }
    }

    fn distance_to(&self, slot: usize) -> f32 {
        let (dx, dy) = (self.xs[slot] - self.place.x, self.ys[slot] - self.place.y);
        (dx * dx + dy * dy).sqrt()
    }

    /// Fills the logits of the open slots, which are returned.
    fn find_logits(&mut self) -> Range<usize> {
        let open = self.open();
        self.find_query();
        self.find_glimpse(open.clone());
        self.logit_keys.multiply(0..self.query.len(), &self.glimpse, self.nodes.len(), &mut self.logits);
        let logit_bound = self.decoder.architecture.variant.logit_bound();
        for logit in &mut self.logits[open.clone()] {
            *logit = logit_bound * tanh(*logit);
        }
        let aversion = self.decoder.weights.aversion;
        if aversion != 0.0 {
            for slot in open.clone() {
                self.logits[slot] -= aversion * libm::log1pf(self.distance_to(slot) / self.decoder.view.spacing);
            }
        }
        open
    }

    fn find_query(&mut self) {
        let state = self.state();
        for (query, part) in self.query.iter_mut().zip(self.decoder.queries.row(self.place.node)) {
            *query = *part;
        }
        for (feature, row) in state.iter().zip(self.decoder.weights.state.rows()) {
            for (query, weight) in self.query.iter_mut().zip(row) {
                *query += feature * weight;
            }
        }
    }

    /// Multi-head attention of the query over the open slots.
    fn find_glimpse(&mut self, open: Range<usize>) {
        let width = self.query.len();
        let head_width = self.decoder.architecture.head_width();
        for begin in (0..width).step_by(head_width) {
            let of_head = begin..begin + head_width;
            self.keys.multiply(of_head.clone(), &self.query[of_head.clone()], self.nodes.len(), &mut self.attention);
            let total = exp_relative(&mut self.attention[open.clone()]);
            let glimpse = &mut self.glimpse[of_head.clone()];
            glimpse.fill(0.0);
            for slot in open.clone() {
                let weight = self.attention[slot];
                for (sum, value) in glimpse.iter_mut().zip(&self.values[slot * width + begin..][..head_width]) {
                    *sum += weight * value;
                }
            }
            for sum in glimpse {
                *sum /= total;
            }
        }
    }
}
