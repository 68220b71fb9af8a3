//! Runs of the program over a shot.

use std::{
    fs,
    process::{Child, Command, Output, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

use serde_json::Value;
use untangled_lab::Failure;
use untangled_mesh_io::read_mesh;
use untangled_testkit::process::untangled;

use super::{
    excess::{Excess, HEADER_SIZE, VERTEX_SIZE, position},
    scene::Scene,
};

/// The whole shot in one run.
pub(crate) struct Whole {
    pub(crate) bytes: Vec<u8>,
    pub(crate) totals: Value,
    pub(crate) num_tangled: usize,
    pub(crate) num_left: usize,
    pub(crate) num_left_by_check: usize,
    pub(crate) num_same_frames: usize,
    pub(crate) excess: Excess,
    pub(crate) excess_alone: Excess,
    pub(crate) check_seconds: f64,
    pub(crate) seconds: f64,
    pub(crate) peak_mb: u64,
}

pub(crate) fn lines(output: &Output) -> Result<Vec<Value>, Failure> {
    if output.stdout.is_empty() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
    }
    parsed(&output.stdout)
}

fn parsed(printed: &[u8]) -> Result<Vec<Value>, Failure> {
    let lines: Result<Vec<Value>, _> = String::from_utf8_lossy(printed).lines().map(serde_json::from_str).collect();
    Ok(lines?)
}

pub(crate) fn num_unclean(lines: &[Value], name: &str) -> usize {
    lines.iter().filter(|line| line[name] == Value::Bool(false)).count()
}

fn fix(scene: &Scene, out: &str) -> Command {
    fix_cache(scene, "cloth.pc2", out)
}

/// `fix` of the cloth in a cache or stage.
pub(crate) fn fix_cache(scene: &Scene, cache: &str, out: &str) -> Command {
    let mut command = scene.command("fix", cache);
    command.args(["-o", out]);
    command
}

/// Repairs and checks the whole shot.
pub(crate) fn whole(scene: &Scene) -> Result<Whole, Failure> {
    let start = Instant::now();
    let before = lines(&scene.command("check", "cloth.pc2").output()?)?;
    let check_seconds = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let printed = fs::File::create(scene.folder.join("whole.json"))?;
    let mut child = fix(scene, "whole.pc2").stdout(printed).spawn()?;
    let peak_mb = watch_memory(&mut child)?;
    let output = parsed(&scene.read("whole.json")?)?;
    let seconds = start.elapsed().as_secs_f64();
    let after = lines(&scene.command("check", "whole.pc2").output()?)?;
    let (input, bytes) = (scene.read("cloth.pc2")?, scene.read("whole.pc2")?);
    let frame_size = VERTEX_SIZE * scene.num_vertices;
    let frames = |bytes: &'_ [u8]| bytes[HEADER_SIZE..].chunks(frame_size).map(<[u8]>::to_vec).collect::<Vec<_>>();
    let num_same_frames = frames(&input).iter().zip(frames(&bytes)).filter(|(a, b)| **a == *b).count();
    Ok(Whole {
        totals: output.last().map(|line| line["totals"].clone()).unwrap_or_default(),
        num_tangled: num_unclean(&output[..scene.num_frames], "clean_before"),
        num_left: num_unclean(&output[..scene.num_frames], "clean"),
        num_left_by_check: num_unclean(&after[..scene.num_frames.min(before.len())], "clean"),
        num_same_frames,
        excess: Excess::of(scene, &input, &bytes),
        excess_alone: Excess::of(scene, &input, &alone(scene, &output, &input)?),
        check_seconds,
        seconds,
        peak_mb,
        bytes,
    })
}

/// The shot with each tangled frame repaired by itself, as a mesh file.
fn alone(scene: &Scene, output: &[Value], input: &[u8]) -> Result<Vec<u8>, Failure> {
    let mut bytes = input.to_vec();
    let bodies = scene.read("body.pc2")?;
    for frame in (0..scene.num_frames).filter(|&frame| output[frame]["clean_before"] == Value::Bool(false)) {
        for (name, cache) in [("cloth", input), ("body", &bodies)] {
            let mesh = read_mesh(scene.folder.join(format!("{name}.obj")))?;
            let num_vertices = mesh.positions().len();
            let positions: Vec<[f64; 3]> =
                (0..num_vertices).map(|vertex| position(num_vertices, cache, frame, vertex).into()).collect();
            mesh.write_with_positions(&positions, &mut fs::File::create(scene.folder.join(format!("{name}-1.obj")))?)?;
        }
        let mut command = Command::new(untangled());
        command.current_dir(&scene.folder).args(["fix", "cloth-1.obj", "-o", "alone.obj", "--overwrite"]);
        command.args(["--body", "body-1.obj"]).output()?;
        let repaired = read_mesh(scene.folder.join("alone.obj"))?;
        let start = HEADER_SIZE + frame * VERTEX_SIZE * scene.num_vertices;
        for (slot, value) in bytes[start..].chunks_mut(4).zip(repaired.positions().as_flattened()) {
            #[expect(clippy::cast_possible_truncation, reason = "rounding as a cache does")]
            slot.copy_from_slice(&(*value as f32).to_le_bytes());
        }
    }
    Ok(bytes)
}

/// The most memory that a process takes until it ends, in megabytes.
fn watch_memory(child: &mut Child) -> Result<u64, Failure> {
    let mut peak = 0;
    let status = format!("/proc/{}/status", child.id());
    while child.try_wait()?.is_none() {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kilobytes: Option<u64> = line.and_then(|line| line.trim().trim_end_matches(" kB").parse().ok());
        peak = peak.max(kilobytes.unwrap_or(0) / 1024);
        sleep(Duration::from_millis(50));
    }
    Ok(peak)
}

/// Repairs the shot in parts, one after the other. Gives back the seconds, and whether the parts hold the same frames.
pub(crate) fn parts(scene: &Scene, num_parts: usize, whole: &[u8]) -> Result<(f64, bool), Failure> {
    let (start, mut frames) = (Instant::now(), Vec::new());
    for part in 0..num_parts {
        let [first, end] = [part, part + 1].map(|part| part * scene.num_frames / num_parts);
        let name = format!("part-{num_parts}-{part}.pc2");
        lines(&fix(scene, &name).args(["--frames", &format!("{first}..{}", end - 1)]).output()?)?;
        frames.extend_from_slice(&scene.read(&name)?[HEADER_SIZE..]);
    }
    Ok((start.elapsed().as_secs_f64(), frames == whole[HEADER_SIZE..]))
}

/// Kills a run at some moments, and goes on with it each time. Gives back the seconds of all, whether the file is the
/// same, and how many frames were there after a kill, in all.
pub(crate) fn killed(scene: &Scene, num_kills: u32, seconds: f64, whole: &[u8]) -> Result<(f64, bool, usize), Failure> {
    let (start, mut num_kept) = (Instant::now(), 0);
    for kill in 0..num_kills {
        let mut child = fix(scene, "killed.pc2").stdout(Stdio::null()).stderr(Stdio::null()).spawn()?;
        // Together three quarters of a run, so that there is something left to kill.
        let part = 0.02 + 0.012 * f64::from(kill);
        sleep(Duration::from_secs_f64(part * seconds));
        child.kill()?;
        child.wait()?;
        let journal = scene.read("killed.pc2.journal").unwrap_or_default();
        num_kept = num_kept.max(journal.iter().filter(|&&byte| byte == b'\n').count().saturating_sub(1));
        if scene.folder.join("killed.pc2").exists() {
            break;
        }
    }
    if !scene.folder.join("killed.pc2").exists() {
        lines(&fix(scene, "killed.pc2").output()?)?;
    }
    Ok((start.elapsed().as_secs_f64(), scene.read("killed.pc2")? == whole, num_kept))
}
