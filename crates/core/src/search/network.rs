//! What the search knows about places: coordinates, leg costs, service, nearest neighbours.
//!
//! Costs are seconds ([`crate::travel::leg_duration`]); in a research instance a second is a length unit. There is no n x n
//! matrix: a leg is computed from coordinates (one square root), and the legs to the nearest neighbours are stored beside
//! them, because those are what insertions ask for.

use crate::geometry::Point;
use crate::problem::Problem;

/// Nearest neighbours kept per visit. The 8 lattice neighbours and most of the next ring; 24 did not shorten plans, and
/// slowed the steps by a quarter.
pub(crate) const NUM_NEIGHBOURS: usize = 16;

/// A nearest neighbour of a visit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Neighbour {
    /// Cost of the leg to it.
    pub leg: f64,
    /// Its node index.
    pub node: u32,
}

/// Visits `0..num_visits`, then one copy of the depot per route: `num_visits + route`.
#[derive(Debug)]
pub(crate) struct Network {
    pub num_visits: usize,
    pub num_routes: usize,
    /// Positions of all nodes.
    pub points: Vec<Point>,
    /// Time on station of all nodes; 0 for the depot copies.
    pub services: Vec<f64>,
    /// Cost of the leg from the depot to each visit.
    pub depot_legs: Vec<f64>,
    /// Longest time a drone can be under way.
    pub max_route_cost: f64,
    pace: f64,
    stop: f64,
    neighbours: Vec<Neighbour>,
    num_neighbours: usize,
}

impl Network {
    /// Without neighbour lists: O(n).
    pub fn new(problem: &Problem) -> Self {
        let vehicle_type = problem.vehicle_type();
        let (num_visits, num_routes) = (problem.num_visits(), vehicle_type.num_available.min(problem.num_visits()));
        let depot = problem.depot().position;
        let mut points: Vec<Point> = problem.visits().iter().map(|visit| visit.position).collect();
        points.resize(num_visits + num_routes, depot);
        let mut services: Vec<f64> = problem.visits().iter().map(|visit| visit.service_duration).collect();
        services.resize(num_visits + num_routes, 0.0);
        let mut network = Self {
            num_visits,
            num_routes,
            points,
            services,
            depot_legs: Vec::new(),
            max_route_cost: vehicle_type.max_duration,
            pace: 1.0 / vehicle_type.speed,
            stop: vehicle_type.leg_stop_duration,
            neighbours: Vec::new(),
            num_neighbours: 0,
        };
        network.depot_legs = (0..num_visits).map(|visit| network.leg_between(depot, network.points[visit])).collect();
        network
    }

    /// Cost of the leg between two places.
    #[inline]
    pub fn leg_between(&self, from: Point, to: Point) -> f64 {
        let length = from.distance(to);
        if length > 0.0 { length * self.pace + self.stop } else { 0.0 }
    }

    /// Cost of the leg between two nodes.
    #[inline]
    pub fn leg(&self, from: u32, to: u32) -> f64 {
        self.leg_between(self.points[from as usize], self.points[to as usize])
    }

    /// Where the depot is.
    pub fn depot(&self) -> Point {
        self.points[self.num_visits]
    }

    /// No plan has a cheaper longest route: the farthest visit must be made and left.
    pub fn farthest_visit_bound(&self) -> f64 {
        let there_and_back = self.depot_legs.iter().zip(&self.services).map(|(leg, service)| 2.0 * leg + service);
        there_and_back.fold(0.0, f64::max)
    }

    /// Cost of a route: legs and service.
    pub fn route_cost(&self, visits: &[u32]) -> f64 {
        let (Some(&first), Some(&last)) = (visits.first(), visits.last()) else { return 0.0 };
        let legs: f64 = visits.windows(2).map(|pair| self.leg(pair[0], pair[1])).sum();
        let services: f64 = visits.iter().map(|&visit| self.services[visit as usize]).sum();
        self.depot_legs[first as usize] + legs + services + self.depot_legs[last as usize]
    }

