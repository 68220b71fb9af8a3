//! The iterations of the descent.

use std::ops::ControlFlow;

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use super::{
    candidate::{Candidate, Context},
    limited_step::LimitedStep,
    motion::{ContourSegment, Motion, MotionFinder, Scene, contours},
    rows::Rows,
    score::{Score, add_moved},
    variant::{DescentVariant, Stage, recipes},
};
use crate::{
    analysis::Analysis,
    geometry::mean_edge_length,
    intersect::Intersector,
    paths::{IntersectionPaths, PathFinder},
    relax::{
        constraints::Constraints,
        energy::ArapEnergy,
        outcome::{BestState, End, Method, RelaxError},
        relaxer::{Progress, Relaxer},
        settings::Effort,
        sides::{SideRows, SideTracker},
        step::{island_strains, measure, num_movable, remove_pinned_chains},
    },
};

/// Rings round the constraints that may move, more of them where motions are deep.
const DOMAIN_RINGS: usize = 14;
const RINGS_FOR_DEPTH: f64 = 2.0;
const MAX_DOMAIN_RINGS: f64 = 46.0;
/// The part of the rest shape in the edges that are kept, from the second iteration on.
const REST_WEIGHT: f64 = 0.3;
/// Ends where so many iterations took away less than a part of the merit.
const PATIENCE: usize = 8;
/// The same where nothing intersects, and cloth is on the wrong side only: other ways are those of contours.
const PATIENCE_WITHOUT_CONTOURS: usize = 4;
const MIN_GAIN: f64 = 0.02;
/// Iterations without that much gain until other ways are tried.
const STALLED: usize = 2;
/// States with fewer edge-face intersections, or, on any fineness, no more path pairs get more candidates.
const FEW: usize = 400;
const FEW_PAIRS: usize = 32;

/// Iterates from the present state until nothing intersects any more, or nothing helps any more.
///
/// Cost: an iteration takes three to nine displacements, in parallel; each has some factorisations of a sparse system
/// over the vertices near the intersections, and up to three searches for intersections.
pub(in crate::relax) fn descend(
    relaxer: &mut Relaxer<'_>,
    variant: DescentVariant,
    best: &mut BestState,
    progress: &mut Progress<'_>,
) -> Result<End, RelaxError> {
    let mut descent = Descent::of(variant);
    // The least merit, and the iteration that reached it.
    let mut least = (f64::INFINITY, 0);
    for iteration in 0.. {
        descent.look(relaxer);
        let tangle: f64 = descent.now.iter().map(|score| score.tangle.merit()).sum();
        if tangle < best.merit {
            *best = BestState { merit: tangle, positions: relaxer.frame.positions().to_vec() };
        }
        if iteration > 0 && descent.report(relaxer, progress).is_break() {
            return Ok(End::Interrupted);
        }
        if descent.num_wrong == 0 && num_movable(relaxer.mesh, &descent.analysis.intersections) == 0 {
            return Ok(End::Clean);
        }
        if relaxer.is_exhausted() {
            return Ok(End::Exhausted);
        }
        let merit: f64 = descent.now.iter().map(Score::merit).sum();
        if merit < (1.0 - MIN_GAIN) * least.0 {
            least = (merit, iteration);
        }
        descent.stalled = iteration - least.1;
        let has_contours = !descent.analysis.paths.pairs.is_empty();
        if descent.stalled >= if has_contours { PATIENCE } else { PATIENCE_WITHOUT_CONTOURS } {
            break;
        }
        let positions = descent.step(relaxer, if iteration == 0 { 0.0 } else { REST_WEIGHT });
        if (relaxer.should_stop)() {
            return Ok(End::Interrupted);
        }
        relaxer.frame.set(relaxer.mesh, positions.iter().map(|point| (*point).into()))?;
    }
    Ok(End::Stuck)
}

/// The state of a descent.
struct Descent {
    variant: DescentVariant,
    intersector: Intersector,
    path_finder: PathFinder,
    /// Without regions, which are not needed here.
    analysis: Analysis,
    /// Each with its island.
    motions: Vec<(Motion, usize)>,
    now: Vec<Score>,
    /// Free vertices on the wrong side of bodies and layers.
    num_wrong: usize,
    sides: SideRows,
    /// For all kinds of rows.
    constraints: [Constraints; 3],
    candidates: Vec<Candidate>,
    limited: LimitedStep,
    edge_length_m: f64,
    /// Iterations without much gain.
    stalled: usize,
}

