//! What is at which address below the token.

use std::time::Duration;

use serde_json::json;

use crate::{
    cli::watch::hub::Hub,
    http::{Answer, Body},
};

/// What `report/` builds.
const SCRIPT: &str = include_str!("../../../../report/built/watch.js");
const STYLE: &str = include_str!("../../../../report/built/watch.css");
const PAGE: &str = "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
    <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>untangled watch</title>\n\
    <link rel=\"icon\" href=\"data:,\">\n<link rel=\"stylesheet\" href=\"watch.css\">\n</head>\n<body>\n\
    <noscript>This page draws by a script. Allow scripts to see it; nothing leaves this machine.</noscript>\n\
    <div id=\"page\"></div>\n<script src=\"watch.js\"></script>\n</body>\n</html>\n";

/// Longest time that a question waits for its answer; the page asks again then.
const PATIENCE: Duration = Duration::from_secs(2);

/// The answer to a question that may be asked.
pub(super) fn answer(target: &str, hub: &Hub) -> Answer {
    let (path, query) = target.split_once('?').unwrap_or((target, ""));
    let session = value(query, "session").unwrap_or_default();
    match path {
        "" => page("text/html; charset=utf-8", PAGE),
        "watch.js" => page("text/javascript; charset=utf-8", SCRIPT),
        "watch.css" => page("text/css; charset=utf-8", STYLE),
        "sessions" => sessions(hub),
        "mesh" => mesh(hub, session),
        "frame" => match value(query, "after").unwrap_or("0").parse() {
            Ok(after) => frame(hub, session, after),
            Err(_) => Answer::text("400 Bad Request", "`after` is a number\n"),
        },
        _ => Answer::text("404 Not Found", "there is no such page\n"),
    }
}

/// A value of a query; the page sends nothing that would have to be decoded.
fn value<'a>(query: &'a str, name: &str) -> Option<&'a str> {
    query.split('&').find_map(|pair| pair.split_once('=').filter(|(own, _)| *own == name)).map(|(_, value)| value)
}

fn page(content_type: &'static str, text: &'static str) -> Answer {
    Answer::new("200 OK", content_type, Body::Static(text.as_bytes()))
}

fn sessions(hub: &Hub) -> Answer {
    let (sessions, waiting) = match hub.sessions() {
        Ok(sessions) => (sessions, None),
        Err(words) => (Vec::new(), Some(words)),
    };
    let version = env!("CARGO_PKG_VERSION");
    let document = json!({
        "schema": "untangled.watch/1", "version": version, "daemon": hub.name(), "waiting": waiting,
        "sessions": sessions,
    });
    Answer::new("200 OK", "application/json", Body::Shared(document.to_string().into_bytes().into()))
}

fn mesh(hub: &Hub, session: &str) -> Answer {
    match hub.channel(session).and_then(|channel| channel.mesh(PATIENCE)) {
        Ok(Some(message)) => Answer::new("200 OK", "application/octet-stream", Body::Shared(message)),
        Ok(None) => nothing(),
        Err(words) => gone(&words),
    }
}

fn frame(hub: &Hub, session: &str, after: u64) -> Answer {
    match hub.channel(session).and_then(|channel| channel.frame(after, PATIENCE)) {
        Ok(Some(fetched)) => {
            let answer = Answer::new("200 OK", "application/octet-stream", Body::Shared(fetched.message));
            answer.with("Untangled-Serial", fetched.serial.to_string())
        }
        Ok(None) => nothing(),
        Err(words) => gone(&words),
    }
}

/// Nothing new yet.
fn nothing() -> Answer {
    Answer::text("200 OK", "")
}

fn gone(words: &str) -> Answer {
    Answer::text("410 Gone", &format!("{words}\n"))
}
