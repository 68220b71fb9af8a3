//! What became of a request or of a frame.

/// Status of a reply or of a correction. On the wire it is a `u32`; values that a peer doesn't know are errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
#[non_exhaustive]
pub enum Status {
    /// Done.
    Ok = 0,
    /// The daemon speaks another version of the protocol.
    UnsupportedProtocol = 1,
    /// The request is malformed: kind, section table or lengths.
    BadRequest = 2,
    /// The mesh was refused.
    BadMesh = 3,
    /// A setting was refused.
    BadSettings = 4,
    /// There is no such session.
    UnknownSession = 5,
    /// The daemon serves as many sessions as it may.
    TooManySessions = 6,
    /// More vertices or faces than the daemon takes.
    TooLarge = 7,
    /// Shared memory would not hold the session's samples.
    NotEnoughMemory = 8,
    /// Corrections as forces were asked for, without masses.
    MassesRequired = 9,
    /// A position is not finite, or too large.
    BadPosition = 10,
    /// The frame's header can't be used: `dt_s`, `simulated_s` or the number of vertices.
    BadHeader = 11,
    /// Something in the daemon failed that should not.
    Internal = 12,
    // 13 is not given out: peers test with it what they do with a code that they don't know.
    /// More faces of the frame intersect, or might, than the session's settings allow: it was not analysed.
    TooManyIntersections = 14,
    /// The frame's time was up before its intersections were found.
    OutOfTime = 15,
    /// The daemon has no room for one more observer.
    TooManyObservers = 16,
}

impl Status {
    const ALL: [Self; 16] = [
        Self::Ok,
        Self::UnsupportedProtocol,
        Self::BadRequest,
        Self::BadMesh,
        Self::BadSettings,
        Self::UnknownSession,
        Self::TooManySessions,
        Self::TooLarge,
        Self::NotEnoughMemory,
        Self::MassesRequired,
        Self::BadPosition,
        Self::BadHeader,
        Self::Internal,
        Self::TooManyIntersections,
        Self::OutOfTime,
        Self::TooManyObservers,
    ];

    /// The value on the wire.
    #[must_use]
    pub fn code(self) -> u32 {
        self as u32
    }

    /// What it means, in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Ok => "done",
            Self::UnsupportedProtocol => "unsupported protocol",
            Self::BadRequest => "bad request",
            Self::BadMesh => "bad mesh",
            Self::BadSettings => "bad settings",
            Self::UnknownSession => "unknown session",
            Self::TooManySessions => "too many sessions",
            Self::TooLarge => "too large",
            Self::NotEnoughMemory => "not enough shared memory",
            Self::MassesRequired => "masses required",
            Self::BadPosition => "bad position",
            Self::BadHeader => "bad header",
            Self::TooManyIntersections => "too many intersections",
            Self::OutOfTime => "out of time",
            Self::TooManyObservers => "too many observers",
            Self::Internal => "internal: a defect of the daemon",
        }
    }

    /// The status of a value on the wire, if it is one.
    #[must_use]
    pub fn from_code(code: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|status| status.code() == code)
    }
}
