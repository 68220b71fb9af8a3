//! `check` and `fix` with `--prim`: the shot of the other tests as a stage of USD.

use std::{ffi::OsStr, fs, os::unix::ffi::OsStrExt};

use untangled_testkit::{
    files::formats::obj,
    generate::Sheet,
    shots::{FlapShot, pc2, usda, usda_points},
};

use super::{code, folder, frames, frames_of, lines, run};
use crate::mesh_folder::names;

const FIX: [&str; 6] = ["fix", "shot.usda", "--prim", "/garment", "-o", "fix.usda"];

/// The folder of the other tests, with the shot as `shot.usda` besides.
fn stage() -> tempfile::TempDir {
    let folder = folder();
    fs::write(folder.path().join("shot.usda"), usda(&frames())).unwrap();
    folder
}

#[test]
fn fix_of_a_stage_writes_a_layer_with_the_points_that_fix_of_a_cache_writes() {
    let folder = stage();
    let path = folder.path();
    let source = fs::read(path.join("shot.usda")).unwrap();
    let output = run(&[&FIX[..], &["--json"]].concat(), path);
    assert_eq!(code(&output), 0, "{output:?}");
    let (reported, totals) = lines(&output);
    let times: Vec<f64> = reported.iter().map(|line| line["time_code"].as_f64().unwrap()).collect();
    assert_eq!(times, (1..=24).map(f64::from).collect::<Vec<_>>());
    assert_eq!(
        (&totals["cache"], &totals["first_frame"], &totals["clean"]),
        (&"shot.usda".into(), &1.into(), &true.into())
    );
    assert!(totals["num_unchanged_frames"].as_u64() > Some(0));
    // The same shot as PC2, in the same singles, and a mesh of them: the same corrections.
    let mut first = frames().swap_remove(0);
    #[expect(clippy::cast_possible_truncation, reason = "rounding is the purpose")]
    first.positions.as_flattened_mut().iter_mut().for_each(|x| *x = f64::from(*x as f32));
    fs::write(path.join("single.obj"), obj(&first, false)).unwrap();
    assert_eq!(code(&run(&["fix", "single.obj", "--cache", "in.pc2", "-o", "out.pc2"], path)), 0);
    let layer = fs::read_to_string(path.join("fix.usda")).unwrap();
    assert!(usda_points(&layer) == frames_of(&fs::read(path.join("out.pc2")).unwrap()));
    assert!(layer.contains("subLayers = [\n        @./shot.usda@\n    ]"), "{}", &layer[..300]);
    assert_eq!(fs::read(path.join("shot.usda")).unwrap(), source);
    assert!(!path.join("fix.usda.partial").exists() && !path.join("fix.usda.journal").exists());
    // The layer is a stage, and clean.
    let check = run(&["check", "fix.usda", "--prim", "/garment/cloth", "--json"], path);
    assert_eq!(code(&check), 0, "{check:?}");
    let before = run(&["check", "shot.usda", "--prim", "/garment/cloth", "--json"], path);
    let (before, _) = lines(&before);
    for (check, fix) in before.iter().zip(&reported) {
        assert_eq!((&check["before"], &check["time_code"]), (&fix["before"], &fix["time_code"]));
    }
}

#[test]
fn fix_of_parts_of_a_stage_writes_the_samples_of_the_whole() {
    let folder = stage();
    let path = folder.path();
    assert_eq!(code(&run(&FIX, path)), 0);
    let whole = usda_points(&fs::read_to_string(path.join("fix.usda")).unwrap());
    let mut joined = Vec::new();
    for range in ["1..7", "8..13", "14..24"] {
        let output = run(&[&FIX[..5], &["part.usda", "--overwrite", "--frames", range]].concat(), path);
        assert_eq!(code(&output), 0, "{output:?}");
        joined.extend(usda_points(&fs::read_to_string(path.join("part.usda")).unwrap()));
    }
    assert!(joined == whole);
    // Of one thread, and after a crash that left half of a journal.
    let whole = fs::read(path.join("fix.usda")).unwrap();
    let mut one = super::command(&[&FIX[..5], &["one.usda"]].concat(), path);
    assert_eq!(code(&one.env("RAYON_NUM_THREADS", "1").output().unwrap()), 0);
    assert!(fs::read(path.join("one.usda")).unwrap() == whole);
}

