//! `fix --cache`: every frame certified, in the format of the input, in parts as in one run.

use std::fs;

use untangled_testkit::{files::formats::obj, generate::Sheet, shots::pc2};

use super::{HEADER_SIZE, code, command, folder, frames_of, lines, run};

#[test]
fn fix_of_a_cache_leaves_every_frame_clean_and_clean_frames_without_fade_bit_for_bit() {
    let folder = folder();
    let path = folder.path();
    let output = run(&["fix", "cloth.obj", "--cache", "in.pc2", "-o", "out.pc2", "--json"], path);
    assert_eq!(code(&output), 0, "{output:?}");
    let (reported, totals) = lines(&output);
    assert_eq!((reported.len(), &totals["num_clean_frames"], &totals["clean"]), (24, &24.into(), &true.into()));
    let [before, after] = ["in.pc2", "out.pc2"].map(|name| fs::read(path.join(name)).unwrap());
    assert_eq!(before[..HEADER_SIZE], after[..HEADER_SIZE]);
    let (mut num_unchanged, mut num_faded) = (0, 0);
    for ((line, before), after) in reported.iter().zip(frames_of(&before)).zip(frames_of(&after)) {
        assert_eq!(line["after"]["num_face_pairs"], 0);
        let num_moved = before.chunks(12).zip(after.chunks(12)).filter(|(before, after)| before != after).count();
        assert_eq!(line["num_moved_vertices"], num_moved, "{line}");
        num_unchanged += usize::from(num_moved == 0);
        num_faded += usize::from(num_moved > 0 && line["clean_before"] == true);
    }
    assert_eq!(totals["num_unchanged_frames"], num_unchanged);
    assert!(num_faded >= 10, "{num_faded}");
    assert!(totals["num_unchanged_vertices"].as_u64() > Some(10), "{totals}");
    // Somebody else's eyes: the exact check of each frame that was written.
    let check = run(&["check", "cloth.obj", "--cache", "out.pc2", "--json"], path);
    assert_eq!(code(&check), 0, "{check:?}");
    for line in lines(&check).0 {
        assert_eq!(line["before"]["certificate"]["num_crossings_single"], 0, "{line}");
    }
    assert!(!path.join("out.pc2.partial").exists() && !path.join("out.pc2.journal").exists());
    // A clean cache is written as it is.
    let again = run(&["fix", "cloth.obj", "--cache", "out.pc2", "-o", "again.pc2", "--json"], path);
    assert_eq!(code(&again), 0);
    assert_eq!(fs::read(path.join("again.pc2")).unwrap(), after);
}

