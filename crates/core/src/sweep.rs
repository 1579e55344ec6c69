//! Back-and-forth coverage of a convex polygon: in which directions to sweep, and the path of a sweep.
//!
//! Problem: cover a convex polygon by parallel lines with little time lost in turns. Source: Vasquez-Gomez,
//! Marciano-Melchor, Valentin and Herrera-Lozada, Coverage path planning for 2D convex regions, J. Intell. Robot. Syst. 2020
//! (doi 10.1007/s10846-019-01024-y): the lines of a best path run along an edge of the polygon, which rotating calipers
//! find (Shamos, Computational Geometry, PhD thesis, Yale 1978).
//! Complexity: O(h) for all pairs of a polygon of h corners, O(h + l) for a path of l lines.
//! Changed: where the authors' code compares numbers that differ only by rounding, a [`Tolerance`] says what is equal;
//! [`Tolerance::EXACT`] is their arithmetic to the last bit.

use crate::geometry::Point;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// What counts as equal where a construction asks whether two lengths or two angles are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// In units of the coordinates.
    pub length: f64,
    /// In radians.
    pub angle: f64,
}

impl Tolerance {
    /// Nothing but the same number: rounding decides.
    pub const EXACT: Self = Self { length: 0.0, angle: 0.0 };

    /// 1e-9 of `side`, and 1e-9 rad: far above rounding, far below what a survey can tell.
    #[must_use]
    pub fn of_side(side: f64) -> Self {
        Self { length: 1e-9 * side, angle: 1e-9 }
    }
}

/// The direction of a vector in (-π, π], counter-clockwise from east; 0 for the zero vector.
///
/// Directions within the tolerance of east and west are exactly 0 and π, on whose side of the axis they may lie.
fn heading(vector: Point, tolerance: Tolerance) -> f64 {
    let angle = vector.y.atan2(vector.x);
    if angle.abs() < tolerance.angle {
        0.0
    } else if angle < tolerance.angle - PI {
        PI
    } else {
        angle
    }
}

/// The clockwise angle from heading `from` to heading `to` as the authors' code has it: between two headings of the
/// upper half plane that lie counter-clockwise it is 2π plus, not minus, their difference.
fn clockwise_angle(from: f64, to: f64) -> f64 {
    match (from < 0.0, to < 0.0) {
        (true, true) if from < to => TAU + (from - to),
        (true, false) => TAU + from - to,
        (false, false) if from < to => TAU - (from - to),
        _ => from - to,
    }
}

/// A convex polygon as the rows that the paper's planner works on: the corners counter-clockwise, the first repeated at
/// the end, with the heading of the edge that leaves each row.
///
/// The last row's edge leads from the last corner to the first, which are the same: it has no length and heads east.
#[derive(Clone, Debug)]
pub struct ClosedPolygon {
    rows: Vec<Point>,
    headings: Vec<f64>,
    tolerance: Tolerance,
}

impl ClosedPolygon {
    /// The polygon of at least one corner; `corners` come counter-clockwise and without the repetition of the first.
    #[must_use]
    pub fn new(corners: &[Point], tolerance: Tolerance) -> Self {
        let mut rows = Vec::with_capacity(corners.len() + 1);
        rows.extend(corners.iter().chain(corners.first()));
        let mut headings = Vec::with_capacity(rows.len());
        headings.extend(rows.windows(2).map(|edge| heading(edge[1] - edge[0], tolerance)));
        headings.push(0.0);
        Self { rows, headings, tolerance }
    }

    fn angle(&self, from: usize, to: usize) -> f64 {
        clockwise_angle(self.headings[from], self.headings[to])
    }

    fn previous(&self, row: usize) -> usize {
        row.checked_sub(1).unwrap_or(self.rows.len() - 1)
    }

    fn next(&self, row: usize) -> usize {
        (row + 1) % self.rows.len()
    }

