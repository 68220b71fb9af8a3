//! Sessions of meshes that were split at edges, and ask for what is in one place to be one.

use std::{collections::BTreeMap, time::Duration};

use untangled_client::{
    Client, Correction, CorrectionKind, ExchangeError, Precision, RegisterError, Registration, Session, Status,
    WaitError, flags,
};
use untangled_testkit::{
    generate::split_at_edges,
    process::{Daemon, PATIENCE, STEP, TestDomain, untangled},
};

use super::cloth::Tangle;

/// A cloth, and the same split at a third of its edges.
struct Pair {
    whole: Tangle,
    split: Tangle,
    /// For each vertex of the split cloth that of the whole one in its place.
    whole_vertex: Vec<usize>,
}

impl Pair {
    /// All vertices of `cloth` are in places of their own.
    fn of(cloth: &Tangle) -> Self {
        let part = |part| {
            let split = split_at_edges(&cloth.triangles, &cloth.positions, part, 3);
            Tangle { positions: split.positions, triangles: split.faces, pins: Vec::new() }
        };
        let (mut whole, mut split) = (part(0.0), part(0.3));
        let bits = |at: &[f64; 3]| at.map(f64::to_bits);
        let places: BTreeMap<[u64; 3], usize> = whole.positions.iter().map(bits).zip(0..).collect();
        let whole_vertex: Vec<usize> = split.positions.iter().map(|at| places[&bits(at)]).collect();
        whole.pins = vec![0, 5];
        let pinned = |&vertex: &u32| whole.pins.contains(&u32::try_from(whole_vertex[vertex as usize]).unwrap());
        split.pins = (0..u32::try_from(whole_vertex.len()).unwrap()).filter(pinned).collect();
        Self { whole, split, whole_vertex }
    }

    /// Registrations of both, with a mass for each vertex. Those of the split cloth in one place sum to one of the
    /// whole cloth without rounding.
    fn registrations(&self, precision: Precision) -> [Registration; 2] {
        let mut counts = vec![0; self.whole.positions.len()];
        self.whole_vertex.iter().for_each(|&vertex| counts[vertex] += 1);
        let mut left = vec![0.5; counts.len()];
        let mut mass = |&vertex: &usize| {
            counts[vertex] -= 1;
            let mass = if counts[vertex] > 0 { 0.5 * left[vertex] } else { left[vertex] };
            left[vertex] -= mass;
            mass
        };
        let masses = [vec![0.5; self.whole.positions.len()], self.whole_vertex.iter().map(&mut mass).collect()];
        let of = |cloth: &Tangle, masses: &Vec<f64>| Registration {
            masses_kg: Some(masses.clone()),
            rest_positions: Some(cloth.positions.clone()),
            ..cloth.registration(precision)
        };
        [of(&self.whole, &masses[0]), Registration { weld: true, ..of(&self.split, &masses[1]) }]
    }
}

fn exchange(session: &mut Session, cloth: &Tangle) -> Correction {
    session.exchange(STEP, PATIENCE, |slots| slots.copy_from_slice(&cloth.positions_f32())).unwrap()
}

fn assert_same(pair: &Pair, whole: &Correction, split: &Correction, is_force: bool) {
    let counts = |correction: &Correction| {
        let header = correction.header();
        (header.num_edge_face_intersections, header.num_face_pairs, header.num_pairs, header.contour_length_m.to_bits())
    };
    assert_eq!(counts(whole), counts(split));
    assert!(whole.header().num_edge_face_intersections > 0);
    let mut sums = vec![[0.0f64; 3]; pair.whole.positions.len()];
    for (vertex, &of_whole) in split.vertices().iter().zip(&pair.whole_vertex) {
        let expected = whole.vertices()[of_whole];
        assert_eq!(vertex.flags, expected.flags);
        if is_force {
            (0..3).for_each(|axis| sums[of_whole][axis] += f64::from(vertex.value[axis]));
        } else {
            assert_eq!(vertex.value.map(f32::to_bits), expected.value.map(f32::to_bits));
        }
    }
    for (sum, expected) in sums.iter().zip(whole.vertices()).filter(|_| is_force) {
        let is_near = |axis: usize| (sum[axis] - f64::from(expected.value[axis])).abs() <= 1e-5 * sum[axis].abs();
        assert!((0..3).all(is_near), "{sum:?} {expected:?}");
    }
    let num_inside = split.vertices().iter().filter(|vertex| vertex.flags & flags::INSIDE != 0).count();
    assert_eq!(split.header().num_inside, num_inside as u64);
}

fn session_pair(client: &Client, [whole, split]: [Registration; 2]) -> [Session; 2] {
    [client.register(whole).unwrap(), client.register(split).unwrap()]
}

