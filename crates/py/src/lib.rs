//! `pondhop._core`: the Python binding of `pondhop-core`.
//!
//! It converts, releases the GIL and maps errors; it holds no algorithm. Its files are named after the core modules they
//! wrap. Every index is checked at this border, because a Rust panic is no `Exception` in Python.

mod arguments;
mod attention;
mod bound;
mod effort;
mod error;
mod evaluate;
mod frame;
mod generate;
mod hpp;
mod plan;
mod problem;
mod rounds;
mod search;
mod separation;
mod territory;
mod travel;
mod values;

use pyo3::prelude::*;

/// The native core of pondhop. Use the names of the package `pondhop`, not this module.
#[pymodule]
mod _core {
    #[pymodule_export]
    use crate::attention::AttentionModel;
    #[pymodule_export]
    use crate::bound::{lower_bound, lower_bound_of_makespan, lower_bound_of_total};
    #[pymodule_export]
    use crate::evaluate::evaluate;
    #[pymodule_export]
    use crate::frame::LocalFrame;
    #[pymodule_export]
    use crate::generate::generate;
    #[pymodule_export]
    use crate::hpp::{hpp, hpp_clusters};
    #[pymodule_export]
    use crate::plan::{Plan, Violation};
    #[pymodule_export]
    use crate::problem::{Energy, Problem};
    #[pymodule_export]
    use crate::rounds::{Round, RoundPlan, RoundViolation, Trip, evaluate_round, round_bound, search_round};
    #[pymodule_export]
    use crate::search::search;
    #[pymodule_export]
    use crate::separation::{Separation, separation};
    #[pymodule_export]
    use crate::territory::territory;
    #[pymodule_export]
    use crate::travel::{leg_durations, leg_lengths};

    use super::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
