//! What is minimised: the longest route, a little the mean one, or the total under a cap; and by what plans are compared.

use std::cmp::Ordering;

/// Costs of the routes of a plan.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RouteCosts {
    pub longest: f64,
    pub total: f64,
    /// By how much routes exceed their limits of other things, in shares of those, summed.
    pub excess: f64,
}

impl RouteCosts {
    /// Of routes that cost this each and exceed no limit.
    pub fn of(costs: &[f64]) -> Self {
        Self { longest: costs.iter().copied().fold(0.0, f64::max), total: costs.iter().sum(), excess: 0.0 }
    }
}

/// What a plan costs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Objective {
    /// Weight of the longest route.
    pub max_weight: f64,
    /// Weight of the total.
    pub total_weight: f64,
    /// No route may become longer.
    pub cap: f64,
    /// Routes should not become longer.
    pub target: f64,
    /// What it costs to exceed a limit by the whole of it.
    pub excess_price: f64,
}

/// Weight of the mean route beside the longest: without it, shortening any other route would not count.
const MEAN_WEIGHT: f64 = 0.02;
/// What it costs to exceed a limit by the whole of it, in longest routes. At 30 or 100 plans stayed a thousandth above a limit that
/// others kept.
const EXCESS_PRICE: f64 = 1000.0;

impl Objective {
    /// The longest route, and a little the mean one of `num_routes`, from a plan with these costs on.
    pub fn longest_route(num_routes: usize, costs: RouteCosts) -> Self {
        let total_weight = MEAN_WEIGHT / num_routes as f64;
        Self {
            max_weight: 1.0,
            total_weight,
            cap: f64::INFINITY,
            target: costs.longest,
            excess_price: EXCESS_PRICE * costs.longest,
        }
    }

    /// Only the total, from a plan with these costs on, while no route may become longer than `cap`.
    pub fn total_within(cap: f64, costs: RouteCosts) -> Self {
        Self { max_weight: 0.0, total_weight: 1.0, cap, target: cap, excess_price: EXCESS_PRICE * costs.longest }
    }

    /// The same, now that a plan with these costs is known: no route should become longer than its longest one, if that counts at
    /// all.
    pub fn aimed_at(self, costs: RouteCosts) -> Self {
        let target = if self.max_weight > 0.0 { self.target.min(costs.longest) } else { self.target };
        Self { target, ..self }
    }

    /// What a plan with routes of these costs costs.
    pub fn value(&self, costs: RouteCosts) -> f64 {
        self.max_weight * costs.longest + self.total_weight * costs.total + self.excess_price * self.excess(costs)
    }

    /// By how much routes exceed the cap, of which no step makes them go beyond, but a plan may begin there; and other limits.
    fn excess(&self, costs: RouteCosts) -> f64 {
        costs.excess + if costs.longest > self.cap { costs.longest / self.cap - 1.0 } else { 0.0 }
    }

    /// By what two plans are compared in the end: the longest route first, if it counts, then the total. The value, which
    /// guides the search, would take a longer route for a shorter total.
    pub fn rank(&self, costs: RouteCosts) -> Rank {
        Rank {
            excess: self.excess(costs),
            longest: if self.max_weight > 0.0 { costs.longest } else { 0.0 },
            total: costs.total,
        }
    }
}

/// By how much sums of the same legs differ at most, after many changes.
const ROUNDING: f64 = 1e-8;

fn is_about(one: f64, other: f64) -> bool {
    (one - other).abs() <= ROUNDING * other
}

/// How good a plan is: less is better, the fields in falling order of importance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rank {
    excess: f64,
    longest: f64,
    total: f64,
}

impl Rank {
    /// Of plans with these costs, in which the longest route counts.
    pub fn of(costs: RouteCosts) -> Self {
        Self { excess: costs.excess, longest: costs.longest, total: costs.total }
    }

    /// The same, if up to the cost `free` the longest route does not matter.
    pub fn free_up_to(self, free: f64) -> Self {
        Self { longest: self.longest.max(free), ..self }
    }

    /// Whether no route exceeds a limit.
    pub fn is_within_limits(&self) -> bool {
        self.excess == 0.0
    }

    /// Orders two ranks, the better one first.
    pub fn compare(&self, other: &Self) -> Ordering {
        let by_excess = self.excess.total_cmp(&other.excess);
        by_excess.then(self.longest.total_cmp(&other.longest)).then(self.total.total_cmp(&other.total))
    }

    /// Whether this is equal to `other` but for rounding.
    pub fn is_about(&self, other: &Self) -> bool {
        is_about(self.excess, other.excess)
            && is_about(self.longest, other.longest)
            && is_about(self.total, other.total)
    }

    /// Whether this is better than `other`, and not only by rounding.
    pub fn is_clearly_better(&self, other: &Self) -> bool {
        if !is_about(self.excess, other.excess) {
            return self.excess < other.excess;
        }
        if is_about(self.longest, other.longest) { self.total < other.total } else { self.longest < other.longest }
    }

    /// Whether this is better than `other`.
    pub fn is_better(&self, other: &Self) -> bool {
        self.compare(other) == Ordering::Less
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rank(longest: f64, total: f64) -> Rank {
        Rank::of(RouteCosts { longest, total, excess: 0.0 })
    }

    /// A limit that may be used up must not be pulled down by the plans on the way.
    #[test]
    fn a_better_plan_lowers_the_target_only_if_the_longest_route_counts() {
        let costs = |costs: [f64; 2]| RouteCosts::of(&costs);
        let (together, apart) = (costs([8.0, 0.0]), costs([6.0, 2.0]));
        let longest = Objective::longest_route(2, together);
        assert_eq!(longest.target, 8.0);
        assert_eq!(longest.aimed_at(apart).target, 6.0);
        assert_eq!(longest.aimed_at(apart).aimed_at(together).target, 6.0);
        assert_eq!(Objective::total_within(9.0, together).aimed_at(apart).target, 9.0);
    }

    #[test]
    fn equal_longest_routes_are_judged_by_the_total() {
        let (base, rounded) = (rank(2.0, 9.0), rank(2.0 * (1.0 - 1e-12), 9.5));
        assert!(rounded.is_better(&base) && !rounded.is_clearly_better(&base) && base.is_clearly_better(&rounded));
        assert!(rank(1.9, 9.5).is_clearly_better(&base) && !base.is_clearly_better(&rank(1.9, 9.5)));
        assert!(!base.is_clearly_better(&base));
        // Where up to 2.5 the longest route does not matter, a plan beyond is worse, whatever its total.
        let within = |longest, total| rank(longest, total).free_up_to(2.5);
        assert!(within(2.4, 9.0).is_clearly_better(&within(2.0, 9.5)));
        assert!(within(2.4, 9.0).is_clearly_better(&within(2.6, 8.0)));
    }

    #[test]
    fn a_plan_within_its_limits_is_better_than_one_beyond() {
        let costs = |longest, excess| RouteCosts { longest, total: longest, excess };
        let (within, beyond) = (Rank::of(costs(9.0, 0.0)), Rank::of(costs(2.0, 1e-3)));
        assert!(within.is_better(&beyond) && within.is_clearly_better(&beyond) && !beyond.is_clearly_better(&within));
        let objective = Objective::longest_route(2, costs(2.0, 0.0));
        assert!(objective.value(costs(2.0, 0.01)) > objective.value(costs(2.5, 0.0)));
    }
}
