//! What could not be resolved.

use serde::Serialize;

use untangle::{
    paths::PairType,
    relax::BlockedPath,
    sides::{Sides, clusters},
};

use crate::cli::{
    input::Input,
    owners::{OwnedVertex, Owners},
};

/// A path that could not be resolved.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Blocked {
    /// Its type; nothing for vertices inside of a body.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pair_type: Option<PairType>,
    /// For vertices inside of a body, joined by edges, how many they are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub num_vertices_inside_body: Option<usize>,
    /// A vertex next to it, counted from 0 over all files.
    pub vertex: u32,
    /// The file of that vertex.
    pub file: String,
    /// The vertex counted from 0 in its file.
    pub vertex_in_file: usize,
    /// The object or group that it stands in, if that has a name.
    pub part: Option<String>,
    /// Its length in metres; of vertices inside of a body the largest depth.
    pub length_m: f64,
    /// Why, in words.
    pub reason: String,
}

impl From<BlockedPath> for Blocked {
    fn from(path: BlockedPath) -> Self {
        let BlockedPath { pair_type, vertex, length_m, reason } = path;
        Self {
            pair_type: Some(pair_type),
            num_vertices_inside_body: None,
            vertex,
            file: String::new(),
            vertex_in_file: vertex as usize,
            part: None,
            length_m,
            reason,
        }
    }
}

impl Blocked {
    /// What is inside of bodies in a state, cluster by cluster.
    pub(in crate::cli::fix) fn inside_bodies(Input { weld, mesh, frame, .. }: &Input) -> Vec<Self> {
        let Some(sides) = Sides::of(mesh, frame) else { return Vec::new() };
        let blocked = clusters(mesh, &sides.wrong_vertices(mesh, frame)).into_iter().map(|cluster| {
            let vertex = weld.first(cluster.vertex);
            let reason = match cluster.num_pinned {
                0 => "no motion brought it out of the body without crushing or overstretching the cloth",
                count if count == cluster.num_vertices => "all its vertices are pinned, inside of a body",
                _ => "a part of it is pinned inside of a body",
            };
            Self {
                pair_type: None,
                num_vertices_inside_body: Some(cluster.num_vertices),
                vertex,
                file: String::new(),
                vertex_in_file: vertex as usize,
                part: None,
                length_m: cluster.depth_m,
                reason: reason.to_owned(),
            }
        });
        blocked.collect()
    }

    /// Says to whom the vertices of paths belong.
    pub(in crate::cli) fn name_owners(blocked: &mut [Self], owners: &Owners<'_>) {
        let of = owners.of_vertices(blocked.iter().map(|path| path.vertex));
        for (path, owner) in blocked.iter_mut().zip(of) {
            if let Some(OwnedVertex { file, vertex_in_file, part }) = owner {
                (path.file, path.vertex_in_file, path.part) = (file, vertex_in_file, part);
            }
        }
    }
}
