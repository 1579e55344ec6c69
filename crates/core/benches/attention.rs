//! Time of the attention model on the paper's farms, with weights that nobody trained: one farm an iteration.
#![allow(missing_docs)]

#[path = "../tests/attention_models/mod.rs"]
mod attention_models;

use attention_models::random_tensors;
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use pondhop_core::attention::{Architecture, Decoding, Model, Variant};
use pondhop_core::generate::{Variant as FarmVariant, generate};
use pondhop_core::problem::Problem;

fn farms_of_the_paper(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("attention");
    for (name, variant) in [("cvrp", Variant::Cvrp), ("minmax", Variant::MinMax)] {
        let architecture = Architecture { variant, width: 128, num_heads: 8, num_layers: 3, feed_forward_width: 512 };
        let model = Model::new(architecture, random_tensors(&architecture, 1)).expect("tensors of the architecture");
        for (num_ponds, decoding) in [
            (50, Decoding::Greedy),
            (50, Decoding::Symmetries),
            (50, Decoding::Sampling { num_samples: 128 }),
            (100, Decoding::Greedy),
            (700, Decoding::Greedy),
        ] {
            let farm = generate(num_ponds, FarmVariant::Authors, 1).expect("a farm of the paper's sizes");
            let problem = Problem::research(farm.depot, &farm.ponds, 5).expect("a valid farm");
            let id = BenchmarkId::new(format!("{name} {decoding:?}"), num_ponds);
            group.bench_function(id, |bencher| bencher.iter(|| model.plan(&problem, decoding, 1)));
        }
    }
    group.finish();
}

criterion_group!(benches, farms_of_the_paper);
criterion_main!(benches);
