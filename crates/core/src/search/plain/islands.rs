//! Several populations one after the other, then the best of all of them together.
//!
//! Problem: children make the plans of one population alike long before a long search ends. On one in ten farms of 100 ponds
//! all of them then lie in one basin, which is not the best, and no number of further children leaves it.
//!
//! Source: the island model (Cohoon, Hegde, Martin and Richards, ICGA 1987): populations that breed apart keep what one alone
//! loses. Changed: they meet only once, at the end, and breed one after the other, so that a plan depends on the effort alone.

use super::construct::Cuts;
use super::context::Search;
use super::population::{Breeding, Population};
use super::starts::Starts;
use crate::effort::Effort;

/// Share of the effort for the islands; the rest is for the best of all of them together.
const ISLANDS_END: f64 = 0.6;
/// Steps per visit of an island: at least the first, and the second times the number of visits.
const ISLAND_STEPS_PER_VISIT: (f64, f64) = (150.0, 3.0);
const MAX_ISLANDS: usize = 8;
/// Plans of each island that live on.
const NUM_SURVIVORS: usize = 2;
/// Steps that take as long as making a start, per visit.
const START_STEPS_PER_VISIT: f64 = 0.3;

/// The plans of one thread when its starts have raced; where the effort allows several islands, when all of them have bred.
pub(super) fn settle<'a>(
    search: &'a Search<'a>,
    cuts: &'a Cuts<'a>,
    effort: &mut Effort<'_>,
    thread: usize,
) -> Population<'a> {
    let mut starts = Starts::new(search, cuts, thread);
    let begin = effort.share();
    let first = starts.make();
    let start_steps = START_STEPS_PER_VISIT * search.network.num_visits as f64;
    // Steps a visit that the whole effort is worth.
    let steps_per_visit = START_STEPS_PER_VISIT / search.budget.share_of_work(start_steps, begin);
    let num_islands = num_islands(search, steps_per_visit);
    let breeding = |island: usize, begin, end| Breeding {
        begin,
        end,
        steps_per_visit,
        stream: (thread + island * search.options.num_threads) as u64,
        recuts_along: (num_islands > 1).then_some(cuts),
        longest_elsewhere: f64::INFINITY,
    };
    if num_islands == 1 {
        let mut population = Population::new(search, vec![first], breeding(0, 0.0, 1.0));
        population.race(search, effort, &mut starts);
        return population;
    }
    starts.has_random_cuts = true;
    let (mut first, mut survivors, mut longest) = (Some(first), Vec::new(), f64::INFINITY);
    for island in 0..num_islands {
        let begin = effort.share();
        if island > 0 && begin >= ISLANDS_END {
            break;
        }
        let end = begin + (ISLANDS_END - begin).max(0.0) / (num_islands - island) as f64;
        let start = first.take().unwrap_or_else(|| starts.make());
        let breeding = Breeding { longest_elsewhere: longest, ..breeding(island, begin, end) };
        let mut population = Population::new(search, vec![start], breeding);
        population.race(search, effort, &mut starts);
        population.breed(search, effort, end, search.floor());
        longest = longest.min(population.best().best.max_route_cost());
        if longest <= search.floor() {
            // What none can undercut need not be found twice, and the total needs all plans.
            survivors.extend(population.into_chains());
            break;
        }
        survivors.extend(population.into_chains().take(NUM_SURVIVORS));
    }
    Population::new(search, survivors, breeding(num_islands, 0.0, 1.0))
}

fn num_islands(search: &Search<'_>, steps_per_visit: f64) -> usize {
    if search.network.num_routes == 1 {
        return 1;
    }
    let least_steps_per_visit =
        ISLAND_STEPS_PER_VISIT.0.max(ISLAND_STEPS_PER_VISIT.1 * search.network.num_visits as f64);
    ((ISLANDS_END * steps_per_visit / least_steps_per_visit) as usize).clamp(1, MAX_ISLANDS)
}
