//! Sparse corrections beside dense ones of the same frames.

use std::sync::Arc;

use untangle::{
    frame::Frame,
    mesh::{Mesh, MeshDescription},
    settings::Settings,
    untangler::Untangler,
};
use untangled_client::{
    ContactFilter, Correction, CorrectionKind, Registration, Session, VertexCorrection, VertexEntry, flags,
};
use untangled_proto::{
    RegisterParams, RequestKind, Status,
    sections::{SectionWriter, id},
};
use untangled_testkit::process::{Daemon, KnownCloth, PATIENCE, RawPeer, STEP, TestDomain, header};

type Bits = (u32, [u32; 3], u32);

/// The entries of a correction, by their bits.
fn entries(entries: impl Iterator<Item = VertexEntry>) -> Vec<Bits> {
    entries.map(|entry| (entry.vertex, entry.value.map(f32::to_bits), entry.flags)).collect()
}

/// The entries that the vertices of a correction should have.
fn expected(vertices: &[VertexCorrection]) -> Vec<Bits> {
    let bits = (0..).zip(vertices).map(|(k, vertex)| (k, vertex.value.map(f32::to_bits), vertex.flags));
    bits.filter(|&(_, value, flags)| flags & !flags::PINNED != 0 || value != [0; 3]).collect()
}

fn check(dense: &Correction, sparse: &Correction) {
    assert_eq!(dense.vertices(), sparse.vertices());
    assert!(dense.sparse().is_none());
    let expected = expected(dense.vertices());
    assert_eq!(entries(sparse.sparse().unwrap().iter().copied()), expected);
    assert_eq!(entries(sparse.entries()), expected);
    assert_eq!(entries(dense.entries()), expected);
    let times = |correction: &Correction| {
        let mut header = *correction.header();
        (header.stage_ns, header.num_values, header.num_labels) = ([0; 8], 0, 0);
        header
    };
    assert_eq!(times(dense), times(sparse));
    assert_eq!([dense.header().num_values, dense.header().num_labels], [0; 2]);
    assert_eq!(sparse.header().num_values as usize, expected.len());
}

#[test]
fn sparse_corrections_say_what_dense_ones_say() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    assert!(["sparse", "labels"].iter().all(|name| client.daemon().features.iter().any(|known| known == name)));
    let cloth = KnownCloth::new(400);
    // One of the strip, one of the sheet that the strip passes through, and one far from both.
    let last = u32::try_from(cloth.num_vertices() - 1).unwrap();
    let pins = vec![last - 40, 0, last];
    for correction in [CorrectionKind::Force, CorrectionKind::Acceleration, CorrectionKind::Displacement] {
        let registration = Registration { correction, pins: pins.clone(), ..cloth.registration() };
        let mut dense = client.register(registration.clone()).unwrap();
        let mut sparse = client.register(Registration { sparse: true, ..registration.clone() }).unwrap();
        let mut labelled = client.register(Registration { labels: true, ..registration }).unwrap();
        assert_eq!([&dense, &sparse, &labelled].map(Session::is_sparse), [false, true, true]);
        assert_eq!([&dense, &sparse, &labelled].map(Session::has_labels), [false, false, true]);
        let mut held = Vec::new();
        let mut num_entries = Vec::new();
        for _ in 0..20 {
            let of = |session: &mut Session| cloth.exchange(session, PATIENCE).unwrap();
            let [dense, sparse, labelled] = [&mut dense, &mut sparse, &mut labelled].map(of);
            check(&dense, &sparse);
            check(&dense, &labelled);
            let is_pinned = |vertex: u32| dense.vertices()[vertex as usize].flags & flags::PINNED != 0;
            assert!(pins.iter().all(|&pin| is_pinned(pin)) && !is_pinned(1));
            num_entries.push(sparse.sparse().unwrap().len());
            // Memory of corrections that are held is not used for others.
            held.push((dense, sparse));
            if held.len() > 2 {
                held.remove(0);
            }
            held.iter().for_each(|(dense, sparse)| check(dense, sparse));
        }
        assert!(num_entries.contains(&0) && num_entries.iter().any(|&num| num > 50), "{num_entries:?}");
    }
}

