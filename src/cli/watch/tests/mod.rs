//! The server with sessions that are made up: who gets an answer, and which.

mod made_up;

use std::{
    io::{Read, Write},
    net::TcpStream,
    os::unix::net::UnixStream,
    sync::{Arc, atomic::Ordering},
    thread::JoinHandle,
    time::Duration,
};

use made_up::{MadeUp, Shared};

use super::{hub::Hub, web::Server};

/// A server on a thread of its own, which ends when this is dropped.
struct Running {
    shared: Arc<Shared>,
    /// `127.0.0.1:PORT`.
    host: String,
    /// `/TOKEN/`.
    path: String,
    ending: Option<UnixStream>,
    thread: Option<JoinHandle<()>>,
}

impl Running {
    fn start() -> Self {
        let shared = Arc::new(Shared::default());
        let server = Server::bind(0, Hub::new(Arc::new(MadeUp(Arc::clone(&shared))))).unwrap();
        let page = server.page().unwrap();
        let (host, path) = page.strip_prefix("http://").unwrap().split_once('/').unwrap();
        let (ended, ending) = UnixStream::pair().unwrap();
        let thread = std::thread::spawn(move || server.run(&ended).unwrap());
        let (host, path) = (host.to_owned(), format!("/{path}"));
        Self { shared, host, path, ending: Some(ending), thread: Some(thread) }
    }

    fn connect(&self) -> TcpStream {
        TcpStream::connect(&self.host).unwrap()
    }

    /// The answer to a text: its head, and its body.
    fn say(&self, text: &str) -> (String, Vec<u8>) {
        let mut stream = self.connect();
        stream.write_all(text.as_bytes()).unwrap();
        let mut all = Vec::new();
        // A peer that does not read on closes with a reset.
        let _ = stream.read_to_end(&mut all);
        let end = all.windows(4).position(|four| four == b"\r\n\r\n").map_or(all.len(), |at| at + 4);
        (String::from_utf8_lossy(&all[..end]).into_owned(), all[end..].to_vec())
    }

    /// Asks as the page does, on a connection of its own.
    fn get(&self, target: &str) -> (String, Vec<u8>) {
        let mut stream = self.connect();
        self.get_on(&mut stream, target)
    }

    fn get_on(&self, stream: &mut TcpStream, target: &str) -> (String, Vec<u8>) {
        let text = format!("GET {}{target} HTTP/1.1\r\nHost: {}\r\n\r\n", self.path, self.host);
        stream.write_all(text.as_bytes()).unwrap();
        let mut head = Vec::new();
        let mut byte = [0];
        while !head.ends_with(b"\r\n\r\n") {
            stream.read_exact(&mut byte).unwrap();
            head.push(byte[0]);
        }
        let head = String::from_utf8(head).unwrap();
        let length = head.lines().find_map(|line| line.strip_prefix("Content-Length: ")).unwrap();
        let mut body = vec![0; length.parse().unwrap()];
        stream.read_exact(&mut body).unwrap();
        (head, body)
    }

    /// The head of the answer to a request for the page with these headers instead of the usual ones.
    fn page_with(&self, headers: &str) -> String {
        self.say(&format!("GET {} HTTP/1.1\r\n{headers}Connection: close\r\n\r\n", self.path)).0
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        drop(self.ending.take());
        self.thread.take().unwrap().join().unwrap();
    }
}

fn text(body: &[u8]) -> String {
    String::from_utf8_lossy(body).into_owned()
}

#[test]
fn page_has_its_parts_and_may_load_nothing_else() {
    let running = Running::start();
    let (head, body) = running.get("");
    assert!(head.starts_with("HTTP/1.1 200 OK\r\n"), "{head}");
    assert!(text(&body).contains("<script src=\"watch.js\">"));
    for header in ["default-src 'none'", "frame-ancestors 'none'", "no-referrer", "nosniff", "no-store"] {
        assert!(head.contains(header), "{header}: {head}");
    }
    assert!(!head.contains("Access-Control"), "no other page may read it: {head}");
    assert!(running.get("watch.js").0.contains("text/javascript"));
    assert!(running.get("watch.css").0.contains("text/css"));
    assert!(running.get("other").0.starts_with("HTTP/1.1 404"));
}

#[test]
fn requests_without_token_or_from_elsewhere_are_refused() {
    let running = Running::start();
    let host = format!("Host: {}\r\n", running.host);
    let refused = |head: String| assert!(head.starts_with("HTTP/1.1 403"), "{head}");
    let port = running.host.split(':').next_back().unwrap().to_owned();
    for name in ["localhost", "127.0.0.1", "[::1]"] {
        let head = running.page_with(&format!("Host: {name}:{port}\r\nOrigin: http://{name}:{port}\r\n"));
        assert!(head.starts_with("HTTP/1.1 200"), "{name}: {head}");
    }
    // A name that was made to lead here, none, two.
    for headers in ["Host: evil.example\r\n", "Host: 127.0.0.1.evil.example\r\n", "", &format!("{host}{host}")] {
        refused(running.page_with(headers));
    }
    refused(running.page_with(&format!("{host}Origin: https://evil.example\r\n")));
    refused(running.page_with(&format!("{host}Origin: null\r\n")));
    refused(running.page_with(&format!("{host}Sec-Fetch-Site: cross-site\r\n")));
    let visit = format!("{host}Sec-Fetch-Site: cross-site\r\nSec-Fetch-Mode: navigate\r\n");
    assert!(running.page_with(&visit).starts_with("HTTP/1.1 200"), "a link leads there");
    let token = running.path.trim_matches('/');
    let other = format!("{}0", &token[..token.len() - 1]);
    let other = if other == token { format!("{}1", &token[..token.len() - 1]) } else { other };
    for path in ["/", "/sessions", "//sessions", &format!("/{other}/sessions"), &format!("/{}/", &token[1..])] {
        refused(running.say(&format!("GET {path} HTTP/1.1\r\n{host}\r\n")).0);
    }
    let post = running.say(&format!("POST {}sessions HTTP/1.1\r\n{host}\r\n", running.path)).0;
    assert!(post.starts_with("HTTP/1.1 405"), "{post}");
    assert!(Running::start().path != running.path, "each run has its own token");
}

