//! The exchange that `PROTOCOL.md` prints is what this crate writes.
#![allow(clippy::unwrap_used, reason = "a test")]

use untangled_proto::{
    CorrectionHeader, CorrectionKind, PROTOCOL_VERSION, PositionF32, Precision, RegisterParams, ReplyHeader,
    RequestHeader, RequestKind, StateHeader, Status, VertexCorrection,
    correction::NO_FAULT,
    names::{self, SessionService},
    sections::{SectionWriter, Sections, id},
};

const TOKEN: [u64; 2] = [0x1122_3344_5566_7788, 0x99aa_bbcc_ddee_ff00];
const INSTANCE: u64 = 0x0123_4567_89ab_cdef;

/// The bytes of a struct of the wire.
fn bytes<T>(value: &T) -> Vec<u8> {
    // SAFETY: `layout.rs` pins the structs that are passed here: plain numbers without padding, all of them written.
    unsafe { std::slice::from_raw_parts(std::ptr::from_ref(value).cast::<u8>(), size_of::<T>()) }.to_vec()
}

/// The blocks of bytes in the page, in order.
fn printed() -> Vec<Vec<u8>> {
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/PROTOCOL.md")).unwrap();
    let blocks = page.split("```hex\n").skip(1).map(|rest| rest.split("```").next().unwrap().to_owned());
    let line = |line: &str| -> Vec<u8> {
        line.split_whitespace().skip(1).map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect()
    };
    blocks.map(|block| block.lines().flat_map(line).collect()).collect()
}

/// The registration of the page: its header and its payload.
fn registration() -> (RequestHeader, Vec<u8>) {
    let params = RegisterParams {
        num_vertices: 3,
        precision: Precision::F32 as u32,
        correction: CorrectionKind::Displacement as u32,
        reserved: [0; 2],
    };
    let (payload, num_sections) = SectionWriter::default()
        .bytes(id::PARAMS, params.to_bytes().to_vec())
        .u32s(id::TRIANGLES, &[[0, 1, 2]])
        .bytes(id::SETTINGS, br#"{"quality":"fast"}"#.to_vec())
        .finish();
    let header = RequestHeader {
        protocol_version: PROTOCOL_VERSION,
        kind: RequestKind::Register as u32,
        num_sections,
        token: TOKEN,
        ..RequestHeader::default()
    };
    (header, payload)
}

#[test]
fn exchange_of_the_page_has_the_bytes_that_are_written() {
    let (request, payload) = registration();
    let reply = ReplyHeader {
        protocol_version: PROTOCOL_VERSION,
        status: Status::Ok.code(),
        instance: INSTANCE,
        session: 7,
        token: TOKEN,
        ..ReplyHeader::default()
    };
    let step = 1.0 / 64.0;
    let state = StateHeader { frame: 1, dt_s: step, num_vertices: 3, ..StateHeader::default() };
    let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(PositionF32);
    let correction = CorrectionHeader {
        frame: 1,
        dt_s: step,
        status: Status::Ok.code(),
        kind: CorrectionKind::Displacement as u32,
        num_vertices: 3,
        fault_index: NO_FAULT,
        ..CorrectionHeader::default()
    };
    let expected = [
        bytes(&request),
        payload.clone(),
        bytes(&reply),
        bytes(&state),
        bytes(&positions),
        bytes(&correction)[..56].to_vec(),
        bytes(&[VertexCorrection::default(); 3]),
    ];
    let printed = printed();
    assert_eq!(printed.len(), expected.len());
    for (k, (printed, expected)) in printed.iter().zip(&expected).enumerate() {
        assert_eq!(printed, expected, "block {k} of the page, counted from 0");
    }
    assert_eq!(names::session(INSTANCE, 7, SessionService::State), "untangled/0123456789abcdef/7/state");
    // What is read back is what was said.
    let sections = Sections::parse(&printed[1], 3).unwrap();
    assert_eq!(sections.u32s(id::TRIANGLES).unwrap(), Some(vec![[0, 1, 2]]));
    assert_eq!(sections.bytes(id::SETTINGS), Some(&br#"{"quality":"fast"}"#[..]));
}
