//! `pondhop_core::error` as the Python exception `pondhop.InvalidInput`.

use pondhop_core::error::Fault;
use pyo3::prelude::*;

pyo3::import_exception!(pondhop.errors, InvalidInput);

/// Where the core finds a fault of a problem, and the argument of `pondhop.Problem` that it came from. A `#` stands for an
/// index.
const ARGUMENTS: [(&str, &str); 25] = [
    ("depot.position.x", "depot[0]"),
    ("depot.position.y", "depot[1]"),
    ("visits", "ponds"),
    ("visits[#].position.x", "ponds[#][0]"),
    ("visits[#].position.y", "ponds[#][1]"),
    ("visits[#].service_duration", "service_durations_s[#]"),
    ("visits[#].service_energy", "service_energies_j[#]"),
    ("vehicle_type.num_available", "num_drones"),
    ("vehicle_type.speed", "speed_m_s"),
    ("vehicle_type.leg_stop_duration", "leg_stop_s"),
    ("vehicle_type.takeoff_duration", "takeoff_s"),
    ("vehicle_type.way_home.speed", "way_home_speed_m_s"),
    ("vehicle_type.way_home.fixed_duration", "way_home_fixed_s"),
    ("vehicle_type.energy.takeoff_energy", "energy.takeoff_j"),
    ("vehicle_type.energy.leg_power", "energy.leg_w"),
    ("vehicle_type.energy.leg_stop_power", "energy.leg_stop_w"),
    ("vehicle_type.energy.way_home_power", "energy.way_home_w"),
    ("vehicle_type.energy.way_home_fixed_energy", "energy.way_home_fixed_j"),
    ("vehicle_type.energy.usable_energy", "energy.usable_j"),
    ("layers[#].takeoff_duration", "layers[#][0]"),
    ("layers[#].way_home_duration", "layers[#][1]"),
    ("layers[#].takeoff_energy", "layers[#][2]"),
    ("layers[#].way_home_energy", "layers[#][3]"),
    ("vehicle_type.max_length", "max_length_m"),
    ("vehicle_type.max_duration", "max_duration_s"),
];

/// The Python exception that carries the same faults, in the words of the Python API.
pub fn to_python(error: &pondhop_core::error::InvalidInput) -> PyErr {
    let of = |fault: &Fault| (argument_of(&fault.path), fault.message.clone(), fault.action.clone());
    let faults: Vec<(String, String, String)> = error.faults.iter().map(of).collect();
    InvalidInput::new_err((faults,))
}

fn argument_of(path: &str) -> String {
    let index = path.split_once('[').and_then(|(_, rest)| rest.split_once(']')).map_or("", |(index, _)| index);
    let pattern = if index.is_empty() { path.to_owned() } else { path.replacen(index, "#", 1) };
    match ARGUMENTS.iter().find(|(core, _)| *core == pattern) {
        Some((_, argument)) => argument.replace('#', index),
        // Routes and tensors have the same names in Python.
        None => path.to_owned(),
    }
}
