//! The `untangled` binary.

use std::process::ExitCode;

fn main() -> ExitCode {
    untangled::cli::main()
}
