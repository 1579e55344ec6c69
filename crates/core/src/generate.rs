//! Research farms: ponds on a grid inside a random outline, as the paper's data set has them.
//!
//! Source: Davis, Mukherjee, Wills and Ouyang, "Path Planning Algorithms for Robotic Aquaculture Monitoring", section 3
//! (the text), and the authors' published MATLAB code (what made their instances). The two differ; [`Variant`] offers
//! both. Only correctly rounded operations and [`Random`] are used, so a seed gives the same farm on every machine.
//! O(n log n) for n ponds.
//!
//! A union of three triangles may enclose a hole (one farm in fifteen has one, in the authors' data too): its area does not
//! count and it holds no pond, but the outline that goes with the farm is the outer ring alone, as in the authors' data.

use crate::error::{Faults, InvalidInput};
use crate::geometry::{Point, convex_hull, convex_intersection, cross, signed_area};
use crate::random::Random;

/// How the outline is drawn and how many grid points are deleted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Variant {
    /// As the authors' code does it: the union of three random triangles (its convex hull if it is in several pieces), and
    /// a grid of pitch 0.8 √(area / n), of which about 36 % is deleted.
    #[default]
    Authors,
    /// As the paper describes it: a random convex polygon, and a grid of pitch √(0.8 area / n), of which about 20 % is
    /// deleted. The polygon is the hull of nine uniform points.
    Paper,
}

/// A farm of the unit square.
#[derive(Clone, Debug, PartialEq)]
pub struct ResearchFarm {
    /// Uniform in the bounding box of the outline; often outside the outline itself.
    pub depot: Point,
    /// Grid points inside the farm, in ascending order of x, then y.
    pub ponds: Vec<Point>,
    /// The outline without holes: a simple polygon, counter-clockwise, closed (the last point is the first).
    pub boundary: Vec<Point>,
    /// Pitch of the grid, whose lines lie at whole multiples of it.
    pub spacing: f64,
}

/// Far beyond any farm, and far below what exhausts the memory.
const MAX_PONDS: usize = 10_000_000;

/// Draws a farm with `num_ponds` ponds. The farm depends on the number of ponds, the variant and the seed only.
///
/// # Errors
/// [`InvalidInput`] if no pond is asked for, or more than 10 million.
pub fn generate(num_ponds: usize, variant: Variant, seed: u64) -> Result<ResearchFarm, InvalidInput> {
    let mut faults = Faults::default();
    if !(1..=MAX_PONDS).contains(&num_ponds) {
        let message = format!("{num_ponds} ponds cannot be drawn");
        faults.add("num_ponds", message, &format!("ask for 1 to {MAX_PONDS} ponds"));
    }
    faults.into_result(())?;
    let mut random = Random::new(seed);
    loop {
        if let Some(farm) = draw(num_ponds, variant, &mut random) {
            return Ok(farm);
        }
    }
}

/// One attempt, or `None` if the grid has too few points inside the farm: then the authors draw again.
fn draw(num_ponds: usize, variant: Variant, random: &mut Random) -> Option<ResearchFarm> {
    let land = match variant {
        Variant::Authors => {
            let triangles: [Triangle; 3] = std::array::from_fn(|_| {
                let [a, b, c] = std::array::from_fn(|_| uniform_point(random));
                if cross(a, b, c) > 0.0 { [a, b, c] } else { [a, c, b] }
            });
            Land::of_triangles(&triangles)?
        }
        Variant::Paper => {
            let cloud: [Point; 9] = std::array::from_fn(|_| uniform_point(random));
            Land::convex(hull(&cloud))
        }
    };
    let depot = uniform_point_in_bounding_box(&land.outline, random);
    let area_per_pond = land.area / num_ponds as f64;
    let spacing = match variant {
        Variant::Authors => 0.8 * area_per_pond.sqrt(),
        Variant::Paper => (0.8 * area_per_pond).sqrt(),
    };
    let grid = land.grid_points(spacing);
    if grid.len() < num_ponds {
        return None;
    }
    let ponds = keep_at_random(&grid, num_ponds, random);
    let boundary = land.outline.iter().chain(land.outline.first()).copied().collect();
    Some(ResearchFarm { depot, ponds, boundary, spacing })
}

