//! Publishing: from the outcome of a frame to the header and the values of the sample that a host reads.

use untangled_proto::{
    CorrectionHeader, CorrectionKind, StateHeader, Status, VertexCorrection, VertexEntry,
    correction::{NO_FAULT, TRUNCATED, flags, pair_type},
};

use untangle::{
    labels::VertexLabel,
    mesh::{Mesh, VertexId},
    paths::PairType,
    respond::{Corrections, VertexFlags},
    untangler::Outcome,
};

use super::{cloth::Cloth, ingest::StateFault};

const _: () = assert!(
    VertexFlags::INSIDE.0 == flags::INSIDE
        && VertexFlags::NEAR_PATH.0 == flags::NEAR_PATH
        && VertexFlags::CLAMPED.0 == flags::CLAMPED
        && VertexFlags::PINNED.0 == flags::PINNED,
    "flags on the wire are those of the library"
);

/// The header for a frame that can't be used, or that a limit ended before its intersections were found.
pub(crate) fn refused(state: &StateHeader, kind: CorrectionKind, fault: StateFault) -> CorrectionHeader {
    CorrectionHeader {
        frame: state.frame,
        simulated_s: state.simulated_s,
        dt_s: state.dt_s,
        status: fault.status.code(),
        kind: kind as u32,
        flags: match fault.status {
            Status::TooManyIntersections | Status::OutOfTime => TRUNCATED,
            _ => 0,
        },
        fault_index: fault.index,
        fault_value: fault.value,
        ..CorrectionHeader::default()
    }
}

/// The header for a frame that was worked on; times are filled in last.
pub(crate) fn header(state: &StateHeader, outcome: &Outcome<'_>, values: &Values<'_>) -> CorrectionHeader {
    let analysis = outcome.analysis;
    let Values { cloth, corrections, kind, ref touched, .. } = *values;
    let mut num_pairs = [0; 16];
    for pair in &analysis.paths.pairs {
        num_pairs[pair_index(pair.pair_type)] += 1;
    }
    let left_out = corrections.left_out;
    let per_second2 = 1.0 / (state.dt_s * state.dt_s);
    CorrectionHeader {
        frame: state.frame,
        simulated_s: state.simulated_s,
        dt_s: state.dt_s,
        status: Status::Ok.code(),
        kind: kind as u32,
        flags: if left_out.num_pairs > 0 || left_out.gap { TRUNCATED } else { 0 },
        num_vertices: state.num_vertices,
        fault_index: NO_FAULT,
        num_edge_face_intersections: analysis.intersections.edge_face.len() as u64,
        num_face_pairs: analysis.intersections.segments.len() as u64,
        contour_length_m: analysis.paths.pairs.iter().map(|pair| pair.length_m).sum(),
        num_inside: touched.num_inside(cloth, corrections) as u64,
        max_displacement_m: corrections.max_displacement_m,
        net_force_n: (corrections.net_force * per_second2).into(),
        net_torque_nm: (corrections.net_torque * per_second2).into(),
        num_pairs,
        num_pairs_left_out: left_out.num_pairs as u64,
        length_left_out_m: left_out.length_m,
        ..CorrectionHeader::default()
    }
}

/// Memory for what a frame says of the host's vertices, where these are welded.
#[derive(Debug, Default)]
pub(crate) struct TouchedMemory {
    vertices: Vec<VertexId>,
    labels: Vec<VertexLabel>,
}

/// The host's vertices that a frame says something of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touched<'a> {
    vertices: &'a [VertexId],
    labels: &'a [VertexLabel],
}

impl<'a> Touched<'a> {
    /// Those of a frame: without welded vertices they are the mesh's own, and nothing is copied.
    pub(crate) fn of(cloth: &Cloth, corrections: &'a Corrections, memory: &'a mut TouchedMemory) -> Self {
        let TouchedMemory { vertices, labels } = memory;
        let vertices = cloth.host_vertices(&corrections.touched, vertices);
        let labels = cloth.host_labels(&corrections.labels, labels);
        Self { vertices, labels }
    }

    /// How many of them are flagged inside.
    fn num_inside(&self, cloth: &Cloth, corrections: &Corrections) -> usize {
        let flags = |vertex: &VertexId| corrections.flags[cloth.mesh_vertex(vertex.index()).index()];
        self.vertices.iter().filter(|vertex| flags(vertex).contains(VertexFlags::INSIDE)).count()
    }
}

/// What a correction says of the host's vertices for a frame whose step is `dt_s` seconds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Values<'a> {
    pub(crate) cloth: &'a Cloth,
    pub(crate) corrections: &'a Corrections,
    pub(crate) touched: Touched<'a>,
    pub(crate) kind: CorrectionKind,
    pub(crate) dt_s: f64,
}

