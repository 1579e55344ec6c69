//! Lower bounds: what no plan can beat.
//!
//! The proofs are in `docs/explanation/bounds.md`; in short:
//!
//! 1. *Farthest pond.* Some route flies there and back: twice its distance from the depot.
//! 2. *Averages over far ponds.* Leave out the nearer ponds: by the triangle inequality no route grows. A route of several
//!    ponds can be split in two, neither longer than the whole, so all m drones may be taken to fly (if there are as many
//!    ponds). The longest route is then at least 1/m of the least total of exactly m routes over the ponds left. Where the
//!    depot is far off, leaving out near ponds makes every drone pay the way to the far ones.
//! 3. *Totals.* m routes over a set of ponds are a tree with m edges at the depot (each route without its last leg) and m
//!    more depot legs to different ponds. The least such structure is a lower bound, and stays one if every pond gets a
//!    penalty that is added to all its legs and taken off twice: Held and Karp, The traveling-salesman problem and minimum
//!    spanning trees, Operations Research 1970, part II Mathematical Programming 1971. Penalties rise by subgradient steps.
//!    Among trees with m edges at the depot the least one comes from the one with one by m - 1 best exchanges (Glover and
//!    Klingman, Finding minimum spanning trees with a fixed number of links at a node, 1975).
//!
//! What we changed: trees are found on a sparse graph and still bound the complete one. A pair of ponds i, j that is not
//! among each other's k nearest is at least (rᵢ + rⱼ) / 2 apart, r the distance to the k-th. With such costs, sums of a term
//! for each end, every pair costs no less than the two legs through the pond with the least term. So a star around that
//! pond stands for all pairs that the graph lacks.
//!
//! O(i n (k + log n + m)) for i steps, the last term in the worst case only: where every exchange cuts off a small part.

use crate::geometry::Point;
use crate::neighbours::KdTree;
use crate::problem::Problem;

/// A length that the longest route of no plan falls below, in length units. Speed, service and limits are not considered.
#[must_use]
pub fn lower_bound(problem: &Problem) -> f64 {
    bound_of_longest_route(&SparseGraph::new(problem, NUM_NEIGHBOURS), problem.vehicle_type().num_available)
}

/// A length that the total of no plan falls below, in length units. By the triangle inequality one route is the shortest way
/// to visit everything, so it does not depend on the number of drones.
#[must_use]
pub fn lower_bound_of_total(problem: &Problem) -> f64 {
    bound_of_total(&SparseGraph::new(problem, NUM_NEIGHBOURS))
}

fn bound_of_longest_route(graph: &SparseGraph, num_routes: usize) -> f64 {
    let num_ponds = graph.num_ponds();
    let mut ascent = Ascent::new(graph);
    let mean_route = |total: f64, num_ponds: usize| total / num_routes.min(num_ponds) as f64;
    let all = mean_route(ascent.rise(num_ponds, num_routes), num_ponds);
    // The penalties of all ponds serve any part of them well enough to tell which part gives the best bound.
    let (far, num_far) = PARTS
        .iter()
        .map(|part| (part * num_ponds as f64).ceil() as usize)
        .map(|num_far| (mean_route(ascent.relax(num_far, num_routes), num_far), num_far))
        .fold((all, num_ponds), |best, part| if part.0 > best.0 { part } else { best });
    let risen = mean_route(ascent.rise(num_far, num_routes), num_far);
    graph.farthest_pond_bound().max(ROUNDING * far.max(risen))
}

fn bound_of_total(graph: &SparseGraph) -> f64 {
    let tour = Ascent::new(graph).rise(graph.num_ponds(), 1);
    graph.farthest_pond_bound().max(ROUNDING * tour)
}