#[test]
fn frames_are_the_newest_and_come_once() {
    let running = Running::start();
    running.shared.set_sessions(Some(&["a", "b"]));
    running.shared.frame.store(7, Ordering::SeqCst);
    let mut stream = running.connect();
    let (_, body) = running.get_on(&mut stream, "sessions");
    let sessions: serde_json::Value = serde_json::from_slice(&body).unwrap();
    assert_eq!((&sessions["sessions"][1]["session"], &sessions["waiting"]), (&"b".into(), &().into()));
    let (head, body) = running.get_on(&mut stream, "mesh?session=a");
    assert!(head.contains("Connection: keep-alive") && text(&body).contains("\"session\":\"a\""), "{head}");
    let (head, body) = running.get_on(&mut stream, "frame?session=a&after=0");
    assert!(head.contains("Untangled-Serial: 1\r\n") && text(&body).contains("\"frame\":7"), "{head}");
    // Frames between two questions are lost.
    running.shared.frame.store(12, Ordering::SeqCst);
    let (head, body) = running.get_on(&mut stream, "frame?session=a&after=1");
    assert!(head.contains("Untangled-Serial: 2\r\n") && text(&body).contains("\"frame\":12"), "{head}");
    let (head, body) = running.get_on(&mut stream, "frame?session=a&after=2");
    assert!(head.starts_with("HTTP/1.1 200") && body.is_empty(), "nothing new: {head}");
    assert!(running.get("frame?session=a&after=x").0.starts_with("HTTP/1.1 400"));
}

#[test]
fn pages_share_the_observer_of_a_session() {
    let running = Running::start();
    running.shared.set_sessions(Some(&["a"]));
    running.shared.frame.store(1, Ordering::SeqCst);
    std::thread::scope(|scope| {
        for _ in 0..5 {
            scope.spawn(|| assert!(!running.get("frame?session=a&after=0").1.is_empty()));
        }
    });
    assert_eq!(running.shared.num_opened.load(Ordering::SeqCst), 1);
    let shared = Arc::clone(&running.shared);
    drop(running);
    assert_eq!(shared.num_open.load(Ordering::SeqCst), 0, "the end of the server leaves no observer");
}

#[test]
fn sessions_that_are_not_there_are_said_in_words_and_new_ones_found() {
    let running = Running::start();
    let (_, body) = running.get("sessions");
    assert!(text(&body).contains("\"waiting\":\"no daemon\""), "{}", text(&body));
    let (head, body) = running.get("mesh?session=a");
    assert!(head.starts_with("HTTP/1.1 410") && text(&body) == "there is no such session\n", "{head}");
    running.shared.set_sessions(Some(&["a"]));
    running.shared.frame.store(1, Ordering::SeqCst);
    assert!(!running.get("frame?session=a&after=0").1.is_empty());
    running.shared.set_sessions(Some(&["b"]));
    let (head, body) = running.get("frame?session=a&after=1");
    assert!(head.starts_with("HTTP/1.1 410") && text(&body).contains("has ended"), "{head}");
    let (head, _) = running.get("frame?session=b&after=1");
    assert!(head.contains("Untangled-Serial: 2\r\n"), "frames are counted over all sessions: {head}");
}

#[test]
fn connections_that_say_nothing_or_too_much_make_room() {
    let running = Running::start();
    running.shared.set_sessions(Some(&["a"]));
    let mut known = running.connect();
    running.get_on(&mut known, "sessions");
    let idle: Vec<TcpStream> = (0..80).map(|_| running.connect()).collect();
    assert!(running.get("sessions").0.starts_with("HTTP/1.1 200"), "idle connections make room");
    assert!(running.get_on(&mut known, "sessions").0.starts_with("HTTP/1.1 200"), "one that may ask stays");
    drop(idle);
    let long = format!("GET {} HTTP/1.1\r\nA: {}\r\n\r\n", running.path, "x".repeat(20_000));
    let head = running.say(&long).0;
    assert!(head.is_empty() || head.starts_with("HTTP/1.1 400"), "{head}");
    // A head that does not end is given up.
    let mut slow = running.connect();
    slow.write_all(b"GET / HT").unwrap();
    slow.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
    assert_eq!(slow.read(&mut [0; 8]).unwrap_or(0), 0);
}
