//! The encoder: a vector for every node that depends on all nodes (Kool et al., section 3.1 and appendix A).
//!
//! Each layer mixes the nodes by multi-head attention and then maps every node on its own, with a skip connection and a batch
//! normalisation, which at inference is an affine map, around each. O(n²) time. The n x n weights of a head are never held
//! whole: rows are worked off in blocks, so memory is O(n).

use super::features::View;
use super::softmax::exp_relative;
use super::weights::{Layer, Skip, Weights, columns};
use ndarray::linalg::general_mat_mul;
use ndarray::{Array2, ArrayView2, ArrayViewMut2, Axis, Slice, Zip, aview_mut1, aview1};

/// Attention weights that are held at once: 1 MB, which stays in the second-level cache.
const MAX_HELD_WEIGHTS: usize = 1 << 18;
/// Rows of a block at least, so that keys and values are fetched for many queries at once.
const MIN_BLOCK_ROWS: usize = 64;
/// Rows that the feed-forward map takes at once.
const FEED_FORWARD_ROWS: usize = 256;

/// The embeddings of depot and ponds: (nodes, width).
pub(super) fn encode(weights: &Weights, num_heads: usize, view: &View) -> Array2<f32> {
    let mut nodes = Array2::zeros((view.ponds.nrows() + 1, weights.depot_bias.len()));
    let (mut depot, mut ponds) = nodes.view_mut().split_at(Axis(0), 1);
    depot.assign(&(view.depot.dot(&weights.depot) + &weights.depot_bias));
    ponds.assign(&(view.ponds.dot(&weights.pond) + &weights.pond_bias));
    for layer in &weights.layers {
        let attended = attend(layer, num_heads, &nodes);
        add(&layer.attention, attended.view(), nodes.view_mut());
        for mut block in nodes.axis_chunks_iter_mut(Axis(0), FEED_FORWARD_ROWS) {
            let mut hidden = block.dot(&layer.hidden);
            for mut row in hidden.rows_mut() {
                row.zip_mut_with(&layer.hidden_bias, |value, bias| *value = (*value + bias).max(0.0));
            }
            add(&layer.feed_forward, hidden.view(), block.view_mut());
        }
    }
    nodes
}

fn add(skip: &Skip, mapped: ArrayView2<'_, f32>, mut nodes: ArrayViewMut2<'_, f32>) {
    for mut row in nodes.rows_mut() {
        Zip::from(&mut row)
            .and(&skip.scale)
            .and(&skip.shift)
            .for_each(|value, scale, shift| *value = *value * scale + shift);
    }
    general_mat_mul(1.0, &mapped, &skip.map, 1.0, &mut nodes);
}

/// What every node gathers from all nodes, heads side by side: (nodes, width).
fn attend(layer: &Layer, num_heads: usize, nodes: &Array2<f32>) -> Array2<f32> {
    let (num_nodes, width) = nodes.dim();
    let head_width = width / num_heads;
    let projected = nodes.dot(&layer.queries_keys_values);
    let num_rows = (MAX_HELD_WEIGHTS / num_nodes).max(MIN_BLOCK_ROWS).min(num_nodes);
    let mut held = vec![0.0; num_rows * num_nodes];
    let mut attended = Array2::zeros((num_nodes, width));
    for head in 0..num_heads {
        let of_head = |part: usize| {
            let begin = part * width + head * head_width;
            columns(&projected, begin..begin + head_width)
        };
        let (queries, keys, values) = (of_head(0), of_head(1), of_head(2));
        let mut gathered = attended.slice_axis_mut(Axis(1), Slice::from(head * head_width..(head + 1) * head_width));
        let blocks = gathered.axis_chunks_iter_mut(Axis(0), num_rows);
        for (queries, mut gathered) in queries.axis_chunks_iter(Axis(0), num_rows).zip(blocks) {
            let held = &mut held[..queries.nrows() * num_nodes];
            let shape = (queries.nrows(), num_nodes);
            let mut scores = aview_mut1(held).into_shape_with_order(shape).expect("a score for each query and key");
            general_mat_mul(1.0, &queries, &keys.t(), 0.0, &mut scores);
            let totals: Vec<f32> = held.chunks_exact_mut(num_nodes).map(exp_relative).collect();
            let weights = aview1(held).into_shape_with_order(shape).expect("a weight for each query and key");
            general_mat_mul(1.0, &weights, &values, 0.0, &mut gathered);
            for (mut row, total) in gathered.rows_mut().into_iter().zip(totals) {
                row /= total;
            }
        }
    }
    attended
}
