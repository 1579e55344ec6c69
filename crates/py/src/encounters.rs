//! `pondhop_core::encounters`.

use crate::error::to_python;
use numpy::PyReadonlyArray2;
use pondhop_core::encounters::{Apart, Knot, Track, encounters as all_encounters, least_distance as least};
use pyo3::prelude::*;

/// A flight: whose it is, and its knots, shape (k, 4): seconds, metres east, north and up.
type Flight<'py> = (usize, PyReadonlyArray2<'py, f64>);

/// Both tracks, begin, end, time of the least horizontal distance, that distance, and the vertical one then.
type Told = (usize, usize, f64, f64, f64, f64, f64);

/// Find where drones come too near to each other at the same moment.
///
/// Parameters
/// ----------
/// tracks
///     For each flight the drone, and its knots, shape (k, 4): seconds, metres east, north and up. Flights of one drone are not
///     compared.
/// horizontal_m, vertical_m
///     Drones are apart if they keep the one or the other.
/// of
///     Only encounters of this track; of all, if not given.
///
/// Returns
/// -------
/// list of tuple
///     Both tracks, begin, end, the time when they are nearest horizontally, how near then, and how far apart in height.
///
/// Raises
/// ------
/// InvalidInput
///     With every track that is none.
#[pyfunction]
#[pyo3(signature = (tracks, horizontal_m, vertical_m, of=None))]
pub fn encounters(
    tracks: Vec<Flight<'_>>,
    horizontal_m: f64,
    vertical_m: f64,
    of: Option<usize>,
) -> PyResult<Vec<Told>> {
    let apart = Apart { horizontal: horizontal_m, vertical: vertical_m };
    let found = all_encounters(&to_tracks(&tracks), apart, of).map_err(|error| to_python(&error))?;
    let told = |found: pondhop_core::encounters::Encounter| {
        let (one, other) = found.tracks;
        (one, other, found.begin, found.end, found.time, found.horizontal, found.vertical)
    };
    Ok(found.into_iter().map(told).collect())
}

/// The least distance between two drones at the same moment.
///
/// Parameters
/// ----------
/// tracks
///     As of `encounters`.
///
/// Returns
/// -------
/// tuple or None
///     Metres, both tracks, and when, in seconds; None if no two drones ever fly at the same time.
///
/// Raises
/// ------
/// InvalidInput
///     As `encounters`.
#[pyfunction]
pub fn least_distance(tracks: Vec<Flight<'_>>) -> PyResult<Option<(f64, usize, usize, f64)>> {
    let found = least(&to_tracks(&tracks)).map_err(|error| to_python(&error))?;
    Ok(found.map(|found| (found.distance, found.tracks.0, found.tracks.1, found.time)))
}

fn to_tracks(tracks: &[Flight<'_>]) -> Vec<Track> {
    let track = |(drone, knots): &Flight<'_>| {
        let number = |row: &[f64], column: usize| row.get(column).copied().unwrap_or(f64::NAN);
        let rows = knots.as_array();
        let knots = rows
            .rows()
            .into_iter()
            .map(|row| row.to_vec())
            .map(|row| Knot { time: number(&row, 0), position: [number(&row, 1), number(&row, 2), number(&row, 3)] });
        Track { drone: *drone, knots: knots.collect() }
    };
    tracks.iter().map(track).collect()
}
