//! What several tests share: generated sheets, and the rules that every analysis obeys.

#![allow(dead_code, reason = "each test uses a part of it")]

pub(crate) mod brute;
pub(crate) mod degenerate;
pub(crate) mod fan;
pub(crate) mod files;
pub(crate) mod rules;
pub(crate) mod scene;
pub(crate) mod sheet;
pub(crate) mod summary;
