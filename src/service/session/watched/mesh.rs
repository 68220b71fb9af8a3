//! The mesh of a session, for the reply to an observer.

use untangled_proto::{
    CorrectionKind, Precision, RegisterParams,
    sections::{SectionWriter, id},
};

use crate::service::session::cloth::Cloth;

/// The payload of the reply, and the number of its sections: parameters, triangles, and bodies, pins and layers where
/// there are such. All by the host's vertices; a corner on a welded seam is the lowest of those in its place.
pub(in crate::service::session) fn mesh_sections(
    cloth: &Cloth,
    precision: Precision,
    correction: CorrectionKind,
) -> (Vec<u8>, u32) {
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
    writer.finish()
}
