//! What people are told of frames: reasons, where counts alone give none; and what help says of them.

use std::fs;

use untangled_testkit::shots::pc2;

use super::{code, folder, frames, lines, run};

/// Two triangles that are clean in double precision, the tip of one a third of the last place of a single above the
/// other, as the numbered frames 1 to 3, and in the file `mesh.obj`.
fn near_frames() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let text = "v 0 0 1\nv 4 0 1\nv 0 4 1.00000011920928955\nv 1 1 1.00000003933906555\nv 1 1.5 3\nv 1.5 1 3\n\
                f 1 2 3\nf 4 5 6\n";
    for name in ["mesh.obj", "in_1.obj", "in_2.obj", "in_3.obj"] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

#[test]
fn frames_that_are_clean_but_not_for_every_reader_say_for_which() {
    let folder = near_frames();
    let path = folder.path();
    let check = run(&["check", "mesh.obj", "--cache", "in_#.obj", "--frames", "2"], path);
    assert_eq!(code(&check), 0, "{check:?}");
    assert_eq!(
        String::from_utf8(check.stdout).unwrap(),
        "in_#.obj, frames 2 to 2\n  frame 2: clean,\n    but not for every reader:\n      rounded to single precision: \
         1 crossing face pair\n  1 of 1 frames are clean\n"
    );
    // Nothing may move: there is a reason beside the counts.
    fs::write(path.join("pins"), "0 1 2 3 4 5").unwrap();
    let fix = ["fix", "mesh.obj", "--cache", "in_#.obj", "-o", "out_#.obj", "--pin", "pins", "--frames", "2"];
    let output = run(&fix, path);
    assert_eq!(code(&output), 1, "{output:?}");
    let said = String::from_utf8(output.stdout).unwrap();
    let reader = "      rounded to single precision: 1 crossing face pair\n";
    let expected = format!(
        "  frame 2: not clean: 0 intersecting face pairs became 0; 0 vertices moved, by up to 0.00 mm\n    the input \
         is clean as it is, but not for every reader:\n{reader}    what readers of the output find:\n{reader}"
    );
    assert!(said.contains(&expected), "{said}");
}

#[test]
fn coordinates_that_count_as_zero_are_counted_over_all_frames() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for name in ["mesh.obj", "in_1.obj", "in_2.obj"] {
        fs::write(path.join(name), "v 0 1e-80 0\nv 1 0 0\nv 0 1 -1e-80\nf 1 2 3\n").unwrap();
    }
    let check = ["check", "mesh.obj", "--cache", "in_#.obj"];
    let fix = ["fix", "mesh.obj", "--cache", "in_#.obj", "-o", "out_#.obj", "--overwrite"];
    for arguments in [&check[..], &fix] {
        let output = run(arguments, path);
        let said = String::from_utf8(output.stdout).unwrap();
        assert!(said.contains("\n  4 coordinates below 2^-250 m count as zero\n"), "{said}");
        let (frames, totals) = lines(&run(&[arguments, &["--json"]].concat(), path));
        assert!(frames.iter().all(|line| line["num_zeroed_coordinates"] == 2), "{frames:?}");
        assert_eq!(totals["num_zeroed_coordinates"], 4);
    }
}

#[test]
fn smoothness_of_a_run_of_one_or_two_frames_is_said_to_be_not_measured() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("cut.pc2"), pc2(&frames()[11..13])).unwrap();
    let fix = ["fix", "cloth.obj", "--cache", "cut.pc2", "-o", "out.pc2", "--overwrite"];
    let output = run(&fix, path);
    assert_eq!(code(&output), 0, "{output:?}");
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.ends_with("  how smoothly corrections change is not measured: that needs three frames\n"), "{said}");
    let (_, totals) = lines(&run(&[&fix[..], &["--json"]].concat(), path));
    let smoothness = &totals["smoothness"];
    assert!(smoothness["num_vertices"].as_u64() > Some(0) && smoothness["max_correction_m"].as_f64() > Some(0.0));
    for name in ["max_second_difference_m", "max_ratio_to_smooth", "p99_ratio_to_smooth", "mean_ratio_to_smooth"] {
        assert!(smoothness[name].is_null(), "{totals}");
    }
}

#[test]
fn help_names_usd_for_files_and_what_a_prim_excludes() {
    let folder = tempfile::tempdir().unwrap();
    let help = |command: &str| {
        let text = String::from_utf8(run(&[command, "--help"], folder.path()).stdout).unwrap();
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    for command in ["check", "fix"] {
        let text = help(command);
        let files = "With --prim one stage in USD (.usd, .usda, .usdc, .usdz)";
        assert!(text.contains(files) && text.contains("--prim takes one FILE, and so no --layers"), "{text}");
    }
    assert!(help("fix").contains("with --prim a layer of USD as text (.usda, .usd)"));
    assert!(help("fix").contains("neither it nor --cache goes with --time-limit"));
    assert!(help("join").contains("Exit code: 0 joined; 2 parts that do not belong together"));
}
