//! `check` and `fix` with `--cache` and `--prim`, and `join`.

mod check;
mod coherence;
mod fix;
mod join;
mod refusals;
mod resume;
mod usd;
mod words;

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

use serde_json::Value;
use untangled_testkit::{
    files::formats::obj,
    generate::Sheet,
    process::untangled,
    shots::{FlapShot, mdd, numbered_obj, pc2},
};

/// Bytes of a PC2 file before its frames.
const HEADER_SIZE: usize = 32;

/// The frames of the shot of the tests.
fn frames() -> Vec<Sheet> {
    let shot = FlapShot::small();
    (0..shot.num_frames).map(|frame| shot.cloth(frame)).collect()
}

/// A folder with `cloth.obj`, and the shot as `in.pc2`, `in.mdd` and `in/cloth.001.obj` and so on.
pub(crate) fn folder() -> tempfile::TempDir {
    let (folder, frames) = (tempfile::tempdir().unwrap(), frames());
    let write = |name: &str, bytes: Vec<u8>| fs::write(folder.path().join(name), bytes).unwrap();
    fs::create_dir(folder.path().join("in")).unwrap();
    write("cloth.obj", obj(&frames[0], false));
    write("in.pc2", pc2(&frames));
    write("in.mdd", mdd(&frames));
    for (name, bytes) in numbered_obj(&frames, 1) {
        write(&format!("in/cloth.{name}"), bytes);
    }
    folder
}

fn command(arguments: &[&str], folder: &Path) -> Command {
    let mut command = Command::new(untangled());
    command.args(arguments).current_dir(folder);
    command
}

pub(crate) fn run(arguments: &[&str], folder: &Path) -> Output {
    command(arguments, folder).output().unwrap()
}

/// The lines of a run, the totals apart.
fn lines(output: &Output) -> (Vec<Value>, Value) {
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    let mut lines: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert!(lines.iter().all(|line| line["schema"] == "untangled.sequence/1"), "{output:?}");
    let totals = lines.pop().unwrap();
    (lines, totals["totals"].clone())
}

fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

/// The frames of a PC2 file, as bytes.
fn frames_of(bytes: &[u8]) -> Vec<Vec<u8>> {
    let num_frames = u32::from_le_bytes(std::array::from_fn(|byte| bytes[28 + byte])) as usize;
    let body = &bytes[HEADER_SIZE..];
    body.chunks(body.len() / num_frames).map(<[u8]>::to_vec).collect()
}