impl Descent {
    fn of(variant: DescentVariant) -> Self {
        Self {
            variant,
            intersector: Intersector::default(),
            path_finder: PathFinder::default(),
            analysis: Analysis::default(),
            motions: Vec::new(),
            now: Vec::new(),
            num_wrong: 0,
            sides: SideRows::default(),
            constraints: Default::default(),
            candidates: Vec::new(),
            limited: LimitedStep::default(),
            edge_length_m: 0.0,
            stalled: 0,
        }
    }

    /// Finds the contours of the present state, their motions and islands, and how good it is.
    fn look(&mut self, relaxer: &mut Relaxer<'_>) {
        let way = self.way();
        let Analysis { intersections, paths, regions } = &mut self.analysis;
        let Relaxer { mesh, frame, islands, domain, sides, .. } = relaxer;
        self.intersector.intersect(mesh, frame, intersections);
        remove_pinned_chains(mesh, intersections);
        self.path_finder.find(mesh, frame, intersections, paths);
        regions.by_copy.clear();
        regions.by_copy.resize(paths.copies.len(), None);
        let faces = intersections.segments.iter().flat_map(|segment| segment.faces);
        let mean_edge_m = mean_edge_length(mesh, frame, faces);
        self.edge_length_m = mean_edge_m.or(sides.as_ref().map(SideTracker::mean_edge_m)).unwrap_or(1.0);
        let mut wrong = Vec::new();
        if let Some(sides) = sides {
            sides.look(frame);
            wrong = sides.wrong_groups(mesh, frame.positions());
            self.sides.find(sides, mesh, frame, intersections);
        }
        self.num_wrong = wrong.len();
        let scene = Scene { mesh, frame, orientation: &relaxer.orientation, found: intersections };
        let motions = find_motions(&scene, paths, sides.as_ref(), way);
        let depth = motions.iter().map(|motion| motion.depth_m / motion.edge_length_m);
        let depth = depth.fold(self.sides.depth_edges(), f64::max);
        let rings = DOMAIN_RINGS + whole((RINGS_FOR_DEPTH * depth).min(MAX_DOMAIN_RINGS));
        islands.find(mesh, &self.analysis, &wrong, 2 * rings);
        domain.grow(mesh, motions.iter().flat_map(Motion::vertices).chain(self.sides.vertices()), rings);
        if let Some(sides) = sides {
            self.sides.find_near(sides, mesh, frame, domain);
        }
        self.motions.clear();
        for motion in motions {
            let island = islands.of(mesh.face(motion.first)[0]);
            self.motions.push((motion, island));
        }
        self.judge(relaxer);
    }

    /// Which of the ways out is taken: others than the shortest where that does not help.
    fn way(&self) -> usize {
        self.variant.way + self.stalled.saturating_sub(STALLED - 1)
    }

    /// Judges the present state.
    fn judge(&mut self, relaxer: &Relaxer<'_>) {
        let Relaxer { mesh, frame, islands, domain, rest, limits, .. } = relaxer;
        let (mut tangles, mut strains) = (Vec::new(), Vec::new());
        measure(mesh, frame, &self.analysis.intersections, relaxer.sides.as_ref(), islands, &mut tangles);
        island_strains(mesh, domain, islands, limits, frame.positions(), &mut strains);
        let scores = tangles.iter().zip(&strains);
        self.now = scores.map(|(&tangle, &strain)| Score { tangle, strain, ..Score::default() }).collect();
        let energy = ArapEnergy { mesh, frame, rest, domain, rest_weight: 0.0, membrane: 0.0, anchor: 0.0 };
        add_moved(energy, islands, frame.positions(), self.edge_length_m, &mut self.now);
        for (motion, island) in &self.motions {
            self.now[*island].depth += motion.weight() * motion.depth_m / motion.edge_length_m;
        }
    }

