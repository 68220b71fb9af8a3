//! Descents that differ in how they go: where the first one finds no short way, another may. And the candidates of
//! their iterations.

use super::{candidate::Recipe, rows::Rows};

/// Edges that change their length by more than this factor get stiffer, but where nothing else brings what is on the
/// wrong side to the other.
const MAX_STRETCH: f64 = 1.05;

/// The candidates of an iteration, by constraints and stiffness; the root of that is the length, in edges, over which a
/// displacement decays. The first are for all states, the next for those with few intersections, the last for those
/// that are stalled.
const RECIPES: [[(Rows, f64); 3]; 3] = [
    [(Rows::Wide, 16.0), (Rows::Wide, 256.0), (Rows::Wide, 4096.0)],
    [(Rows::Narrow, 1.0), (Rows::Narrow, 16.0), (Rows::Narrow, 256.0)],
    [(Rows::Shorten, 1.0), (Rows::Shorten, 16.0), (Rows::Shorten, 256.0)],
];

/// What a descent knows of an iteration before its candidates are made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stage {
    /// Whether few edges intersect, and there is time for more candidates.
    pub(super) has_few: bool,
    pub(super) is_stalled: bool,
    /// Whether edges may stretch where nothing else helps.
    pub(super) may_stretch: bool,
}

/// How a descent goes.
#[derive(Clone, Copy, Debug)]
pub(in crate::relax) struct DescentVariant {
    /// Which of the ways out that are about as short is taken; 0 for the shortest, until that does not help.
    pub(super) way: usize,
    /// The part of what motions ask for that one iteration makes.
    pub(super) part: f64,
}

impl DescentVariant {
    /// The one that is tried first.
    pub(in crate::relax) const FIRST: Self = Self { way: 0, part: 1.0 };
    /// Those that follow, in order.
    pub(in crate::relax) const OTHERS: [Self; 2] = [Self { way: 1, part: 1.0 }, Self { way: 0, part: 0.5 }];
}

/// The candidates of an iteration.
pub(super) fn recipes(stage: &Stage) -> Vec<Recipe> {
    let [for_all, for_few, for_stalled] = RECIPES;
    let mut recipes = for_all.to_vec();
    if stage.has_few {
        recipes.extend(for_few);
    }
    if stage.is_stalled {
        recipes.extend(for_stalled);
    }
    let recipe = |max_stretch: f64| move |(rows, stiffness)| Recipe { rows, stiffness, max_stretch };
    let mut recipes: Vec<Recipe> = recipes.into_iter().map(recipe(MAX_STRETCH)).collect();
    if stage.may_stretch {
        recipes.extend(for_all.map(recipe(f64::INFINITY)));
    }
    recipes
}
