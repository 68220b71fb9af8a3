//! All vertices of sparse corrections, in memory that is used again.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use untangled_proto::{VertexCorrection, VertexEntry, flags};

/// Memory for all vertices of the corrections of a session that are held at a time.
#[derive(Debug)]
pub(crate) struct DenseViews {
    num_vertices: usize,
    pins: Box<[u32]>,
    idle: Mutex<Vec<Dense>>,
}

/// All vertices of one correction. Given back when it is dropped.
#[derive(Debug)]
pub(crate) struct DenseView {
    dense: Option<Dense>,
    views: Arc<DenseViews>,
}

/// Vertices of which all are at rest but some.
#[derive(Debug)]
struct Dense {
    vertices: Box<[VertexCorrection]>,
    touched: Vec<u32>,
}

impl DenseViews {
    /// None yet, for a session of so many vertices and these pins, vertices of bodies among them.
    pub(crate) fn new(num_vertices: usize, pins: &[u32]) -> Self {
        // Sorted for a search; as the daemon refuses pins out of range, nothing has to be said of them here.
        let mut pins: Box<[u32]> = pins.into();
        pins.sort_unstable();
        Self { num_vertices, pins, idle: Mutex::default() }
    }

    /// All vertices of a correction with these entries.
    ///
    /// Cost: linear in its entries and in those that the memory held before.
    pub(crate) fn view(views: &Arc<Self>, entries: &[VertexEntry]) -> DenseView {
        let mut dense = views.lock().pop().unwrap_or_else(|| views.rest());
        for vertex in dense.touched.drain(..) {
            dense.vertices[vertex as usize] = views.at_rest(vertex);
        }
        for &VertexEntry { vertex, value, flags } in entries {
            // A peer may have written there since it was checked.
            if let Some(slot) = dense.vertices.get_mut(vertex as usize) {
                *slot = VertexCorrection { value, flags };
                dense.touched.push(vertex);
            }
        }
        DenseView { dense: Some(dense), views: Arc::clone(views) }
    }

    /// Memory in which all vertices are at rest.
    fn rest(&self) -> Dense {
        let mut vertices = vec![VertexCorrection::default(); self.num_vertices].into_boxed_slice();
        for &vertex in &self.pins {
            if let Some(slot) = vertices.get_mut(vertex as usize) {
                slot.flags = flags::PINNED;
            }
        }
        Dense { vertices, touched: Vec::new() }
    }

    fn at_rest(&self, vertex: u32) -> VertexCorrection {
        let is_pinned = self.pins.binary_search(&vertex).is_ok();
        VertexCorrection { value: [0.0; 3], flags: if is_pinned { flags::PINNED } else { 0 } }
    }

    fn lock(&self) -> MutexGuard<'_, Vec<Dense>> {
        // A panic while it is held leaves no inconsistent state.
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl DenseView {
    pub(crate) fn vertices(&self) -> &[VertexCorrection] {
        self.dense.as_ref().map_or(&[], |dense| &dense.vertices)
    }
}

impl Drop for DenseView {
    fn drop(&mut self) {
        let dense = self.dense.take();
        self.views.lock().extend(dense);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_of_corrections_hold_nothing_of_those_before() {
        let entry = |vertex, flags| VertexEntry { vertex, value: [1.0, 0.0, -2.0], flags };
        let corrected = |flags| VertexCorrection { value: [1.0, 0.0, -2.0], flags };
        let [rest, pinned] = [0, flags::PINNED].map(|flags| VertexCorrection { value: [0.0; 3], flags });
        let views = Arc::new(DenseViews::new(4, &[3, 1]));
        let first = DenseViews::view(&views, &[entry(0, 2), entry(3, 9), entry(7, 1)]);
        assert_eq!(first.vertices(), [corrected(2), pinned, rest, corrected(9)]);
        let second = DenseViews::view(&views, &[]);
        assert_eq!(second.vertices(), [rest, pinned, rest, pinned]);
        drop(first);
        assert_eq!(DenseViews::view(&views, &[entry(2, 1)]).vertices(), [rest, pinned, corrected(1), pinned]);
        assert_eq!(views.lock().len(), 1, "the memory of the first is used again");
        drop(second);
    }
}
