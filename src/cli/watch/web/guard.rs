//! Who may ask: somebody who knows the token, at a name of this machine, from no other page.
//!
//! Every user of the machine can connect to a loopback address, and every page that the user has open can send requests
//! there. The token keeps the first out; the name of the host keeps out pages whose own name was made to lead here (DNS
//! rebinding), and the origin all others.

use std::{fs::File, io::Read};

use crate::http::{Answer, Request};

/// Bytes of a token.
const TOKEN_BYTES: usize = 16;

/// Holds the token of this run.
#[derive(Debug)]
pub(super) struct Guard {
    token: String,
}

impl Guard {
    /// With a new token.
    ///
    /// # Errors
    /// What the system says where it gives no random bytes.
    pub(super) fn new() -> std::io::Result<Self> {
        let mut bytes = [0; TOKEN_BYTES];
        File::open("/dev/urandom")?.read_exact(&mut bytes)?;
        Ok(Self { token: bytes.iter().map(|byte| format!("{byte:02x}")).collect() })
    }

    /// Where the page is.
    pub(super) fn page(&self, port: u16) -> String {
        format!("http://127.0.0.1:{port}/{}/", self.token)
    }

    /// What is asked for, below the token; an answer to whoever may not ask.
    pub(super) fn admit<'a>(&self, request: &'a Request) -> Result<&'a str, Answer> {
        let refused = |words| Err(Answer::text("403 Forbidden", words));
        let Some(host) = request.header("host").filter(|host| is_this_machine(host)) else {
            return refused("this page is at 127.0.0.1 and localhost only\n");
        };
        let is_own = |origin: &str| origin.strip_prefix("http://") == Some(host);
        if request.has("origin") && !request.header("origin").is_some_and(is_own) {
            return refused("another page asks\n");
        }
        // Browsers say where a request comes from; a person who follows a link is no request of a page.
        let is_visit = request.header("sec-fetch-mode") == Some("navigate");
        let is_foreign = |site: &str| !matches!(site, "same-origin" | "none");
        if request.header("sec-fetch-site").is_some_and(is_foreign) && !is_visit {
            return refused("another page asks\n");
        }
        let (token, rest) = request.target.strip_prefix('/').and_then(|path| path.split_once('/')).unwrap_or_default();
        if !self.is_token(token) {
            return refused("the address that `untangled watch` printed has a token; this one has another or none\n");
        }
        Ok(rest)
    }

    /// Takes the same time for each token of the right length.
    fn is_token(&self, token: &str) -> bool {
        let differences = token.bytes().zip(self.token.bytes()).fold(0, |sum, (a, b)| sum | (a ^ b));
        token.len() == self.token.len() && differences == 0
    }
}

/// Whether a host header names this machine. The port may be another one, where it is forwarded.
fn is_this_machine(host: &str) -> bool {
    let (name, port) = match host.rsplit_once(':') {
        Some((name, port)) if !port.ends_with(']') => (name, port),
        _ => (host, "80"),
    };
    matches!(name, "127.0.0.1" | "localhost" | "[::1]") && port.parse::<u16>().is_ok()
}
