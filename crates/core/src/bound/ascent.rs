//! Penalties that raise the bound on a total, and the trees that they lead to.

use super::graph::{Leg, SparseGraph};
use super::tree::{NONE, Tree};

/// Subgradient steps per ascent, and how many pond visits they may take together on large farms.
const MAX_STEPS: usize = 24;
const MAX_POND_STEPS: usize = 1_000_000;
const MIN_STEPS: usize = 10;
/// First step, as a share of the mean distance between nearest neighbours; the steps shrink to zero.
const FIRST_STEP: f64 = 0.25;
/// Share of the previous subgradient in a step, which damps oscillation (Volgenant and Jonker 1982 use 0.4).
const MOMENTUM: f64 = 0.3;

/// Penalties and the tree that they lead to. Each step overwrites the tree of the one before.
pub(crate) struct Ascent<'a> {
    graph: &'a SparseGraph,
    penalties: Vec<f64>,
    /// Legs of the relaxation at each pond.
    degrees: Vec<i32>,
    tree: Tree,
    /// What the tree is chosen from: legs with their penalties.
    candidates: Vec<Leg>,
}

impl<'a> Ascent<'a> {
    pub fn new(graph: &'a SparseGraph) -> Self {
        let num_ponds = graph.num_ponds();
        let (penalties, degrees) = (vec![0.0; num_ponds], vec![0; num_ponds]);
        Self { graph, penalties, degrees, tree: Tree::default(), candidates: Vec::new() }
    }

    /// The best bound on the total of `num_routes` routes over the `num_ponds` farthest ponds that an ascent from the
    /// present penalties meets; its penalties are kept.
    pub fn rise(&mut self, num_ponds: usize, num_routes: usize) -> f64 {
        let num_steps = (MAX_POND_STEPS / num_ponds).clamp(MIN_STEPS, MAX_STEPS);
        let mut previous = vec![0.0; num_ponds];
        let (mut best, mut best_penalties) = (f64::NEG_INFINITY, Vec::new());
        for number in 0..num_steps {
            let bound = self.relax(num_ponds, num_routes);
            if bound > best {
                best = bound;
                best_penalties.clone_from(&self.penalties);
            }
            let left = 1.0 - number as f64 / num_steps as f64;
            let step = FIRST_STEP * self.graph.mean_nearest_cost * left * left;
            let ponds = self.penalties.iter_mut().zip(&self.degrees).zip(&mut previous);
            for ((penalty, &degree), previous) in ponds {
                let surplus = f64::from(degree - 2);
                *penalty += step * ((1.0 - MOMENTUM) * surplus + MOMENTUM * *previous);
                *previous = surplus;
            }
        }
        self.penalties = best_penalties;
        best
    }

    /// The bound of the present penalties on the total of `num_routes` routes (or one a pond, if there are fewer) over the
    /// `num_ponds` farthest ponds; leaves the degrees of the ponds.
    pub fn relax(&mut self, num_ponds: usize, num_routes: usize) -> f64 {
        let num_routes = num_routes.min(num_ponds);
        self.degrees.fill(0);
        self.list_candidates(num_ponds);
        let tree = self.tree.grow(num_ponds, &mut self.candidates, &mut self.degrees);
        let hung = self.hang_on_depot(num_ponds, num_routes);
        let mut ends: Vec<usize> = (0..num_ponds).collect();
        if num_routes < num_ponds {
            ends.select_nth_unstable_by(num_routes, |&a, &b| self.last_leg(a).total_cmp(&self.last_leg(b)));
        }
        let mut last_legs = 0.0;
        for &pond in &ends[..num_routes] {
            last_legs += self.last_leg(pond);
            self.degrees[pond] += 1;
        }
        tree + hung + last_legs - 2.0 * self.penalties[..num_ponds].iter().sum::<f64>()
    }

    fn first_leg(&self, pond: usize) -> f64 {
        self.graph.first_legs[pond] + self.penalties[pond]
    }

    fn last_leg(&self, pond: usize) -> f64 {
        self.graph.last_legs[pond] + self.penalties[pond]
    }

