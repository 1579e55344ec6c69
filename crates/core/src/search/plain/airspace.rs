//! Who may fly where: what a search asks before a visit changes its route.

use super::state::State;

/// A rule on which route may take which visit, told of every change so that it can judge the next one.
pub(crate) trait Airspace {
    /// Whether `route` may take `visit`, which belongs to the route that made it last.
    fn admits(&mut self, visit: u32, route: u32) -> bool;
    /// `route` makes `visit` from now on.
    fn assign(&mut self, visit: u32, route: u32);
    /// What was assigned since the last call of this or [`Airspace::undo`] stays.
    fn keep(&mut self);
    /// Takes back what was assigned since the last call of this or [`Airspace::keep`].
    fn undo(&mut self);
    /// Starts afresh from a plan.
    fn load(&mut self, state: &State);
}

/// Every drone may fly everywhere.
#[derive(Clone, Copy, Debug)]
pub(super) struct SharedAirspace;

impl Airspace for SharedAirspace {
    #[inline]
    fn admits(&mut self, _visit: u32, _route: u32) -> bool {
        true
    }

    #[inline]
    fn assign(&mut self, _visit: u32, _route: u32) {}

    #[inline]
    fn keep(&mut self) {}

    #[inline]
    fn undo(&mut self) {}

    #[inline]
    fn load(&mut self, _state: &State) {}
}
