//! `pondhop_core::separation`.

use crate::arguments;
use crate::arguments::{Real, Task, count};
use crate::error::to_python;
use crate::values::hash_of;
use pondhop_core::error::Faults;
use pyo3::prelude::*;
use pyo3::types::PyType;

/// How well a plan keeps the drones apart: immutable.
///
/// Parameters
/// ----------
/// overlap
///     Area inside the convex hulls of the ponds of at least two routes, as a share of the area of the hull of all ponds.
/// num_crossings
///     Pairs of crossing legs of different routes, legs from and to the depot left aside.
/// num_depot_leg_crossings
///     Pairs of crossing legs of different routes, of which at least one starts or ends at the depot.
///
/// Raises
/// ------
/// InvalidInput
///     With every argument that is no number.
#[pyclass(frozen, eq, module = "pondhop")]
#[derive(PartialEq)]
pub struct Separation {
    inner: pondhop_core::separation::Separation,
}

#[pymethods]
impl Separation {
    #[new]
    fn new(
        overlap: Real,
        num_crossings: &Bound<'_, PyAny>,
        num_depot_leg_crossings: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let mut faults = Faults::default();
        let inner = pondhop_core::separation::Separation {
            overlap: overlap.number(&mut faults, "overlap", 0.0),
            num_crossings: count(&mut faults, "num_crossings", num_crossings)?,
            num_depot_leg_crossings: count(&mut faults, "num_depot_leg_crossings", num_depot_leg_crossings)?,
        };
        faults.into_result(Self { inner }).map_err(|error| to_python(&error))
    }

    /// Area inside the convex hulls of the ponds of at least two routes, as a share of the area of the hull of all ponds.
    #[getter]
    fn overlap(&self) -> f64 {
        self.inner.overlap
    }

    /// Pairs of crossing legs of different routes, legs from and to the depot left aside.
    #[getter]
    fn num_crossings(&self) -> usize {
        self.inner.num_crossings
    }

    /// Pairs of crossing legs of different routes, of which at least one starts or ends at the depot.
    #[getter]
    fn num_depot_leg_crossings(&self) -> usize {
        self.inner.num_depot_leg_crossings
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> (Bound<'py, PyType>, (f64, usize, usize)) {
        (slf.get_type(), slf.get().fields())
    }

    fn __hash__(&self) -> u64 {
        let (overlap, num_crossings, num_depot_leg_crossings) = self.fields();
        hash_of([overlap, num_crossings as f64, num_depot_leg_crossings as f64])
    }

    fn __repr__(&self) -> String {
        format!(
            "Separation(overlap={:?}, num_crossings={}, num_depot_leg_crossings={})",
            self.inner.overlap, self.inner.num_crossings, self.inner.num_depot_leg_crossings
        )
    }
}

impl Separation {
    const fn fields(&self) -> (f64, usize, usize) {
        (self.inner.overlap, self.inner.num_crossings, self.inner.num_depot_leg_crossings)
    }
}

/// Measure how well routes keep apart: shared territory and crossing legs.
///
/// Parameters
/// ----------
/// problem
///     What was to be planned.
/// routes
///     Pond indices per route in flying order, the depot implied at both ends.
///
/// Returns
/// -------
/// Separation
///     Overlap of the convex hulls of the routes' ponds, and numbers of crossings.
///
/// Raises
/// ------
/// InvalidInput
///     If a route names a pond that does not exist.
#[pyfunction]
pub fn separation(py: Python<'_>, problem: Task, routes: &Bound<'_, PyAny>) -> PyResult<Separation> {
    let routes = arguments::routes("routes", routes)?;
    py.detach(|| pondhop_core::separation::separation(&problem.0, &routes))
        .map(|inner| Separation { inner })
        .map_err(|error| to_python(&error))
}
