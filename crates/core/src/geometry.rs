//! Points and planar constructions: hull, calipers, sweep lines.

/// A point of the plane: metres in a farm's local frame, or the unitless square of a research farm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// East, or the first coordinate.
    pub x: f64,
    /// North, or the second coordinate.
    pub y: f64,
}

impl Point {
    /// The point `(x, y)`.
    #[must_use]
    pub const fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }

    /// Straight-line distance to `other`. Uses only correctly rounded operations: the same on every machine.
    #[must_use]
    pub fn distance(self, other: Self) -> f64 {
        let (dx, dy) = (self.x - other.x, self.y - other.y);
        (dx * dx + dy * dy).sqrt()
    }
}

impl std::ops::Sub for Point {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y)
    }
}

/// Twice the area of the triangle `(0, a, b)`: positive where `b` lies to the left of `a`.
#[must_use]
pub fn cross(a: Point, b: Point) -> f64 {
    a.x * b.y - a.y * b.x
}

/// Scalar product.
#[must_use]
pub fn dot(a: Point, b: Point) -> f64 {
    a.x * b.x + a.y * b.y
}

/// The longer side of the axis-parallel box around the points; 0 for none.
#[must_use]
pub fn extent(points: impl Iterator<Item = Point>) -> f64 {
    let (mut low, mut high) =
        (Point::new(f64::INFINITY, f64::INFINITY), Point::new(f64::NEG_INFINITY, f64::NEG_INFINITY));
    for point in points {
        low = Point::new(low.x.min(point.x), low.y.min(point.y));
        high = Point::new(high.x.max(point.x), high.y.max(point.y));
    }
    (high.x - low.x).max(high.y - low.y).max(0.0)
}

/// The corners of the convex hull of `points`, as indices into them, counter-clockwise from the lowest of the leftmost.
///
/// Corners nearer than `tolerance` to the line through their neighbours are left out, so that rounding makes no corner
/// on a straight side. Flat points give the two ends, coinciding points one index, no point none. Andrew's monotone
/// chain (Information Processing Letters 1979); O(n log n), O(n) where the points come sorted by x, then y.
#[must_use]
pub fn convex_hull(points: &[Point], tolerance: f64) -> Vec<usize> {
    let mut sorted: Vec<usize> = (0..points.len()).collect();
    sorted.sort_by(|&a, &b| {
        let (a, b) = (points[a], points[b]);
        a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y))
    });
    let mut hull: Vec<usize> = Vec::with_capacity(sorted.len().min(64));
    extend_chain(points, sorted.iter().copied(), tolerance, 0, &mut hull);
    let num_lower = hull.len();
    extend_chain(points, sorted.iter().rev().copied(), tolerance, num_lower.saturating_sub(1), &mut hull);
    if hull.len() > 1 {
        hull.pop();
    }
    hull
}

/// Adds one chain of the hull to those corners that are already there; `fixed` of them stay.
fn extend_chain(
    points: &[Point],
    sorted: impl Iterator<Item = usize>,
    tolerance: f64,
    fixed: usize,
    hull: &mut Vec<usize>,
) {
    for index in sorted {
        let point = points[index];
        if hull.last().is_some_and(|&last| (point.x - points[last].x).abs() + (point.y - points[last].y).abs() <= tolerance) {
            continue;
        }
        while hull.len() >= fixed + 2 {
            let (before, last) = (points[hull[hull.len() - 2]], points[hull[hull.len() - 1]]);
            let chord = point - before;
            if cross(last - before, chord) > tolerance * (chord.x.abs() + chord.y.abs()) {
                break;
            }
            hull.pop();
        }
        hull.push(index);
    }
}

/// Angles closer than this are one angle: far above rounding, far below what a survey can tell.
const ANGLE_TOLERANCE: f64 = 1e-9;

/// The direction of a vector in (-π, π], counter-clockwise from east; 0 for the zero vector.
///
/// Directions within rounding of east and west are exactly 0 and π: [`clockwise_angle`] treats the two half planes
/// differently.
#[must_use]
pub fn heading(vector: Point) -> f64 {
    let angle = libm::atan2(vector.y, vector.x);
    if angle.abs() < ANGLE_TOLERANCE {
        0.0
    } else if angle < -std::f64::consts::PI + ANGLE_TOLERANCE {
        std::f64::consts::PI
    } else {
        angle
    }
}

/// The clockwise angle from heading `from` to heading `to` as the authors' code has it: between two headings of the
/// upper half plane that lie counter-clockwise it is 2π plus, not minus, their difference.
fn clockwise_angle(from: f64, to: f64) -> f64 {
    use std::f64::consts::TAU;
    match (from < 0.0, to < 0.0) {
        (true, true) if from < to => TAU + (from - to),
        (true, false) => TAU + from - to,
        (false, false) if from < to => TAU - (from - to),
        _ => from - to,
    }
}

