//! How the two sheets of a contour leave each other: the shortest way, from the surfaces themselves.
//!
//! | file | purpose |
//! |---|---|
//! | `contour` | path pairs as chains between two sheets, and pieces of them |
//! | `sheets` | geodesic windows of both sheets round a contour |
//! | `triangle` | triangles seen along a direction |
//! | `grid` | which of them overlap |
//! | `shadow` | how far one sheet has to move along a direction to leave the other |
//! | `directions` | the directions that are looked at |
//! | `windows` | the shortest direction, as windows of the sheets see it |
//! | `finder` | direction, depth and points of the motion, of pieces of a contour where that is shorter |

mod contour;
mod directions;
mod finder;
mod grid;
mod shadow;
mod sheets;
#[cfg(test)]
mod tests;
mod triangle;
mod windows;

pub(crate) use contour::{ContourSegment, contours};
pub(crate) use finder::{Motion, MotionFinder, remaining_depth_m};
pub(crate) use shadow::Shadow;
pub(crate) use windows::Scene;
