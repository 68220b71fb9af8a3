//! Candidate pairs of faces: boxes that overlap.
