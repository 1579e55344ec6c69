//! The times of a piece of a trip, joined in constant time.
//!
//! Source: Vidal, Crainic, Gendreau and Prins, A hybrid genetic algorithm with adaptive diversity management for a large class
//! of vehicle routing problems with time windows, Computers and Operations Research 2013, section 4.3.1. Changed: no time is
//! warped; a piece that cannot be flown in time is none.

/// By how much sums of the same times differ at most; a window that is met but for this is met.
pub(super) const ROUNDING: f64 = 1e-7;

/// A piece of a trip: begun at any time from `earliest` to `latest` it takes `duration`; begun before, it waits until then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Segment {
    pub duration: f64,
    pub earliest: f64,
    pub latest: f64,
}

impl Default for Segment {
    fn default() -> Self {
        Self::NOTHING
    }
}

impl Segment {
    /// What takes no time at any time.
    pub const NOTHING: Self = Self { duration: 0.0, earliest: f64::NEG_INFINITY, latest: f64::INFINITY };

    /// What takes this long, at any time.
    #[inline]
    pub const fn lasting(duration: f64) -> Self {
        Self { duration, ..Self::NOTHING }
    }

    /// This, a leg, and then `next`; `None` if `next` cannot be reached in time.
    #[inline]
    pub fn join(self, leg: f64, next: Self) -> Option<Self> {
        let delta = self.duration + leg;
        if self.earliest + delta > next.latest + ROUNDING {
            return None;
        }
        let wait = (next.earliest - delta - self.latest).max(0.0);
        Some(Self {
            duration: delta + next.duration + wait,
            earliest: (next.earliest - delta).max(self.earliest) - wait,
            latest: (next.latest - delta).min(self.latest),
        })
    }

    /// The same, not begun before `time`; `None` if it must be begun before.
    #[inline]
    pub fn not_before(self, time: f64) -> Option<Self> {
        (time <= self.latest + ROUNDING).then(|| Self { earliest: self.earliest.max(time), ..self })
    }

    /// When it ends if it can be begun at `ready`; `None` if that is too late.
    #[inline]
    pub fn end(self, ready: f64) -> Option<f64> {
        (ready <= self.latest + ROUNDING).then(|| self.earliest.max(ready) + self.duration)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Flies pieces with legs between them one after the other, from a start.
    fn fly(pieces: &[(f64, Segment)], start: f64) -> Option<f64> {
        let mut clock = start;
        for &(leg, piece) in pieces {
            clock = (clock + leg).max(piece.earliest);
            if clock > piece.latest {
                return None;
            }
            clock += piece.duration;
        }
        Some(clock)
    }

    #[test]
    fn a_wait_is_spent_before_the_take_off() {
        // Two ponds A [0, 20] and B [100, 120], each 10 s from all, 5 s: out at 10 at the latest, 65 s of wait in the air.
        let pond = |earliest, latest| Segment { duration: 5.0, earliest, latest };
        let trip = Segment::NOTHING.join(10.0, pond(0.0, 20.0)).unwrap();
        let trip = trip.join(10.0, pond(100.0, 120.0)).unwrap().join(10.0, Segment::NOTHING).unwrap();
        assert_eq!((trip.duration, trip.earliest, trip.latest), (105.0, 10.0, 10.0));
        assert_eq!((trip.end(0.0), trip.end(10.0), trip.end(11.0)), (Some(115.0), Some(115.0), None));
    }

    proptest! {
        /// Joined in any order, segments end when a flight of their pieces ends.
        #[test]
        fn joined_pieces_end_as_flown(
            pieces in prop::collection::vec((0_u32..20, 0_u32..10, 0_u32..60, 0_u32..40), 1..7),
            cut in 0_usize..6,
            start in 0_u32..80,
        ) {
            let pieces: Vec<(f64, Segment)> = pieces
                .into_iter()
                .map(|(leg, duration, earliest, width)| {
                    let (earliest, latest) = (f64::from(earliest), f64::from(earliest + width));
                    (f64::from(leg), Segment { duration: f64::from(duration), earliest, latest })
                })
                .collect();
            let join = |pieces: &[(f64, Segment)], begin: Segment| {
                pieces.iter().try_fold(begin, |whole, &(leg, piece)| whole.join(leg, piece))
            };
            let cut = cut.min(pieces.len() - 1);
            let (left, right) = pieces.split_at(cut);
            let at_once = join(&pieces, Segment::NOTHING);
            let parted = join(&right[1..], right[0].1)
                .and_then(|behind| join(left, Segment::NOTHING).and_then(|before| before.join(right[0].0, behind)));
            prop_assert_eq!(at_once.is_some(), parted.is_some());
            let start = f64::from(start);
            let flown = fly(&pieces, start);
            prop_assert_eq!(at_once.and_then(|whole| whole.end(start)), flown);
            prop_assert_eq!(parted.and_then(|whole| whole.end(start)), flown);
        }
    }
}
