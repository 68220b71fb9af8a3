//! What is refused: one line, exit code 2, nothing written.

use std::fs;

use super::{code, folder, run};
use crate::mesh_folder::names;

#[test]
fn caches_refuse_what_does_not_fit_in_one_line() {
    let folder = folder();
    let path = folder.path();
    let whole = fs::read(path.join("in.pc2")).unwrap();
    fs::write(path.join("short.pc2"), &whole[..whole.len() - 4000]).unwrap();
    let mut nan = whole.clone();
    let frame_size = (whole.len() - 32) / 24;
    nan[32 + 5 * frame_size..32 + 5 * frame_size + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    fs::write(path.join("nan.pc2"), &nan).unwrap();
    fs::write(path.join("other.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    fs::write(path.join("body.obj"), "v 0 0 9\nv 1 0 9\nv 0 1 9\nf 1 2 3\n").unwrap();
    fs::write(path.join("exists.pc2"), "mine").unwrap();
    let before = names(path);
    let num_vertices = frame_size / 12;
    let truncated = "short.pc2: frame 22: the file ends within this frame";
    let other = format!("in.pc2: has {num_vertices} vertices, and the mesh has 3");
    let cases: Vec<(&str, &str)> = vec![
        ("check cloth.obj --cache short.pc2", truncated),
        ("check cloth.obj --cache nan.pc2 --frames 4..6", "nan.pc2: frame 5: vertex 0 (from 0) has coordinate x = NaN"),
        ("check other.obj --cache in.pc2", &other),
        ("check cloth.obj --cache none_##.obj", "none_##.obj: no file fits this pattern"),
        ("check cloth.obj --cache none.pc2", "none.pc2: can't be read: No such file"),
        ("check cloth.obj --cache cloth.obj", "cloth.obj: not a vertex cache; expected .pc2"),
        ("check cloth.obj --cache in.pc2 --frames 20..24", "in.pc2: frame 24: there are frames 0 to 23"),
        ("check cloth.obj --cache in.pc2 --face-pairs", "--face-pairs can't be used with --cache"),
        ("check cloth.obj --cache in.pc2 --contours c.obj", "--contours can't be used with --cache"),
        ("check cloth.obj --cache in.pc2 -v", "--verbose can't be used with --cache"),
        ("check cloth.obj --cache in.pc2 --body body.obj --body-cache in.pc2", "vertices, and the mesh has 3"),
        ("check cloth.obj --cache in.pc2 --body-cache in.pc2", "--body-cache is given 1 times for 0 bodies"),
        ("check cloth.obj --frames 1..2", "--cache <IN>"),
        ("check cloth.obj --cache in.pc2 --frames 5..2", "the first frame must not be after the last one"),
        ("fix cloth.obj --cache in.pc2 -o out.mdd", "out.mdd: must be of the format of the cache"),
        ("fix cloth.obj --cache in/cloth.###.obj -o out.obj", "out.obj: must be of the format of the cache"),
        ("fix cloth.obj --cache in/cloth.###.obj -o none/c.#.obj", "none/c.#.obj: there is no such folder"),
        ("fix cloth.obj --cache in.pc2 -o in.pc2 --overwrite", "in.pc2: is an input, and inputs are never overwritten"),
        ("fix cloth.obj --cache in/cloth.###.obj -o in/cloth.###.obj --overwrite", "in/cloth.001.obj: is an input"),
        ("fix cloth.obj --cache in.pc2 -o exists.pc2", "exists.pc2: exists; --overwrite replaces it"),
        ("fix cloth.obj --cache in.pc2 -o out.pc2 --time-limit 5", "--time-limit can't be used with --cache"),
        ("fix cloth.obj --cache short.pc2 -o out.pc2", truncated),
    ];
    for (arguments, words) in cases {
        let output = run(&arguments.split(' ').collect::<Vec<_>>(), path);
        assert_eq!(code(&output), 2, "{arguments} {output:?}");
        assert!(output.stdout.is_empty() || arguments.contains("nan.pc2"), "{arguments} {output:?}");
        let text = String::from_utf8(output.stderr).unwrap();
        assert!(text.contains(words), "{arguments}: {text}");
        let is_usage = text.contains("Usage") || text.contains("For more information");
        assert!(is_usage || text.trim_end().lines().count() == 1, "{arguments}: {text}");
        assert_eq!(names(path), before, "{arguments}");
    }
}

#[test]
fn fix_of_numbered_meshes_replaces_files_only_if_asked_to() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("c_003.obj"), "mine").unwrap();
    let fix = ["fix", "cloth.obj", "--cache", "in/cloth.###.obj", "-o", "c_###.obj", "--frames", "1..4"];
    let output = run(&fix, path);
    assert_eq!(code(&output), 2);
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "untangled: c_003.obj: exists; --overwrite replaces it\n");
    assert!(!path.join("c_001.obj").exists());
    assert_eq!(code(&run(&[&fix[..], &["--overwrite"]].concat(), path)), 0);
    assert!(fs::read(path.join("c_003.obj")).unwrap() != b"mine");
}
