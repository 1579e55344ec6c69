//! Costs of fixed seeds. A change that keeps the trajectory of the search leaves them as they are; one that changes it brings
//! a table of the benchmark before and after in its commit message, and new costs here (CONTRIBUTING.md).

use pondhop_core::evaluate::evaluate;
use pondhop_core::generate::{Variant, generate};
use pondhop_core::problem::Problem;
use pondhop_core::search::{Options, solve};

/// Ponds, routes, iterations, threads; longest route and total.
const GOLDEN: [(usize, usize, u64, usize, f64, f64); 8] = [
    (1, 3, 100, 1, 0.46758357013394874, 0.46758357013394874),
    (50, 5, 2_000, 1, 1.2087488828887454, 5.757651057758714),
    (50, 5, 2_000, 2, 1.2087488828887454, 5.760595523469253),
    (50, 5, 10_000, 2, 1.2087082111840566, 5.745356195951569),
    (50, 5, 60_000, 2, 1.2086395990215717, 5.97270693048202),
    (200, 5, 20_000, 1, 1.5870378998408436, 7.8882175927335005),
    (700, 7, 5_000, 1, 2.0092815980435312, 14.032077435645068),
    (700, 7, 20_000, 1, 2.0247039075363813, 14.120315809200921),
];

#[test]
fn costs_of_fixed_seeds() {
    let costs = GOLDEN.map(|(num_ponds, num_routes, iterations, num_threads, ..)| {
        let farm = generate(num_ponds, Variant::Authors, 3).unwrap();
        let problem = Problem::research(farm.depot, &farm.ponds, num_routes).unwrap();
        let options = Options { seed: 1, max_iterations: Some(iterations), num_threads, ..Options::default() };
        let plan = evaluate(&problem, &solve(&problem, &options).routes).unwrap();
        assert!(plan.is_feasible());
        (num_ponds, num_routes, iterations, num_threads, plan.max_route_length(), plan.total_length())
    });
    assert_eq!(costs, GOLDEN);
}
