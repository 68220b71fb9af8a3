//! Wall time of `untangled check` on mesh files, with start-up, as a user waits for it.
//!
//! ```sh
//! cargo build --release && cargo run --release -p untangled-lab --bin check_times -- FILE...
//! ```
//!
//! Each file is checked three times by a process of its own; the least and the greatest time are printed.

#![allow(clippy::print_stdout, reason = "prints a table")]

use std::{
    error::Error,
    process::{Command, Stdio},
    time::{Duration, Instant},
};

const RUNS: usize = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let binary = std::env::current_exe()?.with_file_name("untangled");
    println!("| file | face pairs | least s | greatest s |\n|---|---|---|---|");
    for file in std::env::args().skip(1) {
        let (mut least, mut greatest) = (Duration::MAX, Duration::ZERO);
        let mut pairs = String::new();
        for _ in 0..RUNS {
            let start = Instant::now();
            let output = Command::new(&binary).args(["check", "--json", &file]).stderr(Stdio::inherit()).output()?;
            let time = start.elapsed();
            (least, greatest) = (least.min(time), greatest.max(time));
            let report: serde_json::Value = serde_json::from_slice(&output.stdout)?;
            pairs = report["num_face_pairs"].to_string();
        }
        let name = file.rsplit('/').next().unwrap_or(&file);
        println!("| {name} | {pairs} | {:.2} | {:.2} |", least.as_secs_f64(), greatest.as_secs_f64());
    }
    Ok(())
}