    /// The pairs of rows for which the paper's planner looks for a sweep direction; at least one.
    ///
    /// Rotating calipers (Shamos, Computational Geometry, PhD thesis, Yale 1978) in the form of Vasquez-Gomez et al.,
    /// O(rows). Quirk kept: that routine is written for an open clockwise polygon and gets a closed counter-clockwise
    /// one, so that most of the pairs are neighbours and few are antipodal.
    #[must_use]
    pub fn caliper_pairs(&self) -> Vec<(usize, usize)> {
        let num_rows = self.rows.len();
        let last = num_rows - 1;
        let (mut i, mut j) = (0, 1);
        while self.angle(last, j) < PI - self.tolerance.angle {
            j = self.next(j);
        }
        let mut pairs = Vec::with_capacity(2 * num_rows);
        pairs.push((i, j));
        while j < num_rows {
            let missing = PI - self.angle(i, j);
            if missing > self.tolerance.angle {
                j += 1;
            } else if missing < -self.tolerance.angle {
                i += 1;
            } else {
                if i + 1 < j {
                    pairs.push((i + 1, j));
                }
                if j < last {
                    pairs.push((i, j + 1));
                }
                i += 1;
                j += 1;
            }
            if j < num_rows && i < j {
                pairs.push((i, j));
            }
        }
        pairs
    }

    /// The sweep that the paper's planner tries for a pair of rows: along the edge after one of the two, or along an edge
    /// before, whichever leaves less width to sweep (Vasquez-Gomez et al.: the best path for an antipodal pair).
    #[must_use]
    pub fn sweep_of_pair(&self, (i, j): (usize, usize)) -> Sweep {
        let (after, opposite) = if self.angle(i, j) - PI < -self.tolerance.angle { (j, i) } else { (i, j) };
        let phi = self.angle(after, opposite) - PI;
        let turn = self.angle(self.previous(after), after);
        let opposite_turn = self.angle(self.previous(opposite), opposite) - phi;
        let (before, support) = if turn < opposite_turn - self.tolerance.angle {
            (self.previous(after), opposite)
        } else {
            (self.previous(opposite), after)
        };
        // The width over an edge of no length is not a number: the comparison is false, and the edge before is taken.
        let is_narrower = self.width(after, opposite) < self.width(before, support) - self.tolerance.length;
        Sweep { row: if is_narrower { after } else { before }, starts_up: is_narrower }
    }

    /// Distance of a row from the line through the edge after another row.
    fn width(&self, edge: usize, row: usize) -> f64 {
        let (from, to, point) = (self.rows[edge], self.rows[self.next(edge)], self.rows[row]);
        let along = to - from;
        (along.y * point.x - along.x * point.y + to.x * from.y - from.x * to.y).abs()
            / (along.y * along.y + along.x * along.x).sqrt()
    }

    /// The frame in which the edge of `sweep` points up.
    #[must_use]
    pub fn frame(&self, sweep: Sweep) -> Frame {
        let along = self.rows[self.next(sweep.row)] - self.rows[sweep.row];
        // Down the reversed edge is up the edge, but for the edge of no length.
        let angle = if sweep.starts_up {
            FRAC_PI_2 - along.y.atan2(along.x)
        } else {
            -FRAC_PI_2 - (0.0 - along.y).atan2(0.0 - along.x)
        };
        Frame { cosine: angle.cos(), sine: angle.sin() }
    }
}

/// A way to sweep a polygon: along which edge, and whether the first line is flown with the edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sweep {
    /// The row whose outgoing edge the lines are parallel to.
    pub row: usize,
    /// Whether the first line is flown in the direction of the edge.
    pub starts_up: bool,
}

/// A frame rotated about the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    cosine: f64,
    sine: f64,
}

impl Frame {
    /// The frame that is not rotated.
    pub const UNTURNED: Self = Self { cosine: 1.0, sine: 0.0 };

