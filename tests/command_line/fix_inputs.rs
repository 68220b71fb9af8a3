//! `untangled fix`: which inputs it takes, refuses and protects.

use std::{
    ffi::OsStr,
    fs,
    os::unix::{ffi::OsStrExt, fs::symlink},
};

use crate::mesh_folder::{SQUARE, code, command, complaint, fix, folder, json};

#[test]
fn fix_onto_an_input_by_any_name_is_refused() {
    let folder = folder();
    let path = folder.path();
    fs::create_dir(path.join("sub")).unwrap();
    symlink(path.join("square.obj"), path.join("link.obj")).unwrap();
    symlink("nowhere.obj", path.join("dangling.obj")).unwrap();
    symlink(path, path.join("sub/up")).unwrap();
    fs::hard_link(path.join("square.obj"), path.join("hard.obj")).unwrap();
    fs::write(path.join("pins.txt"), "0 # the first\n").unwrap();
    let absolute = path.join("square.obj");
    let absolute = absolute.to_str().unwrap();
    let spellings = [
        "square.obj",
        "./square.obj",
        "sub/../square.obj",
        absolute,
        "link.obj",
        "hard.obj",
        "sub/up/square.obj",
        ".",
        "sub/up",
    ];
    for out in spellings {
        for more in [&[][..], &["--overwrite"]] {
            let arguments = [&["square.obj", "-o", out][..], more].concat();
            let text = complaint(&arguments, path);
            assert!(text.contains("is an input, and inputs are never overwritten"), "{text}");
        }
    }
    // Nor is what an input brings along, nor anything by the report.
    fs::hard_link(path.join("cloth.bin"), path.join("bin.gltf")).unwrap();
    for arguments in [
        &["clean.gltf", "-o", "bin.gltf", "--overwrite"][..],
        &["square.obj", "-o", "a.obj", "--report", "hard.obj", "--overwrite"],
        &["square.obj", "-o", "a.obj", "--pin", "pins.txt", "--report", "pins.txt", "--overwrite"],
        &["square.obj", "--pin", "pins.txt", "-o", "pins.txt", "--overwrite"],
    ] {
        let text = complaint(arguments, path);
        assert!(text.contains("is an input"), "{text}");
    }
    let text = complaint(&["square.obj", "-o", "a.obj", "--report", "sub/../a.obj"], path);
    assert!(text.contains("can't be the report as well"), "{text}");
    let text = complaint(&["square.obj", "-o", "dangling.obj", "--overwrite"], path);
    assert!(text.contains("dangling.obj: is a link that leads nowhere"), "{text}");
    assert_eq!(fs::read(path.join("square.obj")).unwrap(), SQUARE.as_bytes());
}

#[test]
fn check_and_fix_of_file_names_that_are_no_text_work() {
    let folder = folder();
    let name = OsStr::from_bytes(b"caf\xe9.obj");
    fs::copy(folder.path().join("square.obj"), folder.path().join(name)).unwrap();
    fs::create_dir(folder.path().join("out")).unwrap();
    for subcommand in ["check", "fix"] {
        let mut command = command(subcommand, folder.path());
        command.arg(name).arg("--json");
        if subcommand == "fix" {
            command.args(["-o", "out"]);
        }
        let output = command.output().unwrap();
        assert_eq!((code(&output), &json(&output)["files"]), (0, &serde_json::json!(["caf\u{fffd}.obj"])));
    }
    assert_eq!(fs::read(folder.path().join("out").join(name)).unwrap(), SQUARE.as_bytes());
}

#[test]
fn fix_of_bad_input_exits_2_with_one_line_that_names_it() {
    let folder = folder();
    let path = folder.path();
    let write = |name: &str, text: &str| fs::write(path.join(name), text).unwrap();
    write("short.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 900\n");
    write("huge.obj", "v 0 0 0\nv 1 1e200 0\nv 0 1 0\nf 1 2 3\n");
    write("points.obj", "v 0 0 0\n");
    write("empty.obj", "");
    for (name, expected) in [
        ("short.obj", "short.obj:5: face 1 refers to vertex 900, but only 3 are defined"),
        ("huge.obj", "huge.obj:2: vertex 2 has coordinate y"),
        ("points.obj", "points.obj: no mesh in it: 1 vertices, 0 faces"),
        ("empty.obj", "empty.obj: no mesh in it: 0 vertices, 0 faces"),
        ("missing.obj", "missing.obj: can't be read: "),
    ] {
        let text = complaint(&["square.obj", name, "-o", "out.obj", "--json"], path);
        assert!(text.contains(expected), "{text}");
    }
    for usage in [&["-o", "a.obj"][..], &["square.obj"], &["square.obj", "-o", "a.obj", "--quality", "best"]] {
        assert_eq!(code(&fix(usage, path)), 2);
    }
}