/// Neighbours of a pond in the sparse graph: enough that on a grid pairs beyond them hardly enter a tree.
const NUM_NEIGHBOURS: usize = 12;
/// Shares of the ponds, the farthest ones, among which the best bound is sought.
const PARTS: [f64; 11] = [0.97, 0.94, 0.91, 0.87, 0.82, 0.75, 0.66, 0.55, 0.43, 0.3, 0.15];
/// Subgradient steps per ascent, and how many pond visits they may take together on large farms.
const MAX_STEPS: usize = 24;
const MAX_POND_STEPS: usize = 1_000_000;
const MIN_STEPS: usize = 10;
/// First step, as a share of the mean distance between nearest neighbours; the steps shrink to zero.
const FIRST_STEP: f64 = 0.25;
/// Share of the previous subgradient in a step, which damps oscillation (Volgenant and Jonker 1982 use 0.4).
const MOMENTUM: f64 = 0.3;
/// Keeps a bound that equals the optimum from exceeding it by rounding.
const ROUNDING: f64 = 1.0 - 1e-10;

/// The ponds in descending order of their distance from the depot, with the legs between near ones.
struct SparseGraph {
    depot_distances: Vec<f64>,
    /// In ascending order of the nearer pond, so that the legs among the farthest ponds come first.
    legs: Vec<Leg>,
    /// Half the distance to the farthest of the nearest neighbours of each pond: a leg that the graph lacks is at least as
    /// long as the sum over its ends. Empty if the graph lacks none.
    half_reaches: Vec<f64>,
    mean_nearest_distance: f64,
}

/// A leg between two ponds.
#[derive(Clone, Copy, Debug)]
struct Leg {
    /// The pond of higher index, which is not farther from the depot than the other.
    nearer: usize,
    farther: usize,
    length: f64,
}

impl SparseGraph {
    fn new(problem: &Problem, num_neighbours: usize) -> Self {
        let depot = problem.depot().position;
        let mut ponds: Vec<Point> = problem.visits().iter().map(|visit| visit.position).collect();
        ponds.sort_by(|a, b| depot.distance(*b).total_cmp(&depot.distance(*a)));
        let tree = KdTree::new(&ponds);
        let mut nearest = Vec::new();
        let (mut legs, mut half_reaches, mut sum_nearest) = (Vec::new(), Vec::new(), 0.0);
        for (pond, &position) in ponds.iter().enumerate() {
            tree.nearest(pond, num_neighbours, &mut nearest);
            for near in &nearest {
                let other = near.index as usize;
                let length = position.distance(ponds[other]);
                legs.push(Leg { nearer: pond.max(other), farther: pond.min(other), length });
            }
            sum_nearest += nearest.first().map_or(0.0, |first| first.squared_distance.sqrt());
            if ponds.len() > num_neighbours + 1 {
                half_reaches.push(nearest.last().map_or(0.0, |last| 0.5 * last.squared_distance.sqrt()));
            }
        }
        legs.sort_unstable_by_key(|leg| (leg.nearer, leg.farther));
        legs.dedup_by_key(|leg| (leg.nearer, leg.farther));
        let depot_distances = ponds.iter().map(|&pond| depot.distance(pond)).collect();
        let mean_nearest_distance = sum_nearest / ponds.len() as f64;
        Self { depot_distances, legs, half_reaches, mean_nearest_distance }
    }

    fn num_ponds(&self) -> usize {
        self.depot_distances.len()
    }

    /// Twice the distance of the farthest pond.
    fn farthest_pond_bound(&self) -> f64 {
        2.0 * self.depot_distances[0]
    }

    fn legs_among(&self, num_ponds: usize) -> &[Leg] {
        &self.legs[..self.legs.partition_point(|leg| leg.nearer < num_ponds)]
    }
}

/// No pond, or no leg.
const NONE: usize = usize::MAX;

/// Penalties and the tree that they lead to. Each step overwrites the tree of the one before.
struct Ascent<'a> {
    graph: &'a SparseGraph,
    penalties: Vec<f64>,
    /// Legs of the relaxation at each pond.
    degrees: Vec<i32>,
    tree: Tree,
    /// What the tree is chosen from: legs with their penalties.
    candidates: Vec<Leg>,
}

