//! `pondhop_core::generate`.

use crate::arguments::{Seed, Whole, Word, checked};
use crate::error::to_python;
use numpy::{PyArray1, PyArray2, ToPyArray};
use pondhop_core::error::Faults;
use pondhop_core::generate::Variant;
use pondhop_core::geometry::Point;
use pyo3::prelude::*;

type Farm<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>, f64);

/// Draw a research farm of the unit square; see `pondhop.instances.generate`.
///
/// Parameters
/// ----------
/// num_ponds
///     1 to 10 million.
/// seed
///     0 to 2**64 - 1.
/// variant
///     ``"authors"`` (as the paper's code does it) or ``"paper"`` (as its text describes it).
///
/// Returns
/// -------
/// tuple
///     Depot, shape (2,); ponds, shape (num_ponds, 2); closed outline, shape (k, 2); pitch of the grid.
///
/// Raises
/// ------
/// InvalidInput
///     With every argument that is out of range.
#[pyfunction]
#[pyo3(signature = (num_ponds, seed, variant=Word::default()))]
pub fn generate<'py>(py: Python<'py>, num_ponds: Whole, seed: Seed, variant: Word<'py>) -> PyResult<Farm<'py>> {
    let mut faults = Faults::default();
    let action = "give a whole number of ponds";
    let num_ponds = num_ponds.number(&mut faults, "num_ponds", &(0..=usize::MAX as u64), action) as usize;
    let seed = seed.number(&mut faults);
    let variants = [("authors", Variant::Authors), ("paper", Variant::Paper)];
    let variant = variant.meaning(&mut faults, "variant", &variants)?;
    checked(faults, ())?;
    let farm =
        py.detach(|| pondhop_core::generate::generate(num_ponds, variant, seed)).map_err(|error| to_python(&error))?;
    let depot = [farm.depot.x, farm.depot.y].to_pyarray(py);
    Ok((depot, array(py, &farm.ponds)?, array(py, &farm.boundary)?, farm.spacing))
}

fn array<'py>(py: Python<'py>, points: &[Point]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let rows: Vec<Vec<f64>> = points.iter().map(|point| vec![point.x, point.y]).collect();
    Ok(PyArray2::from_vec2(py, &rows)?)
}
