//! `untangled publish`, the example host by hand: every flag, once.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
    time::{Duration, Instant},
};

use clap::CommandFactory;
use tempfile::TempDir;
use untangled_publisher::{cli::Cli, report::Summary};
use untangled_testkit::process::{Daemon, TestDomain, untangled};

/// A daemon, and a folder for each run.
struct Runs {
    domain: TestDomain,
    _daemon: Daemon,
    folder: TempDir,
}

/// What a run printed and wrote.
struct Run {
    said: String,
    before: Vec<u8>,
    after: Vec<u8>,
    summary: Summary,
}

impl Runs {
    fn new() -> Self {
        let domain = TestDomain::new();
        Self { _daemon: Daemon::start(&domain), domain, folder: tempfile::tempdir().unwrap() }
    }

    /// Two steps of a small scene with these flags besides.
    fn run(&self, flags: &[&str]) -> Run {
        let out = self.folder.path().join("out");
        let summary = self.folder.path().join("summary.json");
        let mut command = publish(self.domain.name(), &["--edge-m", "0.06", "--frames", "2", "--clean-frames", "0"]);
        if !flags.iter().any(|flag| flag.ends_with(".obj")) {
            command.args(["--scene", "crease"]);
        }
        let output = command.arg("--out").arg(&out).arg("--summary").arg(&summary).args(flags).output().unwrap();
        let (said, error) = words(&output);
        assert!(matches!(output.status.code(), Some(0 | 1)), "{flags:?}: {said}{error}");
        let [before, after] = ["before.obj", "after.obj"].map(|name| fs::read(out.join(name)).unwrap());
        Run { said, before, after, summary: serde_json::from_slice(&fs::read(summary).unwrap()).unwrap() }
    }
}

fn publish(domain: &str, flags: &[&str]) -> Command {
    let mut command = Command::new(untangled());
    command.args(["publish", "--domain", domain]).args(flags);
    command
}

fn words(output: &Output) -> (String, String) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (text(&output.stdout), text(&output.stderr))
}

fn frames(said: &str) -> usize {
    said.lines().filter(|line| line.starts_with("frame ")).count()
}

