//! Hosts in other languages, unchanged, through the bridge. They are those that the checks of the folder above have
//! built; what is missing is said.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

use untangled_bridge_lab::ends::{self, Bridged};

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// A file of the core's build, of the newest profile; says what is skipped where there is none.
fn built(name: &str, skipped: &str) -> Option<PathBuf> {
    let files = ["debug", "release"].map(|profile| repository().join("target").join(profile).join(name));
    let found = files.into_iter().filter(|file| file.is_file());
    let newest = found.max_by_key(|file| fs::metadata(file).unwrap().modified().unwrap());
    if newest.is_none() {
        println!("SKIPPED: {skipped}: there is no {name} below {}", repository().join("target").display());
    }
    newest
}

fn run(command: &mut Command) -> Output {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let words = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success(),
        "{command:?}: {}\n{}\n{words}",
        output.status,
        String::from_utf8_lossy(&output.stdout)
    );
    output
}

#[test]
fn example_host_untangles_its_scene_through_the_bridge() {
    let bridged = Bridged::start();
    let mut command = Command::new(ends::untangled());
    command.args(["publish", "--domain", bridged.near_host.name(), "--scene", "crease", "--edge-m", "0.06"]);
    // Ends with 0 only where its own exact check finds nothing that intersects.
    let output = run(command.args(["--frames", "400"]));
    println!("{}", String::from_utf8_lossy(&output.stdout).lines().next_back().unwrap_or_default());
}

#[test]
fn c_example_untangles_its_scene_through_the_bridge() {
    let Some(library) = built("libuntangled_client.so", "the C client") else { return };
    if Command::new("gcc").arg("--version").output().is_err() {
        println!("SKIPPED: the C client: there is no gcc on this machine");
        return;
    }
    let folder = library.parent().unwrap();
    let scratch = std::env::temp_dir().join(format!("bridge-c-{}", std::process::id()));
    fs::create_dir_all(&scratch).unwrap();
    // The name by which the loader looks for it, which an installation makes.
    std::os::unix::fs::symlink(fs::canonicalize(&library).unwrap(), scratch.join("libuntangled_client.so.1")).unwrap();
    let program = scratch.join("example");
    let sources = repository().join("clients/c");
    let mut gcc = Command::new("gcc");
    gcc.args(["-O1", "-std=c11", "-I"]).arg(&sources).arg("-o").arg(&program).arg(sources.join("example.c"));
    run(gcc.arg("-L").arg(folder).args(["-luntangled_client", "-lm"]).arg(format!("-Wl,-rpath,{}", scratch.display())));
    let bridged = Bridged::start();
    let output = run(Command::new(&program).arg(bridged.near_host.name()));
    let said = String::from_utf8(output.stdout).unwrap();
    fs::remove_dir_all(&scratch).unwrap();
    assert!(said.trim_end().lines().next_back().is_some_and(|line| line.contains(": 0 edges")), "{said}");
}

/// The tests of the Python package, with a daemon that is a daemon, a bridge and a domain.
#[test]
fn python_package_passes_its_tests_through_the_bridge() {
    let Some(library) = built("libuntangled_python.so", "the Python client") else { return };
    let python = repository().join("target/tmp/python-environment/bin/python");
    if !python.is_file() {
        println!("SKIPPED: the Python client: the tests of the folder above have made no {}", python.display());
        return;
    }
    let scratch = std::env::temp_dir().join(format!("bridge-python-{}", std::process::id()));
    let package = scratch.join("untangled_cloth");
    fs::create_dir_all(&scratch).unwrap();
    run(Command::new("cp").arg("-r").arg(repository().join("clients/python/untangled_cloth")).arg(&package));
    fs::copy(library, package.join("_native.abi3.so")).unwrap();
    let served = scratch.join("serve");
    fs::write(&served, include_str!("serve-bridged.sh")).unwrap();
    run(Command::new("chmod").arg("+x").arg(&served));
    let mut pytest = Command::new(fs::canonicalize(&python).map(|_| python.clone()).unwrap());
    pytest
        .args([
            "-m",
            "pytest",
            "-q",
            "-rs",
            "-p",
            "no:cacheprovider",
            "-k",
            // The first reads the log of the daemon itself; sessions are watched near the daemon only.
            "not session_that_is_left_is_closed_and_not_lost and not test_observe",
        ])
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("PYTHONPATH", &scratch)
        .env("DAEMON_PROGRAM", &served)
        .env("BRIDGE_PROGRAM", ends::bridge_program())
        .env("SERVE_PROGRAM", fs::canonicalize(ends::untangled()).unwrap())
        .current_dir(repository().join("clients/python/tests"));
    let output = run(&mut pytest);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    fs::remove_dir_all(&scratch).unwrap();
    println!("{}", said.trim_end().lines().next_back().unwrap_or_default());
    assert!(said.contains(" passed"), "{said}");
}
