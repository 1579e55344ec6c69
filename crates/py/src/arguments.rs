//! What Python passes in: numbers and arrays of any real type, with faults in the words of the Python API.

use crate::error::to_python;
use crate::problem::Problem;
use numpy::PyReadonlyArrayDyn;
use pondhop_core::error::Faults;
use pondhop_core::geometry::Point;
use pondhop_core::problem::Layer;
use pyo3::exceptions::{PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyFloat, PyInt, PyList, PyTuple};
use std::sync::Arc;

/// A number of any real type, or what is shown of something else. A whole number beyond all floats is infinite.
pub struct Real(Result<f64, String>);

impl Real {
    pub const fn of(number: f64) -> Self {
        Self(Ok(number))
    }

    /// The number; `otherwise`, with a fault, if it is none.
    pub fn number(self, faults: &mut Faults, name: &str, otherwise: f64) -> f64 {
        self.0.unwrap_or_else(|shown| {
            faults.add(name, format!("it is {shown}"), "give a real number");
            otherwise
        })
    }
}

impl<'py> FromPyObject<'_, 'py> for Real {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let py = value.py();
        let is_plain = value.is_instance_of::<PyFloat>() || value.is_instance_of::<PyInt>();
        if !is_plain && has_masked(&value)? {
            return Ok(Self(Err("masked".into())));
        }
        match value.extract::<f64>() {
            Ok(number) => Ok(Self(Ok(number))),
            Err(error) if error.is_instance_of::<PyOverflowError>(py) => {
                Ok(Self(Ok(if value.lt(0)? { f64::NEG_INFINITY } else { f64::INFINITY })))
            }
            Err(error) if error.is_instance_of::<PyTypeError>(py) => Ok(Self(Err(shortened(&value)))),
            Err(error) => Err(error),
        }
    }
}

/// A seed of random numbers, or what is shown of something else.
pub struct Seed(Result<u64, String>);

impl Seed {
    pub const fn of(number: u64) -> Self {
        Self(Ok(number))
    }

    pub fn number(self) -> PyResult<u64> {
        self.0.map_err(|shown| fault("seed", format!("it is {shown}"), "give a whole number from 0 to 2^64 - 1"))
    }
}

impl<'py> FromPyObject<'_, 'py> for Seed {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let number = if value.is_instance_of::<PyBool>() { None } else { value.extract().ok() };
        Ok(Self(number.ok_or_else(|| shortened(&value))))
    }
}

/// The argument `problem`.
pub struct Task(pub Arc<pondhop_core::problem::Problem>);

impl<'py> FromPyObject<'_, 'py> for Task {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        match value.cast::<Problem>() {
            Ok(problem) => Ok(Self(Arc::clone(&problem.get().inner))),
            Err(_) => Err(fault("problem", format!("it is {}", shortened(&value)), "give a pondhop.Problem")),
        }
    }
}

/// An error with a single fault.
fn fault(name: &str, message: String, action: &str) -> PyErr {
    let mut faults = Faults::default();
    faults.add(name, message, action);
    faults.into_result(()).map_or_else(|error| to_python(&error), |()| unreachable!("a fault was added"))
}

/// A count from 0, or the fault that it is none.
pub fn count(faults: &mut Faults, name: &str, value: &Bound<'_, PyAny>) -> usize {
    let number = if value.is_instance_of::<PyBool>() { None } else { value.extract().ok() };
    number.unwrap_or_else(|| {
        faults.add(name, format!("it is {}", shortened(value)), "give a whole number, 0 or more");
        0
    })
}

/// A whole number of drones. The fault that there is none is left to the core.
pub fn num_drones(faults: &mut Faults, value: &Bound<'_, PyAny>) -> PyResult<usize> {
    let action = "give a whole number of drones, at least one";
    if value.is_instance_of::<PyBool>() {
        faults.add("num_drones", format!("it is {}", shortened(value)), action);
        return Ok(1);
    }
    match value.extract::<usize>() {
        Ok(number) => Ok(number),
        Err(error)
            if error.is_instance_of::<PyTypeError>(value.py())
                || error.is_instance_of::<PyOverflowError>(value.py()) =>
        {
            faults.add("num_drones", format!("it is {}", shortened(value)), action);
            Ok(1)
        }
        Err(error) => Err(error),
    }
}

/// Positions of shape (n, 2); none if the array is at fault.
pub fn points(faults: &mut Faults, name: &str, value: &Bound<'_, PyAny>) -> PyResult<Option<Vec<Point>>> {
    let Some(array) = real_array(faults, name, value)? else { return Ok(None) };
    let view = array.as_array();
    match *view.shape() {
        // What Python makes of an empty list.
        [0] | [0, 2] => return Ok(Some(Vec::new())),
        [_, 2] => {}
        _ => {
            add_shape_fault(faults, name, view.shape(), "give positions as an array of shape (n, 2)");
            return Ok(None);
        }
    }
    Ok(Some(view.rows().into_iter().map(|row| Point::new(row[0], row[1])).collect()))
}

/// A position of shape (2,); none if the array is at fault.
pub fn point(faults: &mut Faults, name: &str, value: &Bound<'_, PyAny>) -> PyResult<Option<Point>> {
    let Some(array) = real_array(faults, name, value)? else { return Ok(None) };
    let view = array.as_array();
    if *view.shape() == [2] {
        return Ok(Some(Point::new(view[0], view[1])));
    }
    add_shape_fault(faults, name, view.shape(), "give the two coordinates of the position");
    Ok(None)
}

