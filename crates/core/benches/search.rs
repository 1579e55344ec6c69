//! Time of the search: a thousand steps from a given plan, and a whole short search; neighbour lists are in both.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use pondhop_core::generate::{Variant, generate};
use pondhop_core::problem::Problem;
use pondhop_core::search::{Options, solve};

const SIZES: [usize; 4] = [50, 700, 10_000, 100_000];
const NUM_STEPS: u64 = 1_000;

fn search(criterion: &mut Criterion) {
    for num_ponds in SIZES {
        let farm = generate(num_ponds, Variant::Authors, 1).expect("a farm of the paper's generator");
        let problem = Problem::research(farm.depot, &farm.ponds, 5).expect("a valid farm");
        let options = Options { max_iterations: Some(NUM_STEPS), ..Options::default() };
        let start = solve(&problem, &options).routes;
        let resumed = Options { start: Some(&start), ..options };
        for (name, options) in [("search from nothing", options), ("search from a plan", resumed)] {
            criterion.bench_function(&format!("{name}/{num_ponds}"), |bencher| {
                bencher.iter(|| solve(black_box(&problem), &options));
            });
        }
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10);
    targets = search
}
criterion_main!(benches);
