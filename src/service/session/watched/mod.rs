//! What a session publishes for those who look: its paths, and views for observers. Each costs a look into shared
//! memory a frame until somebody subscribes.
//!
//! | file | what it does |
//! |---|---|
//! | `records` | paths as they are on the wire |
//! | `paths` | the paths of a frame, before its correction |
//! | `encode` | the view of a frame as bytes |
//! | `desk` | the services of views, made when somebody asks for the first time; who watches |
//! | `views` | publishes views, after the corrections |
//! | `mesh` | the mesh of a session, for the reply to an observer |

mod desk;
mod encode;
mod mesh;
mod paths;
mod records;
mod views;

pub(crate) use desk::{NewObserver, Observer, ViewDesk};
pub(super) use encode::View;
pub(super) use mesh::mesh_bytes;
pub(super) use paths::PathsPort;
pub(super) use views::ViewPort;
