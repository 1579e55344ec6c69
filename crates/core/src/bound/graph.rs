//! The ponds and the legs between near ones, with a star that stands for the legs it lacks.

use super::price::Price;
use crate::geometry::Point;
use crate::neighbours::KdTree;
use crate::problem::Problem;

/// The ponds in descending order of their distance from the depot, with the legs between near ones.
pub(crate) struct SparseGraph {
    /// What the leg from the depot to each pond costs, and the leg from there to the depot.
    pub first_legs: Vec<f64>,
    pub last_legs: Vec<f64>,
    /// What it costs to be at the farthest pond, the two farthest, and so on.
    services: Vec<f64>,
    /// What a route to each pond and back costs.
    there_and_back: f64,
    /// In ascending order of the nearer pond, so that the legs among the farthest ponds come first.
    legs: Vec<Leg>,
    /// Half the distance to the farthest of the nearest neighbours of each pond: a leg that the graph lacks is at least as
    /// long as the sum over its ends. Empty if the graph lacks none.
    pub half_reaches: Vec<f64>,
    pub mean_nearest_cost: f64,
}

/// A leg between two ponds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leg {
    /// The pond of higher index, which is not farther from the depot than the other.
    pub nearer: usize,
    pub farther: usize,
    pub cost: f64,
}

impl SparseGraph {
    pub(super) fn new(problem: &Problem, price: &impl Price, num_neighbours: usize) -> Self {
        let depot = problem.depot().position;
        let mut visits = problem.visits().to_vec();
        visits.sort_by(|a, b| depot.distance(b.position).total_cmp(&depot.distance(a.position)));
        let ponds: Vec<Point> = visits.iter().map(|visit| visit.position).collect();
        let tree = KdTree::new(&ponds);
        let mut nearest = Vec::new();
        let (mut legs, mut half_reaches, mut sum_nearest) = (Vec::new(), Vec::new(), 0.0);
        for (pond, &position) in ponds.iter().enumerate() {
            tree.nearest(pond, num_neighbours, &mut nearest);
            for near in &nearest {
                let other = near.index as usize;
                let cost = price.between(position.distance(ponds[other]));
                legs.push(Leg { nearer: pond.max(other), farther: pond.min(other), cost });
            }
            sum_nearest += nearest.first().map_or(0.0, |first| first.squared_distance.sqrt());
            if ponds.len() > num_neighbours + 1 {
                half_reaches.push(nearest.last().map_or(0.0, |last| 0.5 * price.between(last.squared_distance.sqrt())));
            }
        }
        legs.sort_unstable_by_key(|leg| (leg.nearer, leg.farther));
        legs.dedup_by_key(|leg| (leg.nearer, leg.farther));
        let depot_distances = ponds.iter().map(|&pond| depot.distance(pond));
        let services: Vec<f64> = visits.iter().map(|visit| price.service(visit.service_duration)).collect();
        let there_and_back = depot_distances
            .clone()
            .zip(&services)
            .map(|(distance, service)| price.first(distance) + service + price.home(distance))
            .fold(0.0, f64::max);
        let add = |sum: &mut f64, service: f64| {
            *sum += service;
            Some(*sum)
        };
        Self {
            first_legs: depot_distances.clone().map(|distance| price.first(distance)).collect(),
            last_legs: depot_distances.map(|distance| price.last(distance)).collect(),
            services: services.into_iter().scan(0.0, add).collect(),
            there_and_back,
            legs,
            half_reaches,
            // The time of a stop is no measure of how much penalties have to differ; here it hardly counts.
            mean_nearest_cost: price.between(sum_nearest) / ponds.len() as f64,
        }
    }

    /// The graph of places whose legs cost at least so much, whatever they mean: `first_legs` out of the depot, `last_legs` back to
    /// it, and `between` two places by their index, the same in both directions. Costs may be negative. O(n^2) for n places.
    pub fn of_costs(
        first_legs: Vec<f64>,
        last_legs: Vec<f64>,
        num_neighbours: usize,
        between: impl Fn(usize, usize) -> f64,
    ) -> Self {
        let num_places = first_legs.len();
        let (mut legs, mut half_reaches, mut sum_nearest) = (Vec::new(), Vec::new(), 0.0);
        let mut near: Vec<(f64, usize)> = Vec::new();
        for place in 0..num_places {
            near.clear();
            near.extend((0..num_places).filter(|&other| other != place).map(|other| (between(place, other), other)));
            if near.len() > num_neighbours {
                // The first leg that is left out costs no more than all others that are.
                let (_, first_out, _) =
                    near.select_nth_unstable_by(num_neighbours, |one, other| one.0.total_cmp(&other.0));
                half_reaches.push(0.5 * first_out.0);
                near.truncate(num_neighbours);
            }
            let nearest = near.iter().map(|&(cost, _)| cost).fold(f64::INFINITY, f64::min);
            sum_nearest += if nearest.is_finite() { nearest } else { 0.0 };
            let leg = |&(cost, other): &(f64, usize)| Leg { nearer: place.max(other), farther: place.min(other), cost };
            legs.extend(near.iter().map(leg));
        }
        legs.sort_unstable_by_key(|leg| (leg.nearer, leg.farther));
        legs.dedup_by_key(|leg| (leg.nearer, leg.farther));
        let mean_nearest_cost = sum_nearest / num_places as f64;
        Self { first_legs, last_legs, services: Vec::new(), there_and_back: 0.0, legs, half_reaches, mean_nearest_cost }
    }

    pub fn num_ponds(&self) -> usize {
        self.first_legs.len()
    }

    /// No route to some pond and back costs less.
    pub fn farthest_pond_bound(&self) -> f64 {
        self.there_and_back
    }

    /// What it costs to be at the `num_ponds` farthest ponds.
    pub fn service_of_farthest(&self, num_ponds: usize) -> f64 {
        self.services[num_ponds - 1]
    }

    pub fn legs_among(&self, num_ponds: usize) -> &[Leg] {
        &self.legs[..self.legs.partition_point(|leg| leg.nearer < num_ponds)]
    }
}