    /// The coordinates of `point` in this frame.
    #[must_use]
    pub fn enter(self, point: Point) -> Point {
        Point::new(self.cosine * point.x - self.sine * point.y, self.sine * point.x + self.cosine * point.y)
    }

    /// The point whose coordinates in this frame are `local`.
    #[must_use]
    pub fn leave(self, local: Point) -> Point {
        Point::new(self.cosine * local.x + self.sine * local.y, self.cosine * local.y - self.sine * local.x)
    }
}

/// Most lines of one sweep. A cluster has about as many as the root of its ponds; more would mean that the pitch says
/// nothing about it (pairs of ponds a step apart, kilometres from each other), and the lines are drawn apart.
const MAX_NUM_LINES: f64 = 4096.0;

/// What the paths over one polygon have in common, with room for the edges so that no path allocates its own.
#[derive(Clone, Debug)]
pub struct Sweeper {
    pitch: f64,
    tolerance: Tolerance,
    sides: Sides,
}

impl Sweeper {
    /// Lines `pitch` apart over a polygon of `num_corners`, with what counts as equal on them.
    #[must_use]
    pub fn new(num_corners: usize, pitch: f64, tolerance: Tolerance) -> Self {
        Self { pitch, tolerance, sides: Sides { height: 0.0, edges: Vec::with_capacity(num_corners), passed: (0, 0) } }
    }

    /// Writes the corners of the back-and-forth path over a convex polygon into `path`: two per line, joined by right angles.
    ///
    /// `corners` are those of the polygon, counter-clockwise, in the frame of the sweep, whose lines are vertical: the first at
    /// the left end, then one every pitch while it is less than half a pitch beyond the right end; a line that misses the
    /// polygon takes the chord half a pitch before it. Of two ends that follow each other, the one that lies inside is pulled to
    /// the other's height (Vasquez-Gomez et al.). A side within the tolerance of a line is part of it; with
    /// [`Tolerance::EXACT`], rounding decides whether it is. O(corners + lines).
    pub fn path(&mut self, corners: &[Point], starts_up: bool, path: &mut Vec<Point>) {
        path.clear();
        let Some(&first) = corners.first() else { return };
        let (mut low, mut high) = (first, first);
        for corner in corners {
            low = Point::new(low.x.min(corner.x), low.y.min(corner.y));
            high = Point::new(high.x.max(corner.x), high.y.max(corner.y));
        }
        let (left, right, bottom, top) = (low.x, high.x, low.y, high.y);
        let pitch = self.pitch.max((right - left) / MAX_NUM_LINES);
        let height = (top + 1.0) - (bottom - 1.0);
        let tolerance = self.tolerance;
        let sides = &mut self.sides;
        sides.reset(corners, height, tolerance);
        let mut is_up = starts_up;
        let mut x = left;
        while x < right + pitch / 2.0 - tolerance.length {
            let passed = sides.passed;
            let mut line = sides.chord(x);
            if line.num_ends == 0 {
                sides.passed = passed;
                line = sides.chord(x - pitch / 2.0);
                line.low.x += pitch / 2.0;
                line.high.x += pitch / 2.0;
            } else if line.num_ends == 1 {
                path.push(line.low);
            }
            if line.num_ends > 1 {
                let (mut enter, exit) = if is_up { (line.low, line.high) } else { (line.high, line.low) };
                if let Some(last) = path.last_mut() {
                    let is_last_inside = if is_up { enter.y < last.y } else { enter.y > last.y };
                    if is_last_inside {
                        last.y = enter.y;
                    } else {
                        enter.y = last.y;
                    }
                }
                path.push(enter);
                path.push(exit);
                is_up = !is_up;
            }
            x += pitch;
        }
    }
}

/// An edge of a polygon that vertical lines may meet.
///
/// The place on it is reckoned as the cut of two segments, the line being as high as the polygon and one unit more at both
/// ends: as the authors do to the last bit, which decides where [`Tolerance::EXACT`] is asked for.
#[derive(Clone, Debug)]
struct Edge {
    from: Point,
    rise: Point,
    /// Between these it may be met; what rounding adds is left to the exact test.
    left: f64,
    right: f64,
    /// The height of the line times the width of the edge, and times the tolerance.
    whole: f64,
    margin: f64,
}

