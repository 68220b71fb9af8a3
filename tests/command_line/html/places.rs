//! Where a page is written, and what is refused.

use std::{
    fs,
    os::unix::fs::{PermissionsExt, symlink},
    path::Path,
    process::{Command, Output},
};

use untangled_testkit::process::untangled;

use super::document;
use crate::{
    mesh_folder::{code, command, complaint, fix, folder, is_progress, names},
    sequence,
};

/// Runs the program where no file may have more than 300 kB: meshes and caches have less, a page has more.
fn without_room(arguments: &str, folder: &Path) -> Output {
    let script = format!("trap '' XFSZ; ulimit -f 300; exec \"$0\" {arguments}");
    Command::new("bash").args(["-c", &script]).arg(untangled()).current_dir(folder).output().unwrap()
}

#[test]
fn page_that_can_not_be_written_withholds_no_result() {
    let (meshes, shot) = (folder(), sequence::folder());
    for (folder, arguments, out) in [
        (&meshes, "check square.obj spike.obj", None),
        (&meshes, "fix tangled.glb -o OUT.ply --report OUT.json", Some("ply")),
        (&shot, "check cloth.obj --cache in.pc2 --frames 9..12", None),
        (&shot, "fix cloth.obj --cache in.pc2 --frames 10..12 -o OUT.pc2 --report OUT.json", Some("pc2")),
    ] {
        let path = folder.path();
        let expected = without_room(&arguments.replace("OUT", "a"), path);
        let before = names(path);
        let output = without_room(&format!("{} --html page.html", arguments.replace("OUT", "b")), path);
        assert_eq!(code(&output), 2, "{output:?}");
        let said = String::from_utf8(output.stderr).unwrap();
        let said: Vec<&str> = said.lines().filter(|line| !is_progress(line)).collect();
        assert_eq!(said, ["untangled: page.html: can't be written: File too large (os error 27)"], "{arguments}");
        // The report is there, but for names and times; files are at their places, and nothing else is.
        let lines = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap().lines().count();
        assert_eq!(lines(output.stdout), lines(expected.stdout), "{arguments}");
        let files = out.map_or(Vec::new(), |kind| vec!["b.json".to_owned(), format!("b.{kind}")]);
        let new: Vec<String> = names(path).into_iter().filter(|name| !before.contains(name)).collect();
        assert_eq!(new, files, "{arguments}");
        if let Some(kind) = out {
            let [a, b] = ["a", "b"].map(|stem| fs::read(path.join(format!("{stem}.{kind}"))).unwrap());
            assert!(a == b, "{arguments}");
        }
    }
}

#[test]
fn folder_that_takes_no_files_is_refused_before_any_work() {
    let folder = sequence::folder();
    let path = folder.path();
    let before = names(path);
    for arguments in [
        "check cloth.obj --cache in.pc2 --html /proc/page.html",
        "fix cloth.obj --cache in.pc2 -o out.pc2 --html /proc/page.html",
        "fix cloth.obj --cache in.pc2 -o out.pc2 --report /proc/report.json",
        "fix cloth.obj --cache in.pc2 -o /proc/out.pc2",
        "fix cloth.obj -o /proc/out.obj",
    ] {
        let output = sequence::run(&arguments.split(' ').collect::<Vec<_>>(), path);
        let said = String::from_utf8(output.stderr.clone()).unwrap();
        assert!(code(&output) == 2 && said.contains(": no file can be made in its folder: "), "{output:?}");
        assert!(said.lines().count() == 1 && !said.contains(".tmp") && output.stdout.is_empty(), "{output:?}");
        assert_eq!(names(path), before);
    }
}

