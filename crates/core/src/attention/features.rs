//! What the network sees of a farm.
//!
//! [`Variant::Cvrp`]: coordinates in the unit square, and of a pond its share of a route's capacity. Farms of the paper lie in
//! the unit square and are taken as they are; any other is moved and scaled so that the longer side of the box around it has
//! length 1 and its centre is that of the square, wherever it lies and whatever its units.
//!
//! [`Variant::MinMax`]: coordinates from the depot in units of the farthest pond's distance, and of a pond its distance from
//! the depot and from the nearest other pond.

use super::Variant;
use crate::geometry::{Point, extent};
use crate::neighbours::KdTree;
use crate::problem::Problem;
use ndarray::{Array1, Array2, Axis};

impl Variant {
    pub(super) const fn num_depot_features(self) -> usize {
        match self {
            Self::Cvrp => 2,
            Self::MinMax => 4,
        }
    }

    pub(super) const fn num_pond_features(self) -> usize {
        match self {
            Self::Cvrp => 3,
            Self::MinMax => 4,
        }
    }

    pub(super) const fn num_state_features(self) -> usize {
        match self {
            Self::Cvrp => 1,
            Self::MinMax => 7,
        }
    }
}

/// One of the eight ways to lay a square on itself.
#[derive(Clone, Copy, Debug)]
pub(super) struct Symmetry(u8);

impl Symmetry {
    /// The square as it is.
    pub const NONE: Self = Self(0);

    pub fn all() -> impl Iterator<Item = Self> {
        (0..8).map(Self)
    }

    /// The image of a point of a square around `(centre, centre)`.
    fn image(self, point: Point, centre: f64) -> Point {
        let mirrored = |value: f64, bit: u8| if self.0 & bit == 0 { value } else { 2.0 * centre - value };
        let (x, y) = (mirrored(point.x, 1), mirrored(point.y, 2));
        if self.0 & 4 == 0 { Point::new(x, y) } else { Point::new(y, x) }
    }
}

/// A farm in the network's coordinates. Node 0 is the depot, node `i + 1` the visit `i`.
#[derive(Debug)]
pub(super) struct Farm {
    variant: Variant,
    nodes: Vec<Point>,
    /// Distance from each pond to the nearest other one; 1 where there is no other.
    spacings: Vec<f64>,
    num_routes: usize,
}

impl Farm {
    pub fn new(variant: Variant, problem: &Problem) -> Self {
        let depot = problem.depot().position;
        let mut nodes: Vec<Point> =
            std::iter::once(depot).chain(problem.visits().iter().map(|visit| visit.position)).collect();
        match variant {
            Variant::Cvrp => fit_unit_square(&mut nodes),
            Variant::MinMax => centre_on_depot(&mut nodes),
        }
        let spacings = match variant {
            Variant::Cvrp => Vec::new(),
            Variant::MinMax => spacings(&nodes[1..]),
        };
        Self { variant, nodes, spacings, num_routes: problem.vehicle_type().num_available }
    }

    /// The farm, laid on itself.
    pub fn view(&self, symmetry: Symmetry) -> View {
        let centre = match self.variant {
            Variant::Cvrp => 0.5,
            Variant::MinMax => 0.0,
        };
        let nodes: Vec<Point> = self.nodes.iter().map(|&node| symmetry.image(node, centre)).collect();
        let num_ponds = nodes.len() - 1;
        let mean_spacing = self.spacings.iter().sum::<f64>() / num_ponds as f64;
        let mut ponds = Array2::zeros((num_ponds, self.variant.num_pond_features()));
        for (index, mut row) in ponds.axis_iter_mut(Axis(0)).enumerate() {
            let pond = nodes[index + 1];
            (row[0], row[1]) = (pond.x as f32, pond.y as f32);
            match self.variant {
                Variant::Cvrp => row[2] = 1.0 / capacity(num_ponds, self.num_routes) as f32,
                Variant::MinMax => {
                    (row[2], row[3]) = (pond.distance(nodes[0]) as f32, self.spacings[index] as f32);
                }
            }
        }
        let depot = match self.variant {
            Variant::Cvrp => Array1::from_vec(vec![nodes[0].x as f32, nodes[0].y as f32]),
            Variant::MinMax => Array1::from_vec(vec![0.0, 0.0, 0.0, mean_spacing as f32]),
        };
        View {
            depot,
            ponds,
            xs: nodes.iter().map(|node| node.x as f32).collect(),
            ys: nodes.iter().map(|node| node.y as f32).collect(),
            spacing: if mean_spacing > 0.0 { mean_spacing as f32 } else { 1.0 },
            num_routes: self.num_routes,
        }
    }
}

/// A farm as the network sees it.
#[derive(Debug)]
pub(super) struct View {
    /// Features of the depot.
    pub depot: Array1<f32>,
    /// Features of the ponds: (ponds, features).
    pub ponds: Array2<f32>,
    /// Coordinates of the nodes.
    pub xs: Vec<f32>,
    pub ys: Vec<f32>,
    /// Mean distance from a pond to the nearest other one; 1 where that is 0.
    pub spacing: f32,
    /// Drones there are.
    pub num_routes: usize,
}

/// How many ponds a route of [`Variant::Cvrp`] may have (paper: n / 5 + 1 for its five drones).
pub(super) const fn capacity(num_ponds: usize, num_routes: usize) -> usize {
    num_ponds / num_routes + 1
}