impl Edge {
    /// Where the line at `x` meets the edge.
    fn at(&self, x: f64, height: f64) -> Option<Point> {
        let part = height * if self.rise.x > 0.0 { x - self.from.x } else { self.from.x - x };
        if part < -self.margin || part > self.whole + self.margin {
            return None;
        }
        let share = part.clamp(0.0, self.whole) / self.whole;
        Some(Point::new(self.from.x + self.rise.x * share, self.from.y + self.rise.y * share))
    }
}

/// The edges of a convex polygon counter-clockwise from its leftmost corner, without the vertical ones: those below it from
/// left to right, then those above it from right to left.
#[derive(Clone, Debug)]
struct Sides {
    height: f64,
    edges: Vec<Edge>,
    /// How many of the first and of the last edges lie to the left of the last line.
    passed: (usize, usize),
}

impl Sides {
    /// Takes the polygon of these corners, which come counter-clockwise.
    fn reset(&mut self, corners: &[Point], height: f64, tolerance: Tolerance) {
        let reach = tolerance.length + 1e-12 * height;
        let margin = height * tolerance.length;
        let mut leftmost = 0;
        for (place, corner) in corners.iter().enumerate() {
            leftmost = if corner.x < corners[leftmost].x { place } else { leftmost };
        }
        let (end, start) = corners.split_at(leftmost);
        let from = start.iter().chain(end);
        let to = from.clone().skip(1).chain(start.first());
        let edge = |(&from, &to): (&Point, &Point)| {
            let rise = to - from;
            let (left, right) = (from.x.min(to.x) - reach, from.x.max(to.x) + reach);
            Edge { from, rise, left, right, whole: height * rise.x.abs(), margin }
        };
        self.edges.clear();
        self.edges.extend(from.zip(to).map(edge).filter(|edge| edge.whole > margin));
        self.height = height;
        self.passed = (0, 0);
    }

    /// Where the line at `x` meets the polygon; `x` is not left of the lines before.
    fn chord(&mut self, x: f64) -> Chord {
        let mut chord = Chord { num_ends: 0, low: Point::default(), high: Point::default() };
        let (below, above) = (self.edges.iter(), self.edges.iter().rev());
        self.passed.0 += below.clone().skip(self.passed.0).take_while(|edge| edge.right < x).count();
        self.passed.1 += above.clone().skip(self.passed.1).take_while(|edge| edge.right < x).count();
        let is_met = |edge: &&Edge| edge.left <= x;
        for edge in below.skip(self.passed.0).take_while(|edge| edge.rise.x > 0.0).take_while(is_met) {
            chord.add(edge.at(x, self.height));
        }
        for edge in above.skip(self.passed.1).take_while(|edge| edge.rise.x < 0.0).take_while(is_met) {
            chord.add(edge.at(x, self.height));
        }
        chord
    }
}

/// Where a vertical line meets a convex polygon.
struct Chord {
    /// How many edges it meets.
    num_ends: usize,
    low: Point,
    high: Point,
}