#[test]
fn page_with_a_hostile_file_name_holds_it_as_text() {
    let folder = folder();
    let path = folder.path();
    for (number, name) in ["</script><b>&\"'.obj", "<!--<script>.obj", "größe \u{2028}日本.obj"].into_iter().enumerate()
    {
        // A name of a file has no slash.
        let name = name.replace('/', "\u{2215}");
        fs::copy(path.join("square.obj"), path.join(&name)).unwrap();
        let page = format!("page{number}.html");
        let output = command("check", path).args(["--html", &page, "--", &name]).output().unwrap();
        assert_eq!(code(&output), 0, "{output:?}");
        assert_eq!(document(&path.join(&page))["mesh"]["parts"][0]["file"], name.as_str());
        let text = fs::read_to_string(path.join(&page)).unwrap();
        assert!(!text.contains("<b>") && text.contains("<title>untangled check: "), "{name}");
    }
    // What is inside of a file is text as well: the name of a group.
    fs::write(
        path.join("named.obj"),
        "g </script><script>alert(1)</script>\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n\
                                       g b\nv 0.2 0.2 -1\nv 0.3 0.2 1\nv 0.2 0.3 1\nf 4 5 6\n",
    )
    .unwrap();
    command("check", path).args(["named.obj", "--html", "named.html"]).output().unwrap();
    let page = document(&path.join("named.html"));
    assert!(page["report"]["meetings"].to_string().contains("</script>"), "{}", page["report"]["meetings"]);
}

#[test]
fn page_is_refused_over_inputs_existing_files_and_other_outputs() {
    let folder = folder();
    let path = folder.path();
    symlink("square.obj", path.join("link.html")).unwrap();
    fs::write(path.join("old.html"), "old").unwrap();
    fs::write(path.join("kept.html"), "kept").unwrap();
    fs::set_permissions(path.join("kept.html"), fs::Permissions::from_mode(0o444)).unwrap();
    fs::create_dir(path.join("folder.html")).unwrap();
    let refused = [
        (&["link.html"][..], "link.html: is an input, and inputs are never overwritten"),
        (&["link.html", "--overwrite"], "link.html: is an input, and inputs are never overwritten"),
        (&["old.html"], "old.html: exists; --overwrite replaces it"),
        (&["kept.html", "--overwrite"], "kept.html: is write-protected"),
        (&["folder.html", "--overwrite"], "folder.html: is a folder"),
        (&["none/page.html"], "none/page.html: there is no folder none"),
        (&["page.obj"], "page.obj: a page is written as .html"),
        (&["page"], "page: a page is written as .html"),
        (&[".html"], ".html: is no name for a page: something must stand before .html, as in page.html"),
        (&["none/.HTM"], "none/.HTM: is no name for a page"),
        (&["/proc/page.html"], "/proc/page.html: no file can be made in its folder: "),
    ];
    for (arguments, reason) in refused {
        let fixing = [&["square.obj", "-o", "out.obj", "--html"], arguments].concat();
        let text = complaint(&fixing, path);
        assert!(text.contains(reason), "{text}");
        let before = names(path);
        let output = command("check", path).args(["square.obj", "--html"]).args(arguments).output().unwrap();
        let text = String::from_utf8(output.stderr.clone()).unwrap();
        assert!(code(&output) == 2 && text.contains(reason) && text.lines().count() == 1, "{output:?}");
        assert!(output.stdout.is_empty() && names(path) == before);
    }
    let text = complaint(&["square.obj", "-o", "out.obj", "--report", "a.html", "--html", "./a.html"], path);
    assert!(text.contains("is the report, and can't be the page as well"), "{text}");
    assert_eq!(fs::read(path.join("old.html")).unwrap(), b"old");
    assert_eq!(code(&fix(&["square.obj", "-o", "out.obj", "--html", "old.html", "--overwrite"], path)), 0);
    assert_eq!(document(&path.join("old.html"))["command"], "fix");
}

#[test]
fn page_over_a_buffer_of_a_document_is_refused() {
    let folder = folder();
    let path = folder.path();
    fs::rename(path.join("cloth.bin"), path.join("cloth.html")).unwrap();
    let text = fs::read_to_string(path.join("clean.gltf")).unwrap().replace("cloth.bin", "cloth.html");
    fs::write(path.join("clean.gltf"), text).unwrap();
    let buffer = fs::read(path.join("cloth.html")).unwrap();
    let output = command("check", path).args(["clean.gltf", "--html", "cloth.html", "--overwrite"]).output().unwrap();
    let complaint = String::from_utf8(output.stderr.clone()).unwrap();
    assert!(code(&output) == 2 && complaint.contains("is an input"), "{output:?}");
    assert_eq!(fs::read(path.join("cloth.html")).unwrap(), buffer);
}
