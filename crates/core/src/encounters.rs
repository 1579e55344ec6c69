//! Where drones come too near to each other at the same moment: found exactly, piece of flight against piece of flight.
//!
//! A drone moves in straight lines at constant speed between knots. Two drones meet while they are nearer than a distance
//! horizontally *and* nearer than a height vertically: a cylinder, as aviation has it. During the time that two pieces have in
//! common their difference is linear in time, so the horizontal condition is an interval between the roots of a quadratic, the
//! vertical one an interval between two times, and the encounter their intersection. Pieces of two tracks are walked through in
//! the order of time: O(m^2 k) for m tracks of k knots, less for tracks that share no time.

use crate::error::{Faults, InvalidInput};

/// Where a drone is at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knot {
    /// In seconds.
    pub time: f64,
    /// Metres east, north and up.
    pub position: [f64; 3],
}

/// One flight of a drone, from its first knot to its last.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Whose it is: flights of one drone are never compared.
    pub drone: usize,
    /// In the order of time; at least one.
    pub knots: Vec<Knot>,
}

/// How far apart drones must be at the same moment: the one or the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apart {
    /// Metres.
    pub horizontal: f64,
    /// Metres.
    pub vertical: f64,
}

/// A time during which two drones are too near to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encounter {
    /// Indices of the tracks, the lesser first.
    pub tracks: (usize, usize),
    /// From when to when, in seconds.
    pub begin: f64,
    /// Likewise.
    pub end: f64,
    /// When they are nearest to each other horizontally in this time.
    pub time: f64,
    /// Metres between them then, horizontally and vertically.
    pub horizontal: f64,
    /// Likewise.
    pub vertical: f64,
}

/// Where two drones are nearest to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Metres, whatever the direction.
    pub distance: f64,
    /// Indices of the tracks, the lesser first.
    pub tracks: (usize, usize),
    /// When, in seconds.
    pub time: f64,
}

/// Finds every encounter of drones, in the order of their begin; only those of track `of` where it is given.
///
/// # Errors
/// [`InvalidInput`] with every track that has no knot, a number that is none, or times that fall.
pub fn encounters(tracks: &[Track], apart: Apart, of: Option<usize>) -> Result<Vec<Encounter>, InvalidInput> {
    check(tracks, apart)?;
    let mut found = Vec::new();
    for (one, first) in tracks.iter().enumerate() {
        for (other, second) in tracks.iter().enumerate().skip(one + 1) {
            if first.drone != second.drone && of.is_none_or(|of| of == one || of == other) {
                meet(first, second, apart, |piece| add(&mut found, (one, other), piece));
            }
        }
    }
    found.sort_by(|one, other| one.begin.total_cmp(&other.begin).then(one.tracks.cmp(&other.tracks)));
    Ok(found)
}

/// The least distance between two drones at the same moment; `None` if no two ever fly at the same time.
///
/// # Errors
/// As [`encounters`].
pub fn least_distance(tracks: &[Track]) -> Result<Option<Nearest>, InvalidInput> {
    check(tracks, Apart { horizontal: 0.0, vertical: 0.0 })?;
    let mut least: Option<Nearest> = None;
    for (one, first) in tracks.iter().enumerate() {
        for (other, second) in tracks.iter().enumerate().skip(one + 1).filter(|(_, second)| first.drone != second.drone)
        {
            pieces(first, second, |begin, end, at, velocity| {
                let squared: f64 = velocity.iter().map(|part| part * part).sum();
                let product: f64 = at.iter().zip(velocity).map(|(part, speed)| part * speed).sum();
                let after = if squared > 0.0 { (-product / squared).clamp(0.0, end - begin) } else { 0.0 };
                let distance =
                    at.iter().zip(velocity).map(|(part, speed)| (part + speed * after).powi(2)).sum::<f64>().sqrt();
                if least.is_none_or(|least| distance < least.distance) {
                    least = Some(Nearest { distance, tracks: (one, other), time: begin + after });
                }
            });
        }
    }
    Ok(least)
}

