//! What several layers together say.

use super::{TRIANGLE, layer, open};

/// Where the first point of a prim is, in the first of some layers.
fn first_point(files: &[(&str, &str)], prim: &str) -> [f64; 3] {
    let folder = tempfile::tempdir().unwrap();
    let files: Vec<(&str, &[u8])> = files.iter().map(|(name, text)| (*name, text.as_bytes())).collect();
    let (mesh, _) = open(folder.path(), &files, prim).unwrap_or_else(|error| panic!("{error}"));
    mesh.positions()[0]
}

fn points(z: &str) -> String {
    format!("point3f[] points = [(0, 0, {z}), (1, 0, 0), (0, 1, 0)]")
}

#[test]
fn stronger_layers_and_arcs_win_over_weaker_ones() {
    let asset = layer("defaultPrim = \"asset\"", &format!("def Xform \"asset\" {{ {TRIANGLE} }}\n"));
    let over = |z: &str| format!("over \"tri\" {{ {} }}", points(z));
    let at = |z: f64| [0.0, 0.0, z];
    let base = |more: &str, inner: &str| {
        layer(more, &format!("def \"set\" (references = @./asset.usda@ {{}} \n) {{ {inner} }}\n").replace(" {}", ""))
    };
    let asset = ("asset.usda", asset.as_str());
    // A reference to the default prim.
    assert_eq!(first_point(&[("shot.usda", &base("", "")), asset], "/set/tri"), at(0.0));
    // An opinion of its own over it, then one of a sublayer, which is weaker than the layer and stronger than the arc.
    assert_eq!(first_point(&[("shot.usda", &base("", &over("3"))), asset], "/set/tri"), at(3.0));
    let sub = layer("", &format!("over \"set\" {{ {} }}\n", over("4")));
    let shot = base("subLayers = [@sub.usda@]", "");
    assert_eq!(first_point(&[("shot.usda", &shot), asset, ("sub.usda", &sub)], "/set/tri"), at(4.0));
    // A payload is weaker than a reference, the first of a list stronger than the others.
    let other = layer("", &format!("def \"other\" {{ {} }}\n", TRIANGLE.replace("(0, 0, 0)", "(0, 0, 9)")));
    let other = ("other.usda", other.as_str());
    let shot =
        layer("", "def \"set\" (payload = @other.usda@</other>\n prepend references = @asset.usda@</asset>) {}\n");
    assert_eq!(first_point(&[("shot.usda", &shot), asset, other], "/set"), at(0.0));
    let shot = layer("", "def \"set\" (references = [@other.usda@</other>, @asset.usda@]) {}\n");
    assert_eq!(first_point(&[("shot.usda", &shot), asset, other], "/set"), at(9.0));
    let weak = layer("", "def \"set\" (references = @asset.usda@) {}\n");
    let shot = layer("subLayers = [@weak.usda@]", "over \"set\" (prepend references = @other.usda@</other>) {}\n");
    assert_eq!(first_point(&[("shot.usda", &shot), asset, other, ("weak.usda", &weak)], "/set"), at(9.0));
    let shot = layer(
        "subLayers = [@weak.usda@]",
        "over \"set\" (delete references = @asset.usda@) { def \"tri\" (references = </elsewhere>) {} }\n\
         def \"elsewhere\" (references = @other.usda@</other/tri>) {}\n",
    );
    assert_eq!(first_point(&[("shot.usda", &shot), asset, other, ("weak.usda", &weak)], "/set"), at(9.0));
}

#[test]
fn variants_are_chosen_by_the_strongest_opinion() {
    let variant = |name: &str, z: &str| format!("\"{name}\" {{ over \"tri\" {{ {} }} }}", points(z));
    let prim = format!(
        "def \"asset\" (\n    variants = {{\n string size = \"small\"\n }}\n prepend variantSets = \"size\"\n) {{\n \
         def Mesh \"tri\" {{ int[] faceVertexCounts = [3]\n int[] faceVertexIndices = [0, 1, 2] }}\n \
         variantSet \"size\" = {{ {} {} }} }}\n",
        variant("small", "1"),
        variant("large", "2")
    );
    let asset = layer("defaultPrim = \"asset\"", &prim);
    let asset = ("asset.usda", asset.as_str());
    assert_eq!(first_point(&[asset], "/asset")[2], 1.0);
    let shot = layer("", "def \"set\" (references = @asset.usda@\n variants = { string size = \"large\" }) {}\n");
    assert_eq!(first_point(&[("shot.usda", &shot), asset], "/set/tri")[2], 2.0);
}

