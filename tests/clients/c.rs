//! The C library and the C++ wrapper, built and run with gcc and g++ against a real daemon.

use std::{
    ffi::OsStr,
    path::{Path, PathBuf},
    process::Command,
};

use untangled_publisher::scenes::Scene;
use untangled_testkit::{
    files::repository,
    hosts::{Frames, has, libraries, link, run, scratch},
    process::{Daemon, TestDomain},
};

const STRICT: [&str; 6] = ["-O1", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"];

/// Compiles a program against the shared library.
fn compile(compiler: &str, standard: &str, source: &str, name: &str) -> PathBuf {
    let program = scratch("c").join(name);
    let mut command = Command::new(compiler);
    command.args(STRICT).arg(standard).arg("-o").arg(&program).arg(repository().join("clients/c").join(source));
    run(link(&mut command));
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
fn c_client_lists_entries_and_judges_contacts_as_brute_force_does() {
    if has("gcc", "contacts of the C client") {
        in_domain(&compile("gcc", "-std=c11", "tests/programs/contacts.c", "contacts"), &[]);
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

/// Installs the libraries of this build, as `clients/c/README.md` says but for the build, and returns the folder.
fn installed() -> PathBuf {
    let prefix = scratch("c").join("prefix");
    let _ = std::fs::remove_dir_all(&prefix);
    run(Command::new(repository().join("clients/c/install")).arg(&prefix).arg(libraries()));
    prefix
}

/// A command without the variables by which a user might help the loader or the tools.
fn bare(program: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new(program);
    for name in ["LD_LIBRARY_PATH", "LIBRARY_PATH", "CPATH", "PKG_CONFIG_PATH", "CMAKE_PREFIX_PATH"] {
        command.env_remove(name);
    }
    command
}

/// Each use of the installation has one folder of its own below this.
fn project(name: &str) -> PathBuf {
    let folder = scratch("c").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn installed_c_library_serves_programs_built_as_documented() {
    if !has("gcc", "the installed C library") {
        return;
    }
    let prefix = installed();
    check_installed_libraries(&prefix);
    if has("pkg-config", "the pkg-config file") {
        build_as_the_readme_says(&prefix);
        build_with_static_library(&prefix);
    }
    if has("cmake", "the CMake package") && has("g++", "the CMake package") {
        build_with_cmake(&prefix);
    }
}

/// Names and sizes: the loader's name has the version of the interface, and nothing is left for debuggers.
fn check_installed_libraries(prefix: &Path) {
    let header = std::fs::read_to_string(prefix.join("include/untangled.h")).unwrap();
    let abi = header.lines().find_map(|line| line.strip_prefix("#define UNTANGLED_ABI_VERSION ")).unwrap();
    let library = prefix.join("lib/libuntangled_client.so");
    let said = run(Command::new("readelf").args(["-d", "-S", "-W"]).arg(&library)).stdout;
    let said = String::from_utf8(said).unwrap();
    let name = format!("[libuntangled_client.so.{abi}]");
    assert!(said.contains(&name) && said.lines().any(|line| line.contains("SONAME") && line.contains(&name)), "{said}");
    assert!(!said.contains(".debug_") && !said.contains(".symtab"), "{said}");
    let loaded = prefix.join(format!("lib/libuntangled_client.so.{abi}"));
    assert_eq!(loaded.canonicalize().unwrap(), library.canonicalize().unwrap());
    let objects = run(Command::new("readelf").args(["-S", "-W"]).arg(prefix.join("lib/libuntangled_client.a"))).stdout;
    assert!(!String::from_utf8_lossy(&objects).contains(".debug_"));
}

/// The second line of the page's commands, word for word but for the folder.
fn build_as_the_readme_says(prefix: &Path) {
    let page = std::fs::read_to_string(repository().join("clients/c/README.md")).unwrap();
    let command = page.lines().find(|line| line.starts_with("cc ")).unwrap();
    let folder = project("as-documented");
    std::fs::copy(repository().join("clients/c/example.c"), folder.join("example.c")).unwrap();
    let command = command.replace("PREFIX", prefix.to_str().unwrap());
    run(bare("sh").args(["-c", &command]).current_dir(&folder));
    starts(&folder.join("example"));
}

fn build_with_static_library(prefix: &Path) {
    let mut ask = bare("pkg-config");
    ask.env("PKG_CONFIG_PATH", prefix.join("lib/pkgconfig"));
    let words = run(ask.args(["--static", "--cflags", "--libs", "untangled-client"])).stdout;
    let words = String::from_utf8(words).unwrap();
    let library = prefix.join("lib/libuntangled_client.a").display().to_string();
    let flags = words.split_whitespace().map(|flag| if flag == "-luntangled_client" { &library } else { flag });
    let program = project("static").join("example");
    let mut command = bare("gcc");
    command.arg(repository().join("clients/c/example.c")).args(flags).args(["-lm", "-o"]).arg(&program);
    run(&mut command);
    starts(&program);
}

/// Builds the example with the CMake package, with the shared and with the static library, and runs it.
fn build_with_cmake(prefix: &Path) {
    let folder = project("cmake");
    let text = format!(
        "cmake_minimum_required(VERSION 3.10)\nproject(host C CXX)\nfind_package(untangled-client 0.1 REQUIRED)\n\
         add_executable(shared {0})\ntarget_link_libraries(shared untangled::client m)\n\
         add_executable(static {0})\ntarget_link_libraries(static untangled::client_static m)\n",
        repository().join("clients/c/example.c").display()
    );
    std::fs::write(folder.join("CMakeLists.txt"), text).unwrap();
    let configure = |build: &str, source: &Path| {
        let mut command = bare("cmake");
        command.arg("-S").arg(source).arg("-B").arg(folder.join(build));
        command.arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display()));
        command
    };
    run(&mut configure("build", &folder));
    run(bare("cmake").arg("--build").arg(folder.join("build")));
    for program in ["shared", "static"] {
        starts(&folder.join("build").join(program));
    }
    for (version, fits) in [("0.1.0", true), ("0.0", false), ("0.2", false), ("1.0", false)] {
        let source = folder.join(version);
        std::fs::create_dir_all(&source).unwrap();
        let text = format!(
            "cmake_minimum_required(VERSION 3.10)\nproject(host C)\nfind_package(untangled-client {version} REQUIRED)\n"
        );
        std::fs::write(source.join("CMakeLists.txt"), text).unwrap();
        let output = configure(&format!("build-{version}"), &source).output().unwrap();
        assert_eq!(output.status.success(), fits, "{version}: {}", String::from_utf8_lossy(&output.stderr));
    }
}

/// Runs an example that was built, in a domain with a daemon, without help for the loader.
fn starts(program: &Path) {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    run(bare(program).arg(domain.name()));
}
