//! The working memory of faer's algorithms, kept between calls.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};

/// A buffer that grows when more is asked for and never shrinks.
#[derive(Default)]
pub(crate) struct Scratch {
    buffer: Option<(MemBuffer, StackReq)>,
}

impl Scratch {
    /// A stack with room for at least `wanted`.
    pub(crate) fn stack(&mut self, wanted: StackReq) -> &mut MemStack {
        let all = self.buffer.as_ref().map_or(wanted, |(_, has)| has.or(wanted));
        if self.buffer.as_ref().is_none_or(|(_, has)| *has != all) {
            self.buffer = None;
        }
        let (buffer, _) = self.buffer.get_or_insert_with(|| (MemBuffer::new(all), all));
        MemStack::new(buffer)
    }
}

impl std::fmt::Debug for Scratch {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("Scratch")
            .field("bytes", &self.buffer.as_ref().map(|(_, has)| has.size_bytes()))
            .finish()
    }
}
