//! Frames in which nearly everything meets nearly everything: what a search keeps, and where it ends.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use untangle::{
    analysis::Analyser,
    frame::Frame,
    intersect::{Intersections, Intersector, SearchEnd, SearchLimits},
    mesh::{Mesh, MeshDescription},
    settings::Settings,
    stage::{Stage, StageObserver},
};
use untangled_testkit::{generate::crumpled, judge::brute_force};

fn mesh(num_vertices: u32, faces: Vec<[u32; 3]>) -> Mesh {
    Mesh::new(MeshDescription { num_vertices: num_vertices as usize, faces, ..Default::default() }).unwrap()
}

/// Triangles without common vertices.
fn separate_faces(num_faces: u32) -> Mesh {
    mesh(3 * num_faces, (0..num_faces).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect())
}

/// Slivers along one diagonal of a cube, side by side: all boxes overlap, and nothing intersects.
fn diagonal_slivers(num_faces: u32) -> (Mesh, Frame) {
    let mesh = separate_faces(num_faces);
    let corner = |index: u32| {
        let aside = 1e-4 * f64::from(index / 3);
        match index % 3 {
            0 => [aside, -aside, 0.0],
            1 => [1.0 + aside, 1.0 - aside, 1.0],
            _ => [1.0 + aside, 1.0 - aside, 1.0 + 1e-3],
        }
    };
    let positions: Vec<_> = (0..3 * num_faces).map(corner).collect();
    let frame = Frame::new(&mesh, &positions).unwrap();
    (mesh, frame)
}

/// Triangles as large as the whole scene.
fn exploded(num_faces: u32) -> (Mesh, Frame) {
    let mesh = separate_faces(num_faces);
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let positions: Vec<[f64; 3]> =
        (0..3 * num_faces).map(|_| std::array::from_fn(|_| rng.random_range(-1.0..1.0))).collect();
    let frame = Frame::new(&mesh, &positions).unwrap();
    (mesh, frame)
}

/// Triangles all of whose corners are in one place.
fn in_one_place(num_faces: u32) -> (Mesh, Frame) {
    let mesh = separate_faces(num_faces);
    let frame = Frame::new(&mesh, &vec![[0.0; 3]; 3 * num_faces as usize]).unwrap();
    (mesh, frame)
}

/// Faces round one vertex, which stands in the middle of a circle with waves, and comes back from `turns` turns.
fn wheel(num_faces: u32, turns: f64, height: f64) -> (Mesh, Frame) {
    let faces = (0..num_faces).map(|face| [0, 1 + face, 1 + (face + 1) % num_faces]).collect();
    let mesh = mesh(num_faces + 1, faces);
    let rim = (0..num_faces).map(|face| {
        let angle = std::f64::consts::TAU * turns * f64::from(face) / f64::from(num_faces);
        let waves = height * (7.0 * angle + f64::from(face % 3)).sin();
        [angle.cos() + 0.2 * height * (5.0 * angle).cos(), angle.sin(), waves]
    });
    let positions: Vec<_> = std::iter::once([0.0; 3]).chain(rim).collect();
    let frame = Frame::new(&mesh, &positions).unwrap();
    (mesh, frame)
}

/// Time for so many questions, how many were asked, and the stage that is at work.
struct Questions {
    left: usize,
    num_asked: usize,
    stage: Stage,
}

impl Questions {
    fn new(left: usize) -> Self {
        Self { left, num_asked: 0, stage: Stage::Intersect }
    }
}

impl StageObserver for Questions {
    fn begin(&mut self, stage: Stage) {
        if self.left > 0 {
            self.stage = stage;
        }
    }
    fn end(&mut self) {}
    fn is_spent(&mut self) -> bool {
        self.num_asked += 1;
        self.left = self.left.saturating_sub(1);
        self.left == 0
    }
}

