//! What an operator meets: logs, metrics, status, memory, open files, places, folders.

mod files;
mod folders;
mod logs;
mod memory;
mod places;
mod watching;
