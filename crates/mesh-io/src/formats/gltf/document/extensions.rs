//! Extensions of glTF that say where vertices are.

use crate::error::ReadErrorKind;

use super::schema::Document;

const DRACO: &str = "KHR_draco_mesh_compression";
const MESHOPT: &str = "EXT_meshopt_compression";

/// Extensions that hold vertices or faces in a compressed form.
const COMPRESSIONS: [&str; 3] = [DRACO, MESHOPT, "KHR_meshopt_compression"];

/// Other extensions that move, add or encode vertices and faces in ways that are not understood here. All further
/// extensions (materials, textures, lights, metadata, ...) leave vertices and faces where they are, and
/// `KHR_mesh_quantization` is read.
const PLACEMENTS: [&str; 9] = [
    "EXT_mesh_gpu_instancing",
    "EXT_mesh_primitive_restart",
    "KHR_mesh_primitive_restart",
    "EXT_primitive_voxels",
    "NV_displacement_micromap",
    "CESIUM_RTC",
    "MPEG_accessor_timed",
    "MPEG_buffer_circular",
    "MPEG_mesh_linking",
];

/// Refuses a document that cannot be read without one of these extensions.
pub(super) fn check(document: &Document) -> Result<(), ReadErrorKind> {
    let required = |name: &str| document.extensions_required.iter().any(|required| required == name);
    if let Some(name) = COMPRESSIONS.iter().find(|name| required(name)) {
        return Err(compressed(name));
    }
    if let Some(name) = PLACEMENTS.iter().find(|name| required(name)) {
        return Err(ReadErrorKind::Extension {
            name: (*name).to_owned(),
            reason: "it changes where vertices or faces are, and is not read; export the model without it".to_owned(),
        });
    }
    Ok(())
}

/// The extension by which the data of a document may stand in a compressed form, if it uses one. Cost: O(n).
pub(crate) fn compression(document: &Document) -> Option<&'static str> {
    let mut named = document.extensions_used.iter().chain(&document.extensions_required);
    let named = named.find_map(|name| COMPRESSIONS.iter().find(|known| *known == name));
    let has_draco = || {
        let mut primitives = document.meshes.iter().flat_map(|mesh| &mesh.primitives);
        primitives.any(|primitive| primitive.extensions.draco.is_some())
    };
    let has_meshopt = || document.buffer_views.iter().any(|view| view.extensions.meshopt.is_some());
    named.copied().or_else(|| has_draco().then_some(DRACO)).or_else(|| has_meshopt().then_some(MESHOPT))
}

/// The refusal of a document whose data is in a compressed form.
pub(crate) fn compressed(name: &str) -> ReadErrorKind {
    let kind = if name == DRACO { "Draco" } else { "meshopt" };
    let reason = format!("{kind}-compressed meshes are not read; export the model without compression");
    ReadErrorKind::Extension { name: name.to_owned(), reason }
}
