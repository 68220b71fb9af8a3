//! `untangled-bridge`: see `untangled_bridge::cli`.

fn main() -> std::process::ExitCode {
    untangled_bridge::cli::main()
}
