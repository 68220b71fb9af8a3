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

/// Of each case the text, the prim, and the words after the name of the file.
fn assert_refused(cases: Vec<(String, &str, &str)>) {
    let wrong: Vec<String> = cases
        .iter()
        .map(|(text, prim, words)| (refusal(text, prim), format!("shot.usda{words}"), text))
        .filter(|(said, words, _)| said != words)
        .map(|(said, words, text)| format!("{said}\n{words}\n{text}"))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn triangle(from: &str, to: &str) -> String {
    layer("", &TRIANGLE.replace(from, to))
}

fn set(metadata: &str) -> String {
    layer("", &format!("def \"set\" ({metadata}) {{ {TRIANGLE} }}\nclass \"c\" {{ int a = 1 }}\n"))
}

#[test]
fn meshes_that_are_not_read_are_refused_with_the_prim_and_the_face_or_point() {
    let counts = "Counts.timeSamples = { 1: [3], 2: [2, 1] }";
    let samples = "points.timeSamples = { 1: [(0,0,0),(1,0,0),(0,1,0)], 2: [(0,0,0),(1,0,0)] } #";
    let blocked = "points.timeSamples = { 1: [(0,0,0),(1,0,0),(0,1,0)], 2: None } #";
    let none = "faceVertexIndices = [0, 1, 3]";
    assert_refused(vec![
        (layer("", TRIANGLE), "/none", ": prim /none: is not there"),
        (layer("", TRIANGLE), "tri", ": prim tri: is no path of a prim, such as /garment/cloth"),
        (layer("", "def \"a\" {}\n"), "/a", ": prim /a: there is no mesh at it or below it that is drawn"),
        (
            triangle("point3f", "half3"),
            "/tri",
            ": prim /tri: has points of the type half3[]; point3f[], float3[] and vector3f[] are read",
        ),
        (triangle("[3]", "[4]"), "/tri", ": prim /tri: has fewer corners than face 0 (from 0) needs"),
        (triangle("[3]", "[2]"), "/tri", ": prim /tri: face 0 (from 0) has 2 corners, at least 3 are needed"),
        (
            triangle("faceVertexIndices = [0, 1, 2]", none),
            "/tri",
            ": prim /tri: face 0 (from 0) refers to points that are none: there are 3",
        ),
        (triangle("1, 2]", "1, 2, 0]"), "/tri", ": prim /tri: has 1 corners beyond its faces"),
        (
            triangle("Counts = [3]", counts),
            "/tri",
            ": prim /tri: has other faceVertexCounts in other frames; the mesh must stay the same",
        ),
        (triangle("points =", samples), "/tri", ": frame 2: prim /tri: has 2 points here, and 3 before"),
        (triangle("points =", blocked), "/tri", ": frame 2: prim /tri: has no points here"),
        (
            triangle("(1, 0, 0)", "(1, inf, 0)"),
            "/tri",
            ": prim /tri: point 1 (from 0) has a coordinate that is not finite",
        ),
        (triangle("(1, 0, 0)", "(1, x, 0)"), "/tri", ":9: prim /tri: points: `x` is no number that fits here"),
        (triangle("[3]", "[-3]"), "/tri", ": prim /tri: face 0 (from 0) has -3 corners, at least 3 are needed"),
        (
            triangle("[0, 1, 2]", "[0, 1,\n 99999999999999999999]"),
            "/tri",
            ":9: prim /tri: faceVertexIndices: `99999999999999999999` is no number that fits here",
        ),
    ]);
}

#[test]
fn transforms_and_arcs_that_are_not_read_are_refused_with_the_prim() {
    let flat = "{ double3 xformOp:scale = (1, 0, 1)\n uniform token[] xformOpOrder = [\"xformOp:scale\"]\n";
    let half = "{ half3 xformOp:scale = (1, 1, x)\n uniform token[] xformOpOrder = [\"xformOp:scale\"]\n";
    let shear = "{ uniform token[] xformOpOrder = [\"xformOp:shear\"]\n";
    assert_refused(vec![
        (triangle("{\n", flat), "/tri", ": prim /tri: xformOp:scale is a transform that can't be inverted"),
        (triangle("{\n", half), "/tri", ":6: prim /tri: xformOp:scale: `x` stands where a number is needed"),
        (triangle("{\n", shear), "/tri", ": prim /tri: has the transform xformOp:shear, which is not known"),
        (
            set("instanceable = true references = </c>"),
            "/set/tri",
            ": prim /set: is an instance, and what is below it can't be moved by itself; make it no instance first",
        ),
        (
            set("inherits = </c>"),
            "/set",
            ": prim /set: has opinions of the class /c, which are not read; flatten the stage",
        ),
        (
            set("clips = { dictionary default = {} }"),
            "/set",
            ": prim /set: has its values in clips, which is not read; flatten the stage first",
        ),
        (
            set("references = @none.usda@"),
            "/set",
            ": prim /set: names a layer that is not read: none.usda: can't be read: No such file or directory (os \
             error 2)",
        ),
        (
            set("payload = @https://example.com/a.usda@"),
            "/set",
            ": prim /set: names a layer that is not read: https://example.com/a.usda: is a network address, and layers \
             are read from files",
        ),
        (set("references = @shot.usda@"), "/set", ": prim /set: names the layer shot.usda, which has no default prim"),
        (
            format!(
                "def \"world\" {{ double3 xformOp:scale = (0, 1, 1)\n uniform token[] xformOpOrder = \
                     [\"xformOp:scale\"]\n{TRIANGLE} }}\n"
            )
            .replace("def \"world\"", &layer("", "def \"world\"")),
            "/world",
            ": prim /world: xformOp:scale is a transform that can't be inverted",
        ),
    ]);
}

#[test]
fn arcs_to_prims_that_are_not_there_are_refused_with_both() {
    let missing = |site: &str| format!(": prim /set: refers to @shot.usda@</{site}>, which is not there");
    let default = set("references = @shot.usda@").replace("metersPerUnit", "defaultPrim = \"none\"\n metersPerUnit");
    assert_refused(vec![
        (set("references = </none>"), "/set", &missing("none")),
        (set("payload = @shot.usda@</c/none>"), "/set", &missing("c/none")),
        (set("prepend references = [</c>, </set2>]"), "/set", &missing("set2")),
        (default, "/set", &missing("none")),
        // Below a prim whose own arcs bring in another one.
        (set("references = </lib/none>") + "def \"lib\" (references = </c>) {}\n", "/set", &missing("lib/none")),
        // Behind a mesh that is there, and in a variant.
        (
            layer("", &format!("def \"set\" {{ {TRIANGLE}\ndef \"b\" (payload = </none>) {{}} }}\n")),
            "/set",
            ": prim /set/b: refers to @shot.usda@</none>, which is not there",
        ),
        (
            layer(
                "",
                "def \"set\" (variants = { string v = \"a\" }\n variantSets = \"v\") { variantSet \"v\" = { \
                 \"a\" (references = </none>) {} } }\n",
            ),
            "/set",
            &missing("none"),
        ),
    ]);
}

#[test]
fn cycles_of_arcs_are_refused_with_their_way() {
    let at = |prim: &str, names: &[&str]| {
        let way: Vec<String> = names.iter().map(|name| format!("@shot.usda@<{name}>")).collect();
        format!(": prim {prim}: refers to itself in a cycle: {}", way.join(" -> "))
    };
    let two = "def \"a\" (references = </b>) {}\ndef \"b\" (payload = </a>) {}\n";
    let below = "def \"a\" (references = </b>) {}\ndef \"b\" { def \"c\" (references = </a>) {} }\n";
    let above = "def \"a\" (references = </b/c>) {}\ndef \"b\" (references = </a/x>) {}\n";
    assert_refused(vec![
        (set("references = </set>"), "/set", &at("/set", &["/set", "/set"])),
        (set("references = </set/tri>"), "/set", &at("/set", &["/set", "/set/tri"])),
        (layer("", two), "/a", &at("/a", &["/a", "/b", "/a"])),
        (layer("", below), "/a", &at("/a/c", &["/a/c", "/b/c", "/a"])),
        (layer("", above), "/a", &at("/a", &["/a", "/b", "/a/x"])),
    ]);
}

#[test]
fn layers_that_are_broken_are_refused_with_the_line() {
    let end = |line: usize, from: usize, sign: char| {
        format!(":{line}: ends, and what is opened in line {from} is not closed: `{sign}` is missing")
    };
    assert_refused(vec![
        (layer("", "def \"a\" {\n    def \"b\" {\n    }\n"), "/a", &end(9, 6, '}')),
        (layer("", "def \"a\" (\n    active = true\n"), "/a", &end(8, 6, ')')),
        (layer("", "def \"a\" {\n variantSet \"v\" = {\n"), "/a", &end(8, 7, '}')),
        (layer("", "def \"a\" {\n int b = [\n1,\n"), "/a", &end(9, 7, ']')),
        (layer("", "def \"a\" {\n int b.timeSamples = {\n1: 2,\n"), "/a", &end(9, 7, '}')),
        (
            layer("subLayers = [@omniverse://host/a.usda@]", TRIANGLE),
            "/tri",
            ": names a sublayer that is not read: omniverse://host/a.usda: is a network address, and layers are read \
             from files",
        ),
        (
            layer("subLayers = [@none.usda@]", TRIANGLE),
            "/tri",
            ": names a sublayer that is not read: none.usda: can't be read: No such file or directory (os error 2)",
        ),
        (layer("subLayers = [@shot.usda@]", TRIANGLE), "/tri", ": is a sublayer of itself"),
        (layer("", "def \"a\" {\n    int b = [1\n}\n"), "/a", ":8: `]` is needed here"),
        (layer("", "def \"a\" {}\ndef \"a\" {}\n"), "/a", ":7: there are two prims `a` here"),
        (
            layer("", TRIANGLE).replace("metersPerUnit = 1", "metersPerUnit = 0"),
            "/tri",
            ": metersPerUnit is 0, and must be more than 0",
        ),
        ("v 0 0 0\n".into(), "/a", ": is no USD file; expected .usda, .usdc or .usdz"),
        (String::new(), "/a", ": is no USD file; expected .usda, .usdc or .usdz"),
    ]);
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
