//! Programs of this build: `untangled`, and the running test as a process of its own.

use std::{env, path::PathBuf, process::Command};

use super::TestDomain;

/// The folder of this build's programs and libraries, for example `target/debug`.
pub(crate) fn build_folder() -> PathBuf {
    let program = env::current_exe().expect("the system knows this program");
    let folder = program.parent().expect("a program lies in a folder");
    // Tests lie one folder deeper than programs.
    let deeper = folder.ends_with("deps") || folder.ends_with("examples");
    if deeper { folder.parent().expect("cargo's folders lie in one").to_owned() } else { folder.to_owned() }
}

/// The program `untangled` of the build that the running test belongs to.
///
/// # Panics
/// If it is not there. Cargo builds it for the tests of the root package; other packages' tests must build it before.
pub fn untangled() -> PathBuf {
    let program = build_folder().join("untangled");
    assert!(
        program.is_file(),
        "there is no {}: build it with `cargo build -p untangled` and the profile of this test (`--release` or none)",
        program.display()
    );
    program
}

/// A command that serves a domain.
pub fn serve(domain: &TestDomain) -> Command {
    let mut command = Command::new(untangled());
    command.args(["serve", "--domain", domain.name()]);
    command
}

/// A command that runs one ignored test of the running test binary alone, in a process of its own.
///
/// `module` is the `module_path!()` of that test.
pub fn this_test(module: &str, test: &str) -> Command {
    // Names of tests begin below the crate.
    let module = module.split_once("::").map_or(String::new(), |(_, module)| format!("{module}::"));
    let mut command = Command::new(env::current_exe().expect("the system knows this program"));
    command.args(["--exact", &format!("{module}{test}"), "--ignored", "--nocapture"]);
    command
}
