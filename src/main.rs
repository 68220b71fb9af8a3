//! The `untangled` binary.

fn main() {}
