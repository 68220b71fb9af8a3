//! The journal beside an output that is not finished: what the run is about, and each frame that is done.
//!
//! A line is written before the frame is at its place, with a checksum of its bytes. A run that was ended leaves a
//! journal whose last lines may be missing, or tell of a frame that is not there: the next run takes the frames that
//! the checksums confirm, from the first one on, and goes on from there.

use std::{
    collections::BTreeMap,
    fs::{self, File, OpenOptions, TryLockError},
    hash::{DefaultHasher, Hasher},
    io::{self, Write},
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};

use crate::cli::sequence::error::SequenceError;

/// What a run is about, by name: of two runs with the same inputs and settings all are the same.
pub(super) type Identity = BTreeMap<String, String>;

#[derive(Debug, Serialize, Deserialize)]
struct Head {
    journal: String,
    identity: Identity,
}

/// A frame that is done.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Entry {
    pub(super) frame: u64,
    checksum: String,
    /// What was reported of it, as it was printed: reading a number and writing it again might change it.
    pub(super) line: String,
}

/// An open journal, locked against other runs.
#[derive(Debug)]
pub(super) struct Journal {
    path: PathBuf,
    file: File,
}

/// What a journal tells of an earlier run.
#[derive(Debug, Default)]
pub(super) struct Earlier {
    /// The frames of a run with the same inputs and settings.
    pub(super) done: Vec<Entry>,
    /// The frames of another run, and the first name in which it differs.
    pub(super) other: Option<(Vec<Entry>, String)>,
}

const VERSION: &str = concat!("untangled ", env!("CARGO_PKG_VERSION"), ", sequence 2");

/// A path with something behind its name.
pub(super) fn beside(path: &Path, what: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".");
    name.push(what);
    name.into()
}

/// The checksum of the bytes of a frame, or of anything else.
pub(super) fn checksum(bytes: &[u8]) -> String {
    let mut hasher = DefaultHasher::new();
    hasher.write(bytes);
    format!("{:016x}-{}", hasher.finish(), bytes.len())
}

impl Entry {
    pub(super) fn new(frame: u64, bytes: &[u8], line: String) -> Self {
        Self { frame, checksum: checksum(bytes), line }
    }

    /// Whether these are the bytes of the frame.
    pub(super) fn is_of(&self, bytes: &[u8]) -> bool {
        self.checksum == checksum(bytes)
    }
}

impl Journal {
    /// Opens the journal at a path, and reads what an earlier run left in it.
    pub(super) fn open(path: PathBuf, identity: &Identity) -> Result<(Self, Earlier), SequenceError> {
        let failed = |source: io::Error| error(&path, &source);
        let file =
            OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path).map_err(failed)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let reason = "another run is at work on this output".to_owned();
                return Err(SequenceError::Target { path, reason });
            }
            Err(TryLockError::Error(source)) => return Err(error(&path, &source)),
        }
        let text = fs::read(&path).map_err(failed)?;
        let earlier = read(&String::from_utf8_lossy(&text), identity);
        Ok((Self { path, file }, earlier))
    }

    /// Begins the journal anew, with frames that are done already.
    pub(super) fn begin(&mut self, identity: &Identity, done: &[Entry]) -> Result<(), SequenceError> {
        let head = Head { journal: VERSION.to_owned(), identity: identity.clone() };
        let mut text = json(&head);
        done.iter().for_each(|entry| text.push_str(&json(entry)));
        // In one step, so that a crash leaves the old journal or the new one.
        let new = beside(&self.path, "new");
        let mut file = File::create(&new).map_err(|source| error(&self.path, &source))?;
        let write = |file: &mut File| {
            file.lock()?;
            file.write_all(text.as_bytes())?;
            file.sync_data()?;
            fs::rename(&new, &self.path)
        };
        write(&mut file).map_err(|source| error(&self.path, &source))?;
        self.file = file;
        Ok(())
    }

    /// Adds a frame.
    pub(super) fn add(&mut self, entry: &Entry) -> Result<(), SequenceError> {
        self.file.write_all(json(entry).as_bytes()).map_err(|source| error(&self.path, &source))
    }

    /// Removes the journal of a run that is finished.
    pub(super) fn remove(self) -> Result<(), SequenceError> {
        fs::remove_file(&self.path).map_err(|source| error(&self.path, &source))
    }
}

fn json(value: &impl Serialize) -> String {
    crate::cli::wording::json_line(value)
}

/// The complete lines of a journal.
fn read(text: &str, identity: &Identity) -> Earlier {
    let mut lines = text.split_inclusive('\n').filter(|line| line.ends_with('\n'));
    let head = lines.next().and_then(|line| serde_json::from_str::<Head>(line).ok());
    let Some(head) = head.filter(|head| head.journal == VERSION) else {
        let other = (!text.is_empty()).then(|| (Vec::new(), "version of the program".to_owned()));
        return Earlier { other, ..Earlier::default() };
    };
    let entries = lines.map_while(|line| serde_json::from_str(line).ok()).collect();
    let differs = identity.iter().find(|(name, value)| head.identity.get(*name) != Some(value));
    let gone = head.identity.keys().find(|name| !identity.contains_key(*name));
    match differs.map(|(name, _)| name).or(gone) {
        Some(name) => Earlier { done: Vec::new(), other: Some((entries, name.clone())) },
        None => Earlier { done: entries, other: None },
    }
}

fn error(path: &Path, source: &io::Error) -> SequenceError {
    SequenceError::Target { path: path.to_path_buf(), reason: format!("can't be written: {source}") }
}