#[test]
fn corrections_and_labels_of_a_split_cloth_that_is_welded_are_those_of_the_whole_one() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    assert!(client.daemon().features.iter().any(|known| known == "weld"));
    let pair = Pair::of(&Tangle::gallery());
    let mut num_intersections = 0;
    for correction in [CorrectionKind::Displacement, CorrectionKind::Acceleration, CorrectionKind::Force] {
        for labels in [false, true] {
            let asked = pair.registrations(Precision::F32);
            let asked = asked.map(|registration| Registration { correction, labels, ..registration });
            let [mut whole, mut split] = session_pair(&client, asked);
            let num_welded = pair.split.positions.len() - pair.whole.positions.len();
            assert!(num_welded > 20);
            assert_eq!((whole.num_welded_vertices(), split.num_welded_vertices()), (0, num_welded));
            let [of_whole, of_split] = [exchange(&mut whole, &pair.whole), exchange(&mut split, &pair.split)];
            num_intersections = of_split.header().num_edge_face_intersections;
            assert_same(&pair, &of_whole, &of_split, correction == CorrectionKind::Force);
            let mut labels_of = vec![Vec::new(); pair.whole.positions.len()];
            of_whole.labels().iter().for_each(|label| labels_of[label.vertex as usize].push(label.label));
            let expected = pair.whole_vertex.iter().zip(0u32..);
            let expected = expected.flat_map(|(&own, vertex)| labels_of[own].iter().map(move |&label| (vertex, label)));
            let expected: Vec<(u32, u32)> = expected.collect();
            let found: Vec<(u32, u32)> = of_split.labels().iter().map(|label| (label.vertex, label.label)).collect();
            assert_eq!(found, expected);
            assert_eq!(labels, !found.is_empty());
        }
    }
    // Without the option seams are open.
    let [_, asked] = pair.registrations(Precision::F32);
    let mut open = client.register(Registration { weld: false, ..asked }).unwrap();
    let correction = exchange(&mut open, &pair.split);
    assert_eq!(open.num_welded_vertices(), 0);
    assert!(correction.header().num_edge_face_intersections > num_intersections);
}

#[test]
fn repair_of_a_split_cloth_that_is_welded_is_that_of_the_whole_one() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    let pair = Pair::of(&Tangle::small());
    let [mut whole, mut split] = session_pair(&client, pair.registrations(Precision::F64));
    let repair = |session: &mut Session, cloth: &Tangle| {
        session.repair_f64(STEP, Duration::from_secs(600), |slots| slots.copy_from_slice(&cloth.positions)).unwrap()
    };
    let [of_whole, of_split] = [repair(&mut whole, &pair.whole), repair(&mut split, &pair.split)];
    assert!(of_whole.is_certified() && of_split.is_certified());
    let bits = |steps: [f64; 3]| steps.map(f64::to_bits);
    let expected = of_whole.displacements_f64().unwrap();
    for (step, &own) in of_split.displacements_f64().unwrap().iter().zip(&pair.whole_vertex) {
        assert_eq!(bits(*step), bits(expected[own]));
    }
    let num_moved = of_split.displacements_f64().unwrap().iter().filter(|step| **step != [0.0; 3]).count();
    assert_eq!(of_split.header().num_moved as usize, num_moved);
    assert!(num_moved > of_whole.header().num_moved as usize);
}

#[test]
fn weld_without_rest_positions_and_states_with_open_seams_are_refused() {
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let client = domain.connect();
    let pair = Pair::of(&Tangle::small());
    let [_, asked] = pair.registrations(Precision::F64);
    let refused = client.register(Registration { rest_positions: None, ..asked.clone() });
    match refused {
        Err(RegisterError::Request(error)) => assert!(error.to_string().contains("rest positions"), "{error}"),
        other => panic!("{other:?}"),
    }
    let mut session = client.register(asked).unwrap();
    let copy = (0..pair.whole_vertex.len()).rev().find(|&vertex| {
        let own = pair.whole_vertex[vertex];
        pair.whole_vertex[..vertex].contains(&own)
    });
    let copy = copy.unwrap();
    let mut positions = pair.split.positions.clone();
    positions[copy][1] += 1e-9;
    match session.exchange_f64(STEP, PATIENCE, |slots| slots.copy_from_slice(&positions)) {
        Err(ExchangeError::Wait(WaitError::Refused(refusal))) => {
            assert_eq!(refusal.status, Status::BadPosition);
            assert_eq!((refusal.fault_index, refusal.fault_value), (Some(copy as u64), positions[copy][1]));
        }
        other => panic!("{other:?}"),
    }
    // The session lives on.
    let correction = session.exchange_f64(STEP, PATIENCE, |slots| slots.copy_from_slice(&pair.split.positions));
    assert!(correction.unwrap().header().num_edge_face_intersections > 0);
    let output =
        std::process::Command::new(untangled()).args(["status", "--json", "--domain", domain.name()]).output().unwrap();
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let num_welded = pair.split.positions.len() - pair.whole.positions.len();
    assert_eq!(report["sessions"][0]["num_welded_vertices"], num_welded, "{report}");
    drop(daemon);
}
