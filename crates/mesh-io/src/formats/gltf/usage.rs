//! What else uses the data of a document: positions that are something else too are not replaced.

use super::{
    data::accessor,
    document::{Accessor, Document},
};

/// What accessors and meshes are used by. Found once for a document.
#[derive(Debug)]
pub(crate) struct Usage {
    /// Number of nodes that have each mesh.
    pub(crate) num_nodes_of_mesh: Vec<usize>,
    /// What each accessor is.
    pub(crate) uses: Vec<Use>,
    /// For each accessor what its bytes are too, in words.
    pub(crate) shared_bytes: Vec<Option<String>>,
}

/// What an accessor is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Use {
    Nothing,
    /// The positions of one mesh.
    Positions(usize),
    /// Anything else, or several things.
    Other,
}

impl Usage {
    /// Cost: O(n log n) for a document of `n` accessors, nodes and primitives, unless many accessors run through the
    /// same bytes.
    pub(crate) fn of(document: &Document) -> Self {
        let mut num_nodes_of_mesh = vec![0; document.meshes.len()];
        for mesh in document.nodes.iter().filter_map(|node| node.mesh) {
            num_nodes_of_mesh[mesh.0] += 1;
        }
        Self { num_nodes_of_mesh, uses: uses(document), shared_bytes: shared_bytes(document) }
    }
}

fn uses(document: &Document) -> Vec<Use> {
    let mut uses = vec![Use::Nothing; document.accessors.len()];
    let mut add = |accessor: usize, found: Use| {
        if let Some(slot) = uses.get_mut(accessor) {
            *slot = if *slot == Use::Nothing || *slot == found { found } else { Use::Other };
        }
    };
    for (mesh, primitive) in
        document.meshes.iter().enumerate().flat_map(|(at, mesh)| mesh.primitives.iter().map(move |one| (at, one)))
    {
        for (name, accessor) in &primitive.attributes {
            add(accessor.0, if name == "POSITION" { Use::Positions(mesh) } else { Use::Other });
        }
        for accessor in primitive.indices.iter().chain(primitive.targets.iter().flat_map(|target| target.values())) {
            add(accessor.0, Use::Other);
        }
    }
    for accessor in document.skins.iter().filter_map(|skin| skin.inverse_bind_matrices) {
        add(accessor.0, Use::Other);
    }
    for sampler in document.animations.iter().flat_map(|animation| &animation.samplers) {
        for accessor in sampler.input.iter().chain(&sampler.output) {
            add(accessor.0, Use::Other);
        }
    }
    uses
}

/// The bytes of an accessor: `count` elements of `width`, `stride` apart, of which the first starts at `start`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bytes {
    pub(crate) buffer: usize,
    pub(crate) start: usize,
    pub(crate) stride: usize,
    pub(crate) width: usize,
    pub(crate) count: usize,
}

impl Bytes {
    /// The bytes of an accessor of scalars or vectors, without its sparse elements; `None` without elements or without
    /// a buffer.
    pub(crate) fn of_elements(document: &Document, accessor: &Accessor) -> Option<Self> {
        let view = &document.buffer_views[accessor.buffer_view?.0];
        let (kind, num_components) = accessor::element(accessor)?;
        let (width, count) = (num_components * kind.size(), accessor.count.0);
        let start = view.byte_offset.0.checked_add(accessor.byte_offset.0)?;
        let stride = view.byte_stride.map_or(width, |stride| stride.0).max(width);
        (count > 0).then_some(Self { buffer: view.buffer.0, start, stride, width, count })
    }

    /// All bytes of a view.
    fn of_view(document: &Document, view: usize) -> Option<Self> {
        let view = document.buffer_views.get(view)?;
        let width = view.byte_length.0;
        let (buffer, start) = (view.buffer.0, view.byte_offset.0);
        (width > 0).then_some(Self { buffer, start, stride: width, width, count: 1 })
    }

    fn end(&self) -> usize {
        self.start.saturating_add((self.count - 1).saturating_mul(self.stride)).saturating_add(self.width)
    }

