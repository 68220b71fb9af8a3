//! `join`: parts that several machines repaired, as one file.

use std::{fs, path::Path};

use super::{HEADER_SIZE, code, folder, run};

#[test]
fn join_of_repaired_parts_has_the_bytes_of_the_whole_in_both_formats() {
    let folder = folder();
    let path = folder.path();
    for format in ["pc2", "mdd"] {
        let name = |stem: &str| format!("{stem}.{format}");
        let fix = |out: &str, more: &[&str]| {
            let cache = name("in");
            let output = run(&[&["fix", "cloth.obj", "--cache", &cache, "-o", out], more].concat(), path);
            assert_eq!(code(&output), 0, "{output:?}");
        };
        fix(&name("whole"), &[]);
        for (stem, frames) in [("a", "0..6"), ("b", "7..7"), ("c", "8..23")] {
            fix(&name(stem), &["--frames", frames]);
        }
        let [a, b, c, joined] = ["a", "b", "c", "joined"].map(name);
        let output = run(&["join", &a, &b, &c, "-o", &joined], path);
        assert!(code(&output) == 0 && output.stderr.is_empty(), "{output:?}");
        assert_eq!(String::from_utf8(output.stdout).unwrap(), format!("{joined}: 24 frames of 3 parts\n"));
        assert!(fs::read(path.join(&joined)).unwrap() == fs::read(path.join(name("whole"))).unwrap());

        // An output that exists is replaced only where that is asked for, an input never.
        assert_eq!(code(&run(&["join", &a, "-o", &joined], path)), 2);
        assert_eq!(code(&run(&["join", &a, &b, "-o", &a, "--overwrite"], path)), 2);
        assert_eq!(code(&run(&["join", &a, "-o", &joined, "--overwrite"], path)), 0);
        assert!(fs::read(path.join(&joined)).unwrap() == fs::read(path.join(&a)).unwrap());
    }
}

/// A folder with parts of the shot: frames 0 to 4, 5 to 9, 6 to 10, 10 and 11; a copy of the first, and one of the
/// whole.
fn parts() -> tempfile::TempDir {
    let folder = folder();
    let whole = fs::read(folder.path().join("in.pc2")).unwrap();
    let frame_size = (whole.len() - HEADER_SIZE) / 24;
    for (name, first, num_frames) in [("a", 0u16, 5u32), ("copy", 0, 5), ("b", 5, 5), ("late", 6, 5), ("last", 10, 2)] {
        let mut bytes = whole[..HEADER_SIZE].to_vec();
        bytes[20..24].copy_from_slice(&(1.0 + f32::from(first)).to_le_bytes());
        bytes[28..].copy_from_slice(&num_frames.to_le_bytes());
        let start = HEADER_SIZE + usize::from(first) * frame_size;
        bytes.extend(&whole[start..start + num_frames as usize * frame_size]);
        fs::write(folder.path().join(format!("{name}.pc2")), bytes).unwrap();
    }
    fs::copy(folder.path().join("in.mdd"), folder.path().join("copy.mdd")).unwrap();
    folder
}

/// Of each case the parts, and words about the one at fault.
fn assert_refused(folder: &Path, cases: &[(&str, &str)]) {
    for (parts, words) in cases {
        let parts: Vec<&str> = parts.split(' ').collect();
        let output = run(&[&["join"], &parts[..], &["-o", "out.pc2"]].concat(), folder);
        let said = String::from_utf8(output.stderr.clone()).unwrap();
        assert!(code(&output) == 2 && said.lines().count() == 1 && said.contains(words), "{parts:?}: {said}");
        assert!(!folder.join("out.pc2").exists() && output.stdout.is_empty());
    }
}

#[test]
fn join_of_parts_that_are_missing_double_or_out_of_order_says_which() {
    let folder = parts();
    assert_refused(
        folder.path(),
        &[
            (
                "a.pc2 late.pc2",
                "late.pc2: starts at 7, and a.pc2 ends at 5: a part with 1 frame between them is missing\n",
            ),
            (
                "a.pc2 last.pc2",
                "last.pc2: starts at 11, and a.pc2 ends at 5: a part with 5 frames between them is missing\n",
            ),
            (
                "a.pc2 last.pc2 b.pc2",
                "last.pc2: is given right after a.pc2, and b.pc2 comes between them: parts are needed in the order",
            ),
            (
                "b.pc2 a.pc2",
                "a.pc2: starts at 1, and b.pc2, which is given before it, at 6: parts are needed in the order of",
            ),
            ("b.pc2 late.pc2", "late.pc2: starts at 7, and b.pc2 ends at 10: frames are in both\n"),
            ("a.pc2 a.pc2", "a.pc2: is given twice\n"),
            ("a.pc2 b.pc2 ./a.pc2", "./a.pc2: is given twice, as a.pc2 too\n"),
            ("a.pc2 b.pc2 copy.pc2", "copy.pc2: has the frames of a.pc2, 1 to 5: it is the same part a second time\n"),
            ("in.mdd copy.mdd", "copy.mdd: has the frames of in.mdd, 0 to 0.95"),
        ],
    );
}

#[test]
fn join_of_what_does_not_belong_together_is_refused_with_the_part_at_fault() {
    let folder = parts();
    let path = folder.path();
    let b = fs::read(path.join("b.pc2")).unwrap();
    let write = |name: &str, bytes: &[u8]| fs::write(path.join(name), bytes).unwrap();
    write("short.pc2", &b[..HEADER_SIZE + 7]);
    write("stub.pc2", b"POINTCACHE2\0");
    write("other.pc2", b"POINTCACHE2 \x01\0\0\0\x01\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0");
    let mut huge = b.clone();
    huge[16..20].copy_from_slice(&u32::MAX.to_le_bytes());
    huge[28..32].copy_from_slice(&u32::MAX.to_le_bytes());
    write("huge.pc2", &huge);
    let fewer = [&b[..16], &1u32.to_le_bytes(), &6f32.to_le_bytes(), &b[24..28], &1u32.to_le_bytes(), &[0; 12]];
    write("fewer.pc2", &fewer.concat());
    assert_refused(
        path,
        &[
            ("a.pc2 short.pc2", "short.pc2: has 39 bytes, and its header promises 5 frames"),
            ("a.pc2 huge.pc2", "huge.pc2: has "),
            ("stub.pc2", "stub.pc2: is too short for its header"),
            ("other.pc2", "other.pc2: does not start with POINTCACHE2"),
            ("a.pc2 fewer.pc2", "fewer.pc2: has 1 vertices, and a.pc2 has "),
            ("a.pc2 in.mdd", "in.mdd: is of another format than a.pc2"),
            ("cloth.obj", "cloth.obj: is neither .pc2 nor .mdd"),
            ("missing.pc2", "missing.pc2: "),
        ],
    );
    let output = run(&["join", "a.pc2", "b.pc2", "-o", "out.mdd"], path);
    assert!(code(&output) == 2 && String::from_utf8(output.stderr).unwrap().contains("must be of the format"));
}