fn check(tracks: &[Track], apart: Apart) -> Result<(), InvalidInput> {
    let mut faults = Faults::default();
    if !(apart.horizontal >= 0.0 && apart.vertical >= 0.0) {
        faults.add("apart", format!("the distances are {apart:?}"), "give metres, 0 or more");
    }
    for (index, track) in tracks.iter().enumerate() {
        if track.knots.is_empty() {
            faults.add(format!("tracks[{index}]"), "it has no knot", "leave it out");
        }
        for (order, knot) in track.knots.iter().enumerate() {
            if !(knot.time.is_finite() && knot.position.iter().all(|part| part.is_finite())) {
                faults.add(
                    format!("tracks[{index}].knots[{order}]"),
                    "it has a number that is none",
                    "give finite numbers",
                );
            } else if order > 0 && knot.time < track.knots[order - 1].time {
                faults.add(
                    format!("tracks[{index}].knots[{order}]"),
                    "its time is before the one before",
                    "sort the knots",
                );
            }
        }
    }
    faults.into_result(())
}

/// Walks through the times during which both tracks move in a straight line: begin, end, the way from the first drone to the
/// second at the begin, and how fast that changes.
fn pieces(first: &Track, second: &Track, mut visit: impl FnMut(f64, f64, [f64; 3], [f64; 3])) {
    let (mut one, mut other) = (0, 0);
    while one + 1 < first.knots.len() && other + 1 < second.knots.len() {
        let (from, to) = (first.knots[one], first.knots[one + 1]);
        let (other_from, other_to) = (second.knots[other], second.knots[other + 1]);
        let (begin, end) = (from.time.max(other_from.time), to.time.min(other_to.time));
        if begin <= end && from.time < to.time && other_from.time < other_to.time {
            let (at, velocity) = state(from, to, begin);
            let (other_at, other_velocity) = state(other_from, other_to, begin);
            let difference = |own: [f64; 3], others: [f64; 3]| [0, 1, 2].map(|axis| others[axis] - own[axis]);
            visit(begin, end, difference(at, other_at), difference(velocity, other_velocity));
        }
        if to.time <= other_to.time { one += 1 } else { other += 1 }
    }
}

fn state(from: Knot, to: Knot, time: f64) -> ([f64; 3], [f64; 3]) {
    let velocity = [0, 1, 2].map(|axis| (to.position[axis] - from.position[axis]) / (to.time - from.time));
    ([0, 1, 2].map(|axis| from.position[axis] + velocity[axis] * (time - from.time)), velocity)
}

/// A time of encounter within one pair of pieces.
struct Piece {
    begin: f64,
    end: f64,
    time: f64,
    horizontal: f64,
    vertical: f64,
}

fn meet(first: &Track, second: &Track, apart: Apart, mut found: impl FnMut(Piece)) {
    pieces(first, second, |begin, end, at, velocity| {
        let span = end - begin;
        let Some((from, to)) = below(quadratic(at, velocity), apart.horizontal * apart.horizontal, span) else {
            return;
        };
        let Some((low, high)) = within(at[2], velocity[2], apart.vertical, span) else { return };
        let (from, to) = (from.max(low), to.min(high));
        if from >= to {
            return;
        }
        let [squared, product, _] = quadratic(at, velocity);
        let nearest = if squared > 0.0 { (-product / squared).clamp(from, to) } else { from };
        let part = |axis: usize| at[axis] + velocity[axis] * nearest;
        found(Piece {
            begin: begin + from,
            end: begin + to,
            time: begin + nearest,
            horizontal: (part(0) * part(0) + part(1) * part(1)).sqrt(),
            vertical: part(2).abs(),
        });
    });
}

/// a, b and c of the squared horizontal distance a t^2 + 2 b t + c.
fn quadratic(at: [f64; 3], velocity: [f64; 3]) -> [f64; 3] {
    [
        velocity[0] * velocity[0] + velocity[1] * velocity[1],
        at[0] * velocity[0] + at[1] * velocity[1],
        at[0] * at[0] + at[1] * at[1],
    ]
}

