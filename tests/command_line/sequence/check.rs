//! `check --cache`.

use super::{code, command, folder, lines, run};

#[test]
fn check_of_a_cache_says_of_each_frame_what_check_says_of_its_file() {
    let folder = folder();
    let path = folder.path();
    let check = |cache: &str, more: &[&str]| {
        let output = run(&[&["check", "cloth.obj", "--cache", cache, "--json"], more].concat(), path);
        assert_eq!(code(&output), 1, "{output:?}");
        lines(&output)
    };
    let (numbered, totals) = check("in/cloth.###.obj", &[]);
    let numbers: Vec<u64> = numbered.iter().map(|line| line["frame"].as_u64().unwrap()).collect();
    assert_eq!(numbers, (1..=24).collect::<Vec<_>>());
    let mut num_tangled = 0;
    for line in &numbered {
        let file = format!("in/cloth.{:03}.obj", line["frame"].as_u64().unwrap());
        let single = run(&["check", &file, "--json"], path);
        let single: serde_json::Value = serde_json::from_slice(&single.stdout).unwrap();
        for name in ["num_edge_face_intersections", "num_face_pairs", "path_pairs", "certificate"] {
            assert_eq!(line["before"][name], single[name], "{file} {name}");
        }
        assert_eq!(line["clean"], single["num_face_pairs"] == 0);
        num_tangled += usize::from(line["clean"] == false);
    }
    assert!((3..16).contains(&num_tangled), "{num_tangled}");
    assert_eq!(totals["num_clean_frames"], 24 - num_tangled);
    assert_eq!((&totals["first_frame"], &totals["last_frame"]), (&1.into(), &24.into()));
    // The same shot in single precision, with frames from 0.
    for cache in ["in.pc2", "in.mdd"] {
        let (singles, _) = check(cache, &[]);
        let clean = |lines: &[serde_json::Value]| lines.iter().map(|line| line["clean"].clone()).collect::<Vec<_>>();
        assert_eq!(clean(&singles), clean(&numbered));
        assert_eq!(singles[23]["frame"], 23);
        let (part, totals) = check(cache, &["--frames", "9..14"]);
        assert_eq!(part, singles[9..=14]);
        assert_eq!(totals["num_frames"], 6);
    }
}

#[test]
fn check_of_clean_frames_ends_with_0_and_says_so_to_people() {
    let folder = folder();
    let output = run(&["check", "cloth.obj", "--cache", "in.pc2", "--frames", "0..2"], folder.path());
    assert_eq!(code(&output), 0, "{output:?}");
    assert_eq!(String::from_utf8(output.stdout).unwrap(), "in.pc2, frames 0 to 2\n  3 of 3 frames are clean\n");
    let output = run(&["check", "cloth.obj", "--cache", "in.pc2", "--gap", "0.5", "--frames", "0..2"], folder.path());
    assert_eq!(code(&output), 1, "{output:?}");
    assert!(String::from_utf8(output.stdout).unwrap().contains("primitive pairs nearer than the gap"));
}

#[test]
fn check_of_a_cache_prints_the_same_bytes_on_any_number_of_threads() {
    let folder = folder();
    let with = |num_threads: &str| {
        let arguments = ["check", "cloth.obj", "--cache", "in.mdd", "--json"];
        command(&arguments, folder.path()).env("RAYON_NUM_THREADS", num_threads).output().unwrap().stdout
    };
    let one = with("1");
    assert!(!one.is_empty() && with("2") == one && with("7") == one);
}
