//! Links of a document to files. A document from a stranger must not take away other files of the user, and must not
//! read without end: only regular files in the folder of the document are read.

use std::{
    fs::{self, File},
    io::Read,
    path::{Component, Path, PathBuf},
};

/// Most characters of a link in a message.
const MOST_CHARACTERS: usize = 80;

/// A file that a link leads to.
#[derive(Debug)]
pub(super) struct Linked {
    /// As the link names it, below the folder.
    pub(super) path: PathBuf,
    /// With all symbolic links resolved.
    pub(super) resolved: PathBuf,
}

/// The file in `folder` that a relative link leads to. Nothing is opened.
///
/// # Errors
/// In words, for links to anything but a regular file in the folder or below it, through symbolic links too.
pub(super) fn resolve(link: &str, folder: &Path) -> Result<Linked, String> {
    let shown: String = link.chars().take(MOST_CHARACTERS).collect();
    let refused = |reason: &str| format!("link `{shown}` {reason}; only files in the folder of the document are read");
    let name = percent_decoded(link).ok_or_else(|| refused("is not UTF-8"))?;
    let has_scheme = link.split(['/', '?', '#']).next().is_some_and(|first| first.contains(':'));
    if has_scheme || name.contains("://") {
        return Err(refused("is not a relative path"));
    }
    if name.contains(['\\', '\0']) || name.is_empty() {
        return Err(refused("is not the path of a file"));
    }
    let mut depth = 0usize;
    for component in Path::new(&name).components() {
        match component {
            Component::RootDir | Component::Prefix(_) => return Err(refused("is not a relative path")),
            Component::CurDir => {}
            Component::ParentDir => depth = depth.checked_sub(1).ok_or_else(|| refused("leads out of the folder"))?,
            Component::Normal(name) => {
                // A document may lie in the home folder, whose hidden files are nobody's buffers.
                if name.as_encoded_bytes().starts_with(b".") {
                    return Err(refused("names a hidden file or folder"));
                }
                depth += 1;
            }
        }
    }
    let path = folder.join(&name);
    let io = |error: std::io::Error| format!("{}: {error}", path.display());
    let resolved = fs::canonicalize(&path).map_err(io)?;
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    if !resolved.starts_with(fs::canonicalize(folder).map_err(io)?) {
        return Err(refused("leads out of the folder"));
    }
    // Before it is opened: opening a pipe waits for its writer.
    if !fs::metadata(&resolved).map_err(io)?.is_file() {
        return Err(refused("leads to no regular file"));
    }
    Ok(Linked { path, resolved })
}

impl Linked {
    /// Reads at most `length` bytes.
    pub(super) fn read(&self, length: usize) -> Result<Vec<u8>, String> {
        let io = |error: std::io::Error| format!("{}: {error}", self.path.display());
        let mut bytes = Vec::new();
        let file = File::open(&self.resolved).map_err(io)?;
        file.take(u64::try_from(length).unwrap_or(u64::MAX)).read_to_end(&mut bytes).map_err(io)?;
        Ok(bytes)
    }
}

/// Decodes a link to a path; `None` if it is not UTF-8.
fn percent_decoded(link: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(link.len());
    let mut rest = link.as_bytes();
    while let [first, tail @ ..] = rest {
        let code = if *first == b'%' { tail.get(..2) } else { None };
        let code = code.filter(|code| code.iter().all(u8::is_ascii_hexdigit));
        let code = code.and_then(|code| u8::from_str_radix(std::str::from_utf8(code).ok()?, 16).ok());
        bytes.push(code.unwrap_or(*first));
        rest = if code.is_some() { &tail[2..] } else { tail };
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::symlink;

    use super::*;

    #[test]
    fn resolve_takes_regular_files_in_the_folder_only() {
        let outer = tempfile::tempdir().unwrap();
        let folder = outer.path().join("model");
        fs::create_dir_all(folder.join("data/.git")).unwrap();
        for name in ["model/a b.bin", "model/data/b.bin", "model/.hidden", "model/data/.git/c", "outside"] {
            fs::write(outer.path().join(name), "0123456789").unwrap();
        }
        symlink("a b.bin", folder.join("inside.bin")).unwrap();
        symlink("../outside", folder.join("link.bin")).unwrap();
        symlink("..", folder.join("up")).unwrap();
        symlink("/dev/zero", folder.join("zero")).unwrap();
        let resolve = |link: &str| super::resolve(link, &folder);
        for link in ["a b.bin", "a%20b.bin", "./data/b.bin", "data/../a b.bin", "inside.bin", "data%2Fb.bin"] {
            assert_eq!(resolve(link).unwrap().read(4).unwrap(), b"0123", "{link}");
        }
        for (link, reason) in [
            ("/etc/passwd", "is not a relative path"),
            ("%2Fetc%2Fpasswd", "is not a relative path"),
            ("file:///etc/passwd", "is not a relative path"),
            ("file:a%20b.bin", "is not a relative path"),
            ("http://example.org/a.bin", "is not a relative path"),
            ("../outside", "leads out of the folder"),
            ("data/../../outside", "leads out of the folder"),
            ("%2e%2E/outside", "leads out of the folder"),
            ("..%2foutside", "leads out of the folder"),
            ("../model/a b.bin", "leads out of the folder"),
            ("link.bin", "leads out of the folder"),
            ("up/outside", "leads out of the folder"),
            ("zero", "leads out of the folder"),
            ("..\\outside", "is not the path of a file"),
            ("%5c..%5Coutside", "is not the path of a file"),
            ("a%00b", "is not the path of a file"),
            ("", "is not the path of a file"),
            (".hidden", "names a hidden file or folder"),
            ("data/.git/c", "names a hidden file or folder"),
            ("data", "leads to no regular file"),
            (".", "leads to no regular file"),
        ] {
            let error = resolve(link).unwrap_err();
            assert!(error.contains(reason), "{link}: {error}");
        }
        assert!(resolve("missing.bin").unwrap_err().contains("missing.bin: No such file"));
        assert!(resolve(&"x/".repeat(2_000)).unwrap_err().len() < 5_000);
    }
}
