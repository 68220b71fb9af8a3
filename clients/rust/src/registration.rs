//! A registration: what a host tells the daemon about its cloth, once.

use untangled_proto::{
    CorrectionKind, PayloadLayout, Precision, RegisterParams, SessionOptions, memory,
    sections::{SectionWriter, id},
};

/// A cloth and what is asked for. Only `num_vertices` and `triangles` are required.
#[derive(Clone, Debug, Default)]
pub struct Registration {
    /// Number of vertices.
    pub num_vertices: usize,
    /// Triangles, `num_faces x 3` vertex indices.
    pub triangles: Vec<[u32; 3]>,
    /// Texture coordinates with indices of their own.
    pub uvs: Option<Uvs>,
    /// Unstrained positions in metres, `num_vertices x 3`.
    pub rest_positions: Option<Vec<[f64; 3]>>,
    /// Mass of each vertex in kilograms, `num_vertices`; needed for [`CorrectionKind::Force`].
    pub masses_kg: Option<Vec<f64>>,
    /// Vertices that the host does not let move.
    pub pins: Vec<u32>,
    /// Layer of each vertex, `num_vertices`, from the body outwards. What is outwards is decided by `rest_positions`,
    /// else in each frame by itself.
    pub layers: Option<Vec<u32>>,
    /// Vertices of bodies: the host alone moves them, cloth belongs outside of them, and they get no corrections. A
    /// face has all of its corners among them, or none. Bodies may intersect each other and themselves. A daemon that
    /// does not know bodies is an error of [`Client::register`](crate::Client::register).
    pub body: Vec<u32>,
    /// Precision of the positions that will be published.
    pub precision: Precision,
    /// The unit of corrections.
    pub correction: CorrectionKind,
    /// Whether corrections shall list only the vertices that have a value or a flag: an untangled frame then costs
    /// nothing for each vertex. A daemon that is too old sends all vertices: see
    /// [`Session::is_sparse`](crate::Session::is_sparse). [`Correction`](crate::Correction) reads the same either way.
    pub sparse: bool,
    /// Whether corrections shall have labels, which say of single contacts whether they have to be off. Makes them
    /// sparse as well; see [`Session::has_labels`](crate::Session::has_labels).
    pub labels: bool,
    /// Whether corrections shall bring the intersection paths of their frame, for pictures and statistics.
    pub paths: bool,
    /// Whether frames of this cloth may be repaired: see [`Session::repair`](crate::Session::repair). Takes shared
    /// memory for four frames more. Without a daemon that knows repairs there are none: see
    /// [`Session::has_repairs`](crate::Session::has_repairs).
    pub repairs: bool,
    /// Whether vertices with exactly one place in `rest_positions` are one along seams, for meshes that were split for
    /// texture coordinates or normals. Ids stay; vertices that are one have to be in one place in each state, get
    /// corrections that keep them there, and share what is a force by their masses. What is welded is decided as for
    /// files by `untangled fix`. A daemon that does not know it is an error of
    /// [`Client::register`](crate::Client::register). See
    /// [`Session::num_welded_vertices`](crate::Session::num_welded_vertices).
    pub weld: bool,
    /// Settings by name, as in `untangled config`; `null` or an empty object for the daemon's defaults.
    pub settings: serde_json::Value,
}

/// Texture coordinates: an atlas in which a corner, not a vertex, has its place.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Uvs {
    /// `num_coordinates x 2`.
    pub coordinates: Vec<[f64; 2]>,
    /// For each face the coordinate index of its three corners, `num_faces x 3`.
    pub corners: Vec<[u32; 3]>,
}

impl Registration {
    /// The payload of the request, and the number of its sections.
    pub(crate) fn encode(&self) -> (Vec<u8>, u32) {
        let params = RegisterParams {
            num_vertices: self.num_vertices as u64,
            precision: self.precision as u32,
            correction: self.correction as u32,
            reserved: [0; 2],
        };
        let mut writer = SectionWriter::default();
        writer.bytes(id::PARAMS, params.to_bytes().to_vec()).u32s(id::TRIANGLES, &self.triangles);
        if let Some(uvs) = &self.uvs {
            writer.f64s(id::UV_COORDINATES, &uvs.coordinates).u32s(id::UV_CORNERS, &uvs.corners);
        }
        if let Some(rest_positions) = &self.rest_positions {
            writer.f64s(id::REST_POSITIONS, rest_positions);
        }
        if let Some(masses) = &self.masses_kg {
            writer.f64s(id::MASSES, masses.as_chunks::<1>().0);
        }
        if !self.pins.is_empty() {
            writer.u32s(id::PINS, self.pins.as_chunks::<1>().0);
        }
        if let Some(layers) = &self.layers {
            writer.u32s(id::LAYERS, layers.as_chunks::<1>().0);
        }
        if let Some(settings) = settings_bytes(&self.settings) {
            writer.bytes(id::SETTINGS, settings);
        }
        let options = self.options();
        if options != SessionOptions::default() {
            writer.u32s(id::OPTIONS, &[[options.bits()]]);
        }
        if !self.body.is_empty() {
            writer.u32s(id::BODY, self.body.as_chunks::<1>().0);
        }
        writer.finish()
    }

    /// What the session asks for beyond what protocol 1 began with.
    pub(crate) fn options(&self) -> SessionOptions {
        let asked = [
            (self.sparse, SessionOptions::SPARSE),
            (self.labels, SessionOptions::LABELS),
            (self.repairs, SessionOptions::REPAIR),
            (self.weld, SessionOptions::WELD),
        ];
        let asked = asked.into_iter().filter(|(is_asked, _)| *is_asked);
        asked.fold(SessionOptions::default(), |options, (_, option)| options.with(option))
    }

    /// Shared memory that the host's side of the session takes.
    pub(crate) fn state_segment_bytes(&self, layout: PayloadLayout) -> u64 {
        memory::state_segment_bytes(self.num_vertices, self.precision, layout)
    }
}

/// The document of a settings section; nothing for `null`.
pub(crate) fn settings_bytes(settings: &serde_json::Value) -> Option<Vec<u8>> {
    if settings.is_null() { None } else { Some(settings.to_string().into_bytes()) }
}
