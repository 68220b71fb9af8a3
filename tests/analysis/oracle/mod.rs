//! Analyses against brute force, another tree, and known answers.

mod bodies;
mod brute_force;
mod known_answers;
mod rational;
mod second_broad_phase;
