//! Where a page may be written.

use std::{ffi::OsStr, path::Path};

use crate::cli::fix::{FixError, Target};

/// The place of a page. Only names that end in .html or .htm are taken: a file of another kind that was named by
/// mistake is not replaced.
///
/// A page is no result: one that can't be written in the end is an error of its own, and withholds nothing. So all that
/// can be known of its place is asked here, before work begins.
///
/// # Errors
/// [`FixError::Target`], as for every output.
pub(in crate::cli) fn page_target(path: &Path, inputs: &[&Path], overwrite: bool) -> Result<Target, FixError> {
    let is_extension = |name: &OsStr| ["html", "htm"].iter().any(|known| name.eq_ignore_ascii_case(known));
    let refused = |reason: &str| FixError::Target { path: path.to_path_buf(), reason: reason.to_owned() };
    // A name of an extension alone is one of a hidden file.
    let name = path.file_name().map(OsStr::as_encoded_bytes).unwrap_or_default();
    if [&b".html"[..], b".htm"].iter().any(|known| name.eq_ignore_ascii_case(known)) {
        return Err(refused("is no name for a page: something must stand before .html, as in page.html"));
    }
    if !path.extension().is_some_and(is_extension) {
        return Err(refused("a page is written as .html"));
    }
    Target::new(path.to_path_buf(), inputs, overwrite)
}
