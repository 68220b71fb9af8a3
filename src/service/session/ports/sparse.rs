//! Corrections that list only the vertices that have one, and labels.

use iceoryx2::port::publisher::Publisher;
use untangled_proto::{CorrectionHeader, SessionOptions, VertexLabel, correction::sparse::LABEL_WORDS};
use untangled_transport::services::{Ipc, SparseService};

use super::{finish::Finish, labels::Labels};
use crate::service::{error::ServeError, session::publish::Values};

/// Sends sparse corrections. Fields are dropped in order: ports before services.
#[derive(Debug)]
pub(super) struct SparseSamples {
    publisher: Publisher<Ipc, [u32], CorrectionHeader>,
    has_labels: bool,
    /// The payload, written before its length is known.
    words: Vec<u32>,
    labels: Labels,
    _service: SparseService,
}

impl SparseSamples {
    pub(super) fn new(
        publisher: Publisher<Ipc, [u32], CorrectionHeader>,
        service: SparseService,
        options: SessionOptions,
    ) -> Self {
        let has_labels = options.has_labels();
        Self { publisher, has_labels, words: Vec::new(), labels: Labels::default(), _service: service }
    }

    pub(super) fn send(
        &mut self,
        values: Option<&Values<'_>>,
        finish: Finish<'_, impl FnOnce(&CorrectionHeader)>,
    ) -> Result<(), ServeError> {
        self.words.clear();
        if let Some(values) = values {
            finish.header.num_values = write_entries(&mut self.words, values);
            if self.has_labels {
                let room = (self.publisher.initial_max_slice_len() - self.words.len()) / LABEL_WORDS;
                finish.header.num_labels = self.write_labels(values, room);
            }
        }
        let sample = self
            .publisher
            .loan_slice_uninit(self.words.len())
            .map_err(|error| ServeError::transport("loaning a correction", &error))?;
        let mut sample = sample.write_from_slice(&self.words);
        *sample.user_header_mut() = finish.header();
        sample.send().map_err(|error| ServeError::transport("sending a correction", &error))?;
        Ok(())
    }

    fn write_labels(&mut self, values: &Values<'_>, room: usize) -> u32 {
        let mut num_labels = 0;
        self.labels.fit(values.labels(), room, |VertexLabel { vertex, label }| {
            self.words.extend([vertex, label]);
            num_labels += 1;
        });
        num_labels
    }
}

/// Writes an entry for each vertex that has a value or a flag other than pinned; how many there are.
fn write_entries(words: &mut Vec<u32>, values: &Values<'_>) -> u32 {
    let mut num_values = 0;
    for entry in values.entries() {
        words.extend(entry.to_words());
        num_values += 1;
    }
    num_values
}
