//! One trial displacement: found, made within strain limits, shortened by a line search, with its memory.

use nalgebra::Point3;

use super::{
    choice::{Groups, Seams},
    damping::{Backtracking, Damping},
    displacement::{DisplacementSolver, Start},
    islands::Islands,
    precision::Precision,
    tangle::{Tangle, measure},
};
use crate::{
    correspond::MaterialPoint,
    frame::Frame,
    intersect::{Intersections, Intersector, SearchEnd, SearchLimits},
    mesh::{Mesh, VertexId},
    relax::{
        constraints::{Constraints, Objective, StrainLimits},
        energy::{ArapEnergy, Domain},
        settings::StopObserver,
        sides::SideTracker,
    },
    sparse_map::SparseMap,
};

/// Longest displacement of one iteration, in mean edge lengths of the faces that intersect.
const MAX_LENGTH: f64 = 6.0;
/// How often a displacement is found again, with the contacts of its step as constraints.
const CONTACT_ROUNDS: usize = 2;
/// Gap that is kept at a contact, as a part of the length of the edge there.
const CONTACT_GAP: f64 = 0.3;
/// Line search: how often a displacement that leaves some island no less tangled is halved.
const MAX_HALVINGS: usize = 3;
/// Backtracking of vertices beyond a strain limit.
const BACKTRACKING: Backtracking = Backtracking { halvings: 3, stops: 7 };

/// How a trial displacement is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TrialSettings {
    pub(crate) objective: Objective,
    /// Its root is the length, in edges, over which a displacement decays.
    pub(crate) stiffness: f64,
    /// Edges that change their length by more than this factor get stiffer.
    pub(crate) max_stretch: f64,
}

/// What all trials of one iteration share.
#[derive(Clone, Copy)]
pub(crate) struct TrialContext<'a> {
    pub(crate) energy: ArapEnergy<'a>,
    /// The intersections of the present state.
    pub(crate) present: &'a Intersections,
    pub(crate) sides: Option<&'a SideTracker>,
    pub(crate) islands: &'a Islands,
    pub(crate) limits: &'a StrainLimits,
    /// Vertices where the sheets are to pass through each other: what meets there is no contact.
    pub(crate) passing: &'a SparseMap<VertexId, ()>,
    /// How tangled each island is now.
    pub(crate) now: &'a [Tangle],
    /// Mean edge length of the faces that intersect, in metres.
    pub(crate) edge_length_m: f64,
    pub(crate) precision: Precision,
    /// Where a search for intersections ends.
    pub(crate) search_limits: SearchLimits,
}

/// A state that is judged island by island.
#[derive(Debug, Default)]
pub(crate) struct JudgedState {
    pub(crate) positions: Vec<Point3<f64>>,
    /// For each island, and last for what lies near none.
    pub(crate) tangles: Vec<Tangle>,
    /// For each island the largest logarithm of an edge's length over that in the input.
    pub(crate) strains: Vec<f64>,
}

/// One trial displacement.
#[derive(Debug, Default)]
pub(crate) struct Trial {
    pub(crate) constraints: Constraints,
    /// The best of the steps along the displacement, island by island.
    pub(crate) best: JudgedState,
    /// Whether there is anything in `best`.
    pub(crate) is_usable: bool,
    solver: DisplacementSolver,
    step: JudgedState,
    frame: Frame,
    intersector: Intersector,
    found: Intersections,
    damping: Damping,
    violated: Vec<usize>,
    mixed: Vec<Point3<f64>>,
}

impl Trial {
    /// Finds the displacement that satisfies the constraints, with its contacts, and the best step along it.
    ///
    /// Nothing in it is usable where `should_stop` ends the work before a first step is judged.
    pub(crate) fn run(&mut self, context: &TrialContext<'_>, settings: TrialSettings, should_stop: &dyn Fn() -> bool) {
        self.is_usable = self.displace(context, settings, should_stop);
        if self.is_usable {
            self.best.positions.clone_from(&self.step.positions);
            self.best.tangles.clone_from(&self.step.tangles);
            self.best.strains.clone_from(&self.step.strains);
            self.line_search(context, should_stop);
        }
    }

