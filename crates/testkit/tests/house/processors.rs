//! The library's answers are the same bytes on every processor: it calls nothing whose bits depend on it.

use std::{fs, path::Path};

use super::tree;

/// Of the standard library, which takes them from the system.
const DEPENDENT: [&str; 18] = [
    ".sin()",
    ".cos()",
    ".tan()",
    ".sin_cos()",
    ".asin()",
    ".acos()",
    ".atan()",
    ".atan2(",
    ".sinh()",
    ".cosh()",
    ".exp()",
    ".exp2()",
    ".ln()",
    ".log2()",
    ".log10()",
    ".powf(",
    ".cbrt()",
    ".hypot(",
];

/// What the lines of a file say that decides by the processor, tests and comments left out.
fn dependent_lines(path: &Path, text: &str) -> Vec<String> {
    let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    let is_dependent = |line: &str| {
        line.contains("faer::") || line.contains("mul_add(") || DEPENDENT.iter().any(|call| line.contains(call))
    };
    let lines = code.lines().filter(|line| !line.trim_start().starts_with("//") && is_dependent(line));
    lines.map(|line| format!("{}: {}", path.display(), line.trim())).collect()
}

#[test]
fn dependent_lines_of_code_that_depends_on_the_processor_are_found() {
    let path = Path::new("crates/untangle/src/one.rs");
    let text =
        "use faer::Mat;\n// x.sin()\nlet y = x.ln();\nlet z = libm::log(x);\n#[cfg(test)]\nmod tests { x.cos() }\n";
    assert_eq!(dependent_lines(path, text).len(), 2);
}

#[test]
fn library_calls_nothing_whose_bits_depend_on_the_processor() {
    let is_of_library = |path: &&std::path::PathBuf| {
        path.starts_with("crates/untangle/src")
            && path.extension().is_some_and(|extension| extension == "rs")
            && !path.components().any(|part| part.as_os_str() == "tests")
            && !path.ends_with("tests.rs")
    };
    let files = tree::files();
    let files: Vec<_> = files.iter().filter(is_of_library).collect();
    assert!(files.len() > 100);
    let read =
        |path: &&std::path::PathBuf| dependent_lines(path, &fs::read_to_string(tree::root().join(path)).unwrap());
    let found: Vec<String> = files.iter().flat_map(read).collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}
