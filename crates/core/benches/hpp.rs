//! Time of HPP on the paper's farms: one farm an iteration.
#![allow(missing_docs)]

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use pondhop_core::generate::{Variant, generate};
use pondhop_core::hpp::plan;
use pondhop_core::problem::Problem;

fn farms_of_the_paper(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("hpp");
    for num_ponds in [50, 100, 200, 300, 500, 700] {
        let problems: Vec<Problem> = (0..20)
            .map(|seed| {
                let farm = generate(num_ponds, Variant::Authors, seed).expect("a farm of the paper's sizes");
                Problem::research(farm.depot, &farm.ponds, 5).expect("a valid farm")
            })
            .collect();
        let mut next = problems.iter().cycle();
        group.bench_function(BenchmarkId::from_parameter(num_ponds), |bencher| {
            bencher.iter(|| next.next().map(|problem| plan(problem, 1)));
        });
    }
    group.finish();
}

criterion_group!(benches, farms_of_the_paper);
criterion_main!(benches);