    /// Finds the displacement and makes the step; again, where it meets something. False where the numbers don't allow
    /// it.
    fn displace(
        &mut self,
        context: &TrialContext<'_>,
        settings: TrialSettings,
        should_stop: &dyn Fn() -> bool,
    ) -> bool {
        for round in 0..=CONTACT_ROUNDS {
            let start = if round > 0 { Start::Warm } else { Start::Cold };
            let TrialSettings { stiffness, max_stretch, .. } = settings;
            if !self.solver.solve(&context.energy, stiffness, max_stretch, &self.constraints, start, should_stop) {
                return false;
            }
            self.limit_length(context);
            if !self.judge(context, should_stop) {
                return false;
            }
            if round == CONTACT_ROUNDS || !self.add_contacts(context) {
                break;
            }
        }
        true
    }

    /// Halves the displacement as long as it does not help every island, and keeps the best step of each island.
    fn line_search(&mut self, context: &TrialContext<'_>, should_stop: &dyn Fn() -> bool) {
        for _ in 0..MAX_HALVINGS {
            let helps = |(best, now): (&Tangle, &Tangle)| best.is_none() || best.merit() < now.merit();
            if self.best.tangles.iter().zip(context.now).all(helps) || should_stop() {
                break;
            }
            for displacement in &mut self.solver.displacement {
                *displacement *= 0.5;
            }
            if !self.judge(context, should_stop) {
                break;
            }
            self.keep_better(context);
        }
    }

    /// Scales down the displacement of islands that go too far.
    fn limit_length(&mut self, context: &TrialContext<'_>) {
        let TrialContext { energy: ArapEnergy { domain, .. }, islands, .. } = *context;
        let limit = MAX_LENGTH * context.edge_length_m;
        let mut largest = vec![0.0f64; islands.len() + 1];
        for (&vertex, displacement) in domain.vertices().iter().zip(&self.solver.displacement) {
            let largest = &mut largest[islands.of(vertex)];
            *largest = largest.max(displacement.norm());
        }
        for (&vertex, displacement) in domain.vertices().iter().zip(&mut self.solver.displacement) {
            let largest = largest[islands.of(vertex)];
            if largest > limit {
                *displacement *= limit / largest;
            }
        }
    }

    /// Makes the step and measures where it leads; false where the numbers don't allow it.
    fn judge(&mut self, context: &TrialContext<'_>, should_stop: &dyn Fn() -> bool) -> bool {
        let TrialContext { energy: ArapEnergy { mesh, domain, .. }, islands, limits, .. } = *context;
        self.make_step(context);
        if self.frame.set(mesh, self.step.positions.iter().map(|point| (*point).into())).is_err() {
            return false;
        }
        let (search_limits, mut observer) = (context.search_limits, StopObserver(should_stop));
        let end = self.intersector.intersect_within(mesh, &self.frame, search_limits, &mut observer, &mut self.found);
        if end != SearchEnd::Complete {
            return false;
        }
        measure(mesh, &self.frame, &self.found, context.sides, islands, &mut self.step.tangles);
        island_strains(mesh, domain, islands, limits, &self.step.positions, &mut self.step.strains);
        true
    }

    /// Moves, damping the displacement round vertices beyond their strain limits.
    fn make_step(&mut self, context: &TrialContext<'_>) {
        let TrialContext { energy: ArapEnergy { mesh, frame, domain, .. }, islands, limits, .. } = *context;
        let vertices = domain.vertices();
        let before = frame.positions();
        self.step.positions.clear();
        self.step.positions.extend_from_slice(before);
        self.damping.reset(vertices.len());
        for round in 0.. {
            for (local, &vertex) in vertices.iter().enumerate() {
                let displacement = self.solver.displacement[local] * self.damping.factor(local);
                self.step.positions[vertex.index()] = context.precision.moved(before[vertex.index()], displacement);
            }
            self.violated.clear();
            let is_violated = |vertex| limits.is_violated(mesh, before, &self.step.positions, vertex);
            self.violated.extend((0..vertices.len()).filter(|&local| is_violated(vertices[local])));
            if self.violated.is_empty() {
                break;
            }
            if round < BACKTRACKING.num_rounds() {
                self.damping.damp(mesh, domain, self.violated.iter().copied(), BACKTRACKING.factor(round));
            } else {
                // The last resort: nothing moves in these islands. What is violated has moved, so that each round stops
                // another one.
                let mut is_stopped = vec![false; islands.len() + 1];
                for &local in &self.violated {
                    is_stopped[islands.of(vertices[local])] = true;
                }
                if !self.damping.stop(|local| is_stopped[islands.of(vertices[local])]) {
                    break;
                }
            }
        }
    }