/// When in 0 to `span` the quadratic is below `limit`.
fn below([squared, product, constant]: [f64; 3], limit: f64, span: f64) -> Option<(f64, f64)> {
    if squared <= 0.0 {
        return (constant < limit).then_some((0.0, span));
    }
    let discriminant = product * product - squared * (constant - limit);
    if discriminant <= 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    let (from, to) = (((-product - root) / squared).max(0.0), ((-product + root) / squared).min(span));
    (from < to).then_some((from, to))
}

/// When in 0 to `span` a height that changes steadily is nearer to 0 than `limit`.
fn within(height: f64, rate: f64, limit: f64, span: f64) -> Option<(f64, f64)> {
    if rate == 0.0 {
        return (height.abs() < limit).then_some((0.0, span));
    }
    let (one, other) = ((-limit - height) / rate, (limit - height) / rate);
    let (from, to) = (one.min(other).max(0.0), one.max(other).min(span));
    (from < to).then_some((from, to))
}

/// By how much the end of one piece and the begin of the next differ at most.
const ROUNDING: f64 = 1e-6;

/// Notes a piece; one that goes on where the last of the same tracks ended belongs to it.
fn add(found: &mut Vec<Encounter>, tracks: (usize, usize), piece: Piece) {
    if let Some(last) = found.last_mut().filter(|last| last.tracks == tracks && piece.begin <= last.end + ROUNDING) {
        last.end = last.end.max(piece.end);
        if piece.horizontal < last.horizontal {
            (last.time, last.horizontal, last.vertical) = (piece.time, piece.horizontal, piece.vertical);
        }
        return;
    }
    let Piece { begin, end, time, horizontal, vertical } = piece;
    found.push(Encounter { tracks, begin, end, time, horizontal, vertical });
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const APART: Apart = Apart { horizontal: 15.0, vertical: 2.0 };

    fn track(drone: usize, knots: &[(f64, f64, f64, f64)]) -> Track {
        let knots = knots.iter().map(|&(time, x, y, z)| Knot { time, position: [x, y, z] }).collect();
        Track { drone, knots }
    }

    fn found(tracks: &[Track]) -> Vec<Encounter> {
        encounters(tracks, APART, None).unwrap()
    }

    #[test]
    fn drones_that_fly_towards_each_other_meet() {
        // 200 m apart at 5 m/s each: 15 m apart after 18.5 s, together after 20 s.
        let tracks = [
            track(0, &[(0.0, 0.0, 0.0, 7.0), (40.0, 200.0, 0.0, 7.0)]),
            track(1, &[(0.0, 200.0, 0.0, 7.0), (40.0, 0.0, 0.0, 7.0)]),
        ];
        let [encounter] = found(&tracks)[..] else { panic!("one encounter") };
        assert!((encounter.begin - 18.5).abs() < 1e-9 && (encounter.end - 21.5).abs() < 1e-9);
        assert!((encounter.time - 20.0).abs() < 1e-9 && encounter.horizontal < 1e-9);
        // One above the other, or one drone on two tracks, they do not.
        let mut above = tracks.clone();
        above[1].knots.iter_mut().for_each(|knot| knot.position[2] = 9.0);
        assert!(found(&above).is_empty());
        let mut own = tracks;
        own[1].drone = 0;
        assert!(found(&own).is_empty());
    }

    #[test]
    fn a_climb_through_the_height_of_another_is_an_encounter_while_it_lasts() {
        // 5 m aside, from 0 to 20 m in 10 s: within 2 m of 7 m from 2.5 s to 4.5 s.
        let tracks = [
            track(0, &[(0.0, 0.0, 0.0, 7.0), (10.0, 0.0, 0.0, 7.0)]),
            track(1, &[(0.0, 5.0, 0.0, 0.0), (10.0, 5.0, 0.0, 20.0)]),
        ];
        let [encounter] = found(&tracks)[..] else { panic!("one encounter") };
        assert!((encounter.begin - 2.5).abs() < 1e-9 && (encounter.end - 4.5).abs() < 1e-9);
    }

    #[test]
    fn what_goes_on_over_several_pieces_is_one_encounter_and_touching_is_none() {
        let still = track(0, &[(0.0, 0.0, 0.0, 7.0), (100.0, 0.0, 0.0, 7.0)]);
        let knots: Vec<(f64, f64, f64, f64)> =
            (0..=20).map(|step| (f64::from(step), f64::from(step) - 10.0, 3.0, 7.0)).collect();
        let [encounter] = found(&[still.clone(), track(1, &knots)])[..] else { panic!("one encounter") };
        assert_eq!((encounter.begin, encounter.end, encounter.horizontal), (0.0, 20.0, 3.0));
        let passing = track(1, &[(0.0, -50.0, 15.0, 7.0), (20.0, 50.0, 15.0, 7.0)]);
        assert!(found(&[still, passing]).is_empty());
    }

    #[test]
    fn the_least_distance_is_told_with_its_time() {
        let tracks = [
            track(0, &[(0.0, 0.0, 0.0, 0.0), (10.0, 100.0, 0.0, 0.0)]),
            track(1, &[(2.0, 50.0, 3.0, 4.0), (8.0, 50.0, 3.0, 4.0)]),
        ];
        let Nearest { distance, tracks: pair, time } = least_distance(&tracks).unwrap().unwrap();
        assert!((distance - 5.0).abs() < 1e-9 && pair == (0, 1) && (time - 5.0).abs() < 1e-9);
        assert_eq!(
            least_distance(&[tracks[0].clone(), track(1, &[(20.0, 0.0, 0.0, 0.0), (30.0, 0.0, 0.0, 0.0)])]).unwrap(),
            None
        );
    }

    #[test]
    fn tracks_that_are_none_are_told() {
        let tracks =
            [track(0, &[]), track(1, &[(1.0, 0.0, 0.0, 0.0), (0.0, f64::NAN, 0.0, 0.0), (0.5, 0.0, 0.0, 0.0)])];
        let error = encounters(&tracks, APART, None).unwrap_err();
        let paths: Vec<&str> = error.faults.iter().map(|fault| fault.path.as_str()).collect();
        assert_eq!(paths, ["tracks[0]", "tracks[1].knots[1]"]);
    }

    proptest! {
        /// Looking at many moments finds no encounter that is not told, and none that is not there.
        #[test]
        fn encounters_are_those_of_many_moments(
            paths in prop::collection::vec(prop::collection::vec((1_u32..8, -40_i32..40, -40_i32..40, 0_i32..12), 2..8), 2..4)
        ) {
            let tracks: Vec<Track> = paths.iter().enumerate().map(|(drone, steps)| {
                let mut time = 0.0;
                let knots = steps.iter().map(|&(wait, x, y, z)| {
                    time += f64::from(wait);
                    Knot { time, position: [f64::from(x), f64::from(y), f64::from(z)] }
                }).collect();
                Track { drone, knots }
            }).collect();
            let told = encounters(&tracks, APART, None).unwrap();
            for moment in 0..600 {
                let time = f64::from(moment) * 0.1;
                for one in 0..tracks.len() {
                    for other in one + 1..tracks.len() {
                        let (Some(at), Some(others)) = (at(&tracks[one], time), at(&tracks[other], time)) else { continue };
                        let horizontal = (at[0] - others[0]).hypot(at[1] - others[1]);
                        let vertical = (at[2] - others[2]).abs();
                        let is_told = |slack: f64| told.iter().any(|found| {
                            found.tracks == (one, other) && found.begin - slack <= time && time <= found.end + slack
                        });
                        if horizontal < 15.0 - 1e-6 && vertical < 2.0 - 1e-6 {
                            prop_assert!(is_told(1e-5));
                        } else if horizontal > 15.0 + 1e-6 || vertical > 2.0 + 1e-6 {
                            prop_assert!(!is_told(-1e-5));
                        }
                    }
                }
            }
        }
    }

    fn at(track: &Track, time: f64) -> Option<[f64; 3]> {
        let piece = track.knots.windows(2).find(|piece| piece[0].time <= time && time < piece[1].time)?;
        Some(state(piece[0], piece[1], time).0)
    }
}
