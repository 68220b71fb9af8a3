//! What is inside of a path.

mod inside_choice;
mod topology;
