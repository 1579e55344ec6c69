//! `pondhop_core::problem`.

use crate::arguments::{self, Real};
use crate::error::to_python;
use crate::values::{Reduced, hash_of, reduced, table};
use numpy::{PyArray1, PyArray2, ToPyArray};
use pondhop_core::error::Faults;
use pondhop_core::geometry::Point;
use pondhop_core::problem::{Depot, VehicleType, Visit, WayHome};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::iter::repeat;
use std::sync::Arc;

/// What flying takes from a battery, and how much of it a route may take: immutable. All 0 and no limit if not given.
///
/// Parameters
/// ----------
/// takeoff_j
///     The first take-off of a route, in joules.
/// leg_w
///     Power in watts while a leg cruises.
/// leg_stop_w
///     Power in watts while a leg stops and starts.
/// way_home_w
///     Power in watts on the way home, climb, wait and landing aside; without effect where the last leg is flown like the
///     others.
/// way_home_fixed_j
///     Climb, wait and landing on the way home, in joules; likewise.
/// usable_j
///     What a route may take, in joules; infinite where nothing limits it.
///
/// Raises
/// ------
/// InvalidInput
///     If a number is none. Whether it makes sense, `Problem` says.
#[pyclass(frozen, eq, module = "pondhop", from_py_object)]
#[derive(Clone, Copy, PartialEq)]
pub struct Energy {
    inner: pondhop_core::problem::Energy,
}

#[pymethods]
impl Energy {
    #[new]
    #[pyo3(signature = (*, takeoff_j=Real::of(0.0), leg_w=Real::of(0.0), leg_stop_w=Real::of(0.0), way_home_w=Real::of(0.0),
                        way_home_fixed_j=Real::of(0.0), usable_j=Real::of(f64::INFINITY)))]
    fn new(
        takeoff_j: Real,
        leg_w: Real,
        leg_stop_w: Real,
        way_home_w: Real,
        way_home_fixed_j: Real,
        usable_j: Real,
    ) -> PyResult<Self> {
        let mut faults = Faults::default();
        let inner = pondhop_core::problem::Energy {
            takeoff_energy: takeoff_j.number(&mut faults, "takeoff_j", 0.0),
            leg_power: leg_w.number(&mut faults, "leg_w", 0.0),
            leg_stop_power: leg_stop_w.number(&mut faults, "leg_stop_w", 0.0),
            way_home_power: way_home_w.number(&mut faults, "way_home_w", 0.0),
            way_home_fixed_energy: way_home_fixed_j.number(&mut faults, "way_home_fixed_j", 0.0),
            usable_energy: usable_j.number(&mut faults, "usable_j", f64::INFINITY),
        };
        faults.into_result(Self { inner }).map_err(|error| to_python(&error))
    }

    /// The first take-off of a route, in joules.
    #[getter]
    fn takeoff_j(&self) -> f64 {
        self.inner.takeoff_energy
    }

    /// Power in watts while a leg cruises.
    #[getter]
    fn leg_w(&self) -> f64 {
        self.inner.leg_power
    }

    /// Power in watts while a leg stops and starts.
    #[getter]
    fn leg_stop_w(&self) -> f64 {
        self.inner.leg_stop_power
    }

    /// Power in watts on the way home.
    #[getter]
    fn way_home_w(&self) -> f64 {
        self.inner.way_home_power
    }

    /// Climb, wait and landing on the way home, in joules.
    #[getter]
    fn way_home_fixed_j(&self) -> f64 {
        self.inner.way_home_fixed_energy
    }

    /// What a route may take, in joules; infinite where nothing limits it.
    #[getter]
    fn usable_j(&self) -> f64 {
        self.inner.usable_energy
    }

    /// The same with some arguments changed.
    ///
    /// Parameters
    /// ----------
    /// **changes
    ///     Arguments as of `Energy`.
    ///
    /// Raises
    /// ------
    /// InvalidInput
    ///     As `Energy`.
    /// TypeError
    ///     If there is no such argument.
    #[pyo3(signature = (**changes))]
    fn replace<'py>(&self, py: Python<'py>, changes: Option<&Bound<'py, PyDict>>) -> PyResult<Bound<'py, PyAny>> {
        let arguments = self.arguments(py)?;
        if let Some(changes) = changes {
            arguments.update(changes.as_mapping())?;
        }
        py.get_type::<Self>().call((), Some(&arguments))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced::<Self>(py, &self.arguments(py)?)
    }

    fn __hash__(&self) -> u64 {
        hash_of(self.fields().map(|(_, value)| value))
    }

    fn __repr__(&self) -> String {
        let fields = self.fields().map(|(name, value)| format!("{name}={value:?}"));
        format!("Energy({})", fields.join(", "))
    }
}

