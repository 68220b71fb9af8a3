//! Observers see the very frames of a session.

use std::{collections::BTreeSet, time::Duration};

use untangle::{
    mesh::{Mesh, MeshDescription},
    sides::Layers,
};
use untangled_client::{
    Correction, PathPoint, PathRecord, Registration, Session, StepTime, flags,
    observe::{Observation, Observer, path_state},
};
use untangled_testkit::{
    generate::outfits::{Outfit, Pose},
    process::{Daemon, KnownCloth, PATIENCE, STEP, TestDomain, fill_flat, sheet},
};

use super::{observe, options};

/// A zero of either sign arrives as a positive one.
fn bits(values: &[[f32; 3]]) -> Vec<[u32; 3]> {
    values.iter().map(|value| value.map(|x| (x + 0.0).to_bits())).collect()
}

fn next(observer: &mut Observer) -> Observation {
    observer.latest(PATIENCE).unwrap().expect("a frame that was sent is seen")
}

/// The observation of a frame, and how many frames were seen or missed until then. Views go out after the corrections.
fn until(observer: &mut Observer, frame: u64) -> (Observation, u64) {
    let mut num_frames = 0;
    loop {
        let seen = next(observer);
        num_frames += seen.num_dropped + 1;
        if seen.frame() == frame {
            return (seen, num_frames);
        }
    }
}

/// Asserts that an observer saw what the host sent and got.
fn check(seen: &Observation, sent: &[[f32; 3]], got: &Correction) {
    assert_eq!((seen.frame(), seen.header()), (got.frame(), got.header()));
    assert_eq!(bits(&seen.positions), bits(sent));
    let exact = |values: &[[f32; 3]]| values.iter().map(|value| value.map(f32::to_bits)).collect::<Vec<_>>();
    assert_eq!(exact(&seen.corrections), exact(&got.vertices().iter().map(|vertex| vertex.value).collect::<Vec<_>>()));
    assert_eq!(seen.flags, got.vertices().iter().map(|vertex| vertex.flags).collect::<Vec<_>>());
    assert!(seen.refusal().is_none());
    let paths = got.paths().expect("the session has paths");
    let unsaid = |record: &PathRecord| PathRecord { state: path_state::UNKNOWN, ..*record };
    assert_eq!(seen.paths().records.iter().map(unsaid).collect::<Vec<_>>(), paths.records);
    let points =
        |points: &[PathPoint]| points.iter().map(|p| (p.position_m.map(f64::to_bits), p.faces)).collect::<Vec<_>>();
    assert_eq!(points(seen.paths().points), points(paths.points));
}

/// What is inside of a pair is flagged so, and a pair has vertices inside where its state says so; only such have a
/// depth.
fn check_regions(seen: &Observation) {
    let flagged = (0u32..).zip(&seen.flags).filter(|(_, own)| **own & flags::INSIDE != 0).map(|(vertex, _)| vertex);
    let inside: BTreeSet<u32> = seen.inside.iter().map(|entry| entry.vertex).collect();
    assert_eq!(inside, flagged.collect());
    let of_pairs: BTreeSet<u32> = seen.inside.iter().map(|entry| entry.pair).collect();
    for record in seen.paths().records {
        assert_eq!(of_pairs.contains(&record.pair), record.state == path_state::REGION, "{record:?}");
    }
    assert!((0u32..).zip(&seen.depths_m).all(|(pair, &depth_m)| depth_m <= 0.0 || of_pairs.contains(&pair)));
    assert!(of_pairs.iter().all(|&pair| seen.depths_m[pair as usize] > 0.0), "{:?}", seen.depths_m);
}

