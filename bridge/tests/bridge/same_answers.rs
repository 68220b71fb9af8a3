//! What a host gets through the bridge is what it gets from the daemon, byte for byte.

use std::{panic::Location, time::Duration};

use untangled_client::{
    Correction, CorrectionHeader, Precision, Registration, RequestError, Session, StepTime, Uvs, VertexCorrection,
};

use untangled_bridge_lab::{
    cloth::Sheets,
    ends::{Bridged, PATIENCE},
};

fn step(frame: u64) -> StepTime {
    StepTime { simulated_s: frame as f64 / 64.0, dt_s: 1.0 / 64.0 }
}

fn exchange(session: &mut Session, positions: &[[f64; 3]], precision: Precision) -> Correction {
    let time = step(session.frame() + 1);
    match precision {
        Precision::F32 => session.exchange(time, PATIENCE, |to| {
            for (to, from) in to.iter_mut().zip(positions) {
                *to = from.map(|value| value as f32);
            }
        }),
        Precision::F64 => session.exchange_f64(time, PATIENCE, |to| to.copy_from_slice(positions)),
    }
    .unwrap()
}

/// A header without times, which no two runs share.
fn timeless(header: &CorrectionHeader) -> CorrectionHeader {
    CorrectionHeader { stage_ns: [0; 8], ..*header }
}

fn bits(vertices: &[VertexCorrection]) -> Vec<[u32; 4]> {
    let bits = |vertex: &VertexCorrection| {
        let [x, y, z] = vertex.value.map(f32::to_bits);
        [x, y, z, vertex.flags]
    };
    vertices.iter().map(bits).collect()
}

/// Runs a cloth beside the daemon and through the bridge, and compares all that comes back. Gives back the number of
/// frames with an intersection.
#[track_caller]
fn compare(
    bridged: &Bridged,
    registration: &Registration,
    frames: u64,
    positions: impl Fn(u64) -> Vec<[f64; 3]>,
) -> u64 {
    let place = Location::caller();
    let [mut own, mut far] = [&bridged.near_daemon, &bridged.near_host]
        .map(|domain| domain.connect().register(registration.clone()).unwrap());
    assert_eq!((own.is_sparse(), own.has_labels()), (far.is_sparse(), far.has_labels()));
    assert_eq!((own.has_repairs(), own.num_welded_vertices()), (far.has_repairs(), far.num_welded_vertices()));
    let mut num_tangled = 0;
    for frame in 1..=frames {
        let state = positions(frame);
        let [own, far] = [&mut own, &mut far].map(|session| exchange(session, &state, registration.precision));
        assert_eq!(timeless(own.header()), timeless(far.header()), "{place}, frame {frame}");
        assert_eq!(bits(own.vertices()), bits(far.vertices()), "{place}, frame {frame}");
        assert!(own.entries().eq(far.entries()), "{place}, frame {frame}");
        assert_eq!(own.labels(), far.labels(), "{place}, frame {frame}");
        assert_eq!(
            own.paths().map(|paths| (paths.records, paths.points)),
            far.paths().map(|paths| (paths.records, paths.points)),
            "{place}, frame {frame}"
        );
        assert_eq!(own.paths().is_some(), registration.paths, "{place}, frame {frame}");
        num_tangled += u64::from(own.header().num_face_pairs > 0);
    }
    num_tangled
}

#[test]
fn corrections_through_the_bridge_are_those_of_the_daemon_in_every_form() {
    let bridged = Bridged::start();
    let sheets = Sheets::new(20);
    let plain = sheets.registration();
    let n = sheets.num_vertices();
    let forms = [
        plain.clone(),
        Registration { sparse: true, ..plain.clone() },
        Registration { labels: true, paths: true, ..plain.clone() },
        Registration { paths: true, ..plain.clone() },
        Registration { precision: Precision::F64, ..plain.clone() },
        Registration { pins: (0..200).collect(), masses_kg: Some(vec![0.01; n]), ..plain.clone() },
        Registration { body: (0..400).collect(), pins: vec![401, 799], ..plain.clone() },
        Registration { body: (0..400).collect(), sparse: true, precision: Precision::F64, ..plain.clone() },
        Registration { layers: Some((0..n).map(|k| u32::from(k >= 400)).collect()), ..plain.clone() },
        Registration { settings: serde_json::json!({ "quality": "fast", "response": "contour" }), ..plain.clone() },
        Registration {
            correction: untangled_client::CorrectionKind::Force,
            masses_kg: Some(vec![0.5; n]),
            ..plain.clone()
        },
    ];
    for form in forms {
        let tangled = compare(&bridged, &form, 12, |frame| sheets.positions(frame));
        assert!((6..12).contains(&tangled), "{tangled} frames intersect");
    }
    let coordinates = sheets.positions(7).into_iter().map(|[x, y, z]| [x + z, y]).collect();
    let uvs = Some(Uvs { coordinates, corners: plain.triangles.clone() });
    let rest_positions = Some(sheets.positions(7));
    compare(&bridged, &Registration { uvs, rest_positions, ..plain.clone() }, 8, |frame| sheets.positions(frame));
}