impl Energy {
    fn arguments<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let arguments = PyDict::new(py);
        for (name, value) in self.fields() {
            arguments.set_item(name, value)?;
        }
        Ok(arguments)
    }

    fn fields(&self) -> [(&'static str, f64); 6] {
        [
            ("takeoff_j", self.takeoff_j()),
            ("leg_w", self.leg_w()),
            ("leg_stop_w", self.leg_stop_w()),
            ("way_home_w", self.way_home_w()),
            ("way_home_fixed_j", self.way_home_fixed_j()),
            ("usable_j", self.usable_j()),
        ]
    }
}

/// A depot, the ponds to visit and a fleet of equal drones: validated, immutable.
///
/// Arrays may be of any real number type, or lists. Problems compare by value and can be pickled.
///
/// Parameters
/// ----------
/// depot
///     Position of the depot, shape (2,): metres, or unitless in research instances.
/// ponds
///     Positions of the ponds, shape (n, 2), n >= 1.
/// num_drones
///     How many drones there are; a plan has at most that many routes.
/// service_durations_s
///     Time on station per pond in seconds, shape (n,); 0 everywhere if not given.
/// speed_m_s
///     Ground speed.
/// leg_stop_s
///     What stopping and starting adds to every leg.
/// max_length_m, max_duration_s
///     Longest route in metres and in seconds that a drone can fly.
/// takeoff_s
///     What a route takes before its first leg: the first take-off.
/// way_home_speed_m_s
///     Ground speed of the last leg, where the autopilot flies it in a way of its own (return to launch). That leg takes
///     ``length / way_home_speed_m_s + way_home_fixed_s``; if not given, it is flown like the others.
/// way_home_fixed_s
///     Climb to the return height, wait and landing; only with `way_home_speed_m_s`.
/// service_energies_j
///     What the time on station takes from the battery per pond in joules, shape (n,); 0 everywhere if not given.
/// energy
///     What flying takes from the battery, and how much a route may take; all 0 and no limit if not given.
/// layers
///     Shape (k, 4), where each drone flies out and home at a height of its own: `takeoff_s`, `way_home_fixed_s`, and the
///     `takeoff_j` and `way_home_fixed_j` of `energy`, for route i of a plan in row i; routes beyond have the last. Only
///     `evaluate` counts with them: planners plan by the values that all drones share.
///
/// Raises
/// ------
/// InvalidInput
///     With every fault of the input: its place, what is wrong, what to do. Coordinates are at most 1e9 in size,
///     speeds 1e-6 to 1e6, durations at most 1e9, powers at most 1e9, energies at most 1e12, so that all that is computed from
///     them is finite.
/// TypeError
///     If there is no such argument.
#[pyclass(frozen, eq, module = "pondhop")]
#[derive(PartialEq)]
pub struct Problem {
    pub inner: Arc<pondhop_core::problem::Problem>,
}