#[test]
fn fix_of_parts_writes_the_bytes_of_the_whole_in_each_format() {
    let folder = folder();
    let path = folder.path();
    let fix = |cache: &str, out: &str, more: &[&str]| {
        let output = run(&[&["fix", "cloth.obj", "--cache", cache, "-o", out], more].concat(), path);
        assert_eq!(code(&output), 0, "{output:?}");
    };
    fix("in.pc2", "whole.pc2", &[]);
    let whole = fs::read(path.join("whole.pc2")).unwrap();
    for ranges in [&["0..11", "12..23"][..], &["0..4", "5..5", "6..13", "14..23"]] {
        let mut joined = Vec::new();
        for range in ranges {
            let name = format!("{}-{range}.pc2", ranges.len());
            fix("in.pc2", &name, &["--frames", range]);
            let part = fs::read(path.join(name)).unwrap();
            let first: f32 = range.split('.').next().unwrap().parse().unwrap();
            assert_eq!(part[20..24], (1.0 + first).to_le_bytes());
            joined.extend(frames_of(&part));
        }
        assert!(joined == frames_of(&whole), "{ranges:?}");
    }
    fix("in.mdd", "whole.mdd", &[]);
    fix("in.mdd", "part.mdd", &["--frames", "7..12"]);
    let [whole, part] = ["whole.mdd", "part.mdd"].map(|name| fs::read(path.join(name)).unwrap());
    let frame_size = (whole.len() - 8 - 4 * 24) / 24;
    assert_eq!(part[8..32], whole[8 + 4 * 7..8 + 4 * 13]);
    assert!(part[32..] == whole[8 + 4 * 24 + 7 * frame_size..8 + 4 * 24 + 13 * frame_size]);
    for name in ["one", "two"] {
        fs::create_dir(path.join(name)).unwrap();
    }
    fix("in/cloth.###.obj", "one/c_##.obj", &[]);
    fix("in/cloth.###.obj", "two/c_##.obj", &["--frames", "1..10"]);
    fix("in/cloth.###.obj", "two/c_##.obj", &["--frames", "11..24"]);
    let mut names: Vec<_> = fs::read_dir(path.join("two")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!((names.len(), names[0].to_str(), names[23].to_str()), (24, Some("c_01.obj"), Some("c_24.obj")));
    for name in names {
        assert!(fs::read(path.join("one").join(&name)).unwrap() == fs::read(path.join("two").join(&name)).unwrap());
    }
    // A clean frame far from all others is a copy.
    assert!(fs::read(path.join("one/c_01.obj")).unwrap() == fs::read(path.join("in/cloth.001.obj")).unwrap());
}

#[test]
fn fix_of_a_cache_writes_the_same_bytes_on_any_number_of_threads() {
    let folder = folder();
    let with = |num_threads: &str| {
        let out = format!("{num_threads}.pc2");
        let arguments =
            ["fix", "cloth.obj", "--cache", "in.pc2", "-o", &out, "--json", "--report", &format!("{out}.json")];
        let mut command = command(&arguments, folder.path());
        let output = command.env("RAYON_NUM_THREADS", num_threads).output().unwrap();
        assert_eq!(code(&output), 0, "{output:?}");
        assert_eq!(fs::read(folder.path().join(format!("{out}.json"))).unwrap(), output.stdout);
        let report = String::from_utf8(output.stdout).unwrap().replace(&out, "out.pc2");
        (report, fs::read(folder.path().join(out)).unwrap())
    };
    let one = with("1");
    assert!(with("2") == one && with("5") == one);
}

#[test]
fn fix_of_a_cache_whose_vertices_are_pinned_says_what_is_left_and_ends_with_1() {
    let folder = folder();
    let path = folder.path();
    let num_vertices = fs::read_to_string(path.join("cloth.obj")).unwrap().matches("\nv ").count();
    let pins: Vec<String> = (0..num_vertices).map(|vertex| vertex.to_string()).collect();
    fs::write(path.join("pins"), pins.join("\n")).unwrap();
    let output = run(&["fix", "cloth.obj", "--cache", "in.pc2", "-o", "out.pc2", "--json", "--pin", "pins"], path);
    assert_eq!(code(&output), 1, "{output:?}");
    let (reported, totals) = lines(&output);
    assert_eq!((&totals["clean"], &totals["num_unchanged_frames"]), (&false.into(), &24.into()));
    for line in reported.iter().filter(|line| line["clean"] == false) {
        assert_eq!(line["blocked"][0]["reason"], "all its vertices are pinned", "{line}");
        assert_eq!(line["before"], line["after"]);
    }
    assert!(fs::read(path.join("in.pc2")).unwrap() == fs::read(path.join("out.pc2")).unwrap());
}

#[test]
fn fix_of_layers_in_one_cache_parts_them_in_each_frame() {
    let folder = folder();
    let path = folder.path();
    // The outer tube is dented into the inner one, and comes out again.
    let tubes = |dent: f64| {
        let push = move |angle: f64, height: f64| -dent * (-8.0 * (angle - 3.0).powi(2) - 60.0 * height * height).exp();
        let mut both = Sheet::default();
        both.add_tube(0.3, [-0.3, 0.3], [36, 16], |_, _| [0.0; 3]);
        both.add_tube(0.33, [-0.3, 0.3], [36, 16], move |angle, height| {
            [push(angle, height) * angle.cos(), push(angle, height) * angle.sin(), 0.0]
        });
        both
    };
    let frames: Vec<Sheet> = (0..20).map(|frame| tubes(0.05 * (-0.15 * f64::from(frame - 10).powi(2)).exp())).collect();
    for (name, radius) in [("inner.obj", 0.3), ("outer.obj", 0.33)] {
        let mut tube = Sheet::default();
        tube.add_tube(radius, [-0.3, 0.3], [36, 16], |_, _| [0.0; 3]);
        fs::write(path.join(name), obj(&tube, false)).unwrap();
    }
    fs::write(path.join("both.pc2"), pc2(&frames)).unwrap();
    let fix = ["fix", "inner.obj", "outer.obj", "--layers", "--cache", "both.pc2", "-o", "parted.pc2", "--json"];
    let output = run(&fix, path);
    let (reported, totals) = lines(&output);
    assert_eq!(code(&output), 0, "{totals}");
    let behind = |line: &serde_json::Value, at: &str| line[at]["layers"][1]["num_vertices_behind"].as_u64().unwrap();
    assert!(reported.iter().any(|line| behind(line, "before") > 0), "{totals}");
    assert!(reported.iter().all(|line| behind(line, "after") == 0 && line["clean"] == true));
    assert!(totals["smoothness"]["max_ratio_to_smooth"].as_f64() < Some(6.0), "{totals}");
}

/// Two layers that roll up from flat to more than half a turn, towards the side of their faces, the outer one dented
/// through the inner one in some frames.
fn rolling(frame: u32) -> [Sheet; 2] {
    let turn = 0.25 * f64::from(frame);
    [false, true].map(|is_outer| {
        let mut sheet = Sheet::default();
        sheet.add_grid([0.0, 1.0], [0.0, 1.0], [12, 12], |x, y| {
            let dent = 0.033 * (-40.0 * ((x - 0.5).powi(2) + (y - 0.5).powi(2))).exp();
            let dent = if (8..=10).contains(&frame) { dent } else { 0.0 };
            let height = if is_outer { 0.03 - dent } else { 0.0 };
            let angle = turn * (x - 0.5);
            let [across, up] =
                if turn > 0.0 { [angle.sin() / turn, (1.0 - angle.cos()) / turn] } else { [x - 0.5, 0.0] };
            [across - height * angle.sin(), y, up + height * angle.cos()]
        });
        sheet
    })
}

#[test]
fn fix_of_flat_layers_that_roll_up_keeps_what_is_outwards_in_the_first_frame_in_parts_too() {
    let folder = folder();
    let path = folder.path();
    for (name, sheet) in ["a.obj", "b.obj"].into_iter().zip(rolling(0)) {
        fs::write(path.join(name), obj(&sheet, false)).unwrap();
    }
    let frames: Vec<Sheet> = (0..16)
        .map(|frame| {
            let [mut both, outer] = rolling(frame);
            both.positions.extend(outer.positions);
            both
        })
        .collect();
    fs::write(path.join("rolling.pc2"), pc2(&frames)).unwrap();
    let layers = ["a.obj", "b.obj", "--layers", "--cache", "rolling.pc2", "--json"];
    for part in ["0..15", "9..15", "14..15"] {
        let (reported, _) = lines(&run(&[&["check"], &layers[..], &["--frames", part]].concat(), path));
        for line in reported {
            let expected = u64::from((8..=10).contains(&line["frame"].as_u64().unwrap()));
            assert_eq!(line["before"]["layers"][1]["num_vertices_behind"], expected, "{part}: {line}");
        }
    }
    for (part, out) in [("0..15", "whole.pc2"), ("0..8", "first.pc2"), ("9..15", "last.pc2")] {
        let output = run(&[&["fix"], &layers[..], &["--frames", part, "-o", out]].concat(), path);
        let (reported, totals) = lines(&output);
        assert_eq!(code(&output), 0, "{part}: {totals}");
        for line in reported {
            assert!(line["max_displacement_m"].as_f64() < Some(0.006), "{part}: {line}");
        }
    }
    let [whole, first, last] = ["whole.pc2", "first.pc2", "last.pc2"].map(|name| fs::read(path.join(name)).unwrap());
    assert!(frames_of(&whole) == [frames_of(&first), frames_of(&last)].concat());
}
