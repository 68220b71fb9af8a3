//! Counts and distances against all pairs, one by one.

mod brute_force;
mod fans;
