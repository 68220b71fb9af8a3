//! What an operator meets: logs, metrics, status, memory, places, folders.

mod folders;
mod logs;
mod memory;
mod places;
mod watching;
