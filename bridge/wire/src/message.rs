//! Envelopes of what a session's ends send to each other.

use crate::BRIDGE_VERSION;

/// Bytes of an envelope: version `u16`, kind `u16`, zero `u32`, link `u64`, sequence `u64`, all little-endian.
pub const ENVELOPE_BYTES: usize = 24;

/// What a message is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum Kind {
    /// To the daemon: a state header, then positions.
    State = 1,
    /// Both ways, in a channel of its own: the sequence up to which messages have come.
    Acknowledged = 2,
    /// To the daemon: from here on somebody listens to paths.
    PathsOn = 3,
    /// To the daemon: nobody listens to paths any more.
    PathsOff = 4,
    /// To the daemon: say again which vertices are pinned.
    PinsAgain = 5,
    /// To the host: a correction header, then vertices as [`elements`](super::elements).
    Dense = 17,
    /// To the host: a correction header, then the words of a sparse correction.
    Sparse = 18,
    /// To the host: a repair header, then displacements as [`elements`](super::elements).
    Repair = 19,
    /// To the host: a paths header, then its payload.
    Paths = 20,
    /// To the host: the daemon has ended the session, or is gone.
    Gone = 21,
}

impl Kind {
    const ALL: [Self; 10] = [
        Self::State,
        Self::Acknowledged,
        Self::PathsOn,
        Self::PathsOff,
        Self::PinsAgain,
        Self::Dense,
        Self::Sparse,
        Self::Repair,
        Self::Paths,
        Self::Gone,
    ];

    fn from_code(code: u16) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| *kind as u16 == code)
    }
}

/// Where a message belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Envelope {
    /// What it is.
    pub kind: Kind,
    /// The link, which the host end has drawn for one registration: a message of an earlier one belongs nowhere.
    pub link: u64,
    /// Counts up from 1 in each direction of a link; what does not count up is a duplicate or late, and dropped. For
    /// [`Kind::Acknowledged`] the sequence that is acknowledged.
    pub sequence: u64,
}

impl Envelope {
    /// A message of this envelope with room for `length` bytes behind it.
    #[must_use]
    pub fn begin(self, length: usize) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(ENVELOPE_BYTES + length);
        bytes.extend_from_slice(&BRIDGE_VERSION.to_le_bytes());
        bytes.extend_from_slice(&(self.kind as u16).to_le_bytes());
        bytes.extend_from_slice(&[0; 4]);
        bytes.extend_from_slice(&self.link.to_le_bytes());
        bytes.extend_from_slice(&self.sequence.to_le_bytes());
        bytes
    }

    /// Reads an envelope, and gives back what stands behind it.
    #[must_use]
    pub fn read(bytes: &[u8]) -> Option<(Self, &[u8])> {
        let (envelope, body) = bytes.split_at_checked(ENVELOPE_BYTES)?;
        let short = |at: usize| u16::from_le_bytes(std::array::from_fn(|k| envelope[at + k]));
        let long = |at: usize| u64::from_le_bytes(std::array::from_fn(|k| envelope[at + k]));
        if short(0) != BRIDGE_VERSION {
            return None;
        }
        Some((Self { kind: Kind::from_code(short(2))?, link: long(8), sequence: long(16) }, body))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn read_gives_back_what_was_written_and_refuses_other_versions_kinds_and_lengths() {
        let envelope = Envelope { kind: Kind::Sparse, link: 0x0123_4567_89ab_cdef, sequence: 7 };
        let mut bytes = envelope.begin(3);
        bytes.extend([1, 2, 3]);
        assert_eq!(Envelope::read(&bytes), Some((envelope, &[1, 2, 3][..])));
        assert_eq!(Envelope::read(&bytes[..23]), None);
        for (at, value) in [(0, 2), (2, 99)] {
            let mut bad = bytes.clone();
            bad[at] = value;
            assert_eq!(Envelope::read(&bad), None);
        }
        for kind in Kind::ALL {
            let envelope = Envelope { kind, ..envelope };
            assert_eq!(Envelope::read(&envelope.begin(0)), Some((envelope, &[][..])));
        }
    }
}
