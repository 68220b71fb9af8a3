//! Ids of processes in the ids and file names of iceoryx2: they tell resources of crashed peers from those of live
//! ones.

use rustix::{
    io::Errno,
    process::{Pid, test_kill_process},
};

/// A process, as the ids of its nodes and ports carry it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ProcessId(Pid);

impl ProcessId {
    /// The process of a node or port with this id: seconds, nanoseconds, process and counter, 32 bits each, from the
    /// lowest bits upwards. Nothing where that part is no process id.
    #[must_use]
    pub fn of(id: u128) -> Option<Self> {
        i32::try_from((id >> 64) & u128::from(u32::MAX)).ok().and_then(Pid::from_raw).map(Self)
    }

    /// Its number.
    #[must_use]
    pub fn number(self) -> u32 {
        self.0.as_raw_nonzero().get().unsigned_abs()
    }

    /// What the system calls its program, at most 15 bytes; nothing where it has ended, or lives in another namespace.
    ///
    /// Cost: some system calls.
    #[must_use]
    pub fn name(self) -> Option<String> {
        let bytes = std::fs::read(format!("/proc/{}/comm", self.number())).ok()?;
        Some(String::from_utf8_lossy(&bytes).trim_end().replace(char::is_control, "?"))
    }

    /// Whether this process sees no such process: it has ended, or lives in another namespace.
    #[must_use]
    pub fn is_gone(self) -> bool {
        test_kill_process(self.0) == Err(Errno::SRCH)
    }
}

/// The processes in the ids that the name of a file of iceoryx2 carries. The name is given without the domain's prefix.
pub fn in_name(name: &str) -> impl Iterator<Item = ProcessId> {
    parts(name).filter_map(|part| ProcessId::of(part.parse().ok()?))
}

/// The parts of a name between its separators. An id is a whole part; it must not be found inside another id.
pub(crate) fn parts(name: &str) -> impl Iterator<Item = &str> {
    name.split(['_', '.'])
}
