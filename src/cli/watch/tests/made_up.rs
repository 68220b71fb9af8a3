//! A source without a daemon: sessions of one triangle that rises from frame to frame.

use std::{
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicU64, AtomicUsize, Ordering},
    },
    time::Duration,
};

use serde_json::json;

use crate::cli::watch::{
    message::Message,
    source::{Feed, SessionLine, Source},
};

/// What the source and the test share.
#[derive(Debug, Default)]
pub(super) struct Shared {
    /// Names of the sessions; nothing while there is no daemon.
    pub(super) sessions: Mutex<Option<Vec<String>>>,
    /// Frames that the host has sent.
    pub(super) frame: AtomicU64,
    /// Observers that there are now, and that there have been.
    pub(super) num_open: AtomicUsize,
    pub(super) num_opened: AtomicUsize,
}

impl Shared {
    pub(super) fn set_sessions(&self, names: Option<&[&str]>) {
        let names = names.map(|names| names.iter().map(|&name| name.to_owned()).collect());
        *self.sessions.lock().unwrap_or_else(PoisonError::into_inner) = names;
    }

    fn sessions(&self) -> Option<Vec<String>> {
        self.sessions.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

pub(super) struct MadeUp(pub(super) Arc<Shared>);

impl Source for MadeUp {
    fn name(&self) -> &'static str {
        "made up"
    }

    fn sessions(&self) -> Result<Vec<SessionLine>, String> {
        let names = self.0.sessions().ok_or("no daemon")?;
        let line = |session: String| SessionLine {
            session,
            host: "a test".to_owned(),
            num_vertices: 3,
            num_faces: 1,
            num_frames: self.0.frame.load(Ordering::SeqCst),
        };
        Ok(names.into_iter().map(line).collect())
    }

    fn open(&self, session: &str) -> Result<Box<dyn Feed>, String> {
        let is_there = self.0.sessions().is_some_and(|names| names.iter().any(|name| name == session));
        if !is_there {
            return Err("there is no such session".to_owned());
        }
        self.0.num_open.fetch_add(1, Ordering::SeqCst);
        self.0.num_opened.fetch_add(1, Ordering::SeqCst);
        Ok(Box::new(MadeUpFeed { shared: Arc::clone(&self.0), session: session.to_owned(), seen: 0 }))
    }
}

struct MadeUpFeed {
    shared: Arc<Shared>,
    session: String,
    seen: u64,
}

impl Feed for MadeUpFeed {
    fn mesh(&self) -> Arc<[u8]> {
        let mut message = Message::default();
        message.whole("triangles", &[0, 1, 2]);
        message.finish(&json!({ "num_vertices": 3, "session": self.session }))
    }

    fn latest(&mut self, timeout: Duration) -> Result<Option<Arc<[u8]>>, String> {
        if !self.shared.sessions().is_some_and(|names| names.contains(&self.session)) {
            return Err("the session has ended".to_owned());
        }
        let frame = self.shared.frame.load(Ordering::SeqCst);
        if frame == self.seen {
            std::thread::sleep(timeout.min(Duration::from_millis(5)));
            return Ok(None);
        }
        self.seen = frame;
        Ok(Some(Message::default().finish(&json!({ "frame": frame }))))
    }
}

impl Drop for MadeUpFeed {
    fn drop(&mut self) {
        self.shared.num_open.fetch_sub(1, Ordering::SeqCst);
    }
}
