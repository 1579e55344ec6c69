//! What is minimised: the longest route, a little the mean one, or the total under a cap; and by what plans are compared.

use std::cmp::Ordering;

/// Costs of the routes of a plan.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RouteCosts {
    pub longest: f64,
    pub total: f64,
}

impl RouteCosts {
    /// Of routes that cost this each.
    pub fn of(costs: &[f64]) -> Self {
        Self { longest: costs.iter().copied().fold(0.0, f64::max), total: costs.iter().sum() }
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
}

/// Weight of the mean route beside the longest: without it, shortening any other route would not count.
const MEAN_WEIGHT: f64 = 0.02;

impl Objective {
    /// The longest route, and a little the mean one of `num_routes`, from a plan with these costs on.
    pub fn longest_route(num_routes: usize, costs: RouteCosts) -> Self {
        let total_weight = MEAN_WEIGHT / num_routes as f64;
        Self { max_weight: 1.0, total_weight, cap: f64::INFINITY, target: costs.longest }
    }

    /// Only the total, while no route may become longer than `cap`.
    pub fn total_within(cap: f64) -> Self {
        Self { max_weight: 0.0, total_weight: 1.0, cap, target: cap }
    }

    /// The same, now that a plan with these costs is known: no route should become longer than its longest one, if that counts at
    /// all.
    pub fn aimed_at(self, costs: RouteCosts) -> Self {
        let target = if self.max_weight > 0.0 { self.target.min(costs.longest) } else { self.target };
        Self { target, ..self }
    }

    /// What a plan with routes of these costs costs.
    pub fn value(&self, costs: RouteCosts) -> f64 {
        self.max_weight * costs.longest + self.total_weight * costs.total
    }

    /// By what two plans are compared in the end: the longest route first, if it counts, then the total. The value, which
    /// guides the search, would take a longer route for a shorter total.
    pub fn rank(&self, costs: RouteCosts) -> Rank {
        Rank { longest: if self.max_weight > 0.0 { costs.longest } else { 0.0 }, total: costs.total }
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
    longest: f64,
    total: f64,
}

impl Rank {
    pub fn new(longest: f64, total: f64) -> Self {
        Self { longest, total }
    }

    /// Orders two ranks, the better one first.
    pub fn compare(&self, other: &Self) -> Ordering {
        self.longest.total_cmp(&other.longest).then(self.total.total_cmp(&other.total))
    }

    /// Whether this is equal to `other` but for rounding.
    pub fn is_about(&self, other: &Self) -> bool {
        is_about(self.longest, other.longest) && is_about(self.total, other.total)
    }

    /// Whether this is better than `other`, and not only by rounding.
    pub fn is_clearly_better(&self, other: &Self) -> bool {
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

    /// A limit that may be used up must not be pulled down by the plans on the way.
    #[test]
    fn a_better_plan_lowers_the_target_only_if_the_longest_route_counts() {
        let costs = |costs: [f64; 2]| RouteCosts::of(&costs);
        let (together, apart) = (costs([8.0, 0.0]), costs([6.0, 2.0]));
        let longest = Objective::longest_route(2, together);
        assert_eq!(longest.target, 8.0);
        assert_eq!(longest.aimed_at(apart).target, 6.0);
        assert_eq!(longest.aimed_at(apart).aimed_at(together).target, 6.0);
        assert_eq!(Objective::total_within(9.0).aimed_at(apart).target, 9.0);
    }

    #[test]
    fn equal_longest_routes_are_judged_by_the_total() {
        let (base, rounded) = (Rank::new(2.0, 9.0), Rank::new(2.0 * (1.0 - 1e-12), 9.5));
        assert!(rounded.is_better(&base) && !rounded.is_clearly_better(&base) && base.is_clearly_better(&rounded));
        assert!(Rank::new(1.9, 9.5).is_clearly_better(&base) && !base.is_clearly_better(&Rank::new(1.9, 9.5)));
        assert!(!base.is_clearly_better(&base));
        // Where up to 2.5 the longest route does not matter, a plan beyond is worse, whatever its total.
        let within = |longest: f64, total| Rank::new(longest.max(2.5), total);
        assert!(within(2.4, 9.0).is_clearly_better(&within(2.0, 9.5)));
        assert!(within(2.4, 9.0).is_clearly_better(&within(2.6, 8.0)));
    }
}
