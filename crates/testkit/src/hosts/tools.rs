//! Compilers, interpreters and their files.

use std::{
    env,
    path::{Path, PathBuf},
    process::{Command, Output},
    sync::OnceLock,
};

use crate::{files::repository, process::build_folder};

/// A folder of this name below the target folder, kept from run to run.
pub fn scratch(name: &str) -> PathBuf {
    let build = build_folder();
    // Cargo marks its target folder.
    let target = build.ancestors().find(|folder| folder.join("CACHEDIR.TAG").is_file()).unwrap_or(&build);
    let folder = target.join("tmp").join(name);
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

/// The folder of this build's libraries for C and Python. Cargo makes libraries for other languages only where they are
/// asked for, so they are asked for here, with this very selection of packages and profile, for which everything below
/// them is built already. The variable `TEST_LIBRARIES` says that somebody has built that of C with other options, and
/// where.
pub fn libraries() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let given = env::var_os("TEST_LIBRARIES").map(PathBuf::from);
        let folder = given.unwrap_or_else(build_libraries);
        // The name by which the loader looks for it, which an installation makes.
        let name = folder.join("libuntangled_client.so.1");
        let _ = std::fs::remove_file(&name);
        std::os::unix::fs::symlink("libuntangled_client.so", name).unwrap();
        folder
    })
}

fn build_libraries() -> PathBuf {
    let folder = build_folder();
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(repository()).args(["build", "--locked", "--quiet", "--workspace", "--lib", "--tests"]);
    if folder.ends_with("release") {
        cargo.arg("--release");
    }
    run(cargo.env("CARGO_TARGET_DIR", folder.parent().unwrap()));
    folder
}

/// Has a compiler link a program with the C library and find its headers. The variable `TEST_CFLAGS` has options beside
/// those of the test.
pub fn link(compile: &mut Command) -> &mut Command {
    let further = env::var("TEST_CFLAGS").unwrap_or_default();
    compile.args(further.split_whitespace());
    compile.arg("-I").arg(repository().join("clients/c")).arg("-L").arg(libraries()).arg("-luntangled_client");
    compile.arg(format!("-Wl,-rpath,{}", libraries().display())).arg("-lm")
}
