//! The formulas of `untangled_proto::memory` against the segments that iceoryx2 makes.
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::os::unix::fs::MetadataExt;

use iceoryx2::{
    prelude::{AllocationStrategy, Node, SignalHandlingMode},
    service::header::{publish_subscribe, request_response},
};
use untangled_proto::{
    PayloadLayout, PositionF32, PositionF64, Precision, SessionOptions,
    memory::{
        REQUEST_SAMPLES, correction_segment_bytes, paths_sample_bytes, reply_sample_bytes, request_segment_bytes,
        session_bytes, sparse_words, state_segment_bytes,
    },
};
use untangled_transport::{
    Domain,
    lock::WipeOnLeave,
    memory, node,
    services::{self, Ipc, Position},
};

const LAYOUTS: [PayloadLayout; 2] = [PayloadLayout::Packed, PayloadLayout::Padded];

/// A node in a domain of its own, which is removed with it.
struct Place {
    node: Node<Ipc>,
    domain: Domain,
    _wipe: WipeOnLeave,
    _base: Base,
}

struct Base(std::path::PathBuf);

impl Drop for Base {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

impl Place {
    fn new(name: &str) -> Self {
        let base = std::env::temp_dir().join(format!("seg-{}-{name}", std::process::id()));
        let domain = Domain::new(name, Some(&base), rustix::process::getuid().as_raw()).unwrap();
        domain.create_folders().unwrap();
        let node = node::create(&domain.config().unwrap(), SignalHandlingMode::Disabled).unwrap();
        Self { node, _wipe: WipeOnLeave(domain.clone()), domain, _base: Base(base) }
    }

    /// Lengths of the domain's files in shared memory whose name has this part, and what they take when all of their
    /// pages are taken.
    fn files(&self, part: &str) -> Vec<u64> {
        let entries = std::fs::read_dir(memory::FOLDER).unwrap().flatten();
        let names = entries.filter(|entry| {
            let name = entry.file_name().into_string().unwrap_or_default();
            name.starts_with(self.domain.prefix()) && name.contains(part)
        });
        names.map(|entry| entry.metadata().unwrap().size().next_multiple_of(4096)).collect()
    }

    /// The segment of a port that has no connections.
    fn segment(&self, port: u128) -> u64 {
        let files = self.files(&port.to_string());
        let [bytes] = files[..] else { panic!("{files:?}") };
        assert_eq!(memory::commit(&self.domain, port).unwrap().next_multiple_of(4096), bytes);
        bytes
    }

