//! Time of what every planner, judge and benchmark stands on: one farm of the paper's generator an iteration.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use pondhop_core::bound::lower_bound;
use pondhop_core::evaluate::evaluate;
use pondhop_core::generate::{Variant, generate};
use pondhop_core::geometry::Point;
use pondhop_core::hpp::plan;
use pondhop_core::neighbours::KdTree;
use pondhop_core::problem::Problem;
use pondhop_core::separation::separation;

const SIZES: [usize; 3] = [50, 700, 10_000];
const NUM_NEIGHBOURS: usize = 24;

/// A farm, planned.
struct Case {
    ponds: Vec<Point>,
    problem: Problem,
    routes: Vec<Vec<usize>>,
}

/// Several farms of each size, because one may be cheaper than another.
fn cases(num_ponds: usize) -> Vec<Case> {
    (0..4)
        .map(|seed| {
            let farm = generate(num_ponds, Variant::Authors, seed).expect("a farm of the paper's generator");
            let problem = Problem::research(farm.depot, &farm.ponds, 5).expect("a valid farm");
            let routes = plan(&problem, 1);
            Case { ponds: farm.ponds, problem, routes }
        })
        .collect()
}

fn foundations(criterion: &mut Criterion) {
    let sizes: Vec<(usize, Vec<Case>)> = SIZES.into_iter().map(|num_ponds| (num_ponds, cases(num_ponds))).collect();
    let mut of_each_size = |name: &str, work: &dyn Fn(&Case)| {
        let mut group = criterion.benchmark_group(name);
        for (num_ponds, cases) in &sizes {
            let mut next = cases.iter().cycle();
            group.bench_function(BenchmarkId::from_parameter(num_ponds), |bencher| {
                bencher.iter(|| next.next().map(work));
            });
        }
        group.finish();
    };
    of_each_size("evaluate", &|case| {
        black_box(evaluate(&case.problem, &case.routes).expect("ponds that exist"));
    });
    of_each_size("separation", &|case| {
        black_box(separation(&case.problem, &case.routes).expect("ponds that exist"));
    });
    of_each_size("lower_bound", &|case| {
        black_box(lower_bound(&case.problem));
    });
    of_each_size("nearest_neighbours", &|case| {
        let tree = KdTree::new(&case.ponds);
        let mut found = Vec::new();
        for pond in 0..case.ponds.len() {
            tree.nearest(pond, NUM_NEIGHBOURS, &mut found);
            black_box(&found);
        }
    });
    of_each_size("generate", &|case| {
        black_box(generate(case.ponds.len(), Variant::Authors, 1).expect("a farm of the paper's generator"));
    });
}

criterion_group!(benches, foundations);
criterion_main!(benches);