#[test]
fn frames_after_a_refused_one_hold_nothing_of_it() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    let cloth = KnownCloth::new(400);
    for sparse in [false, true] {
        let mut session = client.register(Registration { sparse, ..cloth.registration() }).unwrap();
        for _ in 0..30 {
            assert!(cloth.is_right(&cloth.exchange(&mut session, PATIENCE).unwrap()), "sparse: {sparse}");
            if session.frame().is_multiple_of(3) {
                let refused = session.exchange(STEP, PATIENCE, |positions| positions.fill([f32::NAN; 3])).unwrap_err();
                assert!(refused.to_string().contains("vertex 0"), "{refused}");
            }
        }
    }
}

#[test]
fn options_that_are_not_known_are_refused_in_words() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let peer = RawPeer::new(&domain);
    let params = RegisterParams { num_vertices: 3, precision: 0, correction: 3, ..RegisterParams::default() };
    let register = |options: Vec<u8>| {
        let mut writer = SectionWriter::default();
        writer.bytes(id::PARAMS, params.to_bytes().to_vec()).u32s(id::TRIANGLES, &[[0, 1, 2]]);
        let (payload, num_sections) = writer.bytes(id::OPTIONS, options).finish();
        peer.expect_reply(header(RequestKind::Register as u32, num_sections), &payload)
    };
    for (options, words) in [
        (vec![0, 0, 0, 0x80], "options 2147483648 have bits that are not known"),
        (vec![1, 0, 0, 0, 0, 0, 0, 0], "section 10 (options) must have 4 bytes"),
        (vec![1, 0, 0], "section 10 has 3 bytes, not a multiple of 4"),
    ] {
        let (reply, said) = register(options);
        assert_eq!((reply.status, said.as_str()), (Status::BadRequest.code(), words));
    }
    assert_eq!(register(vec![3, 0, 0, 0]).0.status, 0);
}

#[test]
fn labels_of_a_frame_are_those_of_the_library() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let cloth = KnownCloth::new(400);
    let registration = Registration { labels: true, ..cloth.registration() };
    let description = MeshDescription {
        num_vertices: registration.num_vertices,
        faces: registration.triangles.clone(),
        masses_kg: registration.masses_kg.clone(),
        ..MeshDescription::default()
    };
    let mesh = Arc::new(Mesh::new(description).unwrap());
    let mut untangler = Untangler::new(Arc::clone(&mesh), Settings::default()).unwrap();
    untangler.set_labelled(true);
    let mut session = domain.connect().register(registration).unwrap();
    let mut filter = ContactFilter::new(session.num_vertices());
    let mut num_labels = Vec::new();
    for _ in 0..8 {
        let correction = cloth.exchange(&mut session, PATIENCE).unwrap();
        let positions: Vec<_> = cloth.positions(correction.frame()).iter().map(|p| p.map(f64::from)).collect();
        let frame = Frame::new(&mesh, &positions).unwrap();
        let labels = &untangler.process(&frame, &mut ()).corrections.labels;
        let expected: Vec<_> = labels.iter().map(|label| [label.vertex.0, label.label]).collect();
        let sent: Vec<_> = correction.labels().iter().map(|label| [label.vertex, label.label]).collect();
        assert_eq!(sent, expected, "frame {}", correction.frame());
        assert_eq!(correction.header().num_labels as usize, expected.len());
        filter.set(correction.labels().iter().map(|label| (label.vertex, label.label)));
        assert_eq!(filter.is_empty(), expected.is_empty());
        num_labels.push(expected.len());
    }
    assert!(num_labels.contains(&0) && num_labels.iter().any(|&num| num > 20), "{num_labels:?}");
}
