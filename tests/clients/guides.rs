//! The programs in `clients/INTEGRATE.md`, as they are printed there, against a real daemon.

use std::{fs, process::Command};

use untangled_testkit::{
    files::repository,
    hosts::{self, has, link, run, scratch},
    process::{Daemon, TestDomain, this_test},
};

/// The one program of a language in the page.
fn program(language: &str) -> String {
    let page = fs::read_to_string(repository().join("clients/INTEGRATE.md")).unwrap();
    let fence = format!("```{language}\n");
    let mut blocks = page.split(&fence).skip(1).map(|rest| rest.split("```\n").next().unwrap());
    let block = blocks.next().unwrap().to_owned();
    assert!(blocks.next().is_none(), "two programs in {language}");
    // 50 lines are for the host; the scene before it is not counted.
    assert!(block.lines().count() <= 70, "{language}: {} lines", block.lines().count());
    block
}

/// Runs a host in a domain of its own, which it finds by the environment, as a user's program does.
fn untangles(command: &mut Command) {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let output = run(command.env("UNTANGLED_DOMAIN", domain.name()));
    let said = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<_> = said.lines().filter(|line| line.ends_with("edges pierce a face")).collect();
    assert!(
        lines.len() > 2 && !lines[0].contains(": 0 edges") && lines.last().unwrap().contains(": 0 edges"),
        "{said}"
    );
}

/// The Rust program: what stands in the page is this file, which cargo compiles with this test.
#[allow(clippy::print_stdout, clippy::cast_possible_truncation, reason = "a page shows what matters there")]
mod integrate {
    include!("programs/integrate.rs");

    #[test]
    #[ignore = "run by another test, in a process of its own"]
    fn guide_program_in_a_process_of_its_own() {
        main().unwrap();
    }
}

#[test]
fn rust_program_of_the_guide_untangles() {
    let file = fs::read_to_string(repository().join("tests/clients/programs/integrate.rs")).unwrap();
    assert!(program("rust") == file, "tests/clients/programs/integrate.rs and clients/INTEGRATE.md differ");
    untangles(&mut this_test(module_path!(), "integrate::guide_program_in_a_process_of_its_own"));
}

#[test]
fn cpp_program_of_the_guide_untangles() {
    if !has("g++", "the C++ program of the guide") {
        return;
    }
    let folder = scratch("guide");
    let (source, built) = (folder.join("host.cpp"), folder.join("host"));
    fs::write(&source, program("cpp")).unwrap();
    let mut compile = Command::new("g++");
    compile.args(["-std=c++17", "-O1", "-Wall", "-Wextra", "-Werror", "-o"]).arg(&built).arg(&source);
    run(link(&mut compile));
    untangles(&mut Command::new(built));
}

#[test]
fn python_program_of_the_guide_untangles() {
    let Some(mut command) = hosts::python::command("the Python program of the guide") else { return };
    let source = scratch("guide").join("host.py");
    fs::write(&source, program("python")).unwrap();
    untangles(command.arg(source));
}