#[test]
fn time_codes_of_a_layer_become_those_of_the_stage() {
    let samples = "point3f[] points.timeSamples = { 0: [(0,0,0),(1,0,0),(0,1,0)], 12: [(0,0,12),(1,0,0),(0,1,0)], }";
    let cloth = TRIANGLE.replace("point3f[] points =", &format!("{samples} #"));
    let asset = layer("timeCodesPerSecond = 12", &cloth);
    let shot = layer("timeCodesPerSecond = 24\n subLayers = [@sub.usda@ (offset = 100)]", "");
    let sub =
        layer("timeCodesPerSecond = 24", "def \"set\" (references = @asset.usda@</tri> (offset = 10; scale = 2)) {}\n");
    let folder = tempfile::tempdir().unwrap();
    let files = [("shot.usda", shot.as_bytes()), ("sub.usda", sub.as_bytes()), ("asset.usda", asset.as_bytes())];
    let (_, cache) = open(folder.path(), &files, "/set").unwrap();
    // 12 a second become 24, then twice as many, 10 and 100 later.
    assert_eq!([cache.time_code(0), cache.time_code(1)], [Some(110.0), Some(158.0)]);
    assert_eq!(cache.read(1).unwrap().positions()[0][2], 12.0);
    assert_eq!(cache.files().len(), 3);
}

#[test]
fn meshes_that_are_not_drawn_are_left_out_below_the_prim_but_not_at_it() {
    let hidden = |name: &str, what: &str| TRIANGLE.replace("\"tri\" {", &format!("\"{name}\" {{ {what}\n"));
    let prims = [
        hidden("shown", ""),
        hidden("proxy", "uniform token purpose = \"proxy\""),
        hidden("hidden", "token visibility = \"invisible\""),
        hidden("off", "").replace("\"off\"", "\"off\" (active = false)"),
        hidden("gone", "").replace("\"gone\"", "\"gone\" (active = false references = @none.usda@</none>)"),
        hidden("class", "").replace("def Mesh", "class Mesh"),
        hidden("over", "").replace("def Mesh", "over"),
    ];
    let text = layer("", &format!("def \"set\" {{ {} }}\n", prims.concat()));
    let folder = tempfile::tempdir().unwrap();
    let files = [("shot.usda", text.as_bytes())];
    assert_eq!(open(folder.path(), &files, "/set").unwrap().0.positions().len(), 3);
    assert_eq!(open(folder.path(), &files, "/set/proxy").unwrap().0.positions().len(), 3);
}

#[test]
fn target_below_prims_with_arcs_and_variants_brings_in_what_these_bring_in() {
    // The mesh stands in `deep`, which is brought in at the prim above the one that is referred to.
    let deep = layer("", &format!("def \"base\" {{ def \"part\" {{ {TRIANGLE} }} }}\n"));
    let deep = ("deep.usda", deep.as_str());
    let library = |arc: &str| layer("", &format!("def \"lib\" ({arc}) {{}}\n"));
    let shot = |path: &str| layer("", &format!("def \"set\" (references = @lib.usda@<{path}>) {{}}\n"));
    for arc in ["references = @deep.usda@</base>", "payload = @deep.usda@</base>"] {
        let files = [("shot.usda", shot("/lib/part")), ("lib.usda", library(arc)), (deep.0, deep.1.to_owned())];
        let files: Vec<(&str, &str)> = files.iter().map(|(name, text)| (*name, text.as_str())).collect();
        assert_eq!(first_point(&files, "/set/tri"), [0.0; 3], "{arc}");
    }
    // In a variant of the prim above, with an opinion of the layer that has the variant over it.
    let variants = format!(
        "def \"lib\" (\n variants = {{ string size = \"large\" }}\n prepend variantSets = \"size\"\n) {{\n \
         over \"part\" {{ over \"tri\" {{ {} }} }}\n \
         variantSet \"size\" = {{ \"large\" {{ def \"part\" {{ {TRIANGLE} }} }} \"small\" {{}} }} }}\n",
        points("4")
    );
    let files = [("shot.usda", shot("/lib/part")), ("lib.usda", layer("", &variants))];
    let files: Vec<(&str, &str)> = files.iter().map(|(name, text)| (*name, text.as_str())).collect();
    assert_eq!(first_point(&files, "/set/tri"), [0.0, 0.0, 4.0]);
    // Within one layer, and a mesh itself.
    let own = layer(
        "",
        "def \"all\" (references = @deep.usda@</base>) {}\ndef Mesh \"set\" (references = </all/part/tri>) {}\n",
    );
    assert_eq!(first_point(&[("shot.usda", &own), deep], "/set"), [0.0; 3]);
}

#[test]
fn target_takes_the_time_codes_of_the_arcs_above_it() {
    let samples = "point3f[] points.timeSamples = { 0: [(0,0,0),(1,0,0),(0,1,0)], 1: [(0,0,1),(1,0,0),(0,1,0)], }";
    let deep =
        layer("", &format!("def \"base\" {{ {} }}\n", TRIANGLE.replace("point3f[] points =", &format!("{samples} #"))));
    let library = layer("", "def \"lib\" (references = @deep.usda@</base> (offset = 10)) {}\n");
    let shot = layer("", "def \"set\" (references = @lib.usda@</lib/tri> (scale = 2)) {}\n");
    let folder = tempfile::tempdir().unwrap();
    let files = [("shot.usda", shot.as_bytes()), ("lib.usda", library.as_bytes()), ("deep.usda", deep.as_bytes())];
    let (_, cache) = open(folder.path(), &files, "/set").unwrap();
    assert_eq!([cache.time_code(0), cache.time_code(1)], [Some(20.0), Some(22.0)]);
}
