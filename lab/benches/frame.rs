//! Whole frames and each of their stages on generated sheets, flat and crumpled: from nothing, and again and again.

#[path = "../tests/support/sheet.rs"]
#[allow(dead_code, clippy::unwrap_used, reason = "a part of what the tests use")]
mod sheet;

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use untangle::{analysis::Analyser, stage::{Stage, StageObserver}, frame::Frame, settings::Settings, untangler::Untangler};

/// Sheets of twice the square of these.
const RESOLUTIONS: [u32; 4] = [35, 125, 250, 500];

const STAGES: [(Stage, &str); 5] = [
    (Stage::Intersect, "search"),
    (Stage::Paths, "paths"),
    (Stage::Regions, "regions"),
    (Stage::Correspond, "targets"),
    (Stage::Respond, "response"),
];

/// Times one stage.
struct Watch {
    stage: Stage,
    since: Option<Instant>,
    spent: Duration,
}

impl StageObserver for Watch {
    fn begin(&mut self, stage: Stage) {
        self.end();
        self.since = (stage == self.stage).then(Instant::now);
    }

    fn end(&mut self) {
        self.spent += self.since.take().map_or(Duration::ZERO, |since| since.elapsed());
    }
}

fn states(sheet: &sheet::Sheet) -> [(&'static str, Vec<[f64; 3]>); 2] {
    let flat = sheet.uvs.iter().map(|&[u, v]| [u, v, 0.1 * u * v]).collect();
    [("untangled", flat), ("tangled", sheet.positions.clone())]
}

fn analyse(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("analyse");
    group.sample_size(20);
    for resolution in RESOLUTIONS {
        let crumpled = sheet::crumpled(7, resolution);
        let mesh = crumpled.mesh();
        let num_faces = mesh.num_faces();
        for (state, positions) in &states(&crumpled) {
            let frame = Frame::new(&mesh, positions).expect("generated positions are finite");
            let mut analyser = Analyser::default();
            for (memory, keeps) in [("cold", false), ("coherent", true)] {
                let id = BenchmarkId::new(format!("{state}/{memory}"), num_faces);
                group.bench_with_input(id, &frame, |bencher, frame| {
                    bencher.iter(|| {
                        if !keeps {
                            analyser.clear_cache();
                        }
                        analyser.analyse(&mesh, frame, &Settings::default(), &mut ()).paths.pairs.len()
                    });
                });
            }
        }
    }
    group.finish();
}

fn stages(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("stages");
    group.sample_size(20);
    for resolution in RESOLUTIONS {
        let crumpled = sheet::crumpled(7, resolution);
        let mesh = Arc::new(crumpled.mesh());
        let num_faces = mesh.num_faces();
        for (state, positions) in &states(&crumpled) {
            let frame = Frame::new(&mesh, positions).expect("generated positions are finite");
            let mut untangler =
                Untangler::new(mesh.clone(), Settings::default()).expect("the default settings suit every mesh");
            for (stage, name) in STAGES {
                group.bench_with_input(
                    BenchmarkId::new(format!("{state}/{name}"), num_faces),
                    &frame,
                    |bencher, frame| {
                        bencher.iter_custom(|num_rounds| {
                            let mut watch = Watch { stage, since: None, spent: Duration::ZERO };
                            for _ in 0..num_rounds {
                                untangler.process(frame, &mut watch);
                            }
                            // A stage with nothing to do takes no time at all, which is no measurement.
                            watch.spent.max(Duration::from_nanos(1))
                        });
                    },
                );
            }
        }
    }
    group.finish();
}

criterion_group!(benches, analyse, stages);
criterion_main!(benches);