/// A convex polygon as the rows the authors' planner works on: the corners counter-clockwise, the first repeated at the
/// end, with the heading of the edge that leaves each row.
///
/// The last row's edge leads from the last corner to the first, which are the same: it has no length and heads east.
#[derive(Clone, Debug)]
pub struct ClosedPolygon {
    rows: Vec<Point>,
    headings: Vec<f64>,
}

impl ClosedPolygon {
    /// The polygon of `corners`, which come counter-clockwise and without the repetition of the first.
    #[must_use]
    pub fn new(corners: &[Point]) -> Self {
        let rows: Vec<Point> = corners.iter().chain(corners.first()).copied().collect();
        let headings =
            (0..rows.len()).map(|row| heading(rows.get(row + 1).map_or(Point::default(), |&next| next - rows[row]))).collect();
        Self { rows, headings }
    }

    /// The corners, the first repeated at the end.
    #[must_use]
    pub fn rows(&self) -> &[Point] {
        &self.rows
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

    /// The pairs of rows between which the authors' planner looks for a sweep direction.
    ///
    /// Rotating calipers (Shamos, Computational Geometry, PhD thesis, Yale 1978) in the form of Vasquez-Gomez et al. 2018,
    /// algorithm 1. Quirk kept: that routine is written for an open clockwise polygon and gets a closed
    /// counter-clockwise one, so that most of the pairs are neighbours and few are antipodal.
    #[must_use]
    pub fn caliper_pairs(&self) -> Vec<(usize, usize)> {
        use std::f64::consts::PI;
        let num_rows = self.rows.len();
        let last = num_rows - 1;
        let (mut i, mut j) = (0, 1);
        while self.angle(last, j) < PI - ANGLE_TOLERANCE {
            j = self.next(j);
        }
        let mut pairs = vec![(i, j)];
        while j < num_rows {
            let excess = self.angle(i, j) - PI;
            if excess < -ANGLE_TOLERANCE {
                j += 1;
            } else if excess > ANGLE_TOLERANCE {
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

    /// The sweep that the authors' planner tries for a pair of rows: along the edge after one of the two, or along the
    /// edge before, whichever leaves the narrower polygon to sweep (Vasquez-Gomez et al. 2018, algorithm 2).
    #[must_use]
    pub fn sweep_of_pair(&self, (i, j): (usize, usize), tolerance: f64) -> Sweep {
        use std::f64::consts::PI;
        let (after, opposite) = if self.angle(i, j) < PI - ANGLE_TOLERANCE { (j, i) } else { (i, j) };
        let phi = self.angle(after, opposite) - PI;
        let turn = self.angle(self.previous(after), after);
        let opposite_turn = self.angle(self.previous(opposite), opposite) - phi;
        let (before, opposite_before) = if turn < opposite_turn - ANGLE_TOLERANCE {
            (self.previous(after), opposite)
        } else {
            (self.previous(opposite), after)
        };
        // An edge of no length has no width (not a number): the comparison is false and the edge before is taken.
        let is_narrower = self.width(after, opposite) < self.width(before, opposite_before) - tolerance;
        if is_narrower { Sweep { row: after, starts_up: true } } else { Sweep { row: before, starts_up: false } }
    }

    /// Distance of a row from the line through the edge after another row.
    fn width(&self, edge: usize, row: usize) -> f64 {
        let along = self.rows[self.next(edge)] - self.rows[edge];
        cross(along, self.rows[row] - self.rows[edge]).abs() / dot(along, along).sqrt()
    }

    /// The frame in which the edge after the row of `sweep` points up.
    #[must_use]
    pub fn frame(&self, sweep: Sweep) -> Frame {
        let along = self.rows[self.next(sweep.row)] - self.rows[sweep.row];
        let length = dot(along, along).sqrt();
        if length > 0.0 {
            Frame { up: Point::new(along.x / length, along.y / length) }
        } else {
            // The edge of no length heads east; the other end of it, east reversed.
            Frame { up: Point::new(if sweep.starts_up { 1.0 } else { -1.0 }, 0.0) }
        }
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

/// A rotated frame: its y axis points along a unit vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The y axis.
    pub up: Point,
}

impl Frame {
    /// The coordinates of `point` in this frame.
    #[must_use]
    pub fn enter(self, point: Point) -> Point {
        Point::new(cross(point, self.up), dot(point, self.up))
    }

    /// The point whose coordinates in this frame are `local`.
    #[must_use]
    pub fn leave(self, local: Point) -> Point {
        Point::new(self.up.y * local.x + self.up.x * local.y, self.up.y * local.y - self.up.x * local.x)
    }
}

/// Most lines of one sweep. A farm has about the root of its ponds; more than this is a pitch that says nothing about
/// the cluster (pairs of ponds a step apart, kilometres from each other), and the lines are drawn apart.
const MAX_NUM_LINES: f64 = 4096.0;

/// Writes the corners of the back-and-forth path over a convex polygon into `path`: two per line, joined by right angles.
///
/// `corners` are counter-clockwise in the frame of the sweep, whose lines are vertical: the first at the left end, then
/// one every `pitch` while it is less than half a pitch beyond the right end; a line beyond takes the chord half a pitch
/// before it (Vasquez-Gomez et al. 2018, section 3.3). Of two lines that follow each other, the end that lies inside is
/// pulled to the other's height. A side within `tolerance` of a line is part of it. O(corners + lines).
pub fn sweep_path(corners: &[Point], pitch: f64, starts_up: bool, tolerance: f64, path: &mut Vec<Point>) {
    path.clear();
    let mut chords = Chords::new(corners, tolerance);
    let width = chords.right - chords.left;
    let pitch = pitch.max(width / MAX_NUM_LINES);
    let mut is_up = starts_up;
    for line in 0.. {
        let x = chords.left + f64::from(line) * pitch;
        if line > 0 && x >= chords.right + pitch / 2.0 - tolerance {
            break;
        }
        let (low, high) = chords.at(if x > chords.right + tolerance { x - pitch / 2.0 } else { x });
        let (mut enter, exit) = if is_up { (low, high) } else { (high, low) };
        if let Some(last) = path.last_mut() {
            let is_last_inside = if is_up { enter < last.y } else { enter > last.y };
            if is_last_inside {
                last.y = enter;
            } else {
                enter = last.y;
            }
        }
        path.push(Point::new(x, enter));
        path.push(Point::new(x, exit));
        is_up = !is_up;
    }
}

/// The vertical chords of a convex polygon, asked from left to right.
struct Chords<'a> {
    corners: &'a [Point],
    left: f64,
    right: f64,
    tolerance: f64,
    /// Index at which the lower side's edge over the last asked line starts, and the upper side's.
    lower: usize,
    upper: usize,
    /// Edges left before the sides end.
    num_lower: usize,
    num_upper: usize,
}

impl<'a> Chords<'a> {
    fn new(corners: &'a [Point], tolerance: f64) -> Self {
        let left = corners.iter().map(|corner| corner.x).fold(f64::INFINITY, f64::min);
        let right = corners.iter().map(|corner| corner.x).fold(f64::NEG_INFINITY, f64::max);
        // The lowest and the highest corner of a vertical side, which rounding may have tilted.
        let end = |is_end: &dyn Fn(Point) -> bool, sign: f64| {
            let mut best: Option<usize> = None;
            for (index, &corner) in corners.iter().enumerate() {
                if is_end(corner) && best.is_none_or(|best| sign * corner.y < sign * corners[best].y) {
                    best = Some(index);
                }
            }
            best.unwrap_or(0)
        };
        let is_left = |corner: Point| corner.x <= left + tolerance;
        let is_right = |corner: Point| corner.x >= right - tolerance;
        let (lower, upper) = (end(&is_left, 1.0), end(&is_left, -1.0));
        let num_corners = corners.len();
        let num_lower = (end(&is_right, 1.0) + num_corners - lower) % num_corners;
        let num_upper = (upper + num_corners - end(&is_right, -1.0)) % num_corners;
        Self { corners, left, right, tolerance, lower, upper, num_lower, num_upper }
    }

    /// The lowest and the highest point at `x`, which does not decrease from call to call.
    fn at(&mut self, x: f64) -> (f64, f64) {
        let num_corners = self.corners.len();
        while self.num_lower > 0 && self.corners[(self.lower + 1) % num_corners].x <= x + self.tolerance {
            self.lower = (self.lower + 1) % num_corners;
            self.num_lower -= 1;
        }
        while self.num_upper > 0 && self.corners[(self.upper + num_corners - 1) % num_corners].x <= x + self.tolerance {
            self.upper = (self.upper + num_corners - 1) % num_corners;
            self.num_upper -= 1;
        }
        let height = |corner: usize, next: usize, num_left: usize| {
            let (from, to) = (self.corners[corner], self.corners[next]);
            if num_left == 0 || x <= from.x + self.tolerance {
                from.y
            } else {
                from.y + (to.y - from.y) * ((x - from.x) / (to.x - from.x))
            }
        };
        let low = height(self.lower, (self.lower + 1) % num_corners, self.num_lower);
        let high = height(self.upper, (self.upper + num_corners - 1) % num_corners, self.num_upper);
        (low, high)
    }
}