    /// Whether the two share a byte; interleaved attributes share none.
    fn overlaps(&self, other: &Self) -> bool {
        if self.buffer != other.buffer || self.start >= other.end() || other.start >= self.end() {
            return false;
        }
        if self.stride != other.stride {
            return true;
        }
        let stride = self.stride;
        let shift = (other.start % stride + stride - self.start % stride) % stride;
        shift < self.width || shift + other.width > stride
    }
}

/// Bytes and what they are: elements or sparse parts of an accessor, or an image.
struct Owned {
    bytes: Bytes,
    owner: Owner,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Owner {
    Accessor(usize),
    Sparse(usize),
    Image(usize),
}

/// Most comparisons for each run of bytes; interleaved attributes need some ten.
const MOST_COMPARISONS: usize = 1_000;

/// For each accessor what its bytes are too, in words.
fn shared_bytes(document: &Document) -> Vec<Option<String>> {
    let mut all = owned_bytes(document);
    all.sort_by_key(|owned| (owned.bytes.buffer, owned.bytes.start, owned.owner));
    let mut found: Vec<Option<Owner>> = vec![None; document.accessors.len()];
    let mut note = |one: Owner, other: Owner| {
        if let Owner::Accessor(at) = one {
            found[at] = Some(found[at].map_or(other, |known| known.min(other)));
        }
    };
    let most = all.len().saturating_mul(MOST_COMPARISONS);
    let mut num_comparisons = 0;
    // Those that may reach beyond the start of the next one.
    let mut open: Vec<&Owned> = Vec::new();
    for next in &all {
        open.retain(|one| one.bytes.buffer == next.bytes.buffer && one.bytes.end() > next.bytes.start);
        num_comparisons += open.len();
        if num_comparisons > most {
            return vec![Some("too many others to tell".to_owned()); document.accessors.len()];
        }
        for one in &open {
            if one.bytes.overlaps(&next.bytes) {
                note(one.owner, next.owner);
                note(next.owner, one.owner);
            }
        }
        open.push(next);
    }
    let words = |owner: Owner| match owner {
        Owner::Accessor(at) => format!("accessor {at}"),
        Owner::Sparse(at) => format!("the sparse elements of accessor {at}"),
        Owner::Image(at) => format!("image {at}"),
    };
    found.into_iter().map(|owner| owner.map(words)).collect()
}

fn owned_bytes(document: &Document) -> Vec<Owned> {
    let mut all = Vec::new();
    let mut add = |owner, bytes: Option<Bytes>| all.extend(bytes.map(|bytes| Owned { bytes, owner }));
    for (at, accessor) in document.accessors.iter().enumerate() {
        if let Some(view) = accessor.buffer_view {
            // The layout of matrices does not matter here.
            let is_plain = accessor::element(accessor).is_some();
            let elements = || Bytes::of_elements(document, accessor);
            add(Owner::Accessor(at), if is_plain { elements() } else { Bytes::of_view(document, view.0) });
        }
        if let Some(sparse) = &accessor.sparse {
            for view in [sparse.indices.buffer_view, sparse.values.buffer_view] {
                add(Owner::Sparse(at), Bytes::of_view(document, view.0));
            }
        }
    }
    for (at, view) in document.images.iter().enumerate().filter_map(|(at, image)| Some((at, image.buffer_view?))) {
        add(Owner::Image(at), Bytes::of_view(document, view.0));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_of_interleaved_attributes_do_not_overlap() {
        let bytes = |start, stride, width| Bytes { buffer: 0, start, stride, width, count: 10 };
        let positions = bytes(4, 32, 12);
        for (other, expected) in [
            (bytes(16, 32, 12), false),
            (bytes(28, 32, 8), false),
            (bytes(0, 32, 4), false),
            (bytes(28, 32, 12), true),
            (bytes(12, 32, 4), true),
            (bytes(0, 12, 12), true),
            (bytes(4 + 9 * 32 + 12, 12, 12), false),
            (Bytes { buffer: 1, ..positions }, false),
        ] {
            assert_eq!((positions.overlaps(&other), other.overlaps(&positions)), (expected, expected), "{other:?}");
        }
    }
}
