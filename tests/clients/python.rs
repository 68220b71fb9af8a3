//! The Python package, with the extension of this build, against a real daemon.
//!
//! The package is laid out by hand here, from the library that cargo built; `.ci/run` installs it with pip. Numpy and pytest come from PyPI
//! into a virtual environment below the target folder, once.
#![cfg(feature = "daemon")]
#![allow(clippy::unwrap_used, clippy::cast_precision_loss, reason = "a test")]

#[path = "support/daemon.rs"]
mod daemon;
#[path = "support/frames.rs"]
mod frames;
#[path = "support/hosts.rs"]
mod hosts;
#[path = "support/python.rs"]
mod python;

use daemon::{Daemon, TestDomain};
use frames::Frames;
use hosts::{root, run, scratch};
use untangled_publisher::scenes::Scene;

#[test]
fn the_package_passes_its_tests() {
    let Some(mut pytest) = python::command("the Python client") else { return };
    pytest.args(["-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider"]);
    // Not in the folder above: Python would take the package without its extension from there.
    let output = run(pytest.current_dir(root().join("clients/python/tests")));
    let said = String::from_utf8_lossy(&output.stdout);
    // What was skipped there is said here.
    said.lines()
        .filter(|line| line.starts_with("SKIPPED") || line.contains(" passed"))
        .for_each(|line| eprintln!("{line}"));
    assert!(said.contains(" passed"), "{said}");
}

#[test]
fn the_same_bytes_as_the_rust_client() {
    let Some(mut python) = python::command("the same frames through Python") else { return };
    let scene = Frames::tangled(Scene::Gallery, 0.04, 4);
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let expected = scene.exchange(&domain.connect());
    let [file, out] = ["scene", "out"].map(|name| scratch("python").join(name));
    scene.write(&file);
    run(python.arg(root().join("clients/python/tests/frames.py")).arg(domain.name()).args([&file, &out]));
    assert!(std::fs::read(out).unwrap() == expected, "Python brings other bytes");
}
