//! Requests of hosts to a daemon, and its replies, as queries carry them.
//!
//! A request is 16 bytes (version `u16`, zeros, link `u64`), the request's header as its bytes, and its payload. A
//! reply is 16 bytes (version `u16`, outcome `u16`, services `u32`, zeros), then for [`Outcome::Answered`] the reply's
//! header and payload, otherwise words.

use untangled_proto::{ReplyHeader, RequestHeader};

use super::{BRIDGE_VERSION, plain};

const FRONT_BYTES: usize = 16;

/// Services that a new session has, as bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Services(u32);

impl Services {
    /// Sparse corrections in place of those of all vertices.
    pub const SPARSE: Self = Self(1);
    /// Repairs.
    pub const REPAIRS: Self = Self(2);

    /// These and `other`, where `is_there`.
    #[must_use]
    pub fn with(self, other: Self, is_there: bool) -> Self {
        if is_there { Self(self.0 | other.0) } else { self }
    }

    /// Whether `other` is among them.
    #[must_use]
    pub fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }
}

/// What became of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum Outcome {
    /// The daemon has replied.
    Answered = 0,
    /// No daemon serves there; words say where it was looked for.
    NoDaemon = 1,
    /// The daemon end refuses it: a limit, or a version.
    Refused = 2,
}

/// A request.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request<'a> {
    /// For a registration the link that its session will have, for others that of the session that is meant, or zero.
    pub link: u64,
    /// As the host made it.
    pub header: RequestHeader,
    /// As the host made it.
    pub payload: &'a [u8],
}

impl<'a> Request<'a> {
    /// The bytes on the wire.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(FRONT_BYTES + size_of::<RequestHeader>() + self.payload.len());
        bytes.extend_from_slice(&BRIDGE_VERSION.to_le_bytes());
        bytes.extend_from_slice(&[0; 6]);
        bytes.extend_from_slice(&self.link.to_le_bytes());
        bytes.extend_from_slice(plain::bytes_of(&[self.header]));
        bytes.extend_from_slice(self.payload);
        bytes
    }

    /// From the bytes on the wire; nothing where they are too few, or of another version.
    #[must_use]
    pub fn read(bytes: &'a [u8]) -> Option<Self> {
        let (front, rest) = bytes.split_at_checked(FRONT_BYTES)?;
        if front[..2] != BRIDGE_VERSION.to_le_bytes() {
            return None;
        }
        let link = u64::from_le_bytes(std::array::from_fn(|k| front[8 + k]));
        let (header, payload) = plain::split_front(rest)?;
        Some(Self { link, header, payload })
    }
}

/// A reply.
#[derive(Clone, Debug, PartialEq)]
pub enum Reply {
    /// That of the daemon.
    Answered {
        /// Services of the session that was registered.
        services: Services,
        /// As the daemon made it.
        header: ReplyHeader,
        /// As the daemon made it.
        payload: Vec<u8>,
    },
    /// There is no daemon, in words.
    NoDaemon(String),
    /// The daemon end refuses the request, in words.
    Refused(String),
}

impl Reply {
    /// The bytes on the wire.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let (outcome, services) = match self {
            Self::Answered { services, .. } => (Outcome::Answered, *services),
            Self::NoDaemon(_) => (Outcome::NoDaemon, Services::default()),
            Self::Refused(_) => (Outcome::Refused, Services::default()),
        };
        let mut bytes = Vec::new();
        bytes.extend_from_slice(&BRIDGE_VERSION.to_le_bytes());
        bytes.extend_from_slice(&(outcome as u16).to_le_bytes());
        bytes.extend_from_slice(&services.0.to_le_bytes());
        bytes.extend_from_slice(&[0; 8]);
        match self {
            Self::Answered { header, payload, .. } => {
                bytes.extend_from_slice(plain::bytes_of(&[*header]));
                bytes.extend_from_slice(payload);
            }
            Self::NoDaemon(words) | Self::Refused(words) => bytes.extend_from_slice(words.as_bytes()),
        }
        bytes
    }

    /// From the bytes on the wire; nothing where they are too few, or of another version.
    #[must_use]
    pub fn read(bytes: &[u8]) -> Option<Self> {
        let (front, rest) = bytes.split_at_checked(FRONT_BYTES)?;
        if front[..2] != BRIDGE_VERSION.to_le_bytes() {
            return None;
        }
        let words = || String::from_utf8_lossy(rest).into_owned();
        match u16::from_le_bytes([front[2], front[3]]) {
            code if code == Outcome::Answered as u16 => {
                let services = Services(u32::from_le_bytes(std::array::from_fn(|k| front[4 + k])));
                let (header, payload) = plain::split_front(rest)?;
                Some(Self::Answered { services, header, payload: payload.to_vec() })
            }
            code if code == Outcome::NoDaemon as u16 => Some(Self::NoDaemon(words())),
            code if code == Outcome::Refused as u16 => Some(Self::Refused(words())),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_and_replies_come_back_and_short_ones_are_refused() {
        let header = RequestHeader { kind: 2, session: 5, flags: 7, reserved: [1, 2, 3], ..RequestHeader::default() };
        let request = Request { link: 77, header, payload: &[9; 5] };
        let bytes = request.to_bytes();
        assert_eq!(Request::read(&bytes), Some(request));
        assert_eq!(Request::read(&bytes[..79]), None);
        let header = ReplyHeader { status: 3, session: 5, num_bytes: 8, ..ReplyHeader::default() };
        let services = Services::default().with(Services::SPARSE, true).with(Services::REPAIRS, false);
        let reply = Reply::Answered { services, header, payload: b"words".to_vec() };
        assert_eq!(Reply::read(&reply.to_bytes()), Some(reply.clone()));
        assert!(services.contains(Services::SPARSE) && !services.contains(Services::REPAIRS));
        assert_eq!(Reply::read(&reply.to_bytes()[..79]), None);
        for reply in [Reply::NoDaemon("none".into()), Reply::Refused("too many".into())] {
            assert_eq!(Reply::read(&reply.to_bytes()), Some(reply));
        }
    }
}