#[test]
fn fix_of_a_stage_goes_on_after_a_kill_with_the_bytes_of_one_run() {
    let folder = stage();
    let path = folder.path();
    assert_eq!(code(&run(&FIX, path)), 0);
    let arguments = [&FIX[..5], &["out.usda"]].concat();
    let mut num_ended = 0;
    for (num, signal) in [(2, "-KILL"), (6, "-INT"), (10, "-KILL")] {
        num_ended += usize::from(super::resume::end_after(&arguments, path, "out.usda.journal", num, signal));
    }
    assert!(num_ended >= 1, "{num_ended}");
    if !path.join("out.usda").exists() {
        assert_eq!(code(&run(&arguments, path)), 0);
    }
    let [one, other] = ["fix.usda", "out.usda"].map(|name| fs::read(path.join(name)).unwrap());
    assert!(one == other);
    assert!(!path.join("out.usda.partial").exists() && !path.join("out.usda.journal").exists());
}

#[test]
fn fix_of_a_stage_moves_cloth_out_of_a_body_in_its_world() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let shot = FlapShot { ball_middle: Some(11.5), tangles: Vec::new(), ..FlapShot::small() };
    let [cloth, balls]: [Vec<Sheet>; 2] =
        [(8..16).map(|frame| shot.cloth(frame)).collect(), (8..16).map(|frame| shot.ball(frame)).collect()];
    fs::write(path.join("ball.obj"), obj(&balls[0], false)).unwrap();
    fs::write(path.join("ball.pc2"), pc2(&balls)).unwrap();
    // In centimetres, and moved by the prim: its points are not those of the world.
    let scale = 128.0;
    let moved: Vec<Sheet> = cloth
        .iter()
        .map(|sheet| {
            let positions = sheet.positions.iter().map(|[x, y, z]| [scale * x - 3.0, scale * y, scale * z + 5.0]);
            Sheet { positions: positions.collect(), ..sheet.clone() }
        })
        .collect();
    let text = usda(&moved).replace("metersPerUnit = 1", "metersPerUnit = 0.0078125").replace(
        "def Xform \"garment\"\n{\n",
        "def Xform \"garment\"\n{\n    double3 xformOp:translate = (3, 0, -5)\n    \
         uniform token[] xformOpOrder = [\"xformOp:translate\"]\n",
    );
    fs::write(path.join("shot.usda"), text).unwrap();
    let body = ["--body", "ball.obj", "--body-cache", "ball.pc2", "--json"];
    let check = run(&[&["check", "shot.usda", "--prim", "/garment"], &body[..]].concat(), path);
    let (before, _) = lines(&check);
    assert!(before.iter().any(|line| line["before"]["num_body_face_pairs"].as_u64() > Some(0)));
    let output = run(&[&FIX[..], &body].concat(), path);
    let (after, totals) = lines(&output);
    assert_eq!(code(&output), 0, "{totals}");
    assert!(after.iter().all(|line| line["after"]["num_vertices_inside_body"] == 0));
    assert!(after.iter().any(|line| line["max_displacement_m"].as_f64() > Some(1e-4)), "{after:?}");
    let check = run(&[&["check", "fix.usda", "--prim", "/garment"], &body[..]].concat(), path);
    assert_eq!(code(&check), 0, "{check:?}");
}

