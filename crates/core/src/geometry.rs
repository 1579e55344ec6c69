//! Points and planar constructions.

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