fn uniform_point(random: &mut Random) -> Point {
    let x = random.uniform();
    Point::new(x, random.uniform())
}

fn uniform_point_in_bounding_box(outline: &[Point], random: &mut Random) -> Point {
    let infinity = Point::new(f64::INFINITY, f64::INFINITY);
    let low = outline.iter().fold(infinity, |low, corner| Point::new(low.x.min(corner.x), low.y.min(corner.y)));
    let high =
        outline.iter().fold(Point::default(), |high, corner| Point::new(high.x.max(corner.x), high.y.max(corner.y)));
    let share = uniform_point(random);
    Point::new(low.x + share.x * (high.x - low.x), low.y + share.y * (high.y - low.y))
}

fn hull(points: &[Point]) -> Vec<Point> {
    convex_hull(points).into_iter().map(|corner| points[corner]).collect()
}

/// Where ponds may lie.
struct Land {
    /// Convex polygons, counter-clockwise, whose union is the land.
    pieces: Vec<Vec<Point>>,
    /// Area of the union.
    area: f64,
    /// Outer ring of the union, counter-clockwise.
    outline: Vec<Point>,
}

impl Land {
    fn convex(polygon: Vec<Point>) -> Self {
        Self { area: signed_area(&polygon), outline: polygon.clone(), pieces: vec![polygon] }
    }

    /// The union of three triangles, or their convex hull where they are not connected. `None` where rounding keeps the
    /// outline from closing.
    fn of_triangles(triangles: &[Triangle; 3]) -> Option<Self> {
        let [first, second, third] = triangles;
        let first_and_second = convex_intersection(first, second);
        let shared_by_two = [
            signed_area(&first_and_second),
            signed_area(&convex_intersection(first, third)),
            signed_area(&convex_intersection(second, third)),
        ];
        // Any two pairs of three triangles have a triangle in common.
        if shared_by_two.iter().filter(|&&area| area > 0.0).count() < 2 {
            return Some(Self::convex(hull(triangles.as_flattened())));
        }
        // Inclusion and exclusion.
        let areas: f64 = triangles.iter().map(|triangle| signed_area(triangle)).sum();
        let shared_by_three = signed_area(&convex_intersection(&first_and_second, third));
        let area = areas - shared_by_two.iter().sum::<f64>() + shared_by_three;
        let outline = outer_outline(triangles)?;
        Some(Self { pieces: triangles.iter().map(|triangle| triangle.to_vec()).collect(), area, outline })
    }

    /// The points at whole multiples of `spacing` inside, in ascending order of x, then y.
    fn grid_points(&self, spacing: f64) -> Vec<Point> {
        let multiples = |from: f64, to: f64| {
            let first = (from / spacing).ceil() as u64;
            (first..).map(move |multiple| multiple as f64 * spacing).take_while(move |&value| value < to)
        };
        let left = self.outline.iter().map(|corner| corner.x).fold(f64::INFINITY, f64::min);
        let right = self.outline.iter().map(|corner| corner.x).fold(0.0, f64::max);
        let mut inside = Vec::new();
        for x in multiples(left, right) {
            let mut intervals: Vec<(f64, f64)> = self.pieces.iter().filter_map(|piece| column(piece, x)).collect();
            intervals.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut covered_to = 0.0f64;
            for (low, high) in intervals {
                inside.extend(multiples(low.max(covered_to), high).map(|y| Point::new(x, y)));
                covered_to = covered_to.max(high);
            }
        }
        inside
    }
}

/// Where the vertical line at `x` enters and leaves a convex polygon.
fn column(polygon: &[Point], x: f64) -> Option<(f64, f64)> {
    let mut crossings = (0..polygon.len())
        .map(|corner| (polygon[corner], polygon[(corner + 1) % polygon.len()]))
        .filter(|(from, to)| (from.x <= x) != (to.x <= x))
        .map(|(from, to)| from.y + (x - from.x) / (to.x - from.x) * (to.y - from.y));
    let (one, other) = (crossings.next()?, crossings.next()?);
    Some((one.min(other), one.max(other)))
}

/// Three corners, counter-clockwise.
type Triangle = [Point; 3];

