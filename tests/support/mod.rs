//! What several tests share: generated sheets, and the rules that every analysis obeys.

#![allow(dead_code, reason = "each test uses a part of it")]

pub mod brute;
pub mod rules;
pub mod sheet;
pub mod summary;
