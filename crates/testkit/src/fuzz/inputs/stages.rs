//! Stages of USD that are valid more often than not.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::grid::grid;

/// Stages that usd-core wrote; those of the tests of `mesh-io`.
pub(in crate::fuzz) const QUADS_BINARY: &[u8] = include_bytes!("../../../../mesh-io/src/tests/data/quads.usdc");
pub(in crate::fuzz) const QUADS_ARCHIVE: &[u8] = include_bytes!("../../../../mesh-io/src/tests/data/quads.usdz");

fn number(rng: &mut ChaCha8Rng) -> String {
    match rng.random_range(0..30) {
        0 => format!("{:e}", f64::from_bits(rng.random())),
        1 => format!("{}", rng.random_range(-3..3)),
        _ => format!("{:.3}", rng.random_range(-1.0..1.0)),
    }
}

fn vector(rng: &mut ChaCha8Rng) -> String {
    format!("({}, {}, {})", number(rng), number(rng), number(rng))
}

/// Metadata of a prim, most of which bring nothing in.
fn metadata(rng: &mut ChaCha8Rng) -> &'static str {
    const METADATA: [&str; 8] = [
        "",
        "(kind = \"component\")",
        "(prepend references = </source>)",
        "(references = </world>)",
        "(payload = [</source>, </none>])",
        "(variants = { string size = \"a\" } add variantSets = [\"size\"])",
        "(inherits = </class>)",
        "(customData = { dictionary of = { double[] x = [1, 2] } } active = true)",
    ];
    METADATA[if rng.random_bool(0.6) { 0 } else { rng.random_range(0..METADATA.len()) }]
}

/// A text stage with a mesh below transforms, and prims that bring others in.
pub(in crate::fuzz) fn text(rng: &mut ChaCha8Rng) -> Vec<u8> {
    let n = rng.random_range(1..3u32);
    let faces = grid(n);
    let corners: Vec<String> = faces.iter().flatten().map(u32::to_string).collect();
    let points = |rng: &mut ChaCha8Rng| {
        let points: Vec<String> = (0..(n + 1) * (n + 1)).map(|_| vector(rng)).collect();
        format!("[{}]", points.join(", "))
    };
    let points = if rng.random() {
        let samples: Vec<String> = (0..rng.random_range(1..4)).map(|time| format!("{time}: {}", points(rng))).collect();
        format!("points.timeSamples = {{ {}, }}", samples.join(", "))
    } else {
        format!("points = {}", points(rng))
    };
    let place = match rng.random_range(0..5) {
        0 => format!("double3 xformOp:translate = {}", vector(rng)),
        1 => format!("float3 xformOp:scale.timeSamples = {{ 0: {}, 2: {} }}", vector(rng), vector(rng)),
        2 => format!("quatf xformOp:orient = (1, {}, 0, 0)", number(rng)),
        3 => format!("float3 xformOp:rotateXYZ = {}", vector(rng)),
        _ => "int nothing = 1".to_owned(),
    };
    let op = place.split(' ').nth(1).and_then(|name| name.split('.').next()).unwrap_or_default();
    let mesh = format!(
        "def Mesh \"cloth\" {} {{ int[] faceVertexCounts = [{}]\n int[] faceVertexIndices = [{}]\n \
         point3f[] {points}\n {place}\n uniform token[] xformOpOrder = [\"{op}\"] }}",
        metadata(rng),
        vec!["3"; faces.len()].join(", "),
        corners.join(", ")
    );
    let root = ["", "(metersPerUnit = 0.01)", "(subLayers = [])", "(defaultPrim = \"world\")"][rng.random_range(0..4)];
    format!(
        "#usda 1.0\n{root}\ndef Xform \"world\" {} {{ # a comment\n {mesh}\n variantSet \"size\" \
         = {{ \"a\" {{ }} }} }}\ndef \"source\" {{ def Mesh \"flap\" {} {{ }} }}\nclass \"class\" {{ }}\n",
        metadata(rng),
        metadata(rng)
    )
    .into_bytes()
}
