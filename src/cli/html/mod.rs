//! `--html`: a page to look at, one file that opens from disk without a network.
//!
//! The page is made in the browser, by the script of `report/` (TypeScript), from one JSON document that this module
//! writes: [`PageData`]. Each module uses those above it in this table only.
//!
//! | file | purpose |
//! |---|---|
//! | `numbers` | arrays as base64 |
//! | `lines` | intersection paths as lines |
//! | `state` | a state: positions, paths, vertices on the wrong side |
//! | `sequence` | the frames of a shot |
//! | `change` | how far each vertex moved, and how its edges were stretched |
//! | `settings` | the settings of the command, one by one |
//! | `page` | the document, and its file |
//! | `place` | where a page may be written |

mod change;
mod lines;
mod numbers;
mod page;
mod place;
mod sequence;
mod settings;
mod state;

pub(super) use change::ChangeData;
pub(super) use page::{MeshData, PageData};
pub(super) use place::page_target;
pub(super) use sequence::{FrameRecorder, MOST_COORDINATES};
pub(super) use settings::{Setting, settings_of_check, settings_of_fix};
pub(super) use state::StateData;
