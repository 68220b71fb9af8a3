//! The mesh of a session, for the reply to an observer.

use untangled_proto::{
    CorrectionKind, Precision, RegisterParams,
    sections::{SectionWriter, id},
};

use crate::service::session::cloth::Cloth;

/// The number of its sections, 8 bytes, and these: parameters, triangles, and bodies, pins, layers, and what is
/// outwards of these where there are such. All by the host's vertices; a corner on a welded seam is the lowest of those
/// in its place.
pub(in crate::service::session) fn mesh_bytes(
    cloth: &Cloth,
    precision: Precision,
    correction: CorrectionKind,
) -> Vec<u8> {
    let (mesh, n) = (cloth.mesh(), cloth.num_vertices());
    let params = RegisterParams {
        num_vertices: n as u64,
        precision: precision as u32,
        correction: correction as u32,
        ..RegisterParams::default()
    };
    let triangles: Vec<[u32; 3]> =
        mesh.face_ids().map(|face| mesh.face(face).map(|vertex| cloth.host_vertex(vertex))).collect();
    let mut writer = SectionWriter::default();
    writer.bytes(id::PARAMS, params.to_bytes().to_vec()).u32s(id::TRIANGLES, &triangles);
    let listed = |is_listed: &dyn Fn(usize) -> bool| -> Vec<[u32; 1]> {
        (0..).zip(0..n).filter(|&(_, index)| is_listed(index)).map(|(vertex, _)| [vertex]).collect()
    };
    let body = listed(&|index| mesh.is_body(cloth.mesh_vertex(index)));
    let pins = listed(&|index| {
        let vertex = cloth.mesh_vertex(index);
        mesh.is_pinned(vertex) && !mesh.is_body(vertex)
    });
    for (section, vertices) in [(id::BODY, body), (id::PINS, pins)] {
        if !vertices.is_empty() {
            writer.u32s(section, &vertices);
        }
    }
    if let Some(layers) = mesh.layers() {
        let layers: Vec<[u32; 1]> = (0..n).map(|index| [layers[cloth.mesh_vertex(index).index()]]).collect();
        writer.u32s(id::LAYERS, &layers);
    }
    if let Some(outwards) = mesh.outwards() {
        writer.bytes(id::OUTWARDS, outwards.iter().map(|&is_outwards| u8::from(is_outwards)).collect());
    }
    let (payload, num_sections) = writer.finish();
    [&u64::from(num_sections).to_le_bytes()[..], &payload].concat()
}