fn fit_unit_square(nodes: &mut [Point]) {
    let is_within = |node: &Point| (0.0..=1.0).contains(&node.x) && (0.0..=1.0).contains(&node.y);
    if nodes.iter().all(is_within) {
        return;
    }
    let middle = |values: &mut dyn Iterator<Item = f64>| {
        let (low, high) =
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (value.min(low), value.max(high)));
        0.5 * low + 0.5 * high
    };
    let centre = Point::new(middle(&mut nodes.iter().map(|node| node.x)), middle(&mut nodes.iter().map(|node| node.y)));
    let side = positive_or_one(extent(nodes.iter().copied()));
    for node in nodes {
        let from_centre = *node - centre;
        *node = Point::new(0.5 + from_centre.x / side, 0.5 + from_centre.y / side);
    }
}

fn centre_on_depot(nodes: &mut [Point]) {
    let depot = nodes[0];
    let radius = positive_or_one(nodes.iter().map(|node| node.distance(depot)).fold(0.0, f64::max));
    for node in nodes {
        let from_depot = *node - depot;
        *node = Point::new(from_depot.x / radius, from_depot.y / radius);
    }
}

/// What a farm without any extent is divided by.
fn positive_or_one(length: f64) -> f64 {
    if length > 0.0 { length } else { 1.0 }
}

fn spacings(ponds: &[Point]) -> Vec<f64> {
    let tree = KdTree::new(ponds);
    let mut found = Vec::new();
    (0..ponds.len())
        .map(|pond| {
            tree.nearest(pond, 1, &mut found);
            found.first().map_or(1.0, |near| near.squared_distance.sqrt())
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn farm(variant: Variant, depot: (f64, f64), ponds: &[(f64, f64)], num_drones: usize) -> Farm {
        let ponds: Vec<Point> = ponds.iter().map(|&(x, y)| Point::new(x, y)).collect();
        Farm::new(variant, &Problem::research(Point::new(depot.0, depot.1), &ponds, num_drones).unwrap())
    }

    fn rows(view: &View) -> Vec<Vec<f32>> {
        view.ponds.rows().into_iter().map(|row| row.to_vec()).collect()
    }

    #[test]
    fn cvrp_takes_a_farm_in_the_unit_square_as_it_is() {
        let view = farm(Variant::Cvrp, (0.0, 1.0), &[(0.25, 0.5), (0.5, 0.25)], 1).view(Symmetry::NONE);
        assert_eq!(view.depot.to_vec(), [0.0, 1.0]);
        assert_eq!(rows(&view), [[0.25, 0.5, 1.0 / 3.0], [0.5, 0.25, 1.0 / 3.0]]);
    }

    #[test]
    fn cvrp_scales_any_other_farm_into_the_middle_of_the_unit_square() {
        let view = farm(Variant::Cvrp, (10.0, 0.0), &[(14.0, 2.0), (12.0, 1.0)], 2).view(Symmetry::NONE);
        assert_eq!(view.depot.to_vec(), [0.0, 0.25]);
        assert_eq!(rows(&view), [[1.0, 0.75, 0.5], [0.5, 0.5, 0.5]]);
        let view = farm(Variant::Cvrp, (-3.0, -3.0), &[(-3.0, -3.0)], 2).view(Symmetry::NONE);
        assert_eq!((view.depot.to_vec(), rows(&view)), (vec![0.5, 0.5], vec![vec![0.5, 0.5, 1.0]]));
    }

    #[test]
    fn minmax_measures_from_the_depot_in_units_of_the_farthest_pond() {
        let view = farm(Variant::MinMax, (1.0, 1.0), &[(1.0, 9.0), (1.0, 5.0), (-2.0, 1.0)], 2).view(Symmetry::NONE);
        assert_eq!(view.depot.to_vec(), [0.0, 0.0, 0.0, 13.0 / 24.0]);
        assert_eq!(rows(&view), [[0.0, 1.0, 1.0, 0.5], [0.0, 0.5, 0.5, 0.5], [-0.375, 0.0, 0.375, 0.625]]);
        assert_eq!(view.spacing, 13.0 / 24.0);
    }

    #[test]
    fn minmax_of_a_farm_without_spacing_or_extent() {
        let alone = farm(Variant::MinMax, (0.0, 0.0), &[(0.0, 2.0)], 2).view(Symmetry::NONE);
        assert_eq!((rows(&alone), alone.spacing), (vec![vec![0.0, 1.0, 1.0, 1.0]], 1.0));
        let heap = farm(Variant::MinMax, (3.0, 3.0), &[(3.0, 3.0); 2], 2).view(Symmetry::NONE);
        assert_eq!((rows(&heap), heap.spacing), (vec![vec![0.0; 4]; 2], 1.0));
    }

    #[test]
    fn the_eight_symmetries_lay_a_square_on_itself() {
        for centre in [0.0, 0.5] {
            let mut images: Vec<(f64, f64)> = Symmetry::all()
                .map(|symmetry| symmetry.image(Point::new(centre + 0.25, centre + 0.125), centre))
                .map(|image| (image.x - centre, image.y - centre))
                .collect();
            images.sort_by(|a, b| a.partial_cmp(b).unwrap());
            let all = [-0.25, -0.125, 0.125, 0.25].into_iter().flat_map(|x: f64| {
                let y = 0.375 - x.abs();
                [(x, -y), (x, y)]
            });
            assert_eq!(images, all.collect::<Vec<_>>());
        }
    }
}
