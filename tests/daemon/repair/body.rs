//! Sessions with a body, outside of which the cloth belongs.

use std::time::Duration;

use untangled_client::{Precision, RegisterError, Registration, Repair, RequestError, Session, Status, flags};
use untangled_testkit::{
    generate::Sheet,
    process::{Daemon, PATIENCE, STEP, TestDomain},
};

use super::cloth::Tangle;

/// Long enough on any machine.
const LONG: Duration = Duration::from_secs(600);

/// Two balls that overlap, so that the body intersects itself, and a belt round the first.
struct Dressed {
    all: Tangle,
    body: Vec<u32>,
}

impl Dressed {
    fn new(radius: f64, shift: f64) -> Self {
        let mut sheet = Sheet::default();
        sheet.add_ball([0.0; 3], 1.0, 16);
        sheet.add_ball([0.0, 0.0, 1.2], 1.0, 16);
        let body = (0..u32::try_from(sheet.positions.len()).unwrap()).collect();
        sheet.add_tube(radius, [-0.25, 0.25], [36, 3], |_, _| [shift, 0.01, 0.02]);
        let all = Tangle { positions: sheet.positions, triangles: sheet.faces, pins: Vec::new() };
        Self { all, body }
    }

    fn registration(&self, precision: Precision) -> Registration {
        Registration { body: self.body.clone(), ..self.all.registration(precision) }
    }

    fn repair(&self, session: &mut Session, precision: Precision) -> Repair {
        match precision {
            Precision::F32 => session.repair(STEP, LONG, |slots| slots.copy_from_slice(&self.all.positions_f32())),
            Precision::F64 => session.repair_f64(STEP, LONG, |slots| slots.copy_from_slice(&self.all.positions)),
        }
        .unwrap()
    }

    /// Least distance of a vertex of the belt from the centre of the ball.
    fn least_radius(&self, positions: &[[f64; 3]]) -> f64 {
        let radius = |at: &[f64; 3]| at.iter().map(|value| value * value).sum::<f64>().sqrt();
        positions[self.body.len()..].iter().map(radius).fold(f64::INFINITY, f64::min)
    }
}

#[test]
fn repair_of_belts_through_and_inside_of_a_ball_ends_outside_and_leaves_the_body() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    for (radius, shift, precision) in [(1.01, 0.04, Precision::F32), (0.8, 0.0, Precision::F64)] {
        let scene = Dressed::new(radius, shift);
        assert!(scene.least_radius(&scene.all.positions) < 0.98);
        let mut session = client.register(scene.registration(precision)).unwrap();
        let repair = scene.repair(&mut session, precision);
        let header = *repair.header();
        assert!(repair.is_certified() && header.num_inside_body == 0 && header.num_moved > 0, "{header:?}");
        let repaired = scene.all.repaired(&repair);
        // Flat faces of a ball of 16 rings come that much nearer to its centre than its vertices.
        assert!(scene.least_radius(&repaired) > 0.96, "{}", scene.least_radius(&repaired));
        let is_zero = |index: usize| match (repair.displacements_f32(), repair.displacements_f64()) {
            (Some(steps), _) => steps[index].iter().all(|value| value.to_bits() == 0),
            (_, steps) => steps.unwrap()[index].iter().all(|value| value.to_bits() == 0),
        };
        assert!((0..scene.body.len()).all(is_zero), "a vertex of the body moves");
        // Where nothing says that it is a body, its own intersections count.
        if precision == Precision::F64 {
            let mut cloth =
                client.register(Registration { body: Vec::new(), ..scene.registration(precision) }).unwrap();
            let first =
                cloth.exchange_f64(STEP, PATIENCE, |slots| slots.copy_from_slice(&scene.all.positions)).unwrap();
            assert!(first.header().num_edge_face_intersections > 0, "the balls intersect each other");
        }
    }
}

#[test]
fn body_that_intersects_itself_counts_nowhere_and_gets_no_corrections() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    let outside = Dressed::new(1.1, 0.0);
    let mut session = client.register(outside.registration(Precision::F64)).unwrap();
    let repair = outside.repair(&mut session, Precision::F64);
    assert!(repair.is_certified() && repair.header().num_moved == 0, "{:?}", repair.header());
    let correction = session.newest().unwrap().unwrap();
    let header = correction.header();
    assert_eq!((header.num_edge_face_intersections, header.num_face_pairs, header.num_inside), (0, 0, 0));
    drop((repair, correction));
    let through = Dressed::new(1.01, 0.04);
    let mut session = client.register(through.registration(Precision::F64)).unwrap();
    let correction =
        session.exchange_f64(STEP, PATIENCE, |slots| slots.copy_from_slice(&through.all.positions)).unwrap();
    assert!(correction.header().num_edge_face_intersections > 0);
    let (body, belt) = correction.vertices().split_at(through.body.len());
    assert!(body.iter().all(|vertex| vertex.value == [0.0; 3] && vertex.flags & flags::PINNED != 0));
    assert!(belt.iter().any(|vertex| vertex.value != [0.0; 3]));
    assert!(belt.iter().all(|vertex| vertex.flags & flags::PINNED == 0));
}

#[test]
fn section_that_says_what_is_no_body_is_refused_in_words() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    assert!(client.daemon().features.iter().any(|name| name == "body"));
    let scene = Dressed::new(1.01, 0.04);
    let refused = |body: Vec<u32>, words: &[&str]| {
        let registration = Registration { body, ..scene.registration(Precision::F32) };
        match client.register(registration) {
            Err(RegisterError::Request(RequestError::Refused { status: Status::BadMesh, message })) => {
                assert!(words.iter().all(|word| message.contains(word)), "{message}");
            }
            other => panic!("{other:?}"),
        }
    };
    let num_vertices = u32::try_from(scene.all.positions.len()).unwrap();
    refused([&scene.body[..], &[num_vertices]].concat(), &["body", &num_vertices.to_string()]);
    // The first vertex of the body is one of the cloth here.
    refused(scene.body[1..].to_vec(), &["face 0", "of a body and of a cloth"]);
    // What is a body as a whole is a mesh like any other.
    let all = Registration { body: (0..num_vertices).collect(), ..scene.registration(Precision::F64) };
    let mut session = client.register(all).unwrap();
    assert!(scene.repair(&mut session, Precision::F64).is_certified());
}

#[test]
fn sparse_corrections_of_a_session_with_a_body_read_as_dense_ones() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    let scene = Dressed::new(1.01, 0.04);
    let [dense, sparse] = [false, true].map(|sparse| {
        let registration = Registration { sparse, ..scene.registration(Precision::F64) };
        let mut session = client.register(registration).unwrap();
        session.exchange_f64(STEP, PATIENCE, |slots| slots.copy_from_slice(&scene.all.positions)).unwrap()
    });
    assert!(dense.vertices()[0].flags == flags::PINNED && dense.header().num_edge_face_intersections > 0);
    assert_eq!(dense.vertices(), sparse.vertices());
}
