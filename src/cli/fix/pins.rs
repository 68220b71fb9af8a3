//! The pin file.

use std::{fs, path::Path};

use super::error::FixError;

/// Reads 0-based vertex indices, separated by white space; `#` starts a comment that ends with its line.
///
/// # Errors
/// [`FixError::Pins`], with the line at fault.
pub(in crate::cli) fn read(path: &Path, num_vertices: usize) -> Result<Vec<u32>, FixError> {
    let error = |line, reason: String| FixError::Pins { path: path.to_path_buf(), line, reason };
    let bytes = fs::read(path).map_err(|source| error(None, format!("can't be read: {source}")))?;
    let mut pins = Vec::new();
    for (number, line) in String::from_utf8_lossy(&bytes).lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        for word in line.split_whitespace() {
            let at_fault = |reason: String| error(Some(number + 1), reason);
            let shown: String = word.chars().take(32).collect();
            if word.is_empty() || !word.bytes().all(|byte| byte.is_ascii_digit()) {
                return Err(at_fault(format!("`{shown}` where a vertex index is needed")));
            }
            let index = word.parse::<u32>().ok().filter(|&index| (index as usize) < num_vertices);
            let there = || match num_vertices {
                1 => "there is only vertex 0".to_owned(),
                _ => format!("there are vertices 0 to {}", num_vertices.saturating_sub(1)),
            };
            pins.push(index.ok_or_else(|| at_fault(format!("vertex {shown} does not exist, {}", there())))?);
        }
    }
    Ok(pins)
}
