//! The Python package, with the extension of this build, against a real daemon.
//!
//! The package is assembled by hand, from the library that cargo built; the checks of every change install it with pip.
//! Numpy and pytest come from PyPI into a virtual environment below the target folder, once.

use untangled_publisher::scenes::Scene;
use untangled_testkit::{
    files::repository,
    hosts::{Frames, python, run, scratch},
    process::{Daemon, TestDomain, untangled},
};

#[test]
fn python_package_passes_its_tests() {
    let Some(mut pytest) = python::command("the Python client") else { return };
    pytest.env("DAEMON_PROGRAM", untangled()).args(["-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider"]);
    // Not in the folder above: Python would take the package without its extension from there.
    let output = run(pytest.current_dir(repository().join("clients/python/tests")));
    let said = String::from_utf8_lossy(&output.stdout);
    // What was skipped there is said here.
    said.lines()
        .filter(|line| line.starts_with("SKIPPED") || line.contains(" passed"))
        .for_each(|line| eprintln!("{line}"));
    assert!(said.contains(" passed"), "{said}");
}

#[test]
fn python_client_gets_the_same_bytes_as_the_rust_client() {
    let Some(mut python) = python::command("the same frames through Python") else { return };
    let scene = Frames::tangled(Scene::Gallery, 0.04, 4);
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let expected = scene.exchange(&domain.connect());
    let [file, out] = ["scene", "out"].map(|name| scratch("python").join(name));
    scene.write(&file);
    run(python.arg(repository().join("clients/python/tests/frames.py")).arg(domain.name()).args([&file, &out]));
    assert!(std::fs::read(out).unwrap() == expected, "Python brings other bytes");
}
