//! What the classes of the binding have in common as values, and arrays of their numbers.

use numpy::{PyArray2, PyArrayMethods, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::hash::{DefaultHasher, Hash, Hasher};

/// A hash of numbers; the same for equal ones.
pub fn hash_of(numbers: impl IntoIterator<Item = f64>) -> u64 {
    let mut hasher = DefaultHasher::new();
    for number in numbers {
        // 0.0 and -0.0 are equal.
        (number + 0.0).to_bits().hash(&mut hasher);
    }
    hasher.finish()
}

/// What copies and pickles of any protocol make an object of again: its class with keywords, called without anything.
pub type Reduced<'py> = (Bound<'py, PyAny>, Bound<'py, PyTuple>);

/// `Reduced` of a class whose arguments have names; the oldest protocols know no others.
pub fn reduced<'py, T: pyo3::PyTypeInfo>(py: Python<'py>, arguments: &Bound<'py, PyDict>) -> PyResult<Reduced<'py>> {
    let partial = py.import("functools")?.getattr("partial")?.call((py.get_type::<T>(),), Some(arguments))?;
    Ok((partial, PyTuple::empty(py)))
}

/// An array of shape (rows, `num_columns`) of numbers row by row.
pub fn table<'py>(
    py: Python<'py>,
    numbers: impl Iterator<Item = f64>,
    num_columns: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let numbers: Vec<f64> = numbers.collect();
    numbers.to_pyarray(py).reshape([numbers.len() / num_columns, num_columns])
}
