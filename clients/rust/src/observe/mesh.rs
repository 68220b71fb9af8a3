//! What stays the same while a session lives.

use untangled_proto::{
    CorrectionKind, Precision, RegisterParams,
    limits::{MAX_FACES, MAX_VERTICES},
    sections::{SectionError, Sections, id},
};

/// The mesh of a session, by the host's vertices.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ObservedMesh {
    /// Number of vertices.
    pub num_vertices: usize,
    /// Vertices of each face.
    pub triangles: Vec<[u32; 3]>,
    /// Vertices of bodies, ascending.
    pub body: Vec<u32>,
    /// Vertices that the host does not let move, ascending.
    pub pins: Vec<u32>,
    /// Layer of each vertex, from the body outwards; none where the host said nothing of layers.
    pub layers: Option<Vec<u32>>,
    /// For each face whether its normal points outwards of its layer, where rest positions decided that; none where
    /// each frame decides it by itself.
    pub outwards: Option<Vec<bool>>,
    /// Precision of the session's positions; those of observations are single.
    pub precision: Precision,
    /// What the values of corrections are.
    pub correction: CorrectionKind,
}

impl ObservedMesh {
    /// More bytes than any mesh has on the wire: three indices and a byte a face; a place in the list of bodies, one in
    /// that of pins and a layer a vertex; and what comes before them.
    pub(super) const MOST_BYTES: u64 = (13 * MAX_FACES + 12 * MAX_VERTICES) as u64 + (1 << 16);

    /// The mesh as a daemon sends it, if its parts fit together; else what does not.
    pub(super) fn read(bytes: &[u8]) -> Result<Self, String> {
        let in_words = |error: SectionError| error.to_string();
        let (num_sections, payload) = bytes.split_first_chunk().ok_or("it has no sections")?;
        let num_sections = usize::try_from(u64::from_le_bytes(*num_sections)).unwrap_or(usize::MAX);
        let sections = Sections::parse(payload, num_sections).map_err(in_words)?;
        let params = sections.bytes(id::PARAMS).and_then(RegisterParams::from_bytes).ok_or("it has no parameters")?;
        let list = |id| {
            let values = sections.u32s::<1>(id).map_err(in_words)?;
            Ok::<_, String>(values.map(Vec::into_flattened))
        };
        let mesh = Self {
            num_vertices: usize::try_from(params.num_vertices).map_err(|error| error.to_string())?,
            triangles: sections.u32s(id::TRIANGLES).map_err(in_words)?.unwrap_or_default(),
            body: list(id::BODY)?.unwrap_or_default(),
            pins: list(id::PINS)?.unwrap_or_default(),
            layers: list(id::LAYERS)?,
            outwards: sections.bytes(id::OUTWARDS).map(|bytes| bytes.iter().map(|&byte| byte != 0).collect()),
            precision: Precision::from_code(params.precision).ok_or("its precision is not known")?,
            correction: CorrectionKind::from_code(params.correction).ok_or("its kind of correction is not known")?,
        };
        mesh.check().map(|()| mesh)
    }

    fn check(&self) -> Result<(), String> {
        if self.num_vertices > MAX_VERTICES {
            return Err(format!("it has {} vertices; a session has at most {MAX_VERTICES}", self.num_vertices));
        }
        let is_outside = |vertex: &&u32| usize::try_from(**vertex).map_or(true, |index| index >= self.num_vertices);
        let mut named = self.triangles.as_flattened().iter().chain(&self.body).chain(&self.pins);
        if let Some(vertex) = named.find(is_outside) {
            return Err(format!("vertex {vertex} is named, and there are {}", self.num_vertices));
        }
        if let Some(layers) = self.layers.as_ref().filter(|layers| layers.len() != self.num_vertices) {
            return Err(format!("{} vertices have a layer, and there are {}", layers.len(), self.num_vertices));
        }
        let (outwards, num_faces) = (&self.outwards, self.triangles.len());
        match outwards.as_ref().filter(|outwards| outwards.len() != num_faces) {
            Some(outwards) => Err(format!("{} faces have an outward side, and there are {num_faces}", outwards.len())),
            None => Ok(()),
        }
    }

    /// Whether each vertex belongs to a body.
    #[must_use]
    pub fn is_body(&self) -> Vec<bool> {
        let mut is_body = vec![false; self.num_vertices];
        self.body.iter().for_each(|&vertex| is_body[vertex as usize] = true);
        is_body
    }
}

#[cfg(test)]
mod tests {
    use untangled_proto::sections::SectionWriter;

    use super::*;

    fn read(triangles: &[[u32; 3]], layers: &[u32]) -> Result<ObservedMesh, String> {
        read_of(3, triangles, layers)
    }

    fn read_of(num_vertices: u64, triangles: &[[u32; 3]], layers: &[u32]) -> Result<ObservedMesh, String> {
        read_all(num_vertices, triangles, layers, &[1])
    }

    fn read_all(
        num_vertices: u64,
        triangles: &[[u32; 3]],
        layers: &[u32],
        outwards: &[u8],
    ) -> Result<ObservedMesh, String> {
        let params = RegisterParams { num_vertices, precision: 1, correction: 2, ..RegisterParams::default() };
        let mut writer = SectionWriter::default();
        writer.bytes(id::PARAMS, params.to_bytes().to_vec()).u32s(id::TRIANGLES, triangles).u32s(id::PINS, &[[1]]);
        writer.u32s(id::LAYERS, &layers.iter().map(|&layer| [layer]).collect::<Vec<_>>());
        writer.bytes(id::OUTWARDS, outwards.to_vec());
        let (payload, num_sections) = writer.finish();
        ObservedMesh::read(&[&u64::from(num_sections).to_le_bytes()[..], &payload].concat())
    }

    #[test]
    fn mesh_is_read_and_one_that_does_not_fit_is_refused_in_words() {
        let mesh = read(&[[0, 2, 1]], &[4, 5, 6]).unwrap();
        assert_eq!((mesh.num_vertices, mesh.triangles, mesh.pins), (3, vec![[0, 2, 1]], vec![1]));
        assert_eq!((mesh.layers, mesh.precision), (Some(vec![4, 5, 6]), Precision::F64));
        assert_eq!((mesh.correction, mesh.outwards), (CorrectionKind::VelocityChange, Some(vec![true])));
        assert_eq!(read(&[[0, 3, 1]], &[0; 3]).unwrap_err(), "vertex 3 is named, and there are 3");
        assert_eq!(read(&[[0, 2, 1]], &[0; 2]).unwrap_err(), "2 vertices have a layer, and there are 3");
        let words = read_all(3, &[[0, 2, 1]], &[0; 3], &[0, 1]).unwrap_err();
        assert_eq!(words, "2 faces have an outward side, and there are 1");
        let words = read_of(1 << 40, &[[0, 2, 1]], &[0; 3]).unwrap_err();
        assert_eq!(words, "it has 1099511627776 vertices; a session has at most 16777216");
        assert_eq!(ObservedMesh::read(&[0; 8]).unwrap_err(), "it has no parameters");
        assert_eq!(ObservedMesh::read(&[0; 7]).unwrap_err(), "it has no sections");
    }
}
