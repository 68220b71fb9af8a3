//! The examples of repairs in C, C++ and Python, against a real daemon.

use std::process::Command;

use untangled_testkit::{
    files::repository,
    hosts::{self, has, link, run, scratch},
    process::{Daemon, TestDomain},
};

/// Runs an example in a domain of its own, which it finds by the environment.
fn repairs(command: &mut Command) {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let output = run(command.env("UNTANGLED_DOMAIN", domain.name()));
    let said = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<&str> = said.lines().collect();
    assert!(lines[0].starts_with("certified: 1, ") || lines[0].starts_with("certified: True, "), "{said}");
    assert!(lines[1] == "0 edges pierce a face" && lines[2].starts_with("repaired after step "), "{said}");
}

#[test]
fn c_and_cpp_examples_repair_their_scene() {
    for (compiler, standard, source) in [("gcc", "-std=c11", "repair.c"), ("g++", "-std=c++17", "repair.cpp")] {
        if !has(compiler, "the example of repairs") {
            continue;
        }
        let program = scratch("repairs").join(source.replace('.', "_"));
        let mut compile = Command::new(compiler);
        compile
            .args([standard, "-O1", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror", "-o"])
            .arg(&program);
        run(link(compile.arg(repository().join("clients/c").join(source))));
        repairs(&mut Command::new(program));
    }
}

#[test]
fn python_example_repairs_its_scene() {
    let Some(mut python) = hosts::python::command("the example of repairs") else { return };
    repairs(python.arg(repository().join("clients/python/examples/repair.py")));
}
