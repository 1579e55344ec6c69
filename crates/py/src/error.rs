//! `pondhop_core::error` as the Python exception `pondhop.InvalidInput`.

use pyo3::prelude::*;

pyo3::import_exception!(pondhop.errors, InvalidInput);

/// The Python exception that carries the same faults.
pub fn to_python(error: &pondhop_core::error::InvalidInput) -> PyErr {
    let faults: Vec<(String, String, String)> =
        error.faults.iter().map(|fault| (fault.path.clone(), fault.message.clone(), fault.action.clone())).collect();
    InvalidInput::new_err((faults,))
}