fn edges(triangle: &Triangle) -> [(Point, Point); 3] {
    let [a, b, c] = *triangle;
    [(a, b), (b, c), (c, a)]
}

/// Follows the outline of connected triangles, counter-clockwise from the leftmost corner: along an edge until the edge of
/// another triangle leads to the right of it, then along that one.
fn outer_outline(triangles: &[Triangle; 3]) -> Option<Vec<Point>> {
    let all_edges: Vec<(Point, Point)> = triangles.iter().flat_map(edges).collect();
    let start = (0..all_edges.len()).min_by(|&a, &b| all_edges[a].0.x.total_cmp(&all_edges[b].0.x))?;
    let mut outline = vec![all_edges[start].0];
    let (mut edge, mut share) = (start, 0.0);
    // Three triangles have nine edges and at most 18 crossings, and no corner or crossing is passed twice.
    for _ in 0..9 + 18 {
        let crossing = (0..all_edges.len())
            .filter_map(|other| {
                let (along, along_other) = crossing_to_the_right(all_edges[edge], all_edges[other])?;
                (along > share).then_some((along, other, along_other))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let (from, to) = all_edges[edge];
        if let Some((along, other, along_other)) = crossing {
            outline.push(Point::new(from.x + along * (to.x - from.x), from.y + along * (to.y - from.y)));
            (edge, share) = (other, along_other);
        } else {
            // The edges of a triangle follow one another in the list.
            (edge, share) = (edge - edge % 3 + (edge + 1) % 3, 0.0);
            if edge == start {
                return Some(outline);
            }
            outline.push(to);
        }
    }
    None
}

/// Where the second edge crosses the first towards its right: the share of each edge before the crossing.
fn crossing_to_the_right(first: (Point, Point), second: (Point, Point)) -> Option<(f64, f64)> {
    let (along_x, along_y) = (first.1.x - first.0.x, first.1.y - first.0.y);
    let (other_x, other_y) = (second.1.x - second.0.x, second.1.y - second.0.y);
    let turn = along_x * other_y - along_y * other_x;
    if turn >= 0.0 {
        return None;
    }
    let (gap_x, gap_y) = (second.0.x - first.0.x, second.0.y - first.0.y);
    let along = (gap_x * other_y - gap_y * other_x) / turn;
    let along_other = (gap_x * along_y - gap_y * along_x) / turn;
    let is_inside = |share: f64| share > 0.0 && share < 1.0;
    (is_inside(along) && is_inside(along_other)).then_some((along, along_other))
}

/// `num_kept` of the points in their order, every choice equally likely (Knuth, The Art of Computer Programming 2,
/// section 3.4.2, algorithm S).
fn keep_at_random(points: &[Point], num_kept: usize, random: &mut Random) -> Vec<Point> {
    let mut kept = Vec::with_capacity(num_kept);
    for (index, &point) in points.iter().enumerate() {
        if random.below(points.len() - index) < num_kept - kept.len() {
            kept.push(point);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn mean_farthest_pond_bound(num_ponds: usize) -> f64 {
        let bound = |seed| {
            let farm = generate(num_ponds, Variant::Authors, seed).unwrap();
            farm.ponds.iter().map(|&pond| 2.0 * farm.depot.distance(pond)).fold(0.0, f64::max)
        };
        (0..1000).map(bound).sum::<f64>() / 1000.0
    }

    #[test]
    fn farms_are_like_those_of_the_authors() {
        // Means of 100 of their farms per size; one farm deviates by 0.29, so the difference to ours by 0.03.
        for (num_ponds, theirs) in [(50, 1.376), (100, 1.450), (200, 1.453), (300, 1.492), (500, 1.504), (700, 1.492)] {
            let ours = mean_farthest_pond_bound(num_ponds);
            assert!((ours - theirs).abs() < 3.0 * 0.03, "{num_ponds} ponds: {ours}, theirs {theirs}");
        }
    }

    #[test]
    fn a_farm_has_at_least_one_pond_and_at_most_10_million() {
        for num_ponds in [0, 10_000_001, usize::MAX] {
            let error = generate(num_ponds, Variant::Authors, 1).unwrap_err();
            assert_eq!(error.faults[0].path, "num_ponds");
        }
    }

    /// A tent with its floor, which enclose a hole around (6, 3).
    const AROUND_A_HOLE: [Triangle; 3] = [
        [Point::new(-1.0, 0.5), Point::new(13.0, 0.5), Point::new(13.0, 2.0)],
        [Point::new(12.0, 0.0), Point::new(6.0, 12.0), Point::new(4.0, 12.0)],
        [Point::new(0.0, 0.0), Point::new(8.0, 12.0), Point::new(6.0, 12.0)],
    ];

    #[test]
    fn a_hole_holds_no_pond_and_counts_as_no_area() {
        let land = Land::of_triangles(&AROUND_A_HOLE).unwrap();
        let grid = land.grid_points(0.01);
        let has_point_near = |place: Point| grid.iter().any(|point| point.distance(place) < 0.05);
        assert!(has_point_near(Point::new(6.0, 0.7)) && has_point_near(Point::new(6.0, 10.0)));
        assert!(!has_point_near(Point::new(6.0, 3.0)));
        assert!((land.area - grid.len() as f64 * 1e-4).abs() < 0.05);
        assert!(signed_area(&land.outline) > 1.5 * land.area);
    }

    #[test]
    fn the_outline_of_a_triangle_across_another_and_one_inside() {
        let triangles: [Triangle; 3] = [
            [Point::new(0.0, 0.0), Point::new(8.0, 0.0), Point::new(0.0, 8.0)],
            [Point::new(-2.0, 2.0), Point::new(2.0, 2.0), Point::new(-2.0, 6.0)],
            [Point::new(1.0, 1.0), Point::new(2.0, 1.0), Point::new(1.0, 2.0)],
        ];
        let land = Land::of_triangles(&triangles).unwrap();
        let outline = [(-2.0, 2.0), (0.0, 2.0), (0.0, 0.0), (8.0, 0.0), (0.0, 8.0), (0.0, 4.0), (-2.0, 6.0)];
        assert_eq!(land.outline, outline.map(|(x, y)| Point::new(x, y)));
        assert_eq!(land.area, 32.0 + 6.0);
    }

    #[test]
    fn triangles_apart_give_their_hull() {
        let shifted = |by: f64| [Point::new(by, 0.0), Point::new(by + 1.0, 0.0), Point::new(by, 1.0)];
        let land = Land::of_triangles(&[shifted(0.0), shifted(2.0), shifted(4.0)]).unwrap();
        let hull = [(0.0, 0.0), (5.0, 0.0), (4.0, 1.0), (0.0, 1.0)];
        assert_eq!(land.outline, hull.map(|(x, y)| Point::new(x, y)));
        assert_eq!(land.area, 4.5);
    }

    #[test]
    fn the_farm_of_a_seed_is_fixed() {
        let farm = generate(5, Variant::Authors, 1).unwrap();
        assert_eq!(farm.depot, Point::new(0.9483701215214131, 0.5278751006521658));
        assert_eq!(farm.ponds[0], Point::new(0.23379008298873855, 0.23379008298873855));
        let farm = generate(4, Variant::Paper, 2).unwrap();
        assert_eq!(farm.depot, Point::new(0.4804517416501005, 0.3861925314865085));
        assert_eq!(farm.ponds[3], Point::new(0.8188433035868719, 0.6141324776901539));
    }

    proptest! {
        #[test]
        fn ponds_lie_on_the_grid_inside_the_outline(num_ponds in 1usize..300, seed: u64, is_paper: bool) {
            let variant = if is_paper { Variant::Paper } else { Variant::Authors };
            let farm = generate(num_ponds, variant, seed).unwrap();
            prop_assert_eq!(farm.ponds.len(), num_ponds);
            prop_assert_eq!(farm.boundary.first(), farm.boundary.last());
            prop_assert!(signed_area(&farm.boundary) > 0.0);
            for pond in &farm.ponds {
                let on_grid = |value: f64| (value / farm.spacing).round() * farm.spacing == value;
                prop_assert!(on_grid(pond.x) && on_grid(pond.y));
            }
            prop_assert!(farm.ponds.windows(2).all(|pair| (pair[0].x, pair[0].y) < (pair[1].x, pair[1].y)));
            prop_assert_eq!(generate(num_ponds, variant, seed).unwrap(), farm);
        }
    }
}
