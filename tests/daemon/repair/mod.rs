//! Repairs: a certified answer in one exchange, beside the frames of all sessions.

mod auto;
mod body;
mod cloth;
mod exchange;
mod hostile;
mod layers;
mod side_by_side;
mod weld;