#[test]
fn observers_see_positions_corrections_and_paths_as_sent_and_got() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let cloth = KnownCloth::new(400);
    let pins = vec![3, 0];
    for (labels, double) in [(false, false), (true, false), (false, true)] {
        let precision = if double { untangled_client::Precision::F64 } else { untangled_client::Precision::F32 };
        let registration = Registration { paths: true, pins: pins.clone(), labels, precision, ..cloth.registration() };
        let mut session = domain.connect().register(registration.clone()).unwrap();
        let mut observers = [observe(&domain), observe(&domain)];
        for observer in &observers {
            let mesh = observer.mesh();
            assert_eq!((mesh.num_vertices, &mesh.triangles), (cloth.num_vertices(), &registration.triangles));
            assert_eq!((&mesh.pins[..], &mesh.body[..], &mesh.layers), (&[0, 3][..], &[][..], &None));
            assert_eq!((mesh.precision, mesh.correction), (precision, registration.correction));
        }
        let mut num_states = [0; path_state::NAMES.len()];
        let mut deepest_m = 0.0f32;
        for frame in 1..=16 {
            let got = exchange(&cloth, &mut session, double);
            for observer in &mut observers {
                let seen = next(observer);
                check(&seen, cloth.positions(frame), &got);
                assert_eq!((seen.num_frames(), seen.num_dropped), (frame, 0));
                assert!(seen.age() < PATIENCE && seen.stage_times()[7].1 > Duration::ZERO);
                seen.paths().records.iter().for_each(|record| num_states[record.state as usize] += 1);
                check_regions(&seen);
                deepest_m = seen.depths_m.iter().fold(deepest_m, |most, &depth_m| most.max(depth_m));
            }
        }
        assert_eq!(num_states[path_state::UNKNOWN as usize] + num_states[path_state::LEFT_OUT as usize], 0);
        assert!(num_states[path_state::REGION as usize] > 0, "{num_states:?}");
        assert!(deepest_m > 1e-3 && deepest_m < 1.0, "{deepest_m}");
        session.close(PATIENCE).unwrap();
    }
}

fn exchange(cloth: &KnownCloth, session: &mut Session, double: bool) -> Correction {
    if !double {
        return cloth.exchange(session, PATIENCE).unwrap();
    }
    let positions = cloth.positions(session.frame() + 1);
    let fill = |out: &mut [[f64; 3]]| out.iter_mut().zip(positions).for_each(|(out, p)| *out = p.map(f64::from));
    session.exchange_f64(STEP, PATIENCE, fill).unwrap()
}

#[test]
fn bodies_layers_and_welded_seams_are_seen_by_the_hosts_vertices() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    // Two triangles of cloth with a seam, and one of a body.
    let cloth = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    let body = [[0.0, 0.0, 5.0], [1.0, 0.0, 5.0], [0.0, 1.0, 5.0f32]];
    let single: Vec<[f32; 3]> = cloth.iter().chain(&body).copied().collect();
    let registration = Registration {
        num_vertices: 9,
        triangles: vec![[0, 1, 2], [3, 5, 4], [6, 7, 8]],
        rest_positions: Some(single.iter().map(|position| position.map(f64::from)).collect()),
        layers: Some(vec![2, 2, 2, 2, 2, 2, 0, 0, 0]),
        body: vec![6, 7, 8],
        pins: vec![5],
        weld: true,
        ..Registration::default()
    };
    let mut session = domain.connect().register(registration).unwrap();
    let mut observer = observe(&domain);
    let mesh = observer.mesh().clone();
    // Corners on the seam are the lowest of their place.
    assert_eq!(mesh.triangles, [[0, 1, 2], [1, 5, 2], [6, 7, 8]]);
    assert_eq!((&mesh.body[..], &mesh.pins[..]), (&[6, 7, 8][..], &[5][..]));
    assert_eq!(mesh.outwards, None, "there is one layer");
    assert_eq!(mesh.layers.as_deref(), Some(&[2, 2, 2, 2, 2, 2, 0, 0, 0][..]));
    assert_eq!(mesh.is_body().iter().filter(|&&is_body| is_body).count(), 3);
    let got = session.exchange(STEP, PATIENCE, |out| out.copy_from_slice(&single)).unwrap();
    let seen = next(&mut observer);
    assert_eq!(seen.positions, single);
    assert_eq!(seen.flags, got.vertices().iter().map(|vertex| vertex.flags).collect::<Vec<_>>());
    assert_eq!(seen.flags[5..], [8; 4]);
}

