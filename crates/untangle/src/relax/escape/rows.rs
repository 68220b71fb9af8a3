//! The constraints of one iteration: separations along the motions, in parts of their depth.

use super::motion::Motion;
use crate::{
    analysis::Analysis,
    correspond::Correspondences,
    relax::{
        constraints::{ConstraintSource, Constraints, Objective, collect_undecided},
        relaxer::Relaxer,
        sides::SideRows,
    },
};

/// Gap that is to be left between the sheets, in mean edge lengths of the faces along the contour.
const GAP: f64 = 0.4;
/// Gap that is to be left between cloth and bodies, in edge lengths of the cloth.
const SIDE_GAP: f64 = 0.2;
/// Depths up to this many mean edge lengths are left in one step, and of larger ones a part.
const SHORT: f64 = 2.0;
const PART: f64 = 0.5;

/// What constraints ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rows {
    /// Sheets leave each other, and a gap stays between them.
    Wide,
    /// The same with a small gap, which moves less.
    Narrow,
    /// Contours get shorter.
    Shorten,
}

impl Rows {
    /// All of them, in the order of their constraints.
    pub(super) const ALL: [Self; 3] = [Self::Wide, Self::Narrow, Self::Shorten];

    /// Replaces constraints by those for some motions, of which `part` is made in one iteration, and adds those of
    /// bodies.
    pub(super) fn collect(
        self,
        relaxer: &Relaxer<'_>,
        analysis: &Analysis,
        motions: &[(Motion, usize)],
        sides: &SideRows,
        part: f64,
        constraints: &mut Constraints,
    ) {
        let gap = match self {
            Self::Wide => GAP,
            Self::Narrow => 0.25 * GAP,
            Self::Shorten => {
                let Relaxer { mesh, frame, orientation, .. } = relaxer;
                let found = &Correspondences::default();
                let source = ConstraintSource { mesh, frame, analysis, found, orientation };
                let is_decided = |faces| relaxer.sides.as_ref().is_some_and(|sides| sides.decides(mesh, faces));
                collect_undecided(constraints, &source, Objective::Shorten, is_decided);
                sides.add(0.25 * SIDE_GAP, constraints);
                return;
            }
        };
        constraints.clear();
        for (motion, _) in motions {
            for separation in &motion.separations {
                let whole_m = separation.behind_m + gap * motion.edge_length_m;
                let wanted_m = part * whole_m.min((SHORT * motion.edge_length_m).max(PART * whole_m));
                constraints.separate(&separation.own, &separation.partner, motion.direction, wanted_m);
            }
        }
        sides.add(gap / GAP * SIDE_GAP, constraints);
    }
}
