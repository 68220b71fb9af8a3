//! Vertex caches written without the program's own writers.

use crate::{files::formats::obj, generate::Sheet};

fn count(count: usize) -> u32 {
    u32::try_from(count).unwrap()
}

fn singles(frames: &[Sheet]) -> impl Iterator<Item = f32> {
    frames.iter().flat_map(|sheet| sheet.positions.iter().flatten().map(|&x| x as f32))
}

/// As PC2: first frame 1, one sample a frame.
pub fn pc2(frames: &[Sheet]) -> Vec<u8> {
    let mut bytes = b"POINTCACHE2\0".to_vec();
    bytes.extend(1u32.to_le_bytes());
    bytes.extend(count(frames[0].positions.len()).to_le_bytes());
    bytes.extend([1.0f32, 1.0].iter().flat_map(|value| value.to_le_bytes()));
    bytes.extend(count(frames.len()).to_le_bytes());
    bytes.extend(singles(frames).flat_map(f32::to_le_bytes));
    bytes
}

/// As MDD, 24 frames a second.
pub fn mdd(frames: &[Sheet]) -> Vec<u8> {
    let mut bytes = count(frames.len()).to_be_bytes().to_vec();
    bytes.extend(count(frames[0].positions.len()).to_be_bytes());
    bytes.extend((0u16..).take(frames.len()).flat_map(|frame| (f32::from(frame) / 24.0).to_be_bytes()));
    bytes.extend(singles(frames).flat_map(f32::to_be_bytes));
    bytes
}

/// As numbered OBJ: a name for each frame with three digits, from `first` on, and its file.
pub fn numbered_obj(frames: &[Sheet], first: usize) -> Vec<(String, Vec<u8>)> {
    let names = (first..).map(|number| format!("{number:03}.obj"));
    names.zip(frames.iter().map(|sheet| obj(sheet, false))).collect()
}

/// As a text stage of USD: the mesh `/garment/cloth`, a metre to the unit, time codes from 1 on, one for each line.
pub fn usda(frames: &[Sheet]) -> String {
    let faces = &frames[0].faces;
    let corners: Vec<String> = faces.iter().flatten().map(u32::to_string).collect();
    let points = |sheet: &Sheet| {
        let point = |position: &[f64; 3]| format!("({})", position.map(|x| (x as f32).to_string()).join(", "));
        format!("[{}]", sheet.positions.iter().map(point).collect::<Vec<_>>().join(", "))
    };
    let samples = (1..).zip(frames).map(|(time, sheet)| format!("            {time}: {},\n", points(sheet)));
    format!(
        "#usda 1.0\n(\n    defaultPrim = \"garment\"\n    metersPerUnit = 1\n)\n\ndef Xform \"garment\"\n{{\n    \
         def Mesh \"cloth\"\n    {{\n        int[] faceVertexCounts = [{}]\n        \
         int[] faceVertexIndices = [{}]\n        point3f[] points.timeSamples = {{\n{}        }}\n    }}\n}}\n",
        vec!["3"; faces.len()].join(", "),
        corners.join(", "),
        samples.collect::<String>()
    )
}

/// The points of a text layer that has each sample in a line, as little-endian singles: what stands behind `time: `.
pub fn usda_points(text: &str) -> Vec<Vec<u8>> {
    let sample = |line: &str| {
        let (_, points) = line.trim().split_once(": [(")?;
        let numbers = points.split(|char: char| "(), []".contains(char)).filter(|number| !number.is_empty());
        Some(numbers.flat_map(|number| (number.parse::<f64>().unwrap() as f32).to_le_bytes()).collect())
    };
    text.lines().filter_map(sample).collect()
}
