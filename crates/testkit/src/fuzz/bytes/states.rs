//! Headers and positions of frames, as the daemon reads them.

use std::sync::Arc;

use untangle::{
    frame::Frame,
    mesh::Mesh,
    settings::{Response, Settings},
    untangler::Untangler,
};
use untangled::service::session::ingest;
use untangled_checker::{crossings, edge_face_hits};
use untangled_proto::{PositionF32, PositionF64, StateHeader, Status, correction::NO_FAULT};

use super::clouds::Cloud;
use crate::{
    fuzz::checks::{check_frame, check_mesh},
    judge::brute_force,
};

/// Largest coordinate that a frame may have.
const LARGEST: f64 = f64::from_bits((1023 + 250) << 52);

/// A cloud whose last bytes are those of a header and of a coordinate: the header is refused for what is wrong with
/// it, a coordinate too, and an accepted frame has the intersections that brute force and the judge find.
pub(super) fn state(bytes: &[u8]) -> bool {
    let mut cloud = Cloud::of(bytes);
    let Ok(mesh) = Mesh::new(cloud.description()) else { return false };
    check_mesh(&mesh);
    let header_is_right = check_header(&cloud.rest, mesh.num_vertices());
    if let Some((_, last)) = cloud.rest.split_last_chunk::<8>() {
        let at = usize::from(cloud.choices) % (3 * cloud.positions.len());
        cloud.positions.as_flattened_mut()[at] = f64::from_le_bytes(*last);
    }
    let mut frame = Frame::default();
    let single = cloud.choices & 1 != 0;
    let read = if single {
        let positions: Vec<_> = cloud.positions.iter().map(|p| PositionF32(p.map(|x| x as f32))).collect();
        cloud.positions = positions.iter().map(|p| p.0.map(f64::from)).collect();
        ingest::read_f32(&mut frame, &mesh, &positions)
    } else {
        let positions: Vec<_> = cloud.positions.iter().map(|&p| PositionF64(p)).collect();
        ingest::read_f64(&mut frame, &mesh, &positions)
    };
    let is_wrong = |place: &[f64; 3]| place.iter().any(|x| x.is_nan() || x.abs() > LARGEST);
    let wrong = cloud.positions.iter().position(is_wrong);
    match (read, wrong) {
        (Ok(()), None) => {}
        (Err(fault), Some(vertex)) => {
            assert_eq!((fault.status, fault.index), (Status::BadPosition, vertex as u64), "the first vertex at fault");
            return false;
        }
        (read, wrong) => panic!("{read:?}, but the vertex at fault is {wrong:?}"),
    }
    check_analysis(mesh, &frame, cloud.choices);
    header_is_right
}

/// Whether the header of these bytes is right; it is refused if not.
fn check_header(bytes: &[u8], num_vertices: usize) -> bool {
    let mut words = bytes.as_chunks::<8>().0.iter().map(|word| u64::from_le_bytes(*word));
    let mut next = |default: u64| words.next().unwrap_or(default);
    let header = StateHeader {
        simulated_s: f64::from_bits(next(0)),
        dt_s: f64::from_bits(next(0.01f64.to_bits())),
        num_vertices: (next(num_vertices as u64) & u64::from(u32::MAX)) as u32,
        ..StateHeader::default()
    };
    match ingest::check_header(&header, num_vertices) {
        Ok(()) => {
            assert!(header.dt_s > 0.0 && header.dt_s.is_finite() && header.simulated_s.is_finite());
            assert_eq!(header.num_vertices as usize, num_vertices);
            true
        }
        Err(fault) => {
            assert_eq!((fault.status, fault.index), (Status::BadHeader, NO_FAULT));
            let fields = [header.dt_s, header.simulated_s, f64::from(header.num_vertices)];
            assert!(fields.map(f64::to_bits).contains(&fault.value.to_bits()), "the value at fault is one of its own");
            false
        }
    }
}

/// Intersections are those of brute force; none means that the judge finds no crossing, and where it finds nothing
/// that touches there are none.
fn check_analysis(mesh: Mesh, frame: &Frame, choices: u8) {
    let triangles: Vec<[u32; 3]> = mesh.face_ids().map(|face| mesh.face(face).map(|vertex| vertex.0)).collect();
    let responses = [Response::Rbf, Response::Coupled, Response::Contour, Response::Displacement];
    let settings = Settings { response: responses[usize::from(choices >> 1 & 3)], ..Settings::default() };
    let mesh = Arc::new(mesh);
    let mut untangler = Untangler::new(Arc::clone(&mesh), settings).expect("they are valid");
    check_frame(&mut untangler, frame);
    let outcome = untangler.process(frame, &mut ());
    brute_force::assert_equal("a cloud", &mesh, frame, outcome.analysis);
    let positions: Vec<[f64; 3]> = mesh.vertex_ids().map(|vertex| frame.position(vertex).coords.into()).collect();
    let num_found = outcome.analysis.intersections.edge_face.len();
    if num_found == 0 {
        let crossings = crossings(&positions, &triangles).expect("it can be judged");
        assert_eq!(crossings.pairs, [[0; 2]; 0], "nothing intersects, but the judge finds crossings");
    }
    let used = |face: &[u32; 3]| face[0] != face[1] && face[1] != face[2] && face[2] != face[0];
    let used: Vec<[u32; 3]> = triangles.into_iter().filter(used).collect();
    if edge_face_hits(&positions, &used).expect("it can be judged").is_empty() {
        assert_eq!(num_found, 0, "nothing touches, but there are intersections");
    }
}
