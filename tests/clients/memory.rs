//! The C examples under valgrind: no access that is wrong, and nothing left when they end.

use std::{path::Path, process::Command};

use untangled_testkit::{
    files::repository,
    hosts::{has, link, run, scratch},
    process::{Daemon, TestDomain},
};

/// Errors and leaks are this exit code, which no example has.
const FOUND: i32 = 99;

/// An example that was compiled with debugging information.
fn compile(source: &Path, name: &str) -> std::path::PathBuf {
    let program = scratch("memory").join(name);
    let mut compile = Command::new("gcc");
    compile.args(["-std=c11", "-O1", "-g", "-o"]).arg(&program).arg(source);
    run(link(&mut compile));
    program
}

/// A program under valgrind, as `clients/c/README.md` has it.
fn valgrind(program: &Path) -> Command {
    let mut command = Command::new("valgrind");
    command.args(["--quiet", "--leak-check=full", "--errors-for-leak-kinds=definite,indirect,possible"]);
    command.arg(format!("--error-exitcode={FOUND}")).arg(program);
    command
}

fn is_there(what: &str) -> bool {
    has("gcc", what) && has("valgrind", what)
}

#[test]
fn c_hosts_access_and_leak_nothing_that_valgrind_objects_to() {
    if !is_there("the memory of C hosts") {
        return;
    }
    for source in ["example.c", "repair.c", "tests/programs/misuse.c"] {
        let program = compile(&repository().join("clients/c").join(source), &source.replace(['.', '/'], "_"));
        let domain = TestDomain::new();
        let _daemon = Daemon::start(&domain);
        run(valgrind(&program).arg(domain.name()).env("UNTANGLED_DOMAIN", domain.name()));
    }
}

#[test]
fn valgrind_is_asked_so_that_a_leak_and_a_wrong_access_are_found() {
    if !is_there("what valgrind finds") {
        return;
    }
    let faults = ["(void)p[0]", "(void)p[24], free((void *)p)"];
    for (fault, number) in faults.into_iter().zip(0..) {
        let source = scratch("memory").join(format!("fault{number}.c"));
        let main = format!("int main(void) {{ volatile char *p = malloc(24); {fault}; return 0; }}");
        std::fs::write(&source, format!("#include <stdlib.h>\n{main}\n")).unwrap();
        let output = valgrind(&compile(&source, &format!("fault{number}"))).output().unwrap();
        assert_eq!(output.status.code(), Some(FOUND), "{fault}: {}", String::from_utf8_lossy(&output.stderr));
    }
}