    /// Adds constraints where the step made new intersections; false if there are none.
    fn add_contacts(&mut self, context: &TrialContext<'_>) -> bool {
        let before = self.constraints.len();
        let ArapEnergy { mesh, frame, .. } = context.energy;
        for found in &self.found.edge_face {
            let is_old = context
                .present
                .edge_face
                .binary_search_by(|other| (other.edge, other.face).cmp(&(found.edge, found.face)))
                .is_ok();
            let (ends, corners) = (mesh.edge(found.edge), mesh.face(found.face));
            let passes = |vertices: &[VertexId]| vertices.iter().any(|&vertex| context.passing.contains(vertex));
            if is_old || (passes(&ends) && passes(&corners)) {
                continue;
            }
            let own = MaterialPoint {
                vertices: [ends[0], ends[1], ends[1]],
                weights: [1.0 - found.edge_parameter, found.edge_parameter, 0.0],
            };
            let partner = MaterialPoint { vertices: corners, weights: found.barycentric };
            let edge_m = (frame.position(ends[1]) - frame.position(ends[0])).norm();
            self.constraints.keep_apart(frame, &own, &partner, CONTACT_GAP * edge_m);
        }
        self.constraints.len() > before
    }

    /// Takes over the islands that the last step leaves less tangled, those together that would tear each other.
    fn keep_better(&mut self, context: &TrialContext<'_>) {
        let TrialContext { energy: ArapEnergy { mesh, frame, domain, .. }, islands, limits, .. } = *context;
        let seams = Seams { mesh, domain, islands, limits, before: frame.positions() };
        let mut groups = Groups::of_single_islands(self.step.tangles.len());
        let merit = |state: &JudgedState, group: &[usize]| -> f64 {
            group.iter().map(|&island| state.tangles[island].merit()).sum()
        };
        let mut is_better = vec![false; self.step.tangles.len()];
        loop {
            for group in groups.members() {
                let better = merit(&self.step, &group) < merit(&self.best, &group);
                for island in group {
                    is_better[island] = better;
                }
            }
            self.mixed.clone_from(&self.best.positions);
            for &vertex in domain.vertices().iter().filter(|&&vertex| is_better[islands.of(vertex)]) {
                self.mixed[vertex.index()] = self.step.positions[vertex.index()];
            }
            if !groups.join_torn(&seams, &self.mixed) {
                break;
            }
        }
        self.best.positions.clone_from(&self.mixed);
        for island in (0..is_better.len()).filter(|&island| is_better[island]) {
            self.best.tangles[island] = self.step.tangles[island];
            self.best.strains[island] = self.step.strains[island];
        }
    }
}

/// For each island the largest strain of an edge at a vertex of the domain: the logarithm of its length over that in
/// the input.
pub(crate) fn island_strains(
    mesh: &Mesh,
    domain: &Domain,
    islands: &Islands,
    limits: &StrainLimits,
    positions: &[Point3<f64>],
    strains: &mut Vec<f64>,
) {
    strains.clear();
    strains.resize(islands.len() + 1, 0.0);
    for &vertex in domain.vertices() {
        let strain = &mut strains[islands.of(vertex)];
        for &edge in mesh.vertex_edges(vertex) {
            *strain = strain.max(limits.strain(mesh, positions, edge));
        }
    }
}
