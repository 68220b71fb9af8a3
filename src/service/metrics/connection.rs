//! One connection: reads the head of a request, answers, and closes. Never waits for its peer.

use std::{
    io::{ErrorKind, Read, Result, Write},
    net::TcpStream,
    time::{Duration, Instant},
};

use rustix::event::PollFlags;

use crate::http::{Answer, Body, Request};

/// Longest time for a request and its answer.
const PATIENCE: Duration = Duration::from_secs(1);
/// Longest head of a request in bytes.
const MAX_HEAD: usize = 4096;

/// A peer that has connected.
#[derive(Debug)]
pub(super) struct Connection {
    stream: TcpStream,
    head: Vec<u8>,
    /// What is left of the answer, once there is one.
    answer: Option<Vec<u8>>,
    since: Instant,
}

impl Connection {
    pub(super) fn new(stream: TcpStream) -> Result<Self> {
        stream.set_nonblocking(true)?;
        Ok(Self { stream, head: Vec::new(), answer: None, since: Instant::now() })
    }

    pub(super) fn stream(&self) -> &TcpStream {
        &self.stream
    }

    /// What it waits for.
    pub(super) fn interest(&self) -> PollFlags {
        if self.answer.is_some() { PollFlags::OUT } else { PollFlags::IN }
    }

    /// Time until it is given up.
    pub(super) fn time_left(&self) -> Duration {
        PATIENCE.saturating_sub(self.since.elapsed())
    }

    /// Does what can be done without waiting; whether the connection is to be kept.
    pub(super) fn advance(&mut self, body: &dyn Fn() -> String) -> Result<bool> {
        if self.answer.is_none() {
            self.read(body)?;
        }
        let Some(answer) = &mut self.answer else {
            return Ok(!self.time_left().is_zero());
        };
        while !answer.is_empty() {
            match self.stream.write(answer) {
                Ok(0) => return Ok(false),
                Ok(written) => drop(answer.drain(..written)),
                Err(error) if error.kind() == ErrorKind::WouldBlock => return Ok(!self.time_left().is_zero()),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(false)
    }

    /// Reads what has come; with the whole head there is an answer.
    fn read(&mut self, body: &dyn Fn() -> String) -> Result<()> {
        let mut buffer = [0; MAX_HEAD];
        loop {
            let ended = match self.stream.read(&mut buffer) {
                Ok(0) => true,
                Ok(read) => {
                    self.head.extend_from_slice(&buffer[..read]);
                    false
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => return Ok(()),
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) => return Err(error),
            };
            self.answer = answer(&self.head, ended || self.head.len() >= MAX_HEAD, body);
            if self.answer.is_some() {
                return Ok(());
            }
        }
    }
}

/// The answer to a request; nothing while its head is not whole and more may come.
fn answer(head: &[u8], is_end: bool, body: &dyn Fn() -> String) -> Option<Vec<u8>> {
    let request = Request::parse(head, is_end)?;
    let is_head = request.as_ref().is_ok_and(|request| request.is_head);
    let answer = match request {
        Ok(request) if matches!(request.target.as_str(), "/" | "/metrics") => {
            Answer::new("200 OK", "text/plain; version=0.0.4; charset=utf-8", Body::Shared(body().into_bytes().into()))
        }
        Ok(_) => Answer::text("404 Not Found", "metrics are at /metrics\n"),
        Err(refusal) => refusal,
    };
    let mut bytes = answer.head(false).into_bytes();
    if !is_head {
        bytes.extend_from_slice(answer.body.bytes());
    }
    Some(bytes)
}