    /// The nearest neighbours of a visit, nearest first. Empty before [`Network::find_neighbours`].
    #[inline]
    pub fn neighbours(&self, visit: u32) -> &[Neighbour] {
        let start = visit as usize * self.num_neighbours;
        &self.neighbours[start..start + self.num_neighbours]
    }

    /// Fills the neighbour lists from a grid of about two visits a cell: O(n k) for visits spread evenly.
    ///
    /// On a lattice most distances are tied. Ties are broken by index, which is harmless because
    /// [`NUM_NEIGHBOURS`] reaches beyond the ring of eight.
    pub fn find_neighbours(&mut self) {
        self.num_neighbours = NUM_NEIGHBOURS.min(self.num_visits - 1);
        if self.num_neighbours == 0 {
            return;
        }
        let grid = Grid::new(&self.points[..self.num_visits]);
        let mut found: Vec<(f64, u32)> = Vec::new();
        self.neighbours = Vec::with_capacity(self.num_visits * self.num_neighbours);
        for visit in 0..self.num_visits {
            grid.nearest(visit, self.num_neighbours, &mut found);
            for &(_, node) in &found {
                let leg = self.leg(visit as u32, node);
                self.neighbours.push(Neighbour { leg, node });
            }
        }
    }
}

/// Buckets of points on a square grid.
struct Grid<'a> {
    points: &'a [Point],
    low: Point,
    cell: f64,
    num_columns: usize,
    num_rows: usize,
    starts: Vec<u32>,
    members: Vec<u32>,
}

impl<'a> Grid<'a> {
    fn new(points: &'a [Point]) -> Self {
        let (mut low, mut high) = (points[0], points[0]);
        for point in points {
            low = Point::new(low.x.min(point.x), low.y.min(point.y));
            high = Point::new(high.x.max(point.x), high.y.max(point.y));
        }
        let (width, height) = (high.x - low.x, high.y - low.y);
        // Ponds in one line have no area; the longer side alone then bounds the number of cells.
        let area_cell = (2.0 * width * height / points.len() as f64).sqrt();
        let line_cell = 2.0 * width.max(height) / points.len() as f64;
        let cell = area_cell.max(line_cell).max(f64::MIN_POSITIVE);
        let (num_columns, num_rows) = ((width / cell) as usize + 1, (height / cell) as usize + 1);
        let mut grid = Self {
            points,
            low,
            cell,
            num_columns,
            num_rows,
            starts: vec![0; num_columns * num_rows + 1],
            members: vec![],
        };
        let cells: Vec<u32> = points.iter().map(|&point| grid.cell_of(point)).collect();
        for &cell in &cells {
            grid.starts[cell as usize + 1] += 1;
        }
        for cell in 0..num_columns * num_rows {
            grid.starts[cell + 1] += grid.starts[cell];
        }
        let mut next = grid.starts.clone();
        grid.members = vec![0; points.len()];
        for (index, &cell) in cells.iter().enumerate() {
            grid.members[next[cell as usize] as usize] = index as u32;
            next[cell as usize] += 1;
        }
        grid
    }

    fn column_and_row(&self, point: Point) -> (usize, usize) {
        let column = ((point.x - self.low.x) / self.cell) as usize;
        let row = ((point.y - self.low.y) / self.cell) as usize;
        (column.min(self.num_columns - 1), row.min(self.num_rows - 1))
    }

    fn cell_of(&self, point: Point) -> u32 {
        let (column, row) = self.column_and_row(point);
        (row * self.num_columns + column) as u32
    }

