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
use std::ops::RangeInclusive;
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
        if !is_number(&value, "Real")? {
            return Ok(Self(Err(shown(&value)?)));
        }
        match value.extract::<f64>() {
            Ok(number) => Ok(Self(Ok(number))),
            Err(error) if error.is_instance_of::<PyOverflowError>(value.py()) => {
                Ok(Self(Ok(if value.lt(0)? { f64::NEG_INFINITY } else { f64::INFINITY })))
            }
            Err(error) => Err(error),
        }
    }
}

/// A whole number of any type from 0 on, or what is shown of something else.
pub struct Whole(Result<u64, String>);

impl Whole {
    pub const fn of(number: u64) -> Self {
        Self(Ok(number))
    }

    /// The number; the least possible, with a fault, if it is none or out of range.
    pub fn number(self, faults: &mut Faults, name: &str, possible: &RangeInclusive<u64>, action: &str) -> u64 {
        let number = self.0.and_then(|number| possible.contains(&number).then_some(number).ok_or(number.to_string()));
        number.unwrap_or_else(|shown| {
            faults.add(name, format!("it is {shown}"), action);
            *possible.start()
        })
    }
}

impl<'py> FromPyObject<'_, 'py> for Whole {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        // Numbers below 0 and beyond 64 bits are out of every range.
        let number = if is_number(&value, "Integral")? { value.extract().ok() } else { None };
        number.map_or_else(|| Ok(Self(Err(shown(&value)?))), |number| Ok(Self(Ok(number))))
    }
}

/// A seed of random numbers, or what is shown of something else.
pub struct Seed(Whole);

impl Seed {
    pub const fn of(number: u64) -> Self {
        Self(Whole::of(number))
    }

    pub fn number(self, faults: &mut Faults) -> u64 {
        self.0.number(faults, "seed", &(0..=u64::MAX), "give a whole number from 0 to 2^64 - 1")
    }

    /// The number, where nothing else can be at fault.
    pub fn checked(self) -> PyResult<u64> {
        let mut faults = Faults::default();
        let number = self.number(&mut faults);
        checked(faults, number)
    }
}

impl<'py> FromPyObject<'_, 'py> for Seed {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        value.extract().map(Self)
    }
}

/// Whether a value is a number of some kind of Python's `numbers`, which numpy's are, too. Truth values count as none.
fn is_number(value: &Bound<'_, PyAny>, kind: &str) -> PyResult<bool> {
    if value.is_instance_of::<PyBool>() {
        return Ok(false);
    }
    if value.is_exact_instance_of::<PyFloat>() || value.is_exact_instance_of::<PyInt>() {
        return Ok(kind == "Real" || value.is_exact_instance_of::<PyInt>());
    }
    value.is_instance(&value.py().import("numbers")?.getattr(kind)?)
}

/// A value that is to be one of some words; `Word::default()` where none is given.
#[derive(Default)]
pub struct Word<'py>(Option<Bound<'py, PyAny>>);

impl Word<'_> {
    /// What the word stands for. The first of the possible ones is the default, and stands, with a fault, for all others.
    pub fn meaning<T: Copy>(self, faults: &mut Faults, name: &str, possible: &[(&str, T)]) -> PyResult<T> {
        let Some(value) = self.0 else { return Ok(possible[0].1) };
        let word = value.extract::<String>().ok();
        if let Some((_, meaning)) = possible.iter().find(|(known, _)| word.as_deref() == Some(known)) {
            return Ok(*meaning);
        }
        let words = possible.iter().map(|(known, _)| *known).collect::<Vec<&str>>().join(", ");
        faults.add(name, format!("it is {}", shown(&value)?), &format!("choose one of: {words}"));
        Ok(possible[0].1)
    }
}

impl<'py> FromPyObject<'_, 'py> for Word<'py> {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        Ok(Self(Some(value.to_owned())))
    }
}

/// The argument `problem`.
pub struct Task(pub Arc<pondhop_core::problem::Problem>);

impl<'py> FromPyObject<'_, 'py> for Task {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        match value.cast::<Problem>() {
            Ok(problem) => Ok(Self(Arc::clone(&problem.get().inner))),
            Err(_) => {
                let mut faults = Faults::default();
                let action = "give a pondhop.Problem, as farm.to_problem returns it";
                faults.add("problem", format!("it is {}", shown(&value)?), action);
                Err(checked(faults, ()).expect_err("a fault was added"))
            }
        }
    }
}

/// A value, if nothing was wrong.
pub fn checked<T>(faults: Faults, value: T) -> PyResult<T> {
    faults.into_result(value).map_err(|error| to_python(&error))
}

/// A count from 0, or the fault that it is none.
pub fn count(faults: &mut Faults, name: &str, value: &Bound<'_, PyAny>) -> PyResult<usize> {
    let possible = 0..=usize::MAX as u64;
    Ok(value.extract::<Whole>()?.number(faults, name, &possible, "give a whole number, 0 or more") as usize)
}

/// A whole number of drones. The fault that there is none is left to the core.
pub fn num_drones(faults: &mut Faults, value: &Bound<'_, PyAny>) -> PyResult<usize> {
    Ok(value.extract::<Whole>()?.0.map_or_else(
        |shown| {
            faults.add("num_drones", format!("it is {shown}"), "give a whole number of drones, at least one");
            1
        },
        |number| number as usize,
    ))
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
                    let message = format!("there is no pond {}", shown(&pond)?);
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
            faults.add(name, format!("it is {}", shown(value)?), "give a list of pond indices for each route");
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

/// What is shown of a value in a message. Python's own checks show it by the same function, so that a wrong value is told
/// alike wherever it comes to light.
pub fn shown(value: &Bound<'_, PyAny>) -> PyResult<String> {
    value.py().import("pondhop.arguments")?.call_method1("shown", (value,))?.extract()
}
