//! A run that was ended is gone on with.

use std::{
    fs,
    path::Path,
    process::Stdio,
    thread::sleep,
    time::{Duration, Instant},
};

use untangled_testkit::process::untangled;

use super::{code, command, folder, run};

const FIX: [&str; 6] = ["fix", "cloth.obj", "--cache", "in.pc2", "-o", "out.pc2"];

/// Lines of a journal: a head, and one for each frame.
fn num_lines(journal: &Path) -> usize {
    fs::read(journal).unwrap_or_default().iter().filter(|&&byte| byte == b'\n').count()
}

/// Starts a run and sends a signal once a journal has some lines. Whether it was ended by that.
pub(super) fn end_after(arguments: &[&str], folder: &Path, journal: &str, num: usize, signal: &str) -> bool {
    let mut child = command(arguments, folder).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    // Lines of earlier runs are there already.
    let num = num.max(num_lines(&folder.join(journal)) + 2);
    let start = Instant::now();
    while num_lines(&folder.join(journal)) < num && child.try_wait().unwrap().is_none() {
        assert!(start.elapsed() < Duration::from_secs(120));
        sleep(Duration::from_millis(1));
    }
    let kill = std::process::Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    let status = child.wait().unwrap();
    if signal == "-INT" && kill.success() && !status.success() {
        assert_eq!(status.code(), Some(2));
    }
    !status.success()
}

#[test]
fn fix_of_a_cache_goes_on_after_kills_with_the_bytes_of_one_run() {
    assert!(untangled().exists());
    let folder = folder();
    let path = folder.path();
    let whole = run(&[&FIX[..4], &["-o", "whole.pc2", "--json"]].concat(), path);
    assert_eq!(code(&whole), 0);
    let arguments = [&FIX[..], &["--json"]].concat();
    let mut num_ended = 0;
    for (num, signal) in [(1, "-KILL"), (3, "-KILL"), (5, "-INT"), (7, "-KILL"), (9, "-TERM")] {
        num_ended += usize::from(end_after(&arguments, path, "out.pc2.journal", num, signal));
        if path.join("out.pc2").exists() {
            break;
        }
        // What a crash may leave: a line that is half, and a frame that is.
        let journal = path.join("out.pc2.journal");
        let text = fs::read_to_string(&journal).unwrap();
        fs::write(&journal, format!("{text}{{\"frame\":9,\"chec")).unwrap();
    }
    assert!(num_ended >= 2, "{num_ended}");
    if !path.join("out.pc2").exists() {
        let kept = num_lines(&path.join("out.pc2.journal"));
        let last = run(&arguments, path);
        assert_eq!(code(&last), 0, "{last:?}");
        let words = String::from_utf8(last.stderr).unwrap();
        assert!(kept < 2 || words.lines().any(|line| line.starts_with("untangled: going on after ")), "{words}");
        // The report is that of the whole.
        let report = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap().replace("whole.pc2", "out.pc2");
        assert_eq!(report(last.stdout), report(whole.stdout));
    }
    let [out, whole] = ["out.pc2", "whole.pc2"].map(|name| fs::read(path.join(name)).unwrap());
    assert!(out == whole);
    assert!(!path.join("out.pc2.partial").exists() && !path.join("out.pc2.journal").exists());
}

#[test]
fn fix_of_a_cache_starts_anew_where_a_setting_or_the_disk_is_another() {
    let folder = folder();
    let path = folder.path();
    assert!(end_after(&FIX, path, "out.pc2.journal", 6, "-KILL"));
    let other = run(&[&FIX[..], &["--quality", "fast"]].concat(), path);
    assert_eq!(code(&other), 0, "{other:?}");
    let words = String::from_utf8(other.stderr).unwrap();
    assert_eq!(words, "untangled: the run that was ended here had another --quality: starting anew\n");
    // A frame that is not what the journal says is made again.
    let whole = run(&[&FIX[..4], &["-o", "whole.pc2"]].concat(), path);
    assert_eq!(code(&whole), 0);
    fs::remove_file(path.join("out.pc2")).unwrap();
    assert!(end_after(&FIX, path, "out.pc2.journal", 6, "-KILL"));
    let mut partial = fs::read(path.join("out.pc2.partial")).unwrap();
    let frame_size = 12 * fs::read_to_string(path.join("cloth.obj")).unwrap().matches("\nv ").count();
    partial[32 + 2 * frame_size + 5] ^= 1;
    fs::write(path.join("out.pc2.partial"), partial).unwrap();
    let last = run(&FIX, path);
    assert_eq!(code(&last), 0);
    let words = String::from_utf8(last.stderr).unwrap();
    assert_eq!(words, "untangled: going on after 2 frames that an earlier run finished\n");
    let [out, whole] = ["out.pc2", "whole.pc2"].map(|name| fs::read(path.join(name)).unwrap());
    assert!(out == whole);
}

#[test]
fn fix_of_numbered_meshes_leaves_whole_files_only_and_goes_on() {
    let folder = folder();
    let path = folder.path();
    for name in ["out", "whole"] {
        fs::create_dir(path.join(name)).unwrap();
    }
    let fix = |out: &'static str| ["fix", "cloth.obj", "--cache", "in/cloth.###.obj", "-o", out];
    assert_eq!(code(&run(&fix("whole/c.###.obj"), path)), 0);
    assert!(end_after(&fix("out/c.###.obj"), path, "out/c.###.obj.1-24.journal", 8, "-KILL"));
    let whole = |number: usize| fs::read(path.join(format!("whole/c.{number:03}.obj"))).unwrap();
    let out = |number: usize| fs::read(path.join(format!("out/c.{number:03}.obj"))).ok();
    let num_done = (1..=24).take_while(|&number| out(number).is_some()).count();
    assert!((6..24).contains(&num_done), "{num_done}");
    assert!((1..=num_done).all(|number| out(number) == Some(whole(number))));
    assert_eq!(code(&run(&fix("out/c.###.obj"), path)), 0);
    assert!((1..=24).all(|number| out(number) == Some(whole(number))));
    assert_eq!(fs::read_dir(path.join("out")).unwrap().count(), 24);
}

#[test]
fn page_of_a_run_that_is_gone_on_with_is_that_of_one_run() {
    let folder = folder();
    let path = folder.path();
    assert!(end_after(&FIX, path, "out.pc2.journal", 6, "-KILL"));
    let page = |out: &str| {
        let page = format!("{out}.html");
        assert_eq!(code(&run(&[&FIX[..4], &["-o", out, "--html", &page]].concat(), path)), 0);
        fs::read_to_string(path.join(page)).unwrap().replace("whole.pc2", "out.pc2")
    };
    let [resumed, whole] = ["out.pc2", "whole.pc2"].map(page);
    assert!(resumed == whole);
}