#[test]
fn flags_of_the_simulation_change_the_motion_and_not_the_start() {
    let runs = Runs::new();
    let usual = runs.run(&[]);
    assert!(usual.before != usual.after && usual.summary.num_frames == 2, "{}", usual.said);
    assert!(runs.run(&[]).after == usual.after, "two runs of the same differ");
    for flags in [
        ["--dt-s", "0.005"],
        ["--substeps", "3"],
        ["--gravity", "1.62"],
        ["--density", "0.3"],
        ["--stretch", "100"],
        ["--bending", "0.01"],
        ["--drag", "1"],
        ["--thickness-m", "0.1"],
        ["--settings", r#"{"quality": "accurate", "max_step_edge_lengths": 0.1}"#],
    ] {
        let run = runs.run(&flags);
        assert!(run.before == usual.before && run.after != usual.after, "{flags:?}: {}", run.said);
    }
    assert!(runs.run(&["--seed", "2"]).before != usual.before, "the seed changes nothing");
}

#[test]
fn flags_of_corrections_choose_what_is_applied_and_printed() {
    let runs = Runs::new();
    for (kind, unit) in [("force", "N"), ("acceleration", "m/s^2"), ("velocity", "m/s"), ("displacement", "m")] {
        let said = runs.run(&["--correction", kind, "--report-every", "1"]).said;
        assert_eq!(said.matches(&format!(" {unit}  round trip")).count(), 3, "{said}");
    }
    assert_eq!(frames(&runs.run(&["--report-every", "0"]).said), 0);
    let brief = runs.run(&["--brief", "--report-every", "1"]).said;
    assert!(brief.starts_with("frame  intersections") && !brief.contains("round trip"), "{brief}");

    let controls = [&[][..], &["--no-corrections"], &["--mask-only"], &["--force-only"]].map(|flags| runs.run(flags));
    for (k, run) in controls.iter().enumerate() {
        assert!(controls[..k].iter().all(|other| other.after != run.after), "two controls move the cloth alike");
    }
    assert!(controls[3].said.contains("masked    0") && !controls[2].said.contains("masked    0"));
    let both = publish("nobody-home", &["--mask-only", "--force-only"]).output().unwrap();
    assert_eq!(both.status.code(), Some(2));

    // The settings reach the daemon: this response sends flags only.
    let said = runs.run(&["--settings", r#"{"response": "mask"}"#]).said;
    assert!(said.contains("largest   0.000e0"), "{said}");
    let output = publish(runs.domain.name(), &["--settings", r#"{"stifness": 1}"#]).output().unwrap();
    assert!(output.status.code() == Some(2) && words(&output).1.contains("stifness"), "{output:?}");
}

#[test]
fn flags_of_waiting_end_a_step_or_the_program_in_words() {
    let runs = Runs::new();
    let late = runs.run(&["--deadline-ms", "0", "--report-every", "1"]);
    assert!(late.said.contains("no correction within") && late.summary.num_late_frames > 0, "{}", late.said);
    let begin = Instant::now();
    runs.run(&["--rate", "4"]);
    assert!(begin.elapsed() >= Duration::from_millis(500), "two steps, four a second, took {:?}", begin.elapsed());
    let output = publish("nobody-home", &["--connect-timeout-ms", "10"]).output().unwrap();
    let (_, error) = words(&output);
    assert!(output.status.code() == Some(2) && error.contains("nobody-home"), "{error}");
    assert_eq!(error.lines().count(), 1, "{error}");
}

#[test]
fn result_that_cannot_be_written_is_named() {
    let runs = Runs::new();
    let file = runs.folder.path().join("file");
    fs::write(&file, "").unwrap();
    let below = file.join("below");
    for flag in ["--out", "--summary"] {
        let mut command =
            publish(runs.domain.name(), &["--scene", "crease", "--edge-m", "0.06", "--frames", "0", flag]);
        let (_, error) = words(&command.arg(&below).output().unwrap());
        assert!(error.contains(below.to_str().unwrap()) && error.lines().count() == 1, "{flag}: {error}");
    }
}

#[test]
fn file_is_simulated_instead_of_a_scene() {
    let runs = Runs::new();
    let file: PathBuf = runs.folder.path().join("crossed.obj");
    fs::write(&file, "v 0 0 0\nv 4 0 0\nv 0 4 0\nv .5 1 2\nv 1.5 1 2\nv 1 1.1 -1\nf 1 2 3\nf 4 5 6\n").unwrap();
    let name = file.to_str().unwrap();
    let run = runs.run(&[name, "--report-every", "1"]);
    assert!(run.said.starts_with("6 vertices, 2 triangles") && run.said.contains(" m  round trip"), "{}", run.said);
    let both = publish(runs.domain.name(), &[name, "--scene", "crease"]).output().unwrap();
    assert_eq!(both.status.code(), Some(2));
}

/// A flag that nothing uses may not work, and nobody notices.
#[test]
fn flags_of_repairs_choose_when_and_how_long_to_wait() {
    let runs = Runs::new();
    let always = runs.run(&["--repair", "always"]);
    assert!(always.summary.num_repaired_frames > 0 && always.said.contains("repaired"), "{}", always.said);
    for flags in [&["--repair", "never"][..], &["--repair", "always", "--repair-deadline-s", "0.000001"]] {
        let run = runs.run(flags);
        assert!(run.summary.num_repaired_frames == 0 && run.after != always.after, "{flags:?}: {}", run.said);
    }
    let wrong = publish("nobody-home", &["--repair", "sometimes"]).output().unwrap();
    assert!(wrong.status.code() == Some(2) && words(&wrong).1.contains("never, auto or always"), "{wrong:?}");
}

#[test]
fn flags_of_publish_are_all_used_in_this_file() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/command_line/publish.rs");
    let tests = fs::read_to_string(path).unwrap();
    let command = Cli::command();
    let names = command.get_arguments().filter_map(|argument| argument.get_long());
    let unused: Vec<_> =
        names.filter(|name| !["help", "version"].contains(name) && !tests.contains(&format!("\"--{name}\""))).collect();
    assert!(unused.is_empty(), "no test here uses {unused:?}");
}
