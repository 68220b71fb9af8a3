//! Pages of sequences: frames as the caches have them.

use std::{io::Read, path::Path};

use flate2::read::ZlibDecoder;
use serde_json::Value;
use untangled_mesh_io::{MeshFile, VertexCache, read_mesh};

use super::{bytes, count, distance, document};
use crate::{
    mesh_folder::{code, names},
    sequence::{folder, run},
};

/// The whole numbers of a stream.
fn numbers(packed: &Value) -> Vec<u16> {
    let (mut planes, packed) = (Vec::new(), bytes(packed));
    ZlibDecoder::new(&packed[..]).read_to_end(&mut planes).unwrap();
    let (low, high) = planes.split_at(planes.len() / 2);
    low.iter().zip(high).map(|(&low, &high)| u16::from_le_bytes([low, high])).collect()
}

/// Positions of all frames of a page, for each kind of state.
fn streams(page: &Value) -> Vec<Vec<Vec<[f64; 3]>>> {
    let sequence = &page["sequence"];
    let size = 3 * count(&page["mesh"]["num_vertices"]);
    let mut before = numbers(&sequence["before"]);
    for at in size..before.len() {
        before[at] = before[at].wrapping_add(before[at - size]);
    }
    let after = sequence.get("after").map(|packed| {
        numbers(packed).iter().zip(&before).map(|(change, from)| from.wrapping_add(*change)).collect::<Vec<u16>>()
    });
    let three = |value: &Value| [0, 1, 2].map(|axis| value[axis].as_f64().unwrap());
    let [low, step, centre] = [three(&sequence["low"]), three(&sequence["step"]), three(&page["mesh"]["centre"])];
    let place = |n: &[u16]| [0, 1, 2].map(|axis| centre[axis] + low[axis] + step[axis] * f64::from(n[axis]));
    let frames =
        |all: &Vec<u16>| all.chunks_exact(size).map(|frame| frame.chunks_exact(3).map(place).collect()).collect();
    [Some(before), after].iter().flatten().map(frames).collect()
}

/// The frames of a stream are those of a cache, within half a step.
fn assert_frames_are(page: &Value, stream: &[Vec<[f64; 3]>], cache: &VertexCache, first: u64) {
    let step = page["sequence"]["step"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).fold(0.0, f64::max);
    assert!(step < 1e-4, "{step} m a step");
    for (frame, found) in (first..).zip(stream) {
        let frame = cache.read(frame).unwrap();
        assert_eq!(found.len(), frame.positions().len());
        assert!(found.iter().zip(frame.positions()).all(|(&a, &b)| distance(a, b) < step));
    }
}

/// The stretch of each vertex is that of its worst edge, from the caches that were read and written.
fn assert_stretch_fits(page: &Value, path: &Path, cloth: &[MeshFile; 1]) {
    let [before, after] = ["in.pc2", "b.pc2"].map(|name| VertexCache::open(&path.join(name), cloth).unwrap());
    let steps = numbers(&page["sequence"]["stretch"]);
    let badness = |ratio: f64| ratio.max(1.0 / ratio);
    let mut most = 1.0f64;
    for (frame, steps) in (0..).zip(steps.chunks_exact(cloth[0].positions().len())) {
        let [before, after] = [&before, &after].map(|cache| cache.read(frame).unwrap());
        let mut worst = vec![1.0; steps.len()];
        for &[a, b, c] in cloth[0].faces() {
            for [from, to] in [[a, b], [b, c], [c, a]].map(|ends| ends.map(|vertex| vertex as usize)) {
                let length = |places: &[[f64; 3]]| distance(places[from], places[to]);
                let ratio = length(after.positions()) / length(before.positions());
                for vertex in [from, to] {
                    worst[vertex] = if badness(ratio) > badness(worst[vertex]) { ratio } else { worst[vertex] };
                }
            }
        }
        for (steps, worst) in steps.iter().zip(&worst) {
            let told = (0.0005 * f64::from(steps.cast_signed())).exp();
            assert!((badness(told) / badness(*worst) - 1.0).abs() < 1e-3, "frame {frame}: {told}, and not {worst}");
            most = most.max(badness(told));
        }
    }
    assert_eq!(steps.len() % cloth[0].positions().len(), 0);
    assert!(most > 1.01, "something was stretched: {most}");
}