    /// Runs the candidates and takes the best for each island.
    fn step(&mut self, relaxer: &Relaxer<'_>, rest_weight: f64) -> Vec<Point3<f64>> {
        for (rows, constraints) in Rows::ALL.into_iter().zip(&mut self.constraints) {
            rows.collect(relaxer, &self.analysis, &self.motions, &self.sides, self.variant.part, constraints);
        }
        let Analysis { intersections, paths, .. } = &self.analysis;
        let has_few = intersections.edge_face.len() < FEW || paths.pairs.len() <= FEW_PAIRS;
        let recipes = recipes(&Stage {
            has_few: has_few && relaxer.settings.effort != Effort::Fast,
            is_stalled: self.stalled >= STALLED,
            // A belt in a ball gets out by stretching.
            may_stretch: self.num_wrong > 0 && self.stalled > 0,
        });
        self.candidates.resize_with(recipes.len(), Candidate::default);
        let Relaxer { mesh, frame, rest, domain, islands, limits, settings, .. } = relaxer;
        let context = Context {
            energy: ArapEnergy { mesh, frame, rest, domain, rest_weight, membrane: 0.0, anchor: 0.0 },
            sides: relaxer.sides.as_ref(),
            islands,
            limits,
            motions: &self.motions,
            now: &self.now,
            edge_length_m: self.edge_length_m,
            single_precision: settings.single_precision,
            should_stop: relaxer.should_stop,
        };
        let constraints = &self.constraints;
        self.candidates.par_iter_mut().zip(&recipes).for_each(|(candidate, &recipe)| {
            candidate.run(&context, &constraints[recipe.rows as usize], recipe);
        });
        let choice: Vec<Option<usize>> = (0..self.now.len()).map(|island| self.best_for(island)).collect();
        let displacement: Vec<Vector3<f64>> = domain
            .vertices()
            .iter()
            .map(|&vertex| match choice[islands.of(vertex)] {
                Some(index) => self.candidates[index].best.positions[vertex.index()] - frame.position(vertex),
                None => Vector3::zeros(),
            })
            .collect();
        // Islands that move differently must not be torn apart at their borders.
        let mut positions = Vec::new();
        self.limited.make(context.energy, islands, &displacement, settings.single_precision, &mut positions);
        positions
    }

    /// The best candidate for an island, the first of equals; nothing for one that is not tangled.
    fn best_for(&self, island: usize) -> Option<usize> {
        if self.now[island].merit() == 0.0 {
            return None;
        }
        let value = |candidate: &Candidate| candidate.best.scores[island].value();
        let usable = self.candidates.iter().enumerate().filter(|(_, candidate)| candidate.is_usable);
        usable.min_by(|a, b| value(a.1).total_cmp(&value(b.1))).map(|(index, _)| index)
    }

    /// Notes the state that was looked at last.
    fn report(&self, relaxer: &mut Relaxer<'_>, progress: &mut Progress<'_>) -> ControlFlow<()> {
        let length_m = self.analysis.paths.pairs.iter().map(|pair| pair.length_m).sum();
        let num_edge_face = num_movable(relaxer.mesh, &self.analysis.intersections);
        relaxer.note(Method::Push, num_edge_face, length_m, progress)
    }
}

/// The motions of all contours, in their order, but for those where bodies or layers say who belongs on which side.
fn find_motions(
    scene: &Scene<'_>,
    paths: &IntersectionPaths,
    sides: Option<&SideTracker>,
    variant: usize,
) -> Vec<Motion> {
    let mut contours = contours(scene.mesh, scene.frame, paths);
    if let Some(sides) = sides {
        let is_decided = |segment: &ContourSegment| sides.decides(scene.mesh, segment.faces);
        contours.retain(|contour| !contour.segments.iter().any(is_decided));
    }
    let motions: Vec<Vec<Motion>> = contours
        .par_iter()
        .map_init(
            || MotionFinder::of_variant(variant),
            |finder, contour| {
                let mut motions = Vec::new();
                finder.find(scene, contour, &mut motions);
                motions
            },
        )
        .collect();
    motions.into_iter().flatten().collect()
}

/// The whole part of a number that is not negative.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the conversion saturates")]
fn whole(value: f64) -> usize {
    value as usize
}
