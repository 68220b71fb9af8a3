//! The C library and the C++ wrapper, built and run with gcc and g++ against a real daemon.

use std::{
    path::{Path, PathBuf},
    process::Command,
};

use untangled_publisher::scenes::Scene;
use untangled_testkit::{
    files::repository,
    hosts::{Frames, has, libraries, run, scratch},
    process::{Daemon, TestDomain},
};

const STRICT: [&str; 6] = ["-O1", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"];

/// Compiles a program against the shared library.
fn compile(compiler: &str, standard: &str, source: &str, name: &str) -> PathBuf {
    let program = scratch("c").join(name);
    let mut command = Command::new(compiler);
    command.args(STRICT).arg(standard).arg("-I").arg(repository().join("clients/c")).arg("-o").arg(&program);
    command.arg(repository().join("clients/c").join(source)).arg("-L").arg(libraries()).arg("-luntangled_client");
    run(command.arg(format!("-Wl,-rpath,{}", libraries().display())).arg("-lm"));
    program
}

/// Runs a program in a domain with a daemon and returns what it printed.
fn in_domain(program: &Path, arguments: &[&Path]) -> String {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let output = run(Command::new(program).arg(domain.name()).args(arguments));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn c_example_untangles_its_scene() {
    if !has("gcc", "the C example") {
        return;
    }
    let said = in_domain(&compile("gcc", "-std=c11", "example.c", "example"), &[]);
    assert!(said.lines().count() > 1 && said.trim_end().lines().next_back().unwrap().contains(": 0 edges"), "{said}");
}

#[test]
fn c_client_misused_returns_errors() {
    if has("gcc", "what a C host may do wrong") {
        in_domain(&compile("gcc", "-std=c11", "tests/programs/misuse.c", "misuse"), &[]);
    }
}

#[test]
fn c_client_allocates_nothing_in_frames() {
    if has("gcc", "allocations of the C client") {
        in_domain(&compile("gcc", "-std=gnu11", "tests/programs/allocations.c", "allocations"), &[]);
    }
}

#[test]
fn cpp_wrapper_behaves_as_documented() {
    if has("g++", "the C++ wrapper") {
        in_domain(&compile("g++", "-std=c++17", "tests/programs/wrapper.cpp", "wrapper"), &[]);
    }
}

#[test]
fn c_and_cpp_clients_get_the_same_bytes_as_the_rust_client() {
    let scene = Frames::tangled(Scene::Gallery, 0.04, 4);
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let expected = scene.exchange(&domain.connect());
    drop((daemon, domain));
    let folder = scratch("c");
    scene.write(&folder.join("scene"));
    for (compiler, standard, source) in [("gcc", "-std=gnu11", "frames.c"), ("g++", "-std=c++17", "frames.cpp")] {
        if !has(compiler, "the same frames through its client") {
            continue;
        }
        let program = compile(compiler, standard, &format!("tests/programs/{source}"), &source.replace('.', "_"));
        let out = folder.join(format!("{source}.out"));
        in_domain(&program, &[&folder.join("scene"), &out]);
        assert!(std::fs::read(out).unwrap() == expected, "{source} brings other bytes");
    }
}

#[test]
fn installed_c_library_is_found_by_pkg_config_and_cmake() {
    if !has("gcc", "the installed C library") {
        return;
    }
    let prefix = scratch("c").join("prefix");
    run(Command::new(repository().join("clients/c/install")).arg(&prefix).arg(libraries()));
    let example = repository().join("clients/c/example.c");
    build_with_pkg_config(&prefix, &example);
    build_with_cmake(&prefix, &example);
}

/// Builds the example as the pkg-config file says, with the shared and with the static library, and runs it.
fn build_with_pkg_config(prefix: &Path, example: &Path) {
    if !has("pkg-config", "the pkg-config file") {
        return;
    }
    for (name, mode) in [("shared", None), ("static", Some("--static"))] {
        let mut ask = Command::new("pkg-config");
        ask.env("PKG_CONFIG_PATH", prefix.join("lib/pkgconfig")).args(mode);
        let output = run(ask.args(["--cflags", "--libs", "untangled-client"]));
        let words = String::from_utf8(output.stdout).unwrap();
        let mut flags: Vec<String> = words.split_whitespace().map(str::to_owned).collect();
        if mode.is_some() {
            let library = prefix.join("lib/libuntangled_client.a").display().to_string();
            flags.iter_mut().filter(|flag| *flag == "-luntangled_client").for_each(|flag| flag.clone_from(&library));
        }
        let program = scratch("c").join(format!("example-{name}"));
        let mut command = Command::new("gcc");
        command.arg(example).args(flags).args(["-lm", "-o"]).arg(&program);
        run(command.arg(format!("-Wl,-rpath,{}", prefix.join("lib").display())));
        in_domain(&program, &[]);
    }
}

/// Builds the example with the CMake package, with the shared and with the static library, and runs it.
fn build_with_cmake(prefix: &Path, example: &Path) {
    if !has("cmake", "the CMake package") || !has("g++", "the CMake package") {
        return;
    }
    let project = scratch("c").join("cmake");
    std::fs::create_dir_all(&project).unwrap();
    let text = format!(
        "cmake_minimum_required(VERSION 3.10)\nproject(host C CXX)\nfind_package(untangled-client REQUIRED)\n\
         add_executable(shared {0})\ntarget_link_libraries(shared untangled::client m)\n\
         add_executable(static {0})\ntarget_link_libraries(static untangled::client_static m)\n",
        example.display()
    );
    std::fs::write(project.join("CMakeLists.txt"), text).unwrap();
    let build = project.join("build");
    let mut configure = Command::new("cmake");
    configure.arg("-S").arg(&project).arg("-B").arg(&build);
    run(configure.arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display())));
    run(Command::new("cmake").arg("--build").arg(&build));
    for program in ["shared", "static"] {
        in_domain(&build.join(program), &[]);
    }
}
