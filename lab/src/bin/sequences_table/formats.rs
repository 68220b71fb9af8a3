//! The same shot in other formats.

use std::{fs, time::Instant};

use untangled_lab::Failure;
use untangled_mesh_io::read_mesh;
use untangled_testkit::shots::usda_points;

use super::{
    excess::HEADER_SIZE,
    runs::{fix_cache, lines, num_unclean},
    scene::Scene,
};

/// How `fix` went on one of them.
pub(crate) struct Format {
    pub(crate) name: &'static str,
    pub(crate) seconds: f64,
    /// Frames of the output that are not clean by `check`.
    pub(crate) num_left: usize,
    /// How far a coordinate of the output is from that in PC2, both in single precision, in metres.
    pub(crate) max_difference_m: f64,
}

/// Repairs the files of [`Scene::write_formats`], and compares with the bytes of PC2.
pub(crate) fn formats(scene: &Scene, whole: &[u8]) -> Result<Vec<Format>, Failure> {
    let expected = floats(whole[HEADER_SIZE..].chunks(4), f32::from_le_bytes);
    [
        ("MDD", "cloth.mdd", "fixed.mdd"),
        ("numbered OBJ", "###.obj", "fixed_###.obj"),
        ("USD", "cloth.usda", "fixed.usda"),
    ]
    .into_iter()
    .map(|(name, cache, out)| {
        let start = Instant::now();
        lines(&fix_cache(scene, cache, out).output()?)?;
        let seconds = start.elapsed().as_secs_f64();
        let checked = lines(&scene.command("check", out).output()?)?;
        let points = read(scene, out)?;
        if points.len() != expected.len() {
            return Err(format!("{out}: {} coordinates instead of {}", points.len(), expected.len()).into());
        }
        let differences = points.iter().zip(&expected).map(|(a, b)| f64::from((a - b).abs()));
        let num_left = num_unclean(&checked[..scene.num_frames.min(checked.len())], "clean");
        Ok(Format { name, seconds, num_left, max_difference_m: differences.fold(0.0, f64::max) })
    })
    .collect()
}

/// All coordinates of a cache in single precision.
fn read(scene: &Scene, out: &str) -> Result<Vec<f32>, Failure> {
    match out {
        "fixed.mdd" => {
            let bytes = scene.read(out)?;
            Ok(floats(bytes[8 + 4 * scene.num_frames..].chunks(4), f32::from_be_bytes))
        }
        "fixed.usda" => {
            let text = fs::read_to_string(scene.folder.join(out))?;
            Ok(usda_points(&text).iter().flat_map(|frame| floats(frame.chunks(4), f32::from_le_bytes)).collect())
        }
        _ => {
            let mut points = Vec::new();
            for frame in 0..scene.num_frames {
                let mesh = read_mesh(scene.folder.join(format!("fixed_{frame:03}.obj")))?;
                #[expect(clippy::cast_possible_truncation, reason = "rounding as a cache does")]
                points.extend(mesh.positions().as_flattened().iter().map(|&x| x as f32));
            }
            Ok(points)
        }
    }
}

fn floats<'a>(chunks: impl Iterator<Item = &'a [u8]>, number: fn([u8; 4]) -> f32) -> Vec<f32> {
    chunks.map(|chunk| number(std::array::from_fn(|byte| chunk[byte]))).collect()
}