#[pymethods]
impl Problem {
    #[new]
    #[pyo3(signature = (depot, ponds, num_drones, *, service_durations_s=None, speed_m_s=Real::of(1.0), leg_stop_s=Real::of(0.0),
                        max_length_m=Real::of(f64::INFINITY), max_duration_s=Real::of(f64::INFINITY), takeoff_s=Real::of(0.0),
                        way_home_speed_m_s=None, way_home_fixed_s=Real::of(0.0), service_energies_j=None, energy=None, layers=None))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        depot: &Bound<'_, PyAny>,
        ponds: &Bound<'_, PyAny>,
        num_drones: &Bound<'_, PyAny>,
        service_durations_s: Option<&Bound<'_, PyAny>>,
        speed_m_s: Real,
        leg_stop_s: Real,
        max_length_m: Real,
        max_duration_s: Real,
        takeoff_s: Real,
        way_home_speed_m_s: Option<Real>,
        way_home_fixed_s: Real,
        service_energies_j: Option<&Bound<'_, PyAny>>,
        energy: Option<&Bound<'_, PyAny>>,
        layers: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let mut faults = Faults::default();
        // What is at fault is replaced by what is not, so that the core looks at all the rest.
        let depot = arguments::point(&mut faults, "depot", depot)?.unwrap_or_default();
        let positions = arguments::points(&mut faults, "ponds", ponds)?;
        let num_available = arguments::num_drones(&mut faults, num_drones)?;
        let num_ponds = positions.as_ref().map(Vec::len).filter(|&num_ponds| num_ponds > 0);
        let durations = arguments::values(&mut faults, "service_durations_s", service_durations_s, num_ponds)?;
        let energies = arguments::values(&mut faults, "service_energies_j", service_energies_j, num_ponds)?;
        let visits = positions.unwrap_or_else(|| vec![Point::default()]).into_iter();
        let visits = visits.zip(durations.into_iter().chain(repeat(0.0))).zip(energies.into_iter().chain(repeat(0.0)));
        let visits = visits
            .map(|((position, service_duration), service_energy)| Visit { position, service_duration, service_energy })
            .collect();
        let fixed_duration = way_home_fixed_s.number(&mut faults, "way_home_fixed_s", 0.0);
        let way_home = way_home_speed_m_s
            .map(|speed| WayHome { speed: speed.number(&mut faults, "way_home_speed_m_s", 1.0), fixed_duration });
        if way_home.is_none() && fixed_duration != 0.0 {
            let message = "there is a fixed time, but no speed of the way home";
            faults.add("way_home_fixed_s", message, "give way_home_speed_m_s too, or neither");
        }
        let vehicle_type = VehicleType {
            num_available,
            speed: speed_m_s.number(&mut faults, "speed_m_s", 1.0),
            leg_stop_duration: leg_stop_s.number(&mut faults, "leg_stop_s", 0.0),
            takeoff_duration: takeoff_s.number(&mut faults, "takeoff_s", 0.0),
            way_home,
            energy: energy
                .map_or(Ok(pondhop_core::problem::Energy::UNKNOWN), |energy| inner_energy(&mut faults, energy))?,
            max_length: max_length_m.number(&mut faults, "max_length_m", f64::INFINITY),
            max_duration: max_duration_s.number(&mut faults, "max_duration_s", f64::INFINITY),
        };
        let layers = arguments::layers(&mut faults, "layers", layers)?;
        let checked = pondhop_core::problem::Problem::new(Depot { position: depot }, visits, vehicle_type)
            .and_then(|problem| problem.with_layers(layers));
        let inner = faults.with(checked).map_err(|error| to_python(&error))?;
        Ok(Self { inner: Arc::new(inner) })
    }

    /// The problem with some arguments changed, validated anew.
    ///
    /// Parameters
    /// ----------
    /// **changes
    ///     Arguments as of `Problem`.
    ///
    /// Raises
    /// ------
    /// InvalidInput
    ///     As `Problem`: also if the ponds are others in number and the values per pond are kept.
    /// TypeError
    ///     If there is no such argument.
    #[pyo3(signature = (**changes))]
    fn replace<'py>(&self, py: Python<'py>, changes: Option<&Bound<'py, PyDict>>) -> PyResult<Bound<'py, PyAny>> {
        let arguments = self.arguments(py)?;
        if let Some(changes) = changes {
            arguments.update(changes.as_mapping())?;
        }
        py.get_type::<Self>().call((), Some(&arguments))
    }

    /// Position of the depot, shape (2,).
    #[getter]
    fn depot<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let position = self.inner.depot().position;
        [position.x, position.y].to_pyarray(py)
    }

    /// Positions of the ponds, shape (n, 2).
    #[getter]
    fn ponds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        table(py, self.inner.visits().iter().flat_map(|visit| [visit.position.x, visit.position.y]), 2)
    }

    /// Number of ponds.
    #[getter]
    fn num_ponds(&self) -> usize {
        self.inner.num_visits()
    }

    /// Number of drones.
    #[getter]
    fn num_drones(&self) -> usize {
        self.inner.vehicle_type().num_available
    }

    /// Time on station per pond in seconds, shape (n,).
    #[getter]
    fn service_durations_s<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.per_pond(py, |visit| visit.service_duration)
    }

    /// What the time on station takes from the battery per pond in joules, shape (n,).
    #[getter]
    fn service_energies_j<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.per_pond(py, |visit| visit.service_energy)
    }

    /// Ground speed in metres per second.
    #[getter]
    fn speed_m_s(&self) -> f64 {
        self.inner.vehicle_type().speed
    }

    /// What stopping and starting adds to every leg, in seconds.
    #[getter]
    fn leg_stop_s(&self) -> f64 {
        self.inner.vehicle_type().leg_stop_duration
    }

    /// What a route takes before its first leg, in seconds.
    #[getter]
    fn takeoff_s(&self) -> f64 {
        self.inner.vehicle_type().takeoff_duration
    }

    /// Ground speed of the last leg in metres per second; None where it is flown like the others.
    #[getter]
    fn way_home_speed_m_s(&self) -> Option<f64> {
        self.inner.vehicle_type().way_home.map(|way_home| way_home.speed)
    }

    /// Climb, wait and landing on the way home, in seconds; 0 where the last leg is flown like the others.
    #[getter]
    fn way_home_fixed_s(&self) -> f64 {
        self.inner.vehicle_type().way_home.map_or(0.0, |way_home| way_home.fixed_duration)
    }

    /// What flying takes from the battery.
    #[getter]
    fn energy(&self) -> Energy {
        Energy { inner: self.inner.vehicle_type().energy }
    }

    /// What take-off and way home take by route, shape (k, 4); of no rows where all drones fly alike.
    #[getter]
    fn layers<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = self.inner.layers().iter().flat_map(|layer| {
            [layer.takeoff_duration, layer.way_home_duration, layer.takeoff_energy, layer.way_home_energy]
        });
        table(py, rows, 4)
    }

    /// Longest route in metres that a drone can fly; infinite where nothing limits it.
    #[getter]
    fn max_length_m(&self) -> f64 {
        self.inner.vehicle_type().max_length
    }

    /// Longest route in seconds that a drone can fly; infinite where nothing limits it.
    #[getter]
    fn max_duration_s(&self) -> f64 {
        self.inner.vehicle_type().max_duration
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced::<Self>(py, &self.arguments(py)?)
    }

    fn __hash__(&self) -> u64 {
        let visits = self.inner.visits().iter();
        let places = visits.flat_map(|visit| [visit.position.x, visit.position.y, visit.service_duration]);
        hash_of(self.settings().into_iter().map(|(_, value)| value).chain(places))
    }

    fn __repr__(&self) -> String {
        let unlimited = VehicleType::unlimited(1);
        let mut shown = vec![format!("num_ponds={}", self.num_ponds()), format!("num_drones={}", self.num_drones())];
        let plain = Self::settings_of(&unlimited);
        let changed = self.settings().into_iter().zip(plain).filter(|(own, plain)| own.1 != plain.1);
        shown.extend(changed.map(|((name, value), _)| format!("{name}={value:?}")));
        if self.inner.vehicle_type().energy != unlimited.energy {
            shown.push(format!("energy={}", self.energy().__repr__()));
        }
        format!("Problem({})", shown.join(", "))
    }
}