impl<'a> Ascent<'a> {
    fn new(graph: &'a SparseGraph) -> Self {
        let num_ponds = graph.num_ponds();
        let (penalties, degrees) = (vec![0.0; num_ponds], vec![0; num_ponds]);
        Self { graph, penalties, degrees, tree: Tree::default(), candidates: Vec::new() }
    }

    /// The best bound on the total of `num_routes` routes over the `num_ponds` farthest ponds that an ascent from the
    /// present penalties meets; its penalties are kept.
    fn rise(&mut self, num_ponds: usize, num_routes: usize) -> f64 {
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
            let step = FIRST_STEP * self.graph.mean_nearest_distance * left * left;
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
    fn relax(&mut self, num_ponds: usize, num_routes: usize) -> f64 {
        let num_routes = num_routes.min(num_ponds);
        self.degrees.fill(0);
        self.list_candidates(num_ponds);
        let tree = self.tree.grow(num_ponds, &mut self.candidates, &mut self.degrees);
        let hung = self.hang_on_depot(num_ponds, num_routes);
        let mut ends: Vec<usize> = (0..num_ponds).collect();
        if num_routes < num_ponds {
            ends.select_nth_unstable_by(num_routes, |&a, &b| self.depot_leg(a).total_cmp(&self.depot_leg(b)));
        }
        let mut last_legs = 0.0;
        for &pond in &ends[..num_routes] {
            last_legs += self.depot_leg(pond);
            self.degrees[pond] += 1;
        }
        tree + hung + last_legs - 2.0 * self.penalties[..num_ponds].iter().sum::<f64>()
    }

    fn depot_leg(&self, pond: usize) -> f64 {
        self.graph.depot_distances[pond] + self.penalties[pond]
    }

    /// The legs of the graph and the star that stands for those it lacks.
    fn list_candidates(&mut self, num_ponds: usize) {
        let (graph, penalties) = (self.graph, &self.penalties);
        self.candidates.clear();
        self.candidates.extend(graph.legs_among(num_ponds).iter().map(|leg| {
            let length = leg.length + penalties[leg.nearer] + penalties[leg.farther];
            Leg { length, ..*leg }
        }));
        if !graph.half_reaches.is_empty() {
            let term = |pond: usize| graph.half_reaches[pond] + penalties[pond];
            let centre = (1..num_ponds).fold(0, |least, pond| if term(pond) < term(least) { pond } else { least });
            let others = (0..num_ponds).filter(|&pond| pond != centre);
            self.candidates.extend(others.map(|pond| {
                let length = term(pond) + term(centre);
                Leg { nearer: pond.max(centre), farther: pond.min(centre), length }
            }));
        }
    }

    /// What the tree gains in length when it is hung on the depot by exactly `num_routes` legs: by the shortest one, then by
    /// exchanging a leg of the tree for a leg of the depot, the best first. Each exchange cuts one part in two, so only
    /// those are searched again.
    fn hang_on_depot(&mut self, num_ponds: usize, num_routes: usize) -> f64 {
        let first =
            (1..num_ponds).fold(0, |best, pond| if self.depot_leg(pond) < self.depot_leg(best) { pond } else { best });
        self.degrees[first] += 1;
        let mut gained = self.depot_leg(first);
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
        tree.walk(anchor, |pond, longest, length| {
            let gain = graph.depot_distances[pond] + penalties[pond] - length;
            if gain < best.gain {
                best = Exchange { gain, anchor, to: pond, cut: longest };
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

/// A least spanning tree of the ponds. Leg l joins the ponds `ends[2 l]` and `ends[2 l + 1]`.
#[derive(Default)]
struct Tree {
    ends: Vec<usize>,
    lengths: Vec<f64>,
    /// Per pond the first of its places in `ends`, and per place the next of the same pond.
    first_places: Vec<usize>,
    next_places: Vec<usize>,
    is_cut: Vec<bool>,
    groups: Vec<usize>,
    stack: Vec<(usize, usize, usize)>,
}

impl Tree {
    /// Chooses the tree among the candidates and counts its legs in `degrees`; returns its length. Kruskal's algorithm; of
    /// the longer candidates it sorts only those that join what the shorter ones leave apart.
    fn grow(&mut self, num_ponds: usize, candidates: &mut [Leg], degrees: &mut [i32]) -> f64 {
        self.ends.clear();
        self.lengths.clear();
        self.groups.clear();
        self.groups.extend(0..num_ponds);
        let by_length =
            |a: &Leg, b: &Leg| a.length.total_cmp(&b.length).then((a.nearer, a.farther).cmp(&(b.nearer, b.farther)));
        let num_short = (2 * num_ponds).min(candidates.len());
        if num_short < candidates.len() {
            candidates.select_nth_unstable_by(num_short, by_length);
        }
        candidates[..num_short].sort_unstable_by(by_length);
        self.join(&candidates[..num_short]);
        let joins_groups = |leg: &Leg| self.group(leg.nearer) != self.group(leg.farther);
        let mut long: Vec<Leg> = candidates[num_short..].iter().copied().filter(joins_groups).collect();
        long.sort_unstable_by(by_length);
        self.join(&long);
        for &end in &self.ends {
            degrees[end] += 1;
        }
        self.list_places(num_ponds);
        self.lengths.iter().sum()
    }

    fn join(&mut self, legs: &[Leg]) {
        for leg in legs {
            let (one, other) = (self.group(leg.nearer), self.group(leg.farther));
            if one != other {
                self.groups[one] = other;
                self.ends.extend([leg.nearer, leg.farther]);
                self.lengths.push(leg.length);
            }
        }
    }

    fn group(&mut self, mut pond: usize) -> usize {
        while self.groups[pond] != pond {
            self.groups[pond] = self.groups[self.groups[pond]];
            pond = self.groups[pond];
        }
        pond
    }

    fn list_places(&mut self, num_ponds: usize) {
        self.is_cut.clear();
        self.is_cut.resize(self.lengths.len(), false);
        self.first_places.clear();
        self.first_places.resize(num_ponds, NONE);
        self.next_places.clear();
        for (place, &pond) in self.ends.iter().enumerate() {
            self.next_places.push(self.first_places[pond]);
            self.first_places[pond] = place;
        }
    }

    /// Cuts a leg and returns its ends.
    fn cut(&mut self, leg: usize) -> [usize; 2] {
        self.is_cut[leg] = true;
        [self.ends[2 * leg], self.ends[2 * leg + 1]]
    }

    /// Visits every other pond that hangs together with `start`, with the longest leg between them and its length.
    fn walk(&mut self, start: usize, mut visit: impl FnMut(usize, usize, f64)) {
        // A pond, the leg it was reached by and the longest leg on the way.
        self.stack.push((start, NONE, NONE));
        while let Some((pond, last, longest)) = self.stack.pop() {
            if longest != NONE {
                visit(pond, longest, self.lengths[longest]);
            }
            let mut place = self.first_places[pond];
            while place != NONE {
                let leg = place / 2;
                if leg != last && !self.is_cut[leg] {
                    let is_longer = longest == NONE || self.lengths[leg] > self.lengths[longest];
                    self.stack.push((self.ends[place ^ 1], leg, if is_longer { leg } else { longest }));
                }
                place = self.next_places[place];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::evaluate;
    use crate::generate::{Variant, generate};
    use proptest::prelude::*;

    fn problem(depot: (f64, f64), ponds: &[(f64, f64)], num_routes: usize) -> Problem {
        let ponds: Vec<Point> = ponds.iter().map(|&(x, y)| Point::new(x, y)).collect();
        Problem::research(Point::new(depot.0, depot.1), &ponds, num_routes).unwrap()
    }

    /// Per set of ponds (a bit each) the length of its shortest route: Held and Karp's dynamic program.
    fn shortest_routes(problem: &Problem) -> Vec<f64> {
        let ponds: Vec<Point> = problem.visits().iter().map(|visit| visit.position).collect();
        let depot = problem.depot().position;
        let num = ponds.len();
        let mut paths = vec![vec![f64::INFINITY; num]; 1 << num];
        let mut routes = vec![0.0; 1 << num];
        for set in 1usize..1 << num {
            for last in (0..num).filter(|last| set >> last & 1 == 1) {
                let before = set & !(1 << last);
                paths[set][last] = if before == 0 {
                    depot.distance(ponds[last])
                } else {
                    let via = |pond: usize| paths[before][pond] + ponds[pond].distance(ponds[last]);
                    (0..num).map(via).fold(f64::INFINITY, f64::min)
                };
            }
            let home = |last: usize| paths[set][last] + depot.distance(ponds[last]);
            routes[set] = (0..num).map(home).fold(f64::INFINITY, f64::min);
        }
        routes
    }

    /// The shortest longest route, by trying every partition.
    fn optimum(routes: &[f64], num_routes: usize) -> f64 {
        let mut best = routes.to_vec();
        for _ in 1..num_routes {
            let improved = |set: usize| {
                let mut least = best[set];
                let mut part = set;
                while part > 0 {
                    least = least.min(routes[part].max(best[set & !part]));
                    part = (part - 1) & set;
                }
                least
            };
            best = (0..routes.len()).map(improved).collect();
        }
        best[routes.len() - 1]
    }

    #[test]
    fn bounds_by_hand() {
        // All ponds on a line from the depot: the farthest decides, whatever the number of drones.
        let line = problem((0.0, 0.0), &[(1.0, 0.0), (2.0, 0.0), (5.0, 0.0)], 2);
        assert_eq!(lower_bound(&line), 10.0);
        assert!((lower_bound_of_total(&line) - 10.0).abs() < 1e-9);
        // One drone round a square: the bound is the perimeter.
        let square = problem((0.0, 0.0), &[(1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], 1);
        assert!((lower_bound(&square) - 4.0).abs() < 1e-9);
        // Two drones, two clusters far away on one side: each drone flies there.
        let far = problem((0.0, 0.0), &[(10.0, 0.0), (10.0, 3.0), (10.0, 6.0), (10.0, 9.0), (0.1, 0.0)], 2);
        assert!(lower_bound(&far) > 2.0 * 10.0 && lower_bound(&far) >= 2.0 * 181.0f64.sqrt());
    }

    #[test]
    fn ponds_in_one_place_and_at_the_depot() {
        assert_eq!(lower_bound(&problem((1.0, 1.0), &[(1.0, 1.0); 30], 4)), 0.0);
        assert_eq!(lower_bound(&problem((0.0, 0.0), &[(3.0, 4.0); 30], 4)), 10.0);
        assert_eq!(lower_bound(&problem((0.0, 0.0), &[(3.0, 4.0)], 4)), 10.0);
    }

    #[test]
    fn the_bound_of_far_ponds_beats_the_mean_of_all() {
        // Three drones for 100 ponds 10 away and three beside the depot. Over all ponds two drones may stay at the depot:
        // about (100 + 2 * 10) / 3. Without the near ones all three fly there: about (100 + 6 * 10) / 3.
        let far = (0..100).map(|pond| (10.0 + f64::from(pond % 10), f64::from(pond / 10)));
        let near = (1..=3).map(|pond| (0.01 * f64::from(pond), 4.5));
        let problem = problem((0.0, 4.5), &far.chain(near).collect::<Vec<_>>(), 3);
        let graph = SparseGraph::new(&problem, NUM_NEIGHBOURS);
        let mean_of_all = Ascent::new(&graph).rise(103, 3) / 3.0;
        assert!(lower_bound(&problem) > 1.25 * mean_of_all.max(graph.farthest_pond_bound()));
    }

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
                let mut tree = Tree { groups: (0..6).collect(), ..Tree::default() };
                let length = |(a, b): (usize, usize)| places[a].distance(places[b]);
                tree.join(&chosen.iter().map(|&(a, b)| Leg { nearer: a, farther: b, length: 0.0 }).collect::<Vec<_>>());
                if tree.lengths.len() == 5 && chosen.iter().filter(|leg| leg.1 == 5).count() == num_routes {
                    least = least.min(chosen.iter().map(|&leg| length(leg)).sum());
                }
            }
            let problem = Problem::research(farm.depot, &farm.ponds, num_routes).unwrap();
            let graph = SparseGraph::new(&problem, NUM_NEIGHBOURS);
            let mut ascent = Ascent::new(&graph);
            ascent.list_candidates(5);
            let tree = ascent.tree.grow(5, &mut ascent.candidates, &mut ascent.degrees);
            assert!((tree + ascent.hang_on_depot(5, num_routes) - least).abs() < 1e-12);
        }
    }

    fn place() -> impl Strategy<Value = (f64, f64)> {
        (0.0..1.0, 0.0..1.0)
    }

    proptest! {
        #[test]
        fn no_bound_exceeds_the_optimum(
            depot in place(), ponds in prop::collection::vec(place(), 1..9), num_neighbours in 1usize..9,
        ) {
            let problem = problem(depot, &ponds, 1);
            let routes = shortest_routes(&problem);
            let graph = SparseGraph::new(&problem, num_neighbours);
            prop_assert!(bound_of_total(&graph) <= routes[routes.len() - 1] * (1.0 + 1e-9));
            for num_routes in 1..=4 {
                let bound = bound_of_longest_route(&graph, num_routes);
                prop_assert!(bound <= optimum(&routes, num_routes) * (1.0 + 1e-9));
                prop_assert!(bound >= graph.farthest_pond_bound());
            }
        }

        #[test]
        fn no_bound_exceeds_a_plan(seed: u64, num_ponds in 1usize..150, num_routes in 1usize..9) {
            let farm = generate(num_ponds, Variant::Authors, seed).unwrap();
            let problem = Problem::research(farm.depot, &farm.ponds, num_routes).unwrap();
            // Columns of the grid, up and down, in parts of equal size.
            let mut order: Vec<usize> = (0..num_ponds).collect();
            order.sort_by(|&a, &b| {
                let (a, b) = (farm.ponds[a], farm.ponds[b]);
                let is_up = (a.x / farm.spacing).round() as i64 % 2 == 0;
                a.x.total_cmp(&b.x).then(if is_up { a.y.total_cmp(&b.y) } else { b.y.total_cmp(&a.y) })
            });
            let routes: Vec<Vec<usize>> =
                order.chunks(num_ponds.div_ceil(num_routes)).map(<[usize]>::to_vec).collect();
            let plan = evaluate(&problem, &routes).unwrap();
            prop_assert!(plan.is_feasible());
            prop_assert!(lower_bound(&problem) <= plan.max_route_length());
            prop_assert!(lower_bound_of_total(&problem) <= plan.total_length());
        }

        #[test]
        fn moving_turning_and_scaling_a_farm_scales_its_bound(
            ponds in prop::collection::vec((0u16.., 0u16..), 1..40), num_routes in 1usize..6,
        ) {
            // Whole numbers, so that every distance is computed alike.
            let ponds: Vec<(f64, f64)> = ponds.into_iter().map(|(x, y)| (x.into(), y.into())).collect();
            let bound = lower_bound(&problem((0.0, 0.0), &ponds, num_routes));
            let changed: Vec<(f64, f64)> = ponds.iter().map(|&(x, y)| (1000.0 - 4.0 * y, 4.0 * x - 77.0)).collect();
            let changed_bound = lower_bound(&problem((1000.0, -77.0), &changed, num_routes));
            prop_assert!((changed_bound - 4.0 * bound).abs() <= 1e-9 * changed_bound);
        }
    }
}
