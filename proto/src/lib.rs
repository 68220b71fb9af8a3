//! The wire protocol of untangled.
