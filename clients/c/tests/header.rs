//! `untangled.h` is what cbindgen makes of this crate.
#![allow(clippy::unwrap_used, reason = "a test")]

use std::path::Path;

#[test]
fn header_matches_what_cbindgen_generates() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(folder.join("cbindgen.toml")).unwrap();
    let mut builder = cbindgen::Builder::new().with_config(config);
    for name in ["error", "types/mod", "types/views", "registration", "connect", "frames", "repairs", "contacts"] {
        builder = builder.with_src(folder.join("src").join(name).with_extension("rs"));
    }
    let mut made = Vec::new();
    builder.generate().unwrap().write(&mut made);
    let made = with_prefix(&String::from_utf8(made).unwrap());
    let path = folder.join("untangled.h");
    if std::env::var_os("WRITE_HEADER").is_some() {
        std::fs::write(&path, &made).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(kept == made, "untangled.h is out of step: WRITE_HEADER=1 cargo test -p untangled-client-c");
}

/// Names of C are global, and cbindgen knows no prefix for those of enums.
fn with_prefix(header: &str) -> String {
    let mut in_enum = false;
    let mut lines = Vec::new();
    for line in header.lines() {
        in_enum = (in_enum || line.starts_with("enum ")) && !line.starts_with("};");
        let value = line.trim_start();
        let is_variant = in_enum && value.starts_with(|first: char| first.is_ascii_uppercase());
        lines.push(if is_variant { format!("    UNTANGLED_{value}\n") } else { format!("{line}\n") });
    }
    lines.concat()
}