#[test]
fn stages_refuse_what_does_not_fit_in_one_line() {
    let folder = stage();
    let path = folder.path();
    fs::write(path.join("exists.usda"), "mine").unwrap();
    let before = names(path);
    let cases = [
        ("check shot.usda", "shot.usda: USD is read with --prim PATH"),
        ("check cloth.obj --body shot.usda", "shot.usda: USD is read with --prim PATH"),
        ("check shot.usda --prim /none", "shot.usda: prim /none: is not there"),
        ("check cloth.obj --prim /garment", "cloth.obj: is no USD file; expected .usda, .usdc or .usdz"),
        ("check shot.usda --prim /garment --cache in.pc2", "'--prim <PATH>' cannot be used with '--cache <IN>'"),
        (
            "check shot.usda shot.usda --prim /garment",
            "more than one FILE can't be used with --cache or --prim: USD is one FILE",
        ),
        (
            "check shot.usda --prim /garment --layers",
            "--layers can't be used with --cache or --prim: layers are several FILEs",
        ),
        ("check shot.usda --prim /garment --frames 0..3", "shot.usda: frame 0: there are frames 1 to 24"),
        (
            "fix shot.usda --prim /garment -o out.usdc",
            "out.usdc: what goes over a stage of USD is written as text, .usda",
        ),
        ("fix shot.usda --prim /garment -o exists.usda", "exists.usda: exists; --overwrite replaces it"),
        (
            "fix shot.usda --prim /garment -o shot.usda --overwrite",
            "shot.usda: is an input, and inputs are never overwritten",
        ),
        ("fix cloth.obj -o out.usda", "out.usda: meshes are written as .obj, .ply"),
    ];
    for (arguments, words) in cases {
        let output = run(&arguments.split(' ').collect::<Vec<_>>(), path);
        assert_eq!(code(&output), 2, "{arguments} {output:?}");
        let text = String::from_utf8(output.stderr).unwrap();
        assert!(text.contains(words), "{arguments}: {text}");
        let is_usage = text.contains("Usage") || text.contains("For more information");
        assert!(is_usage || text.trim_end().lines().count() == 1, "{arguments}: {text}");
        assert_eq!(names(path), before, "{arguments}");
    }
}

#[test]
fn stage_whose_name_a_layer_can_not_hold_is_refused_before_any_work() {
    let folder = stage();
    let path = folder.path();
    fs::create_dir(path.join("a@@@b")).unwrap();
    for (name, words) in [
        (&b"a@@@b.usda"[..], "can't name ./a@@@b.usda as the layer below it: no @@@"),
        (b"a@@@b/shot.usda", "can't name ./a@@@b/shot.usda as the layer below it: no @@@"),
        (b"shot@", "no @ at its end"),
        (b"a\nb.usda", "no control character may stand in its path"),
        (b"a\xff.usda", "as the layer below it: names in USD are UTF-8"),
    ] {
        let name = OsStr::from_bytes(name);
        fs::copy(path.join("shot.usda"), path.join(name)).unwrap();
        let mut fix = super::command(&["fix"], path);
        let output = fix.arg(name).args(["--prim", "/garment", "-o", "fix.usda"]).output().unwrap();
        let said = String::from_utf8(output.stderr.clone()).unwrap();
        assert!(code(&output) == 2 && said.contains(words) && said.lines().count() == 1, "{said}");
        assert!(said.starts_with("untangled: fix.usda: can't name ") && output.stdout.is_empty(), "{said}");
        fs::remove_file(path.join(name)).unwrap();
        let left = names(path);
        assert!(!left.iter().any(|name| name.contains("fix.usda")), "{left:?}");
    }
    fs::copy(path.join("shot.usda"), path.join("shot@one.usda")).unwrap();
    let fix = ["fix", "shot@one.usda", "--prim", "/garment", "-o", "fix.usda", "--frames", "1..2", "--json"];
    let output = run(&fix, path);
    assert_eq!(code(&output), 0, "{output:?}");
    // Two frames have no second difference.
    let (_, totals) = lines(&output);
    assert!(totals["smoothness"]["max_second_difference_m"].is_null(), "{totals}");
}
