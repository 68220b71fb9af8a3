//! What must not change an analysis.

mod coherence;
mod degenerate;
mod properties;
mod seams;
