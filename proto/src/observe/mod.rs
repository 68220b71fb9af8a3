//! What is published for those who look at a session and take no part in it.

pub mod paths;
pub mod view;