#[test]
fn search_of_overlapping_boxes_keeps_no_pair_that_does_not_intersect() {
    let (mesh, frame) = diagonal_slivers(4_000);
    let (mut intersector, mut found) = (Intersector::default(), Intersections::default());
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let memory = pool.install(|| allocation_counter::measure(|| intersector.intersect(&mesh, &frame, &mut found)));
    assert!(found.segments.is_empty());
    // Eight million pairs; the tree and its adjacency take some hundred bytes for each face.
    assert!(memory.bytes_max < 4_000_000, "{} bytes", memory.bytes_max);
}

#[test]
fn search_beyond_a_limit_ends_so_on_any_threads_and_after_any_frames() {
    let (mesh, frame) = exploded(600);
    let (mut all, mut found) = (Intersections::default(), Intersections::default());
    Intersector::default().intersect(&mesh, &frame, &mut all);
    let num_pairs = all.segments.len() as u64;
    assert!(num_pairs > 10_000);
    for num_threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(num_threads).build().unwrap();
        let mut intersector = Intersector::default();
        // The same frame again and again: the later ones find certificates, unless the limit forbids them.
        for (max_found, end) in [
            (num_pairs, SearchEnd::Complete),
            (num_pairs - 1, SearchEnd::TooManyPairs),
            (num_pairs - 1, SearchEnd::TooManyPairs),
            (num_pairs, SearchEnd::Complete),
            (1, SearchEnd::TooManyPairs),
        ] {
            let limits = SearchLimits { max_found, ..SearchLimits::NONE };
            let ended = pool.install(|| intersector.intersect_within(&mesh, &frame, limits, &mut (), &mut found));
            assert_eq!(ended, end, "{max_found} on {num_threads} threads");
            let expected = if end == SearchEnd::Complete { &all.segments[..] } else { &[] };
            assert_eq!(found.segments, expected);
        }
    }
}

#[test]
fn search_counts_the_same_overlapping_boxes_with_and_without_certificates() {
    let sheet = crumpled(3, 30);
    let mesh = sheet.mesh();
    let frame = sheet.frame(&mesh);
    let mut found = Intersections::default();
    let mut cold = |max_tested| {
        let limits = SearchLimits { max_tested, ..SearchLimits::NONE };
        Intersector::default().intersect_within(&mesh, &frame, limits, &mut (), &mut found)
    };
    let (mut least, mut most) = (1, 1 << 20);
    while least < most {
        let middle = (least + most) / 2;
        (least, most) = if cold(middle) == SearchEnd::Complete { (least, middle) } else { (middle + 1, most) };
    }
    assert!(least > 1_000, "{least} pairs of boxes");
    let mut intersector = Intersector::default();
    for max_tested in [u64::MAX, u64::MAX, u64::MAX, least, least - 1, least, u64::MAX, least - 1] {
        let limits = SearchLimits { max_tested, ..SearchLimits::NONE };
        let end = intersector.intersect_within(&mesh, &frame, limits, &mut (), &mut found);
        let expected = if max_tested < least { SearchEnd::TooManyPairs } else { SearchEnd::Complete };
        assert_eq!(end, expected, "{max_tested} where {least} overlap");
    }
}

#[test]
fn analyser_out_of_time_within_the_search_finds_nothing_and_says_so() {
    for (mesh, frame) in [exploded(1_500), in_one_place(1_500)] {
        let unlimited = Settings { max_face_pairs: Some(u64::MAX), ..Settings::default() };
        let mut analyser = Analyser::default();
        let mut questions = Questions::new(usize::MAX);
        analyser.analyse(&mesh, &frame, &unlimited, &mut questions);
        assert_eq!(analyser.search_end(), SearchEnd::Complete);
        assert!(questions.num_asked > 10, "{} questions", questions.num_asked);
        let mut impatient = Questions::new(2);
        let analysis = analyser.analyse(&mesh, &frame, &unlimited, &mut impatient);
        assert!(analysis.intersections.edge_face.is_empty() && analysis.paths.pairs.is_empty());
        assert_eq!((analyser.search_end(), impatient.num_asked), (SearchEnd::OutOfTime, 2));
    }
}

