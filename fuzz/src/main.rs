//! Feeds what libFuzzer makes of seeds to the readers of the testkit and of the bridge.
//!
//! `FUZZ_TARGET` names the reader; its seeds are written into the folder `FUZZ_SEEDS` first, and the words of its
//! format into the file `FUZZ_WORDS`; `fuzz/run` sets all three. With the name `list` it prints the names.

#![no_main]

mod bridge;
mod words;

use std::{env, fs, path::Path, sync::OnceLock};

use libfuzzer_sys::{Corpus, fuzz_target};
use untangled_testkit::fuzz::bytes::{ByteTarget, TARGETS};

static TARGET: OnceLock<ByteTarget> = OnceLock::new();

/// The target of a name, after its seeds and words were written.
fn begin() -> ByteTarget {
    let all = || TARGETS.iter().chain([&bridge::TARGET]);
    let names: Vec<&str> = all().map(|target| target.name).collect();
    let name = env::var("FUZZ_TARGET").unwrap_or_default();
    if name == "list" {
        println!("{}", names.join("\n"));
        std::process::exit(0);
    }
    let target = all().find(|target| target.name == name);
    let target = *target.unwrap_or_else(|| panic!("FUZZ_TARGET is {name:?}, and not one of {}", names.join(", ")));
    if let Ok(folder) = env::var("FUZZ_SEEDS") {
        for (seed, bytes) in (target.seeds)().into_iter().enumerate() {
            fs::write(Path::new(&folder).join(format!("seed-{seed:02}")), bytes).expect("the folder is there");
        }
    }
    if let Ok(file) = env::var("FUZZ_WORDS") {
        fs::write(file, words::dictionary(&name)).expect("its folder is there");
    }
    target
}

fuzz_target!(
    init: {
        TARGET.get_or_init(begin);
    },
    |bytes: &[u8]| -> Corpus {
        (TARGET.get_or_init(begin).read)(bytes);
        Corpus::Keep
    }
);
