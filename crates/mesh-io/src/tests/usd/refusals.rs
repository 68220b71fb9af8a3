//! What is refused: in one line, with the layer and its line, or the prim.

use super::{TRIANGLE, layer, open};
use crate::{VertexCache, read_mesh};

fn refusal(text: &str, prim: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let opened = open(folder.path(), &[("shot.usda", text.as_bytes())], prim);
    let read = opened.map_err(|error| error.to_string()).and_then(|(_, cache): (_, VertexCache)| {
        cache.frames().try_for_each(|frame| cache.read(frame).map(drop)).map_err(|error| error.to_string())
    });
    read.unwrap_err().replace(&format!("{}/", folder.path().display()), "")
}

#[test]
fn stages_that_are_not_read_are_refused_with_the_prim_or_the_line() {
    let triangle = |from: &str, to: &str| layer("", &TRIANGLE.replace(from, to));
    let set = |metadata: &str| {
        layer("", &format!("def \"set\" ({metadata}) {{ {TRIANGLE} }}\nclass \"c\" {{ int a = 1 }}\n"))
    };
    let samples = "points.timeSamples = { 1: [(0,0,0),(1,0,0),(0,1,0)], 2: [(0,0,0),(1,0,0)] } #";
    let blocked = "points.timeSamples = { 1: [(0,0,0),(1,0,0),(0,1,0)], 2: None } #";
    let cases = [
        (layer("", TRIANGLE), "/none", "shot.usda: prim /none: is not there"),
        (layer("", TRIANGLE), "tri", "shot.usda: prim tri: is no path of a prim, such as /garment/cloth"),
        (
            layer("", "def \"set\" {}\n"),
            "/set",
            "shot.usda: prim /set: there is no mesh at it or below it that is drawn",
        ),
        (
            triangle("point3f", "point3h"),
            "/tri",
            "shot.usda: prim /tri: has points of the type point3h[]; point3f[] is read",
        ),
        (triangle("[3]", "[4]"), "/tri", "shot.usda: prim /tri: has fewer corners than face 0 (from 0) needs"),
        (triangle("[3]", "[2]"), "/tri", "shot.usda: prim /tri: face 0 (from 0) has 2 corners, at least 3 are needed"),
        (
            triangle("1, 2]", "1, 3]"),
            "/tri",
            "shot.usda: prim /tri: face 0 (from 0) refers to points that are none: there are 3",
        ),
        (triangle("1, 2]", "1, 2, 0]"), "/tri", "shot.usda: prim /tri: has 1 corners beyond its faces"),
        (
            triangle("Counts = [3]", "Counts.timeSamples = { 1: [3], 2: [2, 1] }"),
            "/tri",
            "shot.usda: prim /tri: has other faceVertexCounts in other frames; the mesh must stay the same",
        ),
        (triangle("points =", samples), "/tri", "shot.usda: frame 2: prim /tri: has 2 points here, and 3 before"),
        (triangle("points =", blocked), "/tri", "shot.usda: frame 2: prim /tri: has no points here"),
        (
            triangle("(1, 0, 0)", "(1, inf, 0)"),
            "/tri",
            "shot.usda: prim /tri: point 1 (from 0) has a coordinate that is not finite",
        ),
        (triangle("(1, 0, 0)", "(1, x, 0)"), "/tri", "shot.usda: `x` is no number that fits here"),
        (
            triangle(
                "\"tri\" {",
                "\"tri\" { double3 xformOp:scale = (1, 0, 1)\n uniform token[] xformOpOrder = [\"xformOp:scale\"]\n",
            ),
            "/tri",
            "shot.usda: prim /tri: has a transform that can't be inverted",
        ),
        (
            triangle("\"tri\" {", "\"tri\" { uniform token[] xformOpOrder = [\"xformOp:shear\"]\n"),
            "/tri",
            "shot.usda: prim /tri: has the transform xformOp:shear, which is not known",
        ),
        (
            set("instanceable = true references = </c>"),
            "/set/tri",
            "shot.usda: prim /set: is an instance, and what is below it can't be moved by itself; make it no instance first",
        ),
        (
            set("inherits = </c>"),
            "/set",
            "shot.usda: prim /set: has opinions of the class /c, which are not read; flatten the stage",
        ),
        (
            set("clips = { dictionary default = {} }"),
            "/set",
            "shot.usda: prim /set: has its values in clips, which is not read; flatten the stage first",
        ),
        (
            set("references = @none.usda@"),
            "/set",
            "shot.usda: prim /set: names a layer that is not read: none.usda: can't be read: No such file or directory (os error 2)",
        ),
        (set("references = @shot.usda@"), "/set", "shot.usda: prim /set: names a layer without a default prim"),
        (layer("subLayers = [@shot.usda@]", TRIANGLE), "/tri", "shot.usda: is a sublayer of itself"),
        (
            layer("", "def \"set\" (references = </set>) {}\n"),
            "/set",
            "shot.usda: prim /set: has too many references, payloads and variants",
        ),
        (layer("", "def \"a\" {\n    int b = [1\n}\n"), "/a", "shot.usda:9: ends within a value"),
        (layer("", "def \"a\" {}\ndef \"a\" {}\n"), "/a", "shot.usda:7: there are two prims `a` here"),
        ("v 0 0 0\n".into(), "/a", "shot.usda: is no USD file; expected .usda, .usdc or .usdz"),
        (String::new(), "/a", "shot.usda: is no USD file; expected .usda, .usdc or .usdz"),
    ];
    let wrong: Vec<String> = cases
        .iter()
        .map(|(text, prim, words)| (refusal(text, prim), words, text))
        .filter(|(said, words, _)| said != *words)
        .map(|(said, words, text)| format!("{said}\n{words}\n{text}"))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn class_that_says_nothing_is_passed_over() {
    let folder = tempfile::tempdir().unwrap();
    let text = layer("", &format!("class \"c\" {{}}\ndef \"set\" (inherits = [</c>, </none>]) {{ {TRIANGLE} }}\n"));
    assert!(open(folder.path(), &[("shot.usda", text.as_bytes())], "/set").is_ok());
}

#[test]
fn stage_without_a_prim_is_refused_with_what_to_do() {
    let error = read_mesh("shot.usdc").unwrap_err().to_string();
    assert!(error.starts_with("shot.usdc: USD is read with --prim PATH"), "{error}");
}