#[test]
fn analyser_out_of_time_within_the_tracing_of_paths_finds_nothing_and_says_so() {
    let (mesh, frame) = exploded(600);
    let mut analyser = Analyser::default();
    let mut last_stage = None;
    for num_questions in 1.. {
        let mut questions = Questions::new(num_questions);
        let analysis = analyser.analyse(&mesh, &frame, &Settings::default(), &mut questions);
        let num_found = (analysis.intersections.segments.len(), analysis.paths.pairs.len());
        if analyser.search_end() == SearchEnd::Complete {
            assert!(num_found.0 > 10_000 && num_found.1 > 0, "{num_found:?}");
            break;
        }
        assert_eq!((analyser.search_end(), num_found), (SearchEnd::OutOfTime, (0, 0)));
        last_stage = Some(questions.stage);
    }
    assert_eq!(last_stage, Some(Stage::Paths));
}

#[test]
fn analyser_with_default_limits_ends_exploded_and_zeroed_frames() {
    for (mesh, frame) in [exploded(1_500), in_one_place(4_200)] {
        let mut analyser = Analyser::default();
        analyser.analyse(&mesh, &frame, &Settings::default(), &mut ());
        assert_eq!(analyser.search_end(), SearchEnd::TooManyPairs);
    }
}

#[test]
fn search_round_a_vertex_of_many_faces_equals_brute_force() {
    let mut num_found = 0;
    for (turns, height) in [(1.0, 0.0), (1.0, 0.4), (2.0, 0.3), (3.0, 0.1), (0.5, 0.5)] {
        for num_faces in [65, 120] {
            let (mesh, frame) = wheel(num_faces, turns, height);
            let analysis = untangle::analysis::analyse(&mesh, &frame);
            brute_force::assert_equal(&format!("{num_faces}, {turns}, {height}"), &mesh, &frame, &analysis);
            num_found += analysis.intersections.segments.len();
        }
    }
    assert!(num_found > 100, "{num_found} intersections");
}

#[test]
fn search_round_a_vertex_of_many_faces_tests_few_of_their_pairs() {
    let limits = SearchLimits { max_tested: 500_000, ..SearchLimits::NONE };
    let mut found = Intersections::default();
    // In one plane, as a cone with waves, and as a spiral of two turns, one layer over the other but for the seam.
    for (turns, height) in [(1.0, 0.0), (1.0, 0.2), (2.0, 0.0)] {
        let (mesh, frame) = wheel(20_000, turns, height);
        let mut intersector = Intersector::default();
        for _ in 0..3 {
            let end = intersector.intersect_within(&mesh, &frame, limits, &mut (), &mut found);
            assert_eq!(end, SearchEnd::Complete, "{turns} turns, height {height}");
        }
    }
}

/// The sheet with one of its vertices so far away.
fn flung(resolution: u32, far: f64) -> (Mesh, Frame) {
    let mut sheet = crumpled(3, resolution);
    let mesh = sheet.mesh();
    let middle = sheet.positions.len() / 2;
    sheet.positions[middle] = [far, 0.3 * far, -far];
    let frame = sheet.frame(&mesh);
    (mesh, frame)
}

#[test]
fn search_with_a_vertex_far_away_equals_brute_force() {
    for far in [1e3, 1e5, -1e9, 1e30, 1e70] {
        let (mesh, frame) = flung(16, far);
        let analysis = untangle::analysis::analyse(&mesh, &frame);
        assert!(!analysis.intersections.segments.is_empty());
        brute_force::assert_equal(&format!("{far}"), &mesh, &frame, &analysis);
    }
}

#[test]
fn search_with_a_vertex_far_away_tests_few_more_boxes() {
    let limits = SearchLimits { max_tested: 1_000_000, ..SearchLimits::NONE };
    let (mesh, usual) = flung(50, 1.0);
    let mut intersector = Intersector::default();
    let mut found = Intersections::default();
    // The frames between find the caches of each other.
    for far in [1e9, 1.0, 1e9, 1e9, -1e30, 1e70, 1.0_f64] {
        let frame = if far.abs() > 1.0 { flung(50, far).1 } else { usual.clone() };
        let end = intersector.intersect_within(&mesh, &frame, limits, &mut (), &mut found);
        assert_eq!(end, SearchEnd::Complete, "{far}");
    }
}