impl Chord {
    fn add(&mut self, end: Option<Point>) {
        let Some(end) = end else { return };
        if self.num_ends == 0 || end.y < self.low.y {
            self.low = end;
        }
        if self.num_ends == 0 || end.y >= self.high.y {
            self.high = end;
        }
        self.num_ends += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 4 wide and 3 high, from the lower left corner.
    const RECTANGLE: [Point; 4] =
        [Point::new(0.0, 0.0), Point::new(4.0, 0.0), Point::new(4.0, 3.0), Point::new(0.0, 3.0)];

    fn tolerance() -> Tolerance {
        Tolerance::of_side(10.0)
    }

    fn path(corners: &[Point], pitch: f64, starts_up: bool) -> Vec<(f64, f64)> {
        let mut path = Vec::new();
        Sweeper::new(corners.len(), pitch, tolerance()).path(corners, starts_up, &mut path);
        path.into_iter().map(|corner| (corner.x, corner.y)).collect()
    }

    #[test]
    fn a_rectangle_is_swept_from_side_to_side() {
        let up = [(0.0, 0.0), (0.0, 3.0), (2.0, 3.0), (2.0, 0.0), (4.0, 0.0), (4.0, 3.0)];
        assert_eq!(path(&RECTANGLE, 2.0, true), up);
        assert_eq!(path(&RECTANGLE, 2.0, false), up.map(|(x, y)| (x, 3.0 - y)));
    }

    #[test]
    fn the_corner_to_start_from_does_not_matter() {
        for first in 1..4 {
            let mut corners = RECTANGLE;
            corners.rotate_left(first);
            assert_eq!(path(&corners, 2.0, true), path(&RECTANGLE, 2.0, true));
        }
    }

    #[test]
    fn a_line_beyond_the_right_end_takes_the_chord_half_a_pitch_before() {
        // Lines at 0, 3 and 6, of which the last is drawn only while it is less than half a pitch beyond the end.
        let wide = [Point::new(0.0, 0.0), Point::new(5.0, 0.0), Point::new(5.0, 1.0), Point::new(0.0, 1.0)];
        assert_eq!(path(&wide, 3.0, true)[4..], [(6.0, 0.0), (6.0, 1.0)]);
        assert_eq!(path(&RECTANGLE, 3.0, true).last(), Some(&(3.0, 0.0)));
    }

    #[test]
    fn ends_that_follow_each_other_are_pulled_to_the_outer_one() {
        // Chords at 0, 1 and 2: the corner, -1 to 1, -2 to 2. The line of the first, without length, is pulled up to 1.
        let triangle = [Point::new(0.0, 0.0), Point::new(2.0, -2.0), Point::new(2.0, 2.0)];
        let by_hand = [(0.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, -2.0), (2.0, -2.0), (2.0, 2.0)];
        assert_eq!(path(&triangle, 1.0, true), by_hand);
    }

    #[test]
    fn no_corner_has_no_path() {
        assert!(path(&[], 1.0, true).is_empty());
    }

    #[test]
    fn the_pairs_of_a_rectangle_are_its_neighbours() {
        // The quirk: antipodal would be (0, 2) and (1, 3). Row 4 is corner 0 again.
        let polygon = ClosedPolygon::new(&RECTANGLE, tolerance());
        assert_eq!(polygon.caliper_pairs(), [(0, 1), (1, 2), (2, 3), (3, 4)]);
    }

    #[test]
    fn the_sweeps_of_a_rectangle() {
        let polygon = ClosedPolygon::new(&RECTANGLE, tolerance());
        // Both edges leave no width, so the one before is taken; before row 0 lies the edge of no length.
        assert_eq!(polygon.sweep_of_pair((0, 1)), Sweep { row: 4, starts_up: false });
        assert_eq!(polygon.sweep_of_pair((1, 2)), Sweep { row: 1, starts_up: false });
    }

    #[test]
    fn the_edge_of_a_sweep_points_up_in_its_frame() {
        let polygon = ClosedPolygon::new(&RECTANGLE, tolerance());
        for starts_up in [true, false] {
            for row in 0..4 {
                let frame = polygon.frame(Sweep { row, starts_up });
                let (from, to) = (frame.enter(polygon.rows[row]), frame.enter(polygon.rows[row + 1]));
                let length = polygon.rows[row].distance(polygon.rows[row + 1]);
                assert!((to.x - from.x).abs() < 1e-12 && (to.y - from.y - length).abs() < 1e-12);
                assert!(frame.leave(from).distance(polygon.rows[row]) < 1e-12);
            }
        }
    }
}