#[test]
fn welded_seams_pass_and_their_pins_with_them() {
    let bridged = Bridged::start();
    let sheets = Sheets::new(12);
    // A second copy of each vertex of the first column of triangles, as an exporter leaves it.
    let mut registration = sheets.registration();
    let split: Vec<u32> = (0..12).collect();
    let n = u32::try_from(sheets.num_vertices()).unwrap();
    for triangle in registration.triangles.iter_mut().take(8) {
        for corner in triangle.iter_mut().filter(|corner| **corner < 12) {
            *corner += n;
        }
    }
    let with_copies = |positions: Vec<[f64; 3]>| {
        let copies: Vec<[f64; 3]> = split.iter().map(|&vertex| positions[vertex as usize]).collect();
        [positions, copies].concat()
    };
    registration.num_vertices += split.len();
    registration.rest_positions = Some(with_copies(sheets.positions(7)));
    registration.pins = vec![0, 1, 2];
    registration.weld = true;
    for sparse in [false, true] {
        let registration = Registration { sparse, ..registration.clone() };
        compare(&bridged, &registration, 8, |frame| with_copies(sheets.positions(frame)));
    }
}

#[test]
fn repairs_through_the_bridge_are_those_of_the_daemon() {
    let bridged = Bridged::start();
    let sheets = Sheets::new(10);
    for precision in [Precision::F32, Precision::F64] {
        let registration = Registration { repairs: true, precision, ..sheets.registration() };
        let [own, far] = [&bridged.near_daemon, &bridged.near_host].map(|domain| {
            let mut session = domain.connect().register(registration.clone()).unwrap();
            let state = sheets.positions(1);
            let repair = match precision {
                Precision::F32 => session.repair(step(1), PATIENCE, |to| {
                    for (to, from) in to.iter_mut().zip(&state) {
                        *to = from.map(|value| value as f32);
                    }
                }),
                Precision::F64 => session.repair_f64(step(1), PATIENCE, |to| to.copy_from_slice(&state)),
            };
            let repair = repair.unwrap();
            let header = untangled_client::RepairHeader { waited_ns: 0, repair_ns: 0, ..*repair.header() };
            let single: Vec<_> =
                repair.displacements_f32().unwrap_or_default().iter().map(|d| d.map(f32::to_bits)).collect();
            let double: Vec<_> =
                repair.displacements_f64().unwrap_or_default().iter().map(|d| d.map(f64::to_bits)).collect();
            (header, single, double)
        });
        assert_eq!(own, far);
        assert!(own.0.num_moved > 0 && own.0.flags == 1, "certified: {:?}", own.0);
    }
}

#[test]
fn refusals_updates_and_statuses_have_the_words_of_the_daemon() {
    let bridged = Bridged::start();
    let sheets = Sheets::new(5);
    let plain = sheets.registration();
    let [own, far] = [&bridged.near_daemon, &bridged.near_host].map(|domain| domain.connect());
    assert_eq!(own.daemon(), far.daemon());
    let bad = [
        Registration { triangles: vec![[0, 1, 50]], ..plain.clone() },
        Registration { correction: untangled_client::CorrectionKind::Force, ..plain.clone() },
        Registration { settings: serde_json::json!({ "path_ring": 3 }), ..plain.clone() },
        Registration { num_vertices: 1 << 25, ..plain.clone() },
        Registration { weld: true, ..plain.clone() },
        Registration { body: vec![0], ..plain.clone() },
    ];
    for registration in bad {
        let [own, far] = [&own, &far].map(|client| client.register(registration.clone()).unwrap_err().to_string());
        assert_eq!(own, far);
    }
    let [mut own_session, mut far_session] = [&own, &far].map(|client| client.register(plain.clone()).unwrap());
    for settings in [serde_json::json!({ "inside": "nowhere" }), serde_json::json!({ "path_rings": 99 })] {
        let update = |session: &mut Session| session.update_settings(settings.clone(), PATIENCE).unwrap_err();
        let [own, far] = [&mut own_session, &mut far_session].map(update);
        assert!(matches!(&own, RequestError::Refused { .. }));
        assert_eq!(own.to_string(), far.to_string());
    }
    // One that is taken holds at the other end.
    let mask = serde_json::json!({ "response": "mask" });
    for session in [&mut own_session, &mut far_session] {
        session.update_settings(mask.clone(), PATIENCE).unwrap();
    }
    let state = sheets.positions(1);
    let [own_answer, far_answer] =
        [&mut own_session, &mut far_session].map(|session| exchange(session, &state, Precision::F32));
    assert_eq!(bits(own_answer.vertices()), bits(far_answer.vertices()));
    assert!(own_answer.vertices().iter().any(|vertex| vertex.flags != 0));
    // A frame that is refused.
    let mut nan = sheets.positions(2);
    nan[7][1] = f64::NAN;
    let refuse = |session: &mut Session| {
        let frame = session.publish(step(2), |to| {
            for (to, from) in to.iter_mut().zip(&nan) {
                *to = from.map(|value| value as f32);
            }
        });
        session.wait(frame.unwrap(), PATIENCE).unwrap_err().to_string()
    };
    assert_eq!(refuse(&mut own_session), refuse(&mut far_session));
    let report = far.status().unwrap();
    assert_eq!(report["schema"], "untangled.status/1");
    assert_eq!(report["sessions"].as_array().unwrap().len(), 2);
    assert_eq!(report["bridge"]["sessions"][0]["num_frames"], 2);
    far_session.close(Duration::from_secs(5)).unwrap();
    assert_eq!(own.status().unwrap()["sessions"].as_array().unwrap().len(), 1, "the daemon has closed it");
}