#[test]
fn page_of_a_checked_shot_holds_all_frames_and_changes_no_line() {
    let folder = folder();
    let path = folder.path();
    let plain = ["check", "cloth.obj", "--cache", "in.pc2", "--frames", "2..15", "--json"];
    let without = run(&plain, path);
    let with = run(&[&plain[..], &["--html", "page.html"]].concat(), path);
    assert_eq!((code(&with), &with.stdout), (code(&without), &without.stdout));
    let page = document(&path.join("page.html"));
    let frames = page["sequence"]["frames"].as_array().unwrap();
    let lines: Vec<Value> =
        String::from_utf8(with.stdout).unwrap().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(frames.len(), 14);
    for (frame, line) in frames.iter().zip(&lines) {
        assert_eq!(&frame["line"], line);
        let paths = frame["states"][0]["paths"].as_array().unwrap();
        let segments: usize = paths.iter().map(|path| count(&path["num_segments"])).sum();
        assert_eq!(segments, count(&line["before"]["num_face_pairs"]));
    }
    assert!(frames.iter().any(|frame| !frame["states"][0]["paths"].as_array().unwrap().is_empty()));
    assert_eq!(&page["report"], lines.last().unwrap(), "the totals");
    let cache = VertexCache::open(&path.join("in.pc2"), &[read_mesh(path.join("cloth.obj")).unwrap()]).unwrap();
    assert_frames_are(&page, &streams(&page)[0], &cache, 2);
    assert!(page["settings"].to_string().contains("2..15"));
}

#[test]
fn page_of_a_repaired_shot_holds_both_states_and_the_output_is_the_same() {
    let folder = folder();
    let path = folder.path();
    let plain = ["fix", "cloth.obj", "--cache", "in.pc2", "--json", "-o"];
    let without = run(&[&plain[..], &["a.pc2"]].concat(), path);
    let with = run(&[&plain[..], &["b.pc2", "--html", "page.html"]].concat(), path);
    assert_eq!((code(&with), code(&without)), (0, 0), "{with:?}");
    let [a, b] = ["a.pc2", "b.pc2"].map(|name| std::fs::read(path.join(name)).unwrap());
    assert!(a == b, "with a page the same is written");
    let page = document(&path.join("page.html"));
    let cloth = [read_mesh(path.join("cloth.obj")).unwrap()];
    let streams = streams(&page);
    for (stream, name) in streams.iter().zip(["in.pc2", "b.pc2"]) {
        assert_frames_are(&page, stream, &VertexCache::open(&path.join(name), &cloth).unwrap(), 0);
    }
    for frame in page["sequence"]["frames"].as_array().unwrap() {
        assert_eq!(frame["states"][1]["paths"], serde_json::json!([]), "nothing is left");
    }
    assert_stretch_fits(&page, path, &cloth);
    assert!(names(path).iter().all(|name| !name.starts_with('.')), "{:?}", names(path));
}

#[test]
fn page_of_a_shot_is_refused_over_its_cache_and_existing_files() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("old.html"), "old").unwrap();
    std::os::unix::fs::symlink("in.pc2", path.join("cache.html")).unwrap();
    let before = names(path);
    for command in ["check cloth.obj --cache in.pc2", "fix cloth.obj --cache in.pc2 -o out.pc2"] {
        for (page, reason) in [
            ("--html old.html", "old.html: exists; --overwrite replaces it"),
            ("--html cache.html --overwrite", "cache.html: is an input"),
            ("--html page.pc2", "page.pc2: a page is written as .html"),
        ] {
            let arguments = format!("{command} {page}");
            let output = run(&arguments.split(' ').collect::<Vec<_>>(), path);
            let text = String::from_utf8(output.stderr.clone()).unwrap();
            assert!(code(&output) == 2 && text.contains(reason), "{arguments}: {output:?}");
            assert_eq!(names(path), before, "{arguments}");
        }
    }
}
