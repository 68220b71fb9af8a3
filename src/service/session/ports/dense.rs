//! Corrections that have a value for each vertex.

use std::mem::MaybeUninit;

use iceoryx2::port::publisher::Publisher;
use untangled_proto::{CorrectionHeader, VertexCorrection};
use untangled_transport::services::{CorrectionService, Ipc};

use super::finish::Finish;
use crate::service::{error::ServeError, session::publish::Values};

/// Sends dense corrections. Fields are dropped in order: ports before services.
///
/// Samples lie in a few places of shared memory that take turns. Most vertices of most frames have no correction, so it
/// is remembered for each place which of them had one, and only these are written again: an untangled frame costs
/// nothing for each vertex. A host that writes into samples that were lent to it to read harms itself only.
#[derive(Debug)]
pub(super) struct DenseSamples {
    publisher: Publisher<Ipc, [VertexCorrection], CorrectionHeader>,
    places: Vec<Place>,
    _service: CorrectionService,
}

/// A place of a sample in which all vertices are at rest but some.
#[derive(Debug)]
struct Place {
    address: usize,
    touched: Vec<u32>,
}

impl DenseSamples {
    pub(super) fn new(
        publisher: Publisher<Ipc, [VertexCorrection], CorrectionHeader>,
        service: CorrectionService,
    ) -> Self {
        Self { publisher, places: Vec::new(), _service: service }
    }

    pub(super) fn send(
        &mut self,
        values: Option<&Values<'_>>,
        finish: Finish<'_, impl FnOnce(&CorrectionHeader)>,
    ) -> Result<(), ServeError> {
        let mut sample = self
            .publisher
            .loan_slice_uninit(self.publisher.initial_max_slice_len())
            .map_err(|error| ServeError::transport("loaning a correction", &error))?;
        let vertices = sample.payload_mut();
        let address = vertices.as_ptr().addr();
        let place = self.places.iter().position(|place| place.address == address);
        match values {
            Some(values) => {
                let place = place.unwrap_or_else(|| {
                    write_all(vertices, |vertex| values.rest(vertex));
                    self.places.push(Place { address, touched: Vec::new() });
                    self.places.len() - 1
                });
                self.make_room(values.touched().len());
                write_touched(vertices, &mut self.places[place].touched, values);
            }
            // Rare, so the place counts as one that was never written.
            None => {
                write_all(vertices, |_| VertexCorrection::default());
                place.map(|place| self.places.swap_remove(place));
            }
        }
        // SAFETY: every vertex was written when this place was first lent, and only vertices were written there since.
        let mut sample = unsafe { sample.assume_init() };
        *sample.user_header_mut() = finish.header();
        sample.send().map_err(|error| ServeError::transport("sending a correction", &error))?;
        Ok(())
    }

    /// Makes room in all places at once, so that no later frame of this size allocates.
    fn make_room(&mut self, num_touched: usize) {
        for place in &mut self.places {
            place.touched.reserve(num_touched.saturating_sub(place.touched.len()));
        }
    }
}

fn write_all(vertices: &mut [MaybeUninit<VertexCorrection>], mut value: impl FnMut(usize) -> VertexCorrection) {
    for (index, vertex) in vertices.iter_mut().enumerate() {
        vertex.write(value(index));
    }
}

/// Puts the vertices to rest that the frame before left otherwise, and writes those of this frame.
fn write_touched(vertices: &mut [MaybeUninit<VertexCorrection>], touched: &mut Vec<u32>, values: &Values<'_>) {
    for vertex in touched.drain(..) {
        let index = vertex as usize;
        vertices[index].write(values.rest(index));
    }
    for vertex in values.touched() {
        vertices[vertex.index()].write(values.vertex(vertex.index()));
        touched.push(vertex.0);
    }
}
