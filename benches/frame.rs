//! Whole frames of analysis on generated sheets, flat and crumpled: from nothing, and again and again.

#[path = "../tests/support/sheet.rs"]
#[allow(dead_code, clippy::unwrap_used, reason = "a part of what the tests use")]
mod sheet;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use untangled::{analysis::Analyser, frame::Frame, settings::Settings};

fn analyse(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("analyse");
    group.sample_size(20);
    for resolution in [35, 125] {
        let crumpled = sheet::crumpled(7, resolution);
        let mesh = crumpled.mesh();
        let flat: Vec<[f64; 3]> = crumpled.uvs.iter().map(|&[u, v]| [u, v, 0.1 * u * v]).collect();
        let num_faces = mesh.num_faces();
        for (state, positions) in [("untangled", &flat), ("tangled", &crumpled.positions)] {
            let frame = Frame::new(&mesh, positions).expect("generated positions are finite");
            let mut analyser = Analyser::default();
            for (memory, keeps) in [("cold", false), ("coherent", true)] {
                let id = BenchmarkId::new(format!("{state}/{memory}"), num_faces);
                group.bench_with_input(id, &frame, |bencher, frame| {
                    bencher.iter(|| {
                        if !keeps {
                            analyser.forget();
                        }
                        analyser.analyse(&mesh, frame, &Settings::default(), &mut ()).paths.pairs.len()
                    });
                });
            }
        }
    }
    group.finish();
}

criterion_group!(benches, analyse);
criterion_main!(benches);
