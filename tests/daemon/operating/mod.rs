//! What an operator meets: logs, metrics, status, memory, open files, places, folders, lost requests.

mod files;
mod folders;
mod logs;
mod lost;
mod memory;
mod places;
mod watching;