impl<'a> Values<'a> {
    /// The vertices that may have a value or a flag other than pinned, ascending.
    pub(crate) fn touched(&self) -> impl ExactSizeIterator<Item = VertexId> + 'a {
        self.touched.vertices.iter().copied()
    }

    /// What is said of a vertex.
    pub(crate) fn vertex(&self, index: usize) -> VertexCorrection {
        let Self { cloth, corrections, kind, dt_s, .. } = *self;
        let share = if kind == CorrectionKind::Force { cloth.share(index) } else { 1.0 };
        shared_vertex(cloth.mesh(), corrections, kind, dt_s, cloth.mesh_vertex(index).index(), share)
    }

    /// An entry for each vertex that has a value or a flag other than pinned, ascending.
    pub(crate) fn entries(&self) -> impl Iterator<Item = VertexEntry> {
        self.touched().filter_map(|vertex| {
            let VertexCorrection { value, flags } = self.vertex(vertex.index());
            // A force may be too small for single precision.
            let is_said = flags & !flags::PINNED != 0 || value.iter().any(|value| value.to_bits() != 0);
            is_said.then_some(VertexEntry { vertex: vertex.0, value, flags })
        })
    }

    /// What is said of a vertex that is not touched.
    pub(crate) fn rest(&self, index: usize) -> VertexCorrection {
        let is_pinned = self.cloth.mesh().is_pinned(self.cloth.mesh_vertex(index));
        VertexCorrection { value: [0.0; 3], flags: if is_pinned { flags::PINNED } else { 0 } }
    }

    /// Labels, ascending by vertex.
    pub(crate) fn labels(&self) -> &'a [VertexLabel] {
        self.touched.labels
    }
}

/// The value and flags of one vertex, in the unit that the host asked for, for a frame whose step is `dt_s` seconds.
///
/// A value that single precision can't hold is sent as zero with the flag "clamped".
#[must_use]
pub fn vertex(
    mesh: &Mesh,
    corrections: &Corrections,
    kind: CorrectionKind,
    dt_s: f64,
    index: usize,
) -> VertexCorrection {
    shared_vertex(mesh, corrections, kind, dt_s, index, 1.0)
}

/// The value and flags of a vertex that gets a share of its value.
fn shared_vertex(
    mesh: &Mesh,
    corrections: &Corrections,
    kind: CorrectionKind,
    dt_s: f64,
    index: usize,
    share: f64,
) -> VertexCorrection {
    let mass_kg = mesh.masses_kg().map_or(1.0, |masses| masses[index]);
    let per_force = match kind {
        CorrectionKind::Force => 1.0 / (dt_s * dt_s),
        // A force does not move a vertex without mass, and the host does not integrate such a vertex.
        _ if mass_kg <= 0.0 => 0.0,
        CorrectionKind::Acceleration => 1.0 / (mass_kg * dt_s * dt_s),
        CorrectionKind::VelocityChange => 1.0 / (mass_kg * dt_s),
        CorrectionKind::Displacement => 1.0 / mass_kg,
    };
    #[expect(clippy::cast_possible_truncation, reason = "the wire carries single precision")]
    let value: [f32; 3] = (corrections.forces[index] * (share * per_force)).map(|value| value as f32).into();
    let flags = corrections.flags[index].0;
    if value.iter().all(|value| value.is_finite()) {
        VertexCorrection { value, flags }
    } else {
        // Too large for single precision; a host has no use for infinity.
        VertexCorrection { value: [0.0; 3], flags: flags | flags::CLAMPED }
    }
}

/// The index of a type of pairs on the wire.
pub(crate) fn pair_index(pair_type: PairType) -> usize {
    match pair_type {
        PairType::Closed => pair_type::CLOSED,
        PairType::Eight => pair_type::EIGHT,
        PairType::LoopLoop => pair_type::LOOP_LOOP,
        PairType::BoundaryLoopInside => pair_type::BOUNDARY_LOOP_INSIDE,
        PairType::BoundaryLoopBoundary => pair_type::BOUNDARY_LOOP_BOUNDARY,
        PairType::BoundaryLoopLoopBoundary => pair_type::BOUNDARY_LOOP_LOOP_BOUNDARY,
        PairType::Cross => pair_type::CROSS,
        PairType::BoundaryBoundaryInsideInside => pair_type::BB_II,
        PairType::BoundaryBoundaryBoundaryInside => pair_type::BB_BI,
        PairType::BoundaryBoundaryBoundaryBoundary => pair_type::BB_BB,
        PairType::BoundaryInside => pair_type::BI_BI,
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use untangle::mesh::MeshDescription;

    #[test]
    #[expect(clippy::float_cmp, reason = "all values are powers of two")]
    fn vertex_converts_units_and_clamps_overflow() {
        let mesh = |masses_kg| {
            let description =
                MeshDescription { num_vertices: 3, faces: vec![[0, 1, 2]], masses_kg, ..Default::default() };
            Mesh::new(description).unwrap()
        };
        let mut corrections = Corrections {
            forces: vec![Vector3::new(0.5, 0.0, -1.0); 3],
            flags: vec![VertexFlags::INSIDE; 3],
            ..Corrections::default()
        };
        let heavy = mesh(Some(vec![2.0, 2.0, 0.0]));
        let value = |mesh: &Mesh, kind, index| vertex(mesh, &corrections, kind, 0.5, index).value;
        assert_eq!(value(&heavy, CorrectionKind::Force, 0), [2.0, 0.0, -4.0]);
        assert_eq!(value(&heavy, CorrectionKind::Acceleration, 0), [1.0, 0.0, -2.0]);
        assert_eq!(value(&heavy, CorrectionKind::VelocityChange, 0), [0.5, 0.0, -1.0]);
        assert_eq!(value(&heavy, CorrectionKind::Displacement, 0), [0.25, 0.0, -0.5]);
        assert_eq!(value(&heavy, CorrectionKind::Displacement, 2), [0.0; 3]);
        assert_eq!(value(&mesh(None), CorrectionKind::Displacement, 0), [0.5, 0.0, -1.0]);
        corrections.forces[1].x = 1e200;
        let huge = vertex(&heavy, &corrections, CorrectionKind::Force, 0.5, 1);
        assert_eq!(huge, VertexCorrection { value: [0.0; 3], flags: flags::INSIDE | flags::CLAMPED });
    }
}