    fn states<P: Position>(&self, name: &str, num_vertices: usize, layout: PayloadLayout) -> u64 {
        let service = P::create_states(&self.node, name, layout).unwrap();
        let port = service.publisher_builder().initial_max_slice_len(num_vertices).max_loaned_samples(1).create();
        self.segment(port.unwrap().id().value())
    }
}

#[track_caller]
fn assert_close(formula: u64, made: u64, what: &str) {
    assert!(formula >= made && formula - made <= 4096, "{what}: the formula says {formula}, made were {made}");
}

#[test]
fn segments_of_states_and_corrections_are_what_the_formulas_say() {
    let place = Place::new("frames");
    for (k, layout) in LAYOUTS.into_iter().enumerate() {
        for num_vertices in [1, 3, 1000, 40_000] {
            let what = format!("{num_vertices} vertices, {layout:?}");
            let name = |kind: &str| format!("test/{kind}/{k}/{num_vertices}");
            let made = place.states::<PositionF32>(&name("f32"), num_vertices, layout);
            assert_close(state_segment_bytes(num_vertices, Precision::F32, layout), made, &what);
            let made = place.states::<PositionF64>(&name("f64"), num_vertices, layout);
            assert_close(state_segment_bytes(num_vertices, Precision::F64, layout), made, &what);
            let service = services::create_corrections(&place.node, &name("correction"), layout).unwrap();
            let port = service.publisher_builder().initial_max_slice_len(num_vertices).max_loaned_samples(1).create();
            let made = place.segment(port.unwrap().id().value());
            assert_close(correction_segment_bytes(num_vertices, layout, SessionOptions::default()), made, &what);
        }
    }
}

#[test]
fn segments_of_sparse_corrections_are_what_the_formula_says() {
    let place = Place::new("sparse");
    for options in [SessionOptions::SPARSE, SessionOptions::LABELS] {
        for num_vertices in [1, 3, 1000, 40_000] {
            let name = format!("test/sparse/{}/{num_vertices}", options.bits());
            let service = services::create_sparse_corrections(&place.node, &name).unwrap();
            let words = sparse_words(num_vertices, options);
            let port = service.publisher_builder().initial_max_slice_len(words).max_loaned_samples(1).create();
            let made = place.segment(port.unwrap().id().value());
            for layout in LAYOUTS {
                let what = format!("{num_vertices} vertices, {options:?}, {layout:?}");
                assert_close(correction_segment_bytes(num_vertices, layout, options), made, &what);
            }
        }
    }
}

#[test]
fn segments_of_requests_are_what_the_formula_says() {
    let place = Place::new("requests");
    for layout in LAYOUTS {
        let service = services::create_requests(&place.node, layout).unwrap();
        for bytes in [1, 100, 4097, 1_000_000] {
            let port = service
                .client_builder()
                .initial_max_slice_len(bytes)
                .override_request_preallocation(|_| REQUEST_SAMPLES)
                .create()
                .unwrap();
            let made = place.segment(port.id().value());
            assert_close(request_segment_bytes(bytes, layout), made, &format!("{bytes} bytes, {layout:?}"));
        }
    }
}

/// Replies and paths lie in segments that grow; their formulas are of one sample.
#[test]
fn samples_of_replies_and_paths_are_what_the_formulas_say() {
    let headers = [
        size_of::<publish_subscribe::Header>(),
        size_of::<request_response::RequestHeader>(),
        size_of::<request_response::ResponseHeader>(),
    ];
    assert_eq!(headers, [48, 64, 56], "iceoryx2's own headers");
    let place = Place::new("samples");
    for (layout, name) in LAYOUTS.into_iter().zip(["packed", "padded"]) {
        let service = services::create_requests(&place.node, layout).unwrap();
        let server = service
            .server_builder()
            .initial_max_slice_len(2048)
            .allocation_strategy(AllocationStrategy::PowerOfTwo)
            .max_loaned_responses_per_request(1)
            .create()
            .unwrap();
        // 64 clients, two requests of each under way, for each of them one reply waiting, held and being written.
        let num_samples = 64 * 2 * 3;
        let made: u64 = place.files(&server.id().value().to_string()).iter().sum();
        let formula = num_samples * reply_sample_bytes(2048, layout);
        assert!(made >= formula && made - formula < 16384, "{layout:?}: {formula}, made were {made}");
        let service = services::create_paths(&place.node, name, layout).unwrap();
        let port = service
            .publisher_builder()
            .initial_max_slice_len(4096)
            .allocation_strategy(AllocationStrategy::PowerOfTwo)
            .max_loaned_samples(1)
            .create()
            .unwrap();
        let made: u64 = place.files(&port.id().value().to_string()).iter().sum();
        // For each of 4 subscribers one waiting and 4 held, and one being written.
        let formula = 21 * paths_sample_bytes(4096, layout);
        assert!(made >= formula && made - formula < 16384, "{layout:?}: {formula}, made were {made}");
    }
}

#[test]
fn session_of_40000_vertices_fits_a_container() {
    const CONTAINER: u64 = 64 << 20;
    let num_vertices = 40_000;
    let session = session_bytes(num_vertices, Precision::F32, PayloadLayout::Packed, SessionOptions::default());
    // Triangles, texture coordinates with indices, rest positions and masses.
    let request = request_segment_bytes(num_vertices * (2 * 12 + 16 + 2 * 12 + 24 + 8), PayloadLayout::Packed);
    assert!(session + request < CONTAINER / 4, "{session} and {request} bytes");
    assert!(
        session_bytes(num_vertices, Precision::F32, PayloadLayout::Padded, SessionOptions::default()) < CONTAINER / 2,
        "for a 0.1 client"
    );
}