    /// The `count` points nearest to point `index`, without itself, as (squared distance, index), nearest first.
    fn nearest(&self, index: usize, count: usize, found: &mut Vec<(f64, u32)>) {
        let centre = self.points[index];
        let (column, row) = self.column_and_row(centre);
        found.clear();
        let mut ring = 0;
        loop {
            self.collect_ring(column, row, ring, index, found);
            let is_complete = ring >= self.num_columns.max(self.num_rows);
            if found.len() >= count || is_complete {
                // What lies within the rings so far is complete only up to the distance to their border.
                let reach = self.reach(centre, column, row, ring);
                if found.len() > count {
                    found.select_nth_unstable_by(count, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                }
                let farthest = found[..count.min(found.len())].iter().map(|entry| entry.0).fold(0.0, f64::max);
                if is_complete || (found.len() >= count && farthest <= reach * reach) {
                    break;
                }
            }
            ring += 1;
        }
        found.truncate(count);
        found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    }

    /// Distance from `centre` to the border of the rings around its cell.
    fn reach(&self, centre: Point, column: usize, row: usize, ring: usize) -> f64 {
        let (x, y) = (centre.x - self.low.x, centre.y - self.low.y);
        let (column, row, ring) = (column as f64, row as f64, ring as f64);
        let left = x - (column - ring) * self.cell;
        let right = (column + ring + 1.0) * self.cell - x;
        let below = y - (row - ring) * self.cell;
        let above = (row + ring + 1.0) * self.cell - y;
        left.min(right).min(below).min(above)
    }

    fn collect_ring(&self, column: usize, row: usize, ring: usize, index: usize, found: &mut Vec<(f64, u32)>) {
        let first_row = row.saturating_sub(ring);
        let last_row = (row + ring).min(self.num_rows - 1);
        for cell_row in first_row..=last_row {
            let is_edge_row = cell_row + ring == row || cell_row == row + ring;
            if is_edge_row {
                let (first, last) = (column.saturating_sub(ring), (column + ring).min(self.num_columns - 1));
                self.collect_cells(cell_row, first, last, index, found);
            } else {
                if column >= ring {
                    self.collect_cells(cell_row, column - ring, column - ring, index, found);
                }
                if column + ring < self.num_columns {
                    self.collect_cells(cell_row, column + ring, column + ring, index, found);
                }
            }
        }
    }

    /// Cells of one row are neighbours in memory: one pass over their members.
    fn collect_cells(&self, row: usize, first: usize, last: usize, index: usize, found: &mut Vec<(f64, u32)>) {
        let base = row * self.num_columns;
        let (start, end) = (self.starts[base + first] as usize, self.starts[base + last + 1] as usize);
        let centre = self.points[index];
        for &member in &self.members[start..end] {
            if member as usize != index {
                let point = self.points[member as usize];
                let (dx, dy) = (point.x - centre.x, point.y - centre.y);
                found.push((dx * dx + dy * dy, member));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn assert_nearest(points: &[Point]) {
        let problem = Problem::research(Point::new(0.0, 0.0), points, 2).unwrap();
        let mut network = Network::new(&problem);
        network.find_neighbours();
        for visit in 0..points.len() {
            let mut legs: Vec<f64> = (0..points.len())
                .filter(|&other| other != visit)
                .map(|other| points[visit].distance(points[other]))
                .collect();
            legs.sort_by(f64::total_cmp);
            let found: Vec<f64> = network.neighbours(visit as u32).iter().map(|neighbour| neighbour.leg).collect();
            assert_eq!(found, legs[..NUM_NEIGHBOURS.min(points.len() - 1)]);
        }
    }

    proptest! {
        #[test]
        fn neighbours_are_the_nearest(coordinates in prop::collection::vec((-5.0..5.0f64, 0.0..1.0f64), 1..120)) {
            assert_nearest(&coordinates.iter().map(|&(x, y)| Point::new(x, y)).collect::<Vec<_>>());
        }

        #[test]
        fn neighbours_of_coinciding_and_aligned_ponds(columns in prop::collection::vec(0..9u8, 2..80)) {
            assert_nearest(&columns.iter().map(|&x| Point::new(f64::from(x), 3.0)).collect::<Vec<_>>());
        }
    }
}
