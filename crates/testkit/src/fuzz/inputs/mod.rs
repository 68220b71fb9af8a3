//! Inputs that are valid more often than not, and damage to them.

pub(in crate::fuzz) mod damage;
pub(in crate::fuzz) mod grid;
pub(in crate::fuzz) mod mesh_files;
pub(in crate::fuzz) mod requests;
pub(in crate::fuzz) mod stages;
