//! `pondhop_core::generate`.

use crate::error::to_python;
use numpy::{PyArray1, PyArray2, ToPyArray};
use pondhop_core::generate::Variant;
use pondhop_core::geometry::Point;
use pyo3::exceptions::PyValueError;
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
///     If the number of ponds is out of range.
/// ValueError
///     If there is no such variant.
#[pyfunction]
#[pyo3(signature = (num_ponds, seed, variant="authors"))]
pub fn generate<'py>(py: Python<'py>, num_ponds: usize, seed: u64, variant: &str) -> PyResult<Farm<'py>> {
    let variant = match variant {
        "authors" => Variant::Authors,
        "paper" => Variant::Paper,
        _ => return Err(PyValueError::new_err(format!("variant is 'authors' or 'paper', not {variant:?}"))),
    };
    let farm =
        py.detach(|| pondhop_core::generate::generate(num_ponds, variant, seed)).map_err(|error| to_python(&error))?;
    let depot = [farm.depot.x, farm.depot.y].to_pyarray(py);
    Ok((depot, array(py, &farm.ponds)?, array(py, &farm.boundary)?, farm.spacing))
}

fn array<'py>(py: Python<'py>, points: &[Point]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let rows: Vec<Vec<f64>> = points.iter().map(|point| vec![point.x, point.y]).collect();
    Ok(PyArray2::from_vec2(py, &rows)?)
}
