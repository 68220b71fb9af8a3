//! What `untangled fix --cache` makes of a shot, as `docs/results/sequences.md`.
//!
//! ```sh
//! cargo build --release -p untangled
//! cargo run --release -p untangled-lab --bin sequences_table -- [OPTION]... > docs/results/sequences.md
//! ```
//!
//! A generated shot of 240 frames and 8,000 triangles. `--small` takes the shot of the tests instead, `--simulated` one
//! that a solver made; `--write FOLDER` only writes the files. The program `untangled` of the same build is run.
#![allow(clippy::print_stdout, reason = "prints a document")]

mod excess;
mod formats;
mod runs;
mod scene;

use std::{env, path::PathBuf};

use runs::{Whole, killed, parts, whole};
use scene::{Scene, Shot};
use untangled_lab::{
    Failure,
    simulated_shot::SimulatedShot,
    table::{print_header, print_text},
};
use untangled_testkit::shots::FlapShot;

/// Moments at which the run is killed.
const NUM_KILLS: u32 = 10;

fn main() -> Result<(), Failure> {
    let (mut shot, mut option, mut folder) = (None, "", None);
    let mut arguments = env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--small" => shot = Some(Shot::generated(&FlapShot::small())),
            "--simulated" => (shot, option) = (Some(Shot::simulated(&SimulatedShot::large())?), " -- --simulated"),
            "--write" => folder = arguments.next().map(PathBuf::from),
            other => return Err(format!("{other} is not known").into()),
        }
    }
    let shot = shot.unwrap_or_else(|| Shot::generated(&FlapShot::large()));
    if let Some(folder) = folder {
        return Scene::write(&folder, &shot).map(|_| ());
    }
    print_text(&format!(
        "# Sequences\n\n\
         {}\n\n\
         ```sh\n\
         cargo build --release -p untangled\n\
         cargo run --release -p untangled-lab --bin sequences_table{option}\n\
         ```\n",
        shot.words
    ));
    print_shot(&shot)
}

/// Repairs a shot in all ways, and prints how that went.
fn print_shot(shot: &Shot) -> Result<(), Failure> {
    let folder = env::temp_dir().join(format!("untangled-sequences-{}", std::process::id()));
    let scene = Scene::write(&folder, shot)?;
    let found = whole(&scene)?;
    print_whole(&scene, &found);
    print_header(&["how the frames were made", "seconds", "bytes"]);
    println!("| one run | {:.1} | |", found.seconds);
    for num_parts in [1, 2, 8] {
        let (seconds, is_same) = parts(&scene, num_parts, &found.bytes)?;
        println!("| in parts: {num_parts} | {seconds:.1} | {} |", same(is_same));
    }
    let (seconds, is_same, kept) = killed(&scene, NUM_KILLS, found.seconds, &found.bytes)?;
    println!("| killed at {NUM_KILLS} moments, and gone on with | {seconds:.1} | {} |", same(is_same));
    print_text(&format!(
        "\nEach run went on after the frames that the one before had finished, {kept} of them after the last kill.\n"
    ));
    scene.write_formats(shot)?;
    print_header(&["the same shot as", "seconds of `fix`", "frames not clean by `check`", "largest difference, nm"]);
    for format in formats::formats(&scene, &found.bytes)? {
        let difference = 1e9 * format.max_difference_m;
        println!("| {} | {:.1} | {} | {difference:.0} |", format.name, format.seconds, format.num_left);
    }
    std::fs::remove_dir_all(&folder)?;
    print_text(
        "\nDifferences are those of coordinates from the output as PC2, both in single precision. OBJ has what the \
         others round, and where two ways out are as near, the last bits may choose.\n",
    );
    Ok(())
}

fn same(is_same: bool) -> &'static str {
    if is_same { "the same" } else { "OTHERS" }
}

fn print_whole(scene: &Scene, found: &Whole) {
    let totals = &found.totals;
    let smooth = |name: &str| totals["smoothness"][name].as_f64().unwrap_or(f64::NAN);
    print_header(&["what", "value"]);
    println!("| frames | {} |\n| triangles | {} |", totals["num_frames"], scene.num_faces);
    println!("| frames that were not clean | {} |", found.num_tangled);
    println!("| frames that are not clean after `fix`, by `fix` | {} |", found.num_left);
    println!("| the same, by `check` of the output | {} |", found.num_left_by_check);
    println!("| frames unchanged to the bit, by `fix` | {} |", totals["num_unchanged_frames"]);
    println!("| the same, by comparing the files | {} |", found.num_same_frames);
    println!("| vertices | {} |", totals["num_vertices"]);
    println!("| vertices unchanged to the bit in all frames | {} |", totals["num_unchanged_vertices"]);
    println!("| largest correction, mm | {:.2} |", 1000.0 * smooth("max_correction_m"));
    println!("| largest second difference, mm/frame² | {:.3} |", 1000.0 * smooth("max_second_difference_m"));
    println!("| beside a smooth bump as high, worst vertex | {:.2} |", smooth("max_ratio_to_smooth"));
    println!("| 99 of 100 vertices | {:.2} |", smooth("p99_ratio_to_smooth"));
    println!("| mean | {:.2} |", smooth("mean_ratio_to_smooth"));
    let (own, alone) = (found.excess, found.excess_alone);
    let beyond = "acceleration beyond that of the input and of a smooth bump";
    println!("| {beyond}, mm/frame² | {:.3} |", 1000.0 * own.max_m);
    println!("| vertices that have any, of those that are corrected | {} of {} |", own.num_beyond, own.num_corrected);
    println!("| {beyond}, of frames that `fix` repairs one by one, mm/frame² | {:.3} |", 1000.0 * alone.max_m);
    println!("| vertices that have any | {} of {} |", alone.num_beyond, alone.num_corrected);
    println!("| `check` of the input, seconds | {:.1} |", found.check_seconds);
    println!("| `fix`, seconds | {:.1} |", found.seconds);
    println!("| most memory of `fix`, MB | {} |\n", found.peak_mb);
}
