//! The little of HTTP/1.1 that this program speaks, for metrics and for the page of `untangled watch`: the head of a
//! request, and an answer. Sockets, limits of time and of sizes are the business of those who use it.

use std::{fmt::Write, sync::Arc};

use httparse::{EMPTY_HEADER, Status};

/// The head of a request with GET or HEAD.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Request {
    /// Whether only the head of the answer is asked for.
    pub(crate) is_head: bool,
    /// The target as it was sent, with its query.
    pub(crate) target: String,
    headers: Vec<(String, String)>,
    /// Bytes of the head.
    pub(crate) len: usize,
}

impl Request {
    /// Reads a head; nothing while more of it may come, that is, while it is not whole and `is_end` is not set. What is
    /// no request, or another one than GET and HEAD, or has a body, gets an answer of its own.
    pub(crate) fn parse(bytes: &[u8], is_end: bool) -> Option<Result<Self, Answer>> {
        let mut headers = [EMPTY_HEADER; 64];
        let mut request = httparse::Request::new(&mut headers);
        let parsed = request.parse(bytes);
        if matches!(parsed, Ok(Status::Partial)) && !is_end {
            return None;
        }
        let (Ok(Status::Complete(len)), Some(method), Some(target)) = (parsed, request.method, request.path) else {
            return Some(Err(Answer::text("400 Bad Request", "this is no HTTP request\n")));
        };
        let is_head = method == "HEAD";
        if method != "GET" && !is_head {
            let answer = Answer::text("405 Method Not Allowed", "only GET and HEAD are understood\n");
            return Some(Err(answer.with("Allow", "GET, HEAD")));
        }
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let headers = request.headers.iter().map(|header| (header.name.to_ascii_lowercase(), text(header.value)));
        let own = Self { is_head, target: target.to_owned(), headers: headers.collect(), len };
        // Also where it is said twice, or otherwise each time: what follows must not be taken for a request.
        let mut lengths = own.headers.iter().filter(|(name, _)| name == "content-length");
        let has_body = own.has("transfer-encoding") || lengths.any(|(_, length)| length.trim() != "0");
        Some(if has_body { Err(Answer::text("400 Bad Request", "no body is taken\n")) } else { Ok(own) })
    }

    /// The value of a header by its name in small letters; nothing where it is not there, or there more than once.
    pub(crate) fn header(&self, name: &str) -> Option<&str> {
        let mut values = self.headers.iter().filter(|(own, _)| own == name).map(|(_, value)| value.as_str());
        let first = values.next();
        first.filter(|_| values.next().is_none())
    }

    /// Whether a header is there.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.headers.iter().any(|(own, _)| own == name)
    }
}

/// An answer.
#[derive(Clone, Debug)]
pub(crate) struct Answer {
    /// Code and phrase.
    pub(crate) status: &'static str,
    content_type: &'static str,
    headers: Vec<(&'static str, String)>,
    pub(crate) body: Body,
}

/// What an answer carries.
#[derive(Clone, Debug)]
pub(crate) enum Body {
    Static(&'static [u8]),
    Shared(Arc<[u8]>),
}

impl Body {
    pub(crate) fn bytes(&self) -> &[u8] {
        match self {
            Self::Static(bytes) => bytes,
            Self::Shared(bytes) => bytes,
        }
    }
}

impl Answer {
    pub(crate) fn new(status: &'static str, content_type: &'static str, body: Body) -> Self {
        Self { status, content_type, headers: Vec::new(), body }
    }

    pub(crate) fn text(status: &'static str, body: &str) -> Self {
        Self::new(status, "text/plain; charset=utf-8", Body::Shared(body.as_bytes().into()))
    }

    /// With one header more; its value has no line breaks.
    pub(crate) fn with(mut self, name: &'static str, value: impl Into<String>) -> Self {
        self.headers.push((name, value.into()));
        self
    }

    /// The head, up to its empty line.
    pub(crate) fn head(&self, is_kept_open: bool) -> String {
        let Self { status, content_type, headers, body } = self;
        let mut head = format!("HTTP/1.1 {status}\r\nContent-Type: {content_type}\r\n");
        for (name, value) in headers {
            let _ = write!(head, "{name}: {value}\r\n");
        }
        let connection = if is_kept_open { "keep-alive" } else { "close" };
        let _ = write!(head, "Content-Length: {}\r\nConnection: {connection}\r\n\r\n", body.bytes().len());
        head
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<Request, &'static str> {
        Request::parse(text.as_bytes(), true).unwrap().map_err(|answer| answer.status)
    }

    #[test]
    fn parse_takes_get_and_head_without_a_body_and_refuses_the_rest() {
        let request = parsed("GET /a?b=1 HTTP/1.1\r\nHost: x\r\nA: 1\r\na: 2\r\n\r\nrest").unwrap();
        assert_eq!((request.target.as_str(), request.is_head, request.len), ("/a?b=1", false, 44));
        assert_eq!((request.header("host"), request.header("a"), request.has("a")), (Some("x"), None, true));
        assert!(parsed("HEAD / HTTP/1.1\r\n\r\n").unwrap().is_head);
        assert_eq!(parsed("POST / HTTP/1.1\r\n\r\n"), Err("405 Method Not Allowed"));
        for bad in ["", "GET /", "no request\r\n\r\n", "GET / HTTP/1.1\r\nContent-Length: 3\r\n\r\nabc"] {
            assert_eq!(parsed(bad), Err("400 Bad Request"), "{bad}");
        }
        for body in ["Transfer-Encoding: chunked\r\n", "Content-Length: 9\r\n", "Content-Length: 0\r\n"] {
            let twice = parsed(&format!("GET / HTTP/1.1\r\n{body}{body}\r\n"));
            assert_eq!(twice.is_ok(), body.contains(": 0"), "{body}");
        }
        assert!(Request::parse(b"GET / HTTP/1.1\r\nHost: x\r\n", false).is_none(), "more may come");
    }

    #[test]
    fn head_of_an_answer_says_its_length_and_what_becomes_of_the_connection() {
        let answer = Answer::text("404 Not Found", "no\n").with("X", "y");
        let head = "HTTP/1.1 404 Not Found\r\nContent-Type: text/plain; charset=utf-8\r\nX: y\r\n\
                    Content-Length: 3\r\nConnection: close\r\n\r\n";
        assert_eq!(answer.head(false), head);
        assert!(answer.head(true).contains("Connection: keep-alive\r\n"));
    }
}