#[test]
fn what_rest_positions_say_is_outwards_is_seen() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let outfit = Outfit::new(Pose::ALL[0], 12);
    let (mut description, positions) = outfit.world();
    // The shirt with its faces turned round.
    description.faces[..outfit.layers[0].faces.len()].iter_mut().for_each(|face| face.swap(1, 2));
    let registration = Registration {
        num_vertices: description.num_vertices,
        triangles: description.faces.clone(),
        layers: description.layers.clone(),
        body: description.body.clone(),
        rest_positions: Some(positions.clone()),
        ..Registration::default()
    };
    let _session = domain.connect().register(registration).unwrap();
    let mesh = Mesh::new(MeshDescription { rest_positions: Some(positions), ..description }).unwrap();
    let decided = Layers::decide_at_rest(mesh);
    let outwards = decided.outwards().unwrap();
    assert!(outwards.contains(&true) && outwards.contains(&false));
    assert_eq!(observe(&domain).mesh().outwards.as_deref(), Some(outwards));
}

#[test]
fn slow_observers_see_the_newest_frame_and_how_many_they_missed() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let cloth = KnownCloth::new(300);
    let mut session = domain.connect().register(Registration { paths: true, ..cloth.registration() }).unwrap();
    let (mut slow, mut quick) = (observe(&domain), observe(&domain));
    assert!(slow.latest(Duration::ZERO).unwrap().is_none(), "no frame was sent");
    for frame in 1..=20 {
        let got = cloth.exchange(&mut session, PATIENCE).unwrap();
        check(&next(&mut quick), cloth.positions(frame), &got);
    }
    let (seen, num_frames) = until(&mut slow, 20);
    assert_eq!((seen.num_frames(), num_frames), (20, 20));
    assert!(seen.num_dropped >= 18, "{}: at most one waits, while the newest is on its way", seen.num_dropped);
    assert!(slow.latest(Duration::from_millis(1)).unwrap().is_none(), "it was seen before");
    // One that comes later has missed nothing.
    let mut late = observe(&domain);
    cloth.exchange(&mut session, PATIENCE).unwrap();
    assert_eq!([next(&mut late), next(&mut slow)].map(|seen| (seen.frame(), seen.num_dropped)), [(21, 0); 2]);
}

#[test]
fn refused_frames_are_seen_without_positions_and_say_why() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let mut session = domain.connect().register(sheet(4)).unwrap();
    let mut observer = observe(&domain);
    session.exchange(STEP, PATIENCE, |positions| positions[7] = [f32::NAN; 3]).unwrap_err();
    let seen = next(&mut observer);
    assert!(seen.positions.is_empty());
    assert_eq!((seen.corrections.len(), seen.paths().records.len()), (25, 0));
    let words = seen.refusal().unwrap().to_string();
    assert!(words.contains("vertex 7"), "{words}");
    session.exchange(StepTime { dt_s: -1.0, ..STEP }, PATIENCE, fill_flat).unwrap_err();
    assert!(next(&mut observer).positions.is_empty());
    session.exchange(STEP, PATIENCE, fill_flat).unwrap();
    let seen = next(&mut observer);
    assert_eq!((seen.positions.len(), seen.refusal().is_none(), seen.num_frames()), (25, true, 3));
}

#[test]
fn observers_of_two_sessions_see_their_own() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    let mut sessions = [4, 6].map(|n| client.register(sheet(n)).unwrap());
    let found = untangled_client::observe::sessions(&options(&domain)).unwrap();
    assert_eq!(found.iter().map(|session| session.num_vertices).collect::<Vec<_>>(), [25, 49]);
    let mut observers = [0, 1].map(|k: usize| Observer::open(options(&domain), found[k].session).unwrap());
    for (k, observer) in observers.iter_mut().enumerate() {
        for session in &mut sessions {
            session.exchange(STEP, PATIENCE, fill_flat).unwrap();
        }
        let (seen, num_frames) = until(observer, k as u64 + 1);
        assert_eq!((seen.positions.len(), num_frames), ([25, 49][k], k as u64 + 1));
    }
}