    /// The legs of the graph and the star that stands for those it lacks.
    fn list_candidates(&mut self, num_ponds: usize) {
        let (graph, penalties) = (self.graph, &self.penalties);
        self.candidates.clear();
        self.candidates.extend(graph.legs_among(num_ponds).iter().map(|leg| {
            let cost = leg.cost + penalties[leg.nearer] + penalties[leg.farther];
            Leg { cost, ..*leg }
        }));
        if !graph.half_reaches.is_empty() {
            let term = |pond: usize| graph.half_reaches[pond] + penalties[pond];
            let centre = (1..num_ponds).fold(0, |least, pond| if term(pond) < term(least) { pond } else { least });
            let others = (0..num_ponds).filter(|&pond| pond != centre);
            self.candidates.extend(others.map(|pond| {
                let cost = term(pond) + term(centre);
                Leg { nearer: pond.max(centre), farther: pond.min(centre), cost }
            }));
        }
    }

    /// What the tree gains in length when it is hung on the depot by exactly `num_routes` legs: by the shortest one, then by
    /// exchanging a leg of the tree for a leg of the depot, the best first. Each exchange cuts one part in two, so only
    /// those are searched again.
    fn hang_on_depot(&mut self, num_ponds: usize, num_routes: usize) -> f64 {
        let first =
            (1..num_ponds).fold(0, |best, pond| if self.first_leg(pond) < self.first_leg(best) { pond } else { best });
        self.degrees[first] += 1;
        let mut gained = self.first_leg(first);
        let mut exchanges = vec![self.best_exchange(first)];
        for _ in 1..num_routes {
            let by_gain = |a: &usize, b: &usize| exchanges[*a].gain.total_cmp(&exchanges[*b].gain);
            let Some(part) = (0..exchanges.len()).min_by(by_gain) else { break };
            let Exchange { gain, anchor, to, cut } = exchanges[part];
            gained += gain;
            self.degrees[to] += 1;
            for end in self.tree.cut(cut) {
                self.degrees[end] -= 1;
            }
            exchanges[part] = self.best_exchange(anchor);
            exchanges.push(self.best_exchange(to));
        }
        gained
    }

    /// The best exchange in the part of the tree that hangs on the depot by `anchor`: for each of its ponds, a depot leg for
    /// the longest leg between the pond and the anchor. Of infinite gain if the part is a single pond.
    fn best_exchange(&mut self, anchor: usize) -> Exchange {
        let mut best = Exchange { gain: f64::INFINITY, anchor, to: anchor, cut: NONE };
        let Self { graph, penalties, tree, .. } = self;
        tree.walk(anchor, |pond, dearest, cost| {
            let gain = graph.first_legs[pond] + penalties[pond] - cost;
            if gain < best.gain {
                best = Exchange { gain, anchor, to: pond, cut: dearest };
            }
        });
        best
    }
}

/// A depot leg for a leg of the tree.
#[derive(Clone, Copy, Debug)]
struct Exchange {
    gain: f64,
    anchor: usize,
    to: usize,
    cut: usize,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bound::price::Lengths;
    use crate::generate::{Variant, generate};
    use crate::geometry::Point;
    use crate::problem::Problem;

    #[test]
    fn the_least_tree_of_each_depot_degree() {
        let farm = generate(5, Variant::Paper, 3).unwrap();
        let places: Vec<Point> = farm.ponds.iter().copied().chain([farm.depot]).collect();
        let legs: Vec<(usize, usize)> = (0..6).flat_map(|b| (0..b).map(move |a| (a, b))).collect();
        for num_routes in 1..=5 {
            let mut least = f64::INFINITY;
            for set in (0u32..1 << legs.len()).filter(|set| set.count_ones() == 5) {
                let chosen: Vec<(usize, usize)> =
                    legs.iter().enumerate().filter(|(leg, _)| set >> leg & 1 == 1).map(|(_, &leg)| leg).collect();
                let length = |(a, b): (usize, usize)| places[a].distance(places[b]);
                let mut candidates: Vec<Leg> =
                    chosen.iter().map(|&(a, b)| Leg { nearer: a, farther: b, cost: 0.0 }).collect();
                let mut degrees = [0; 6];
                Tree::default().grow(6, &mut candidates, &mut degrees);
                // Five legs join six places, unless some of them make a circle.
                if degrees.iter().sum::<i32>() == 10 && chosen.iter().filter(|leg| leg.1 == 5).count() == num_routes {
                    least = least.min(chosen.iter().map(|&leg| length(leg)).sum());
                }
            }
            let problem = Problem::research(farm.depot, &farm.ponds, num_routes).unwrap();
            let graph = SparseGraph::new(&problem, &Lengths, 12);
            let mut ascent = Ascent::new(&graph);
            ascent.list_candidates(5);
            let tree = ascent.tree.grow(5, &mut ascent.candidates, &mut ascent.degrees);
            assert!((tree + ascent.hang_on_depot(5, num_routes) - least).abs() < 1e-12);
        }
    }
}
