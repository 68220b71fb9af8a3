//! Where a page may be written.

use std::path::Path;

use crate::cli::fix::{FixError, Target};

/// The place of a page. Only names that end in .html or .htm are taken: a file of another kind that was named by
/// mistake is not replaced.
///
/// # Errors
/// [`FixError::Target`], as for every output.
pub(in crate::cli) fn page_target(path: &Path, inputs: &[&Path], overwrite: bool) -> Result<Target, FixError> {
    let is_page = path.extension().is_some_and(|name| name.eq_ignore_ascii_case("html") || name == "htm");
    if !is_page {
        let reason = "a page is written as .html".to_owned();
        return Err(FixError::Target { path: path.to_path_buf(), reason });
    }
    Target::new(path.to_path_buf(), inputs, overwrite)
}
