//! `pondhop_core::attention`.

use crate::arguments;
use crate::arguments::{Seed, Task};
use crate::error::to_python;
use numpy::{PyArray2, PyReadonlyArrayDyn, ToPyArray};
use pondhop_core::attention::{Architecture, Decoding, Model, Variant};
use pondhop_core::error::{Fault, InvalidInput};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;
use std::time::Instant;

/// A trained attention model: a network that builds routes pond by pond.
///
/// Parameters
/// ----------
/// tensors
///     The weights by name, float32, as `pondhop.baselines.attention` stores them; a matrix has shape (outputs, inputs).
/// variant
///     ``"cvrp"``: at most n // num_drones + 1 ponds a route, any number of routes, the least total length; ``"minmax"``: at
///     most one route per drone, the shortest longest route.
/// width, num_heads, num_layers, feed_forward_width
///     Sizes the model was trained with.
///
/// Raises
/// ------
/// InvalidInput
///     With every size that has no meaning; or with every tensor that is missing, of another type or shape, not finite, or
///     no part of the model.
/// ValueError
///     If there is no such variant.
#[pyclass(frozen, module = "pondhop._core")]
pub struct AttentionModel {
    inner: Model,
}

#[pymethods]
impl AttentionModel {
    #[new]
    #[pyo3(signature = (tensors, *, variant, width, num_heads, num_layers, feed_forward_width))]
    fn new(
        tensors: &Bound<'_, PyDict>,
        variant: &str,
        width: usize,
        num_heads: usize,
        num_layers: usize,
        feed_forward_width: usize,
    ) -> PyResult<Self> {
        let variant = match variant {
            "cvrp" => Variant::Cvrp,
            "minmax" => Variant::MinMax,
            _ => return Err(PyValueError::new_err(format!("variant is 'cvrp' or 'minmax', not {variant:?}"))),
        };
        let architecture = Architecture { variant, width, num_heads, num_layers, feed_forward_width };
        let mut of_other_types: Vec<Fault> = Vec::new();
        let mut arrays = BTreeMap::new();
        for (name, value) in tensors {
            let name = name.str()?.to_string();
            match value.extract::<PyReadonlyArrayDyn<'_, f32>>() {
                Ok(array) => {
                    arrays.insert(name, array.as_array().to_owned());
                }
                Err(_) => of_other_types.push(Fault {
                    path: format!("tensors[{name:?}]"),
                    message: "this is no array of float32".into(),
                    action: "give numpy arrays of float32".into(),
                }),
            }
        }
        let model = Model::new(architecture, arrays);
        if of_other_types.is_empty() {
            return model.map(|inner| Self { inner }).map_err(|error| to_python(&error));
        }
        // What is there with a wrong type is not missing.
        let others = model.err().into_iter().flat_map(|error| error.faults);
        let others: Vec<Fault> =
            others.filter(|fault| of_other_types.iter().all(|known| known.path != fault.path)).collect();
        of_other_types.extend(others);
        Err(to_python(&InvalidInput { faults: of_other_types }))
    }

    /// Plan routes. A time limit cannot shorten it: every pond is chosen once.
    ///
    /// Parameters
    /// ----------
    /// problem
    ///     What is to be planned. The model looks at places only: no limit, service duration or speed changes its plan.
    /// decoding
    ///     ``"greedy"``: the likeliest choice at every step; ``"symmetries"``: the best greedy plan of the farm turned and
    ///     mirrored in all eight ways; ``"sampling"``: the best of `num_samples` plans drawn with the model's probabilities.
    /// num_samples
    ///     At least 1; matters to ``"sampling"`` only.
    /// seed
    ///     Draws the samples.
    ///
    /// Returns
    /// -------
    /// routes : list of list of int
    ///     Pond indices per route in flying order, the depot implied at both ends, every pond once. ``"minmax"``: at most one
    ///     route per drone; ``"cvrp"``: perhaps more.
    /// elapsed_s : float
    ///     Wall time in seconds from the problem's coordinates to finished routes, everything included.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an option has no meaning.
    #[pyo3(signature = (problem, *, decoding="greedy", num_samples=1, seed=Seed::of(1)))]
    fn plan(
        &self,
        py: Python<'_>,
        problem: Task,
        decoding: &str,
        num_samples: usize,
        seed: Seed,
    ) -> PyResult<(Vec<Vec<usize>>, f64)> {
        let seed = seed.checked()?;
        let decoding = match decoding {
            "greedy" => Decoding::Greedy,
            "symmetries" => Decoding::Symmetries,
            "sampling" if num_samples > 0 => Decoding::Sampling { num_samples },
            "sampling" => return Err(PyValueError::new_err("num_samples is 1 or more")),
            _ => {
                let message = format!("decoding is 'greedy', 'symmetries' or 'sampling', not {decoding:?}");
                return Err(PyValueError::new_err(message));
            }
        };
        Ok(py.detach(|| {
            let start = Instant::now();
            let routes = self.inner.plan(&problem.0, decoding, seed);
            (routes, start.elapsed().as_secs_f64())
        }))
    }

    /// The logits of every choice that leads to the given routes, to compare networks with.
    ///
    /// Parameters
    /// ----------
    /// problem
    ///     What is planned.
    /// routes
    ///     Pond indices per route; a choice is a pond, or the return to the depot between two routes.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     float32 of shape (choices, num_ponds + 1): the depot's logit first, then the ponds'; minus infinity for what may
    ///     not be chosen.
    ///
    /// Raises
    /// ------
    /// InvalidInput
    ///     At the first place where the routes go on with what may not be chosen.
    fn logits<'py>(
        &self,
        py: Python<'py>,
        problem: Task,
        routes: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let routes = arguments::routes("routes", routes)?;
        let logits = py.detach(|| self.inner.logits(&problem.0, &routes)).map_err(|error| to_python(&error))?;
        Ok(logits.to_pyarray(py))
    }

    fn __repr__(&self) -> String {
        let Architecture { variant, width, num_heads, num_layers, feed_forward_width } = self.inner.architecture();
        let variant = match variant {
            Variant::Cvrp => "cvrp",
            Variant::MinMax => "minmax",
        };
        format!(
            "AttentionModel(variant='{variant}', width={width}, num_heads={num_heads}, num_layers={num_layers}, \
             feed_forward_width={feed_forward_width})"
        )
    }
}
