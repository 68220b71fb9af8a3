//! The JSON of a glTF document: its parts that are read (`schema`), checked once, so that every index in them can be
//! followed.

mod extensions;
mod numbers;
mod schema;

use serde::Deserialize;

use crate::error::ReadErrorKind;

pub(crate) use extensions::{compressed, compression};
pub(crate) use numbers::{Count, Single};
pub(crate) use schema::{Accessor, Buffer, BufferView, Document, Node, Primitive};

/// The version, which is read first: documents of version 1 have another form.
#[derive(Deserialize)]
#[serde(expecting = "an object is needed")]
struct Header {
    asset: Asset,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase", expecting = "`asset` is an object")]
struct Asset {
    version: String,
    min_version: Option<String>,
}

/// Parses a document and checks the indices that reading follows.
///
/// # Errors
/// [`ReadErrorKind::Gltf`] for what is no document of version 2; [`ReadErrorKind::Extension`].
pub(crate) fn parse(json: &[u8]) -> Result<Document, ReadErrorKind> {
    let invalid = |error: serde_json::Error| ReadErrorKind::Gltf(error.to_string());
    let Header { asset } = serde_json::from_slice(json).map_err(invalid)?;
    let version = asset.min_version.unwrap_or(asset.version);
    if !version.starts_with("2.") && version != "2" {
        let version: String = version.chars().take(16).collect();
        return Err(ReadErrorKind::Malformed(format!("is glTF of version `{version}`; version 2.0 is read")));
    }
    let document: Document = serde_json::from_slice(json).map_err(invalid)?;
    extensions::check(&document)?;
    check_indices(&document).map_err(ReadErrorKind::Gltf)?;
    Ok(document)
}

/// Checks that one member names an element that exists.
fn check(who: &dyn Fn() -> String, what: &str, index: Count, length: usize) -> Result<(), String> {
    if index.0 < length {
        return Ok(());
    }
    Err(format!("{} refers to {what} {}, but only {length} are defined", who(), index.0))
}

fn check_indices(document: &Document) -> Result<(), String> {
    let Document { scene, scenes, nodes, meshes, accessors, buffer_views, buffers, .. } = document;
    if let Some(scene) = scene {
        check(&|| "the document".to_owned(), "scene", *scene, scenes.len())?;
    }
    for (at, scene) in scenes.iter().enumerate() {
        for &node in &scene.nodes {
            check(&|| format!("scene {at}"), "node", node, nodes.len())?;
        }
    }
    for (at, node) in nodes.iter().enumerate() {
        let who = || format!("node {at}");
        for &child in &node.children {
            check(&who, "node", child, nodes.len())?;
        }
        if let Some(mesh) = node.mesh {
            check(&who, "mesh", mesh, meshes.len())?;
        }
    }
    for (at, mesh) in meshes.iter().enumerate() {
        for (number, primitive) in mesh.primitives.iter().enumerate() {
            for &accessor in primitive.attributes.values().chain(&primitive.indices) {
                check(&|| format!("mesh {at}, primitive {number}"), "accessor", accessor, accessors.len())?;
            }
        }
    }
    for (at, accessor) in accessors.iter().enumerate() {
        let sparse = accessor.sparse.as_ref();
        let sparse = sparse.map(|sparse| [sparse.indices.buffer_view, sparse.values.buffer_view]);
        for view in accessor.buffer_view.into_iter().chain(sparse.into_iter().flatten()) {
            check(&|| format!("accessor {at}"), "buffer view", view, buffer_views.len())?;
        }
    }
    for (at, view) in buffer_views.iter().enumerate() {
        check(&|| format!("buffer view {at}"), "buffer", view.buffer, buffers.len())?;
    }
    Ok(())
}
