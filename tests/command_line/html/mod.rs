//! `--html` of `untangled check` and `untangled fix`: the document inside of the page, and the page in a browser.

pub(crate) mod browser;
mod contents;
mod frames;
mod places;

use std::{fs, path::Path};

use base64::{Engine, engine::general_purpose::STANDARD};
use serde_json::Value;
use untangled_testkit::{files::formats::obj, generate::Sheet};

const START: &str = "<script type=\"application/json\" id=\"data\">";

/// The document inside of a page.
fn document(page: &Path) -> Value {
    let text = fs::read_to_string(page).unwrap();
    assert_eq!(text.matches(START).count(), 1, "{}", page.display());
    let (_, rest) = text.split_once(START).unwrap();
    let (data, after) = rest.split_once("</script>").unwrap();
    assert!(after.starts_with("\n<script>\n"), "the document ends where its element does");
    assert_eq!(after.matches("</script>").count(), 1, "the script ends where its element does");
    serde_json::from_str(data).unwrap()
}

fn bytes(value: &Value) -> Vec<u8> {
    STANDARD.decode(value.as_str().unwrap()).unwrap()
}

fn singles(value: &Value) -> Vec<f64> {
    bytes(value).chunks_exact(4).map(|four| f64::from(f32::from_le_bytes(four.try_into().unwrap()))).collect()
}

fn whole(value: &Value) -> Vec<usize> {
    bytes(value).chunks_exact(4).map(|four| u32::from_le_bytes(four.try_into().unwrap()) as usize).collect()
}

/// Coordinates of a state, by vertex, in the world.
fn positions(page: &Value, state: &Value) -> Vec<[f64; 3]> {
    let centre: Vec<f64> = page["mesh"]["centre"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
    let place = |three: &[f64]| [0, 1, 2].map(|axis| three[axis] + centre[axis]);
    singles(&state["positions"]).chunks_exact(3).map(place).collect()
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
}

fn count(value: &Value) -> usize {
    usize::try_from(value.as_u64().unwrap()).unwrap()
}

fn write(folder: &Path, name: &str, sheet: &Sheet) {
    fs::write(folder.join(name), obj(sheet, false)).unwrap();
}