/// One number for each pond, shape (n,); empty if not given or at fault. How many are wanted is not asked where the ponds
/// themselves are at fault.
pub fn values(
    faults: &mut Faults,
    name: &str,
    value: Option<&Bound<'_, PyAny>>,
    num_ponds: Option<usize>,
) -> PyResult<Vec<f64>> {
    let Some(value) = value else { return Ok(Vec::new()) };
    let Some(array) = real_array(faults, name, value)? else { return Ok(Vec::new()) };
    let view = array.as_array();
    match num_ponds {
        Some(num_ponds) if *view.shape() != [num_ponds] => {
            add_shape_fault(faults, name, view.shape(), &format!("give a value for each of the {num_ponds} ponds"));
            Ok(Vec::new())
        }
        Some(_) => Ok(view.iter().copied().collect()),
        None => Ok(Vec::new()),
    }
}

/// Rows of take-off and way home in seconds, and of both in joules; empty if not given or at fault.
pub fn layers(faults: &mut Faults, name: &str, value: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<Layer>> {
    let Some(value) = value else { return Ok(Vec::new()) };
    let Some(array) = real_array(faults, name, value)? else { return Ok(Vec::new()) };
    let view = array.as_array();
    match *view.shape() {
        [_, 4] => {}
        [0] => return Ok(Vec::new()),
        _ => {
            add_shape_fault(faults, name, view.shape(), "give layers as an array of shape (k, 4)");
            return Ok(Vec::new());
        }
    }
    let rows = view.rows().into_iter().map(|row| Layer {
        takeoff_duration: row[0],
        way_home_duration: row[1],
        takeoff_energy: row[2],
        way_home_energy: row[3],
    });
    Ok(rows.collect())
}

/// Pond indices per route.
pub fn routes(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<Vec<usize>>> {
    if let Ok(routes) = value.extract() {
        return Ok(routes);
    }
    let mut faults = Faults::default();
    let mut routes = Vec::new();
    for (route, ponds) in items(&mut faults, name, value)?.into_iter().enumerate() {
        let mut indices = Vec::new();
        for (place, pond) in items(&mut faults, &format!("{name}[{route}]"), &ponds)?.into_iter().enumerate() {
            match pond.extract::<usize>() {
                Ok(index) => indices.push(index),
                Err(_) => {
                    let message = format!("there is no pond {}", shortened(&pond));
                    faults.add(format!("{name}[{route}][{place}]"), message, "give the index of a pond, from 0 on");
                }
            }
        }
        routes.push(indices);
    }
    faults.into_result(routes).map_err(|error| to_python(&error))
}

fn items<'py>(faults: &mut Faults, name: &str, value: &Bound<'py, PyAny>) -> PyResult<Vec<Bound<'py, PyAny>>> {
    match value.try_iter() {
        Ok(items) => items.collect(),
        Err(_) => {
            faults.add(name, format!("it is {}", shortened(value)), "give a list of pond indices for each route");
            Ok(Vec::new())
        }
    }
}

fn real_array<'py>(
    faults: &mut Faults,
    name: &str,
    value: &Bound<'py, PyAny>,
) -> PyResult<Option<PyReadonlyArrayDyn<'py, f64>>> {
    let py = value.py();
    if has_masked(value)? {
        faults.add(name, "some of its values are masked", "leave them out, or fill them with values to plan with");
        return Ok(None);
    }
    let array = match py.import("numpy")?.call_method1("asarray", (value,)) {
        Ok(array) => array,
        // Lists of lists of different lengths, or what numpy cannot read.
        Err(error) if error.is_instance_of::<PyValueError>(py) || error.is_instance_of::<PyTypeError>(py) => {
            faults.add(name, "this is no array of numbers", "give numbers, as many in each row");
            return Ok(None);
        }
        Err(error) => return Err(error),
    };
    let number_type = array.getattr("dtype")?;
    if !matches!(number_type.getattr("kind")?.extract::<char>()?, 'i' | 'u' | 'f') {
        faults.add(name, format!("its values are of type {}", number_type.str()?), "give real numbers");
        return Ok(None);
    }
    Ok(Some(array.call_method1("astype", ("float64",))?.extract()?))
}

/// Whether a masked array, or a list of them, hides values: numpy would take what lies below the mask for them.
fn has_masked(value: &Bound<'_, PyAny>) -> PyResult<bool> {
    let is_masked = value.py().import("numpy")?.getattr("ma")?.getattr("is_masked")?;
    if is_masked.call1((value,))?.extract()? {
        return Ok(true);
    }
    if !(value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>()) {
        return Ok(false);
    }
    for item in value.try_iter()? {
        if is_masked.call1((item?,))?.extract()? {
            return Ok(true);
        }
    }
    Ok(false)
}

fn add_shape_fault(faults: &mut Faults, name: &str, shape: &[usize], action: &str) {
    let comma = if shape.len() == 1 { "," } else { "" };
    let sizes = shape.iter().map(ToString::to_string).collect::<Vec<String>>().join(", ");
    faults.add(name, format!("it has shape ({sizes}{comma})"), action);
}

/// What is shown of a value in a message.
pub fn shortened(value: &Bound<'_, PyAny>) -> String {
    const MAX_SHOWN: usize = 40;
    // Numbers of more digits than Python converts have no representation.
    let Ok(text) = value.repr() else { return "a number of very many digits".into() };
    let text = text.to_string();
    let shown: String = text.chars().take(MAX_SHOWN).collect();
    if shown.len() < text.len() { format!("{shown}...") } else { shown }
}
