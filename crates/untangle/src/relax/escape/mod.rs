//! Escape: both sheets of every contour are drawn apart by the shortest motion, in small steps of one displacement
//! field.
//!
//! | file or folder | purpose |
//! |---|---|
//! | `motion` | the shortest way in which the two sheets of a contour leave each other |
//! | `rows` | the constraints of one iteration |
//! | `variant` | descents that differ in how they go |
//! | `limited_step` | steps within the limits of strain |
//! | `score` | how good a state is |
//! | `candidate` | one displacement field, made within the limits and judged |
//! | `descent` | the iterations |

mod candidate;
mod descent;
mod limited_step;
mod motion;
mod rows;
mod score;
#[cfg(test)]
pub(super) mod tests;
mod variant;

pub(super) use descent::descend;
pub(super) use variant::DescentVariant;
