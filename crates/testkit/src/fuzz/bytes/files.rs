//! Mesh files and stages.

use std::sync::Arc;

use untangle::{frame::Frame, mesh::Mesh, settings::Settings, untangler::Untangler};
use untangled_mesh_io::{VertexCache, concatenate, read_mesh};

use super::scratch;
use crate::fuzz::checks::{check_file, check_frame, check_mesh, check_refusal, check_stage};

pub(super) fn obj(bytes: &[u8]) -> bool {
    mesh_file("obj", bytes)
}

pub(super) fn ply(bytes: &[u8]) -> bool {
    mesh_file("ply", bytes)
}

pub(super) fn stl(bytes: &[u8]) -> bool {
    mesh_file("stl", bytes)
}

pub(super) fn gltf(bytes: &[u8]) -> bool {
    // The first bytes tell the container.
    mesh_file("gltf", bytes)
}

/// A mesh file with this extension; whether it was accepted.
pub(in crate::fuzz) fn mesh_file(extension: &str, bytes: &[u8]) -> bool {
    let path = scratch::write(&format!("mesh.{extension}"), bytes);
    let file = match read_mesh(&path) {
        Ok(file) => file,
        Err(error) => {
            check_refusal(&error.to_string(), &path);
            return false;
        }
    };
    check_file(&file, bytes);
    let Ok(world) = concatenate(std::slice::from_ref(&file)) else { return false };
    let positions = world.positions.clone();
    let Ok(mesh) = Mesh::new(world.description) else { return false };
    check_mesh(&mesh);
    let mut frame = Frame::default();
    if frame.set(&mesh, positions.into_iter()).is_ok() {
        let mut untangler = Untangler::new(Arc::new(mesh), Settings::default()).expect("defaults are valid");
        check_frame(&mut untangler, &frame);
    }
    true
}

/// A stage, text, binary or an archive; whether it was accepted.
pub(in crate::fuzz) fn usd(bytes: &[u8]) -> bool {
    let path = scratch::write("stage.usd", bytes);
    match VertexCache::open_usd(&path, "/world") {
        Ok((file, cache)) => check_stage(&file, &cache, &path),
        Err(error) => {
            check_refusal(&error.to_string(), &path);
            return false;
        }
    }
    true
}
