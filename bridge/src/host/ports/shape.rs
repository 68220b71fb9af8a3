//! What the ports of a session are made for.

use untangled_proto::{
    PayloadLayout, PositionF32, PositionF64, Precision, RegisterParams, SessionOptions, Status, memory,
    names::{self, SessionService},
    sections::{Sections, id},
};
use untangled_transport::{Domain, memory as shared_memory};

use super::super::refusal::Refusal;
use crate::wire::request::Services;

/// A session, and how its samples are made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape<'a> {
    pub(crate) domain: &'a Domain,
    pub(crate) instance: u64,
    pub(crate) session: u64,
    pub(crate) num_vertices: usize,
    pub(crate) num_faces: u64,
    pub(crate) precision: Precision,
    pub(crate) layout: PayloadLayout,
    pub(crate) options: SessionOptions,
    pub(crate) services: Services,
}

impl<'a> Shape<'a> {
    /// That of a registration which a daemon has accepted: nothing of it is checked again but what is read here.
    pub(crate) fn read(
        domain: &'a Domain,
        sections: &Sections<'_>,
        layout: PayloadLayout,
        services: Services,
        [instance, session]: [u64; 2],
    ) -> Option<Self> {
        let params = sections.bytes(id::PARAMS).and_then(RegisterParams::from_bytes)?;
        let bits = sections.u32s::<1>(id::OPTIONS).ok()?.unwrap_or_default();
        let bits = bits.first().map_or(0, |[bits]| *bits);
        Some(Self {
            domain,
            instance,
            session,
            num_vertices: usize::try_from(params.num_vertices).ok()?,
            num_faces: sections.bytes(id::TRIANGLES).map_or(0, <[u8]>::len) as u64 / 12,
            precision: Precision::from_code(params.precision)?,
            layout,
            options: known_options(bits),
            services,
        })
    }

    pub(crate) fn name(&self, service: SessionService) -> String {
        names::session(self.instance, self.session, service)
    }

    pub(crate) fn is_sparse(&self) -> bool {
        self.services.contains(Services::SPARSE)
    }

    pub(crate) fn has_repairs(&self) -> bool {
        self.services.contains(Services::REPAIRS)
    }

    /// Bytes of a state's positions.
    pub(crate) fn state_bytes(&self) -> usize {
        let position = match self.precision {
            Precision::F32 => size_of::<PositionF32>(),
            Precision::F64 => size_of::<PositionF64>(),
        };
        self.num_vertices.saturating_mul(position)
    }

    /// Checks that shared memory has room for both sides of the session.
    pub(crate) fn check_memory(&self) -> Result<(), Refusal> {
        let needed = memory::session_bytes(self.num_vertices, self.precision, self.layout, self.options);
        match shared_memory::free() {
            Ok(free) if free < needed => Err(Refusal::new(
                Status::NotEnoughMemory,
                format_args!("the session needs {needed} bytes of shared memory; /dev/shm has {free} left"),
            )),
            Ok(_) => Ok(()),
            Err(error) => Err(Refusal::new(Status::Internal, format_args!("/dev/shm: {error}"))),
        }
    }
}

/// The options among these bits that this release knows: which services a session has is said by the daemon end, and
/// what a later release asks for besides is between host and daemon.
fn known_options(bits: u32) -> SessionOptions {
    let known = SessionOptions::NAMES.iter().map(|(_, option)| *option).filter(|option| bits & option.bits() != 0);
    known.fold(SessionOptions::default(), SessionOptions::with)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_options_leave_out_bits_of_later_releases() {
        assert_eq!(known_options(1 << 30 | 4 | 1), SessionOptions::SPARSE.with(SessionOptions::REPAIR));
        assert_eq!(known_options(0), SessionOptions::default());
    }
}
