//! Programs of other languages: what is on this machine, and the libraries that they need.

#![allow(dead_code, unreachable_pub, reason = "each test file uses a part")]

use std::{
    env,
    path::{Path, PathBuf},
    process::{Command, Output},
    sync::OnceLock,
};

/// The repository.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Where a test of this name may leave files: below the target folder, kept from run to run.
pub fn scratch(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Whether a program is there; says what is skipped where it is not.
pub fn has(program: &str, skipped: &str) -> bool {
    let there = Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success());
    if !there {
        eprintln!("SKIPPED: {skipped}: there is no {program} on this machine");
    }
    there
}

/// Runs a command and returns what it said; its failure is the test's.
pub fn run(command: &mut Command) -> Output {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{command:?}: {}\n{out}\n{err}", output.status);
    output
}

/// The folder of this build's libraries for C and Python. Cargo makes libraries for other languages only where they are asked for, so they
/// are asked for here, with this very selection of packages and profile, for which everything below them is built already.
pub fn libraries() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        // target/PROFILE/deps/this-test
        let folder = env::current_exe().unwrap().parent().unwrap().parent().unwrap().to_path_buf();
        let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        cargo.current_dir(root()).args(["build", "--locked", "--quiet", "--workspace", "--lib", "--tests"]);
        if folder.ends_with("release") {
            cargo.arg("--release");
        }
        run(cargo.env("CARGO_TARGET_DIR", folder.parent().unwrap()));
        folder
    })
}