fn inner_energy(faults: &mut Faults, value: &Bound<'_, PyAny>) -> PyResult<pondhop_core::problem::Energy> {
    if let Ok(energy) = value.extract::<Energy>() {
        return Ok(energy.inner);
    }
    faults.add("energy", format!("it is {}", arguments::shown(value)?), "give a pondhop.Energy");
    Ok(pondhop_core::problem::Energy::UNKNOWN)
}

impl Problem {
    fn per_pond<'py>(&self, py: Python<'py>, value: fn(&Visit) -> f64) -> Bound<'py, PyArray1<f64>> {
        self.inner.visits().iter().map(value).collect::<Vec<f64>>().to_pyarray(py)
    }

    /// What to call `Problem` with for the same problem. Values per pond that are all 0 are left out, so that other ponds need
    /// none.
    fn arguments<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let arguments = PyDict::new(py);
        arguments.set_item("depot", self.depot(py))?;
        arguments.set_item("ponds", self.ponds(py)?)?;
        arguments.set_item("num_drones", self.num_drones())?;
        for (name, value) in self.settings() {
            arguments.set_item(name, value)?;
        }
        if self.way_home_speed_m_s().is_none() {
            arguments.set_item("way_home_speed_m_s", py.None())?;
        }
        arguments.set_item("energy", Bound::new(py, self.energy())?)?;
        if self.inner.visits().iter().any(|visit| visit.service_duration != 0.0) {
            arguments.set_item("service_durations_s", self.service_durations_s(py))?;
        }
        if self.inner.visits().iter().any(|visit| visit.service_energy != 0.0) {
            arguments.set_item("service_energies_j", self.service_energies_j(py))?;
        }
        if !self.inner.layers().is_empty() {
            arguments.set_item("layers", self.layers(py)?)?;
        }
        Ok(arguments)
    }

    fn settings(&self) -> [(&'static str, f64); 7] {
        Self::settings_of(&self.inner.vehicle_type())
    }

    /// All numbers of the drones by their names in Python, energy aside; a way home like the other legs has speed 0.
    fn settings_of(vehicle_type: &VehicleType) -> [(&'static str, f64); 7] {
        [
            ("speed_m_s", vehicle_type.speed),
            ("leg_stop_s", vehicle_type.leg_stop_duration),
            ("takeoff_s", vehicle_type.takeoff_duration),
            ("way_home_speed_m_s", vehicle_type.way_home.map_or(0.0, |way_home| way_home.speed)),
            ("way_home_fixed_s", vehicle_type.way_home.map_or(0.0, |way_home| way_home.fixed_duration)),
            ("max_length_m", vehicle_type.max_length),
            ("max_duration_s", vehicle_type.max_duration),
        ]
    }
}
