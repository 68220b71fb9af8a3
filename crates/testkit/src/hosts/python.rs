//! A Python with numpy, pytest, and the package as this build made it.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
    sync::OnceLock,
};

use super::tools::{libraries, scratch};
use crate::files::repository;

/// A command that runs this Python; none where the machine has no Python, and then it says what is skipped.
///
/// The variable `TEST_PYTHON` names another one, in which the package is installed.
pub fn command(skipped: &str) -> Option<Command> {
    static PYTHON: OnceLock<Result<(PathBuf, Option<PathBuf>), String>> = OnceLock::new();
    let find = || match std::env::var_os("TEST_PYTHON") {
        // An environment in which the package is installed.
        Some(python) => Ok((python.into(), None)),
        None => Ok((environment()?, Some(package()))),
    };
    match PYTHON.get_or_init(find) {
        Ok((python, package)) => {
            let mut command = Command::new(python);
            command.env("PYTHONDONTWRITEBYTECODE", "1");
            command.envs(package.iter().map(|package| ("PYTHONPATH", package)));
            Some(command)
        }
        Err(reason) => {
            eprintln!("SKIPPED: {skipped}: {reason}");
            None
        }
    }
}

/// The interpreter of a virtual environment with what the tests need.
fn environment() -> Result<PathBuf, String> {
    let recent = ["-c", "import sys, venv; sys.exit(sys.version_info < (3, 9))"];
    let system = ["python3", "python3.13", "python3.12", "python3.11", "python3.10"]
        .into_iter()
        .find(|python| Command::new(python).args(recent).output().is_ok_and(|output| output.status.success()));
    let system = system.ok_or("there is no Python of 3.9 or later with venv on this machine")?;
    let folder = scratch("python-environment");
    let python = folder.join("bin/python");
    let complete = |python: &Path| {
        Command::new(python).args(["-c", "import numpy, pytest"]).output().is_ok_and(|output| output.status.success())
    };
    if complete(&python) {
        return Ok(python);
    }
    for (program, arguments) in [
        (Path::new(system), vec!["-m", "venv", folder.to_str().unwrap_or_default()]),
        (&python, vec!["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "numpy", "pytest"]),
    ] {
        let output = Command::new(program).args(arguments).output().map_err(|error| error.to_string())?;
        if !output.status.success() {
            let said = String::from_utf8_lossy(&output.stderr).trim().lines().next_back().unwrap_or("").to_owned();
            return Err(format!("numpy and pytest can't be installed: {said}"));
        }
    }
    Ok(python)
}

/// A folder that holds the package.
fn package() -> PathBuf {
    let folder = scratch("python-package");
    let package = folder.join("untangled_cloth");
    let _ = fs::remove_dir_all(&package);
    copy(&repository().join("clients/python/untangled_cloth"), &package);
    fs::copy(libraries().join("libuntangled_python.so"), package.join("_native.abi3.so")).unwrap();
    folder
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap().map(Result::unwrap) {
        let target = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            if entry.file_name() != "__pycache__" {
                copy(&entry.path(), &target);
            }
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}
