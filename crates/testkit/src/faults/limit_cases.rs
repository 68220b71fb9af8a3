//! Requests whose fields stand at their limits or beyond.

use untangled_proto::{
    RegisterParams, RequestHeader, RequestKind,
    sections::{SectionWriter, id},
};

use crate::process::header;

/// Names of settings, one that there is not, and no name.
const SETTINGS: [&str; 16] = [
    "quality",
    "response",
    "inside",
    "layer_order",
    "winding",
    "pinned_outside",
    "stiffness_per_step2",
    "max_step_edge_lengths",
    "steps_to_clean",
    "thickness_m",
    "min_centres",
    "max_centres",
    "path_rings",
    "deadline_us",
    "unknown",
    "",
];
/// Values of JSON, most of which no setting takes.
const VALUES: [&str; 16] = [
    "0",
    "-1",
    "1",
    "3",
    "1000",
    "1001",
    "1e400",
    "-1e400",
    "1e-400",
    "18446744073709551616",
    "NaN",
    "null",
    "\"1\"",
    "[]",
    "{}",
    "true",
];

/// A request: its header and its payload.
type Request = (RequestHeader, Vec<u8>);

/// Sessions that don't exist: a request to close one that does would be obeyed, whichever peer sends it.
const NO_SESSIONS: [u64; 3] = [0, 1 << 40, u64::MAX];

/// All requests.
pub(super) fn limit_cases() -> Vec<Request> {
    let mut cases = header_cases();
    cases.extend(table_cases());
    cases.extend(params_cases());
    cases.extend(section_cases());
    cases.extend(settings_cases());
    cases
}

/// Each field of the header.
fn header_cases() -> Vec<Request> {
    let (payload, num_sections) = registration_with(0, None);
    let good = header(RequestKind::Register as u32, num_sections);
    let mut headers = Vec::new();
    for value in [0, 1, 2, u32::MAX - 1, u32::MAX] {
        headers.push(RequestHeader { protocol_version: value, ..good });
        headers.push(RequestHeader { flags: value, ..good });
        headers.push(RequestHeader { token: [u64::from(value); 2], ..good });
        headers.push(RequestHeader { reserved: [u64::from(value); 3], ..good });
    }
    for kind in (0..8).chain([u32::MAX]) {
        headers.extend(NO_SESSIONS.map(|session| RequestHeader { kind, session, ..good }));
    }
    for num_sections in [0, 1, 9, 10, 11, 32, 33, 1 << 31, u32::MAX] {
        headers.push(RequestHeader { num_sections, ..good });
    }
    headers.into_iter().map(|header| (header, payload.clone())).collect()
}

/// Each word of the first entries of the table of sections, and payloads that are too short.
fn table_cases() -> Vec<Request> {
    let (valid, num_sections) = registration_with(0, None);
    let good = header(RequestKind::Register as u32, num_sections);
    let mut payloads = Vec::new();
    for entry in 0..3 {
        for (at, width) in [(0, 4), (4, 4), (8, 8), (16, 8)] {
            for value in [0u64, 1, 7, 8, 9, 24, valid.len() as u64, 1 << 31, 1 << 63, u64::MAX] {
                let mut payload = valid.clone();
                payload[24 * entry + at..][..width].copy_from_slice(&value.to_le_bytes()[..width]);
                payloads.push(payload);
            }
        }
    }
    payloads.extend([0, 1, 23, 24, 239, 240, valid.len() - 1].map(|length| valid[..length].to_vec()));
    payloads.into_iter().map(|payload| (good, payload)).collect()
}

/// Each field of the parameters.
fn params_cases() -> Vec<Request> {
    let mut all = Vec::new();
    for num_vertices in [0, 1, 2, 3, 4, 1 << 24, (1 << 24) + 1, 1 << 32, u64::MAX] {
        for precision in [0, 1, 2, u32::MAX] {
            all.push(RegisterParams { num_vertices, precision, correction: 3, ..RegisterParams::default() });
        }
    }
    for correction in [0, 1, 2, 3, 4, u32::MAX] {
        all.push(RegisterParams { num_vertices: 3, precision: 0, correction, ..RegisterParams::default() });
    }
    all.into_iter().map(|params| section_case(id::PARAMS, Some(params.to_bytes().to_vec()))).collect()
}

/// Each section missing, of every wrong length, and with every extreme number.
fn section_cases() -> Vec<Request> {
    let mut cases = Vec::new();
    for section in 1..=id::BODY {
        cases.push(section_case(section, None));
        for length in [0, 1, 3, 4, 8, 11, 12, 16, 23, 24, 31, 33, 48, 72, 100] {
            cases.push(section_case(section, Some(vec![0; length])));
            cases.push(section_case(section, Some(vec![255; length])));
        }
    }
    for (section, count) in [(id::UV_COORDINATES, 6), (id::REST_POSITIONS, 9), (id::MASSES, 3)] {
        for value in [f64::NAN, f64::INFINITY, -1.0, f64::MAX, f64::MIN_POSITIVE, 1e300] {
            let bytes = vec![value; count].iter().flat_map(|x| x.to_le_bytes()).collect();
            cases.push(section_case(section, Some(bytes)));
        }
    }
    cases
}

/// Each settings document, with a registration and with a change of settings.
fn settings_cases() -> Vec<Request> {
    let mut cases: Vec<Request> =
        documents().into_iter().map(|document| section_case(id::SETTINGS, Some(document))).collect();
    for document in documents() {
        let (payload, num_sections) = SectionWriter::default().bytes(id::SETTINGS, document).finish();
        let update = header(RequestKind::UpdateSettings as u32, num_sections);
        cases.extend(NO_SESSIONS.map(|session| (RequestHeader { session, ..update }, payload.clone())));
    }
    cases
}

/// A registration whose section has these bytes, or is missing.
fn section_case(section: u32, bytes: Option<Vec<u8>>) -> Request {
    let (payload, num_sections) = registration_with(section, bytes);
    (header(RequestKind::Register as u32, num_sections), payload)
}

/// A valid registration with one section in place of its own; no bytes leave the section out.
fn registration_with(section: u32, bytes: Option<Vec<u8>>) -> (Vec<u8>, u32) {
    let params = RegisterParams { num_vertices: 3, precision: 0, correction: 0, ..RegisterParams::default() };
    let floats = |count: usize| vec![0.5f64; count].iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let indices = |values: &[u32]| values.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let valid = [
        (id::PARAMS, params.to_bytes().to_vec()),
        (id::TRIANGLES, indices(&[0, 1, 2])),
        (id::UV_COORDINATES, [0.0f64, 0.0, 1.0, 0.0, 0.0, 1.0].iter().flat_map(|x| x.to_le_bytes()).collect()),
        (id::UV_CORNERS, indices(&[0, 1, 2])),
        (
            id::REST_POSITIONS,
            [0.0f64, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect(),
        ),
        (id::MASSES, floats(3)),
        (id::PINS, indices(&[2])),
        (id::LAYERS, indices(&[0, 0, 1])),
        (id::SETTINGS, b"{}".to_vec()),
        (id::OPTIONS, indices(&[0])),
        (id::BODY, Vec::new()),
        (77, vec![1, 2, 3]),
    ];
    let mut writer = SectionWriter::default();
    for (id, content) in valid {
        match (id == section, &bytes) {
            (false, _) => drop(writer.bytes(id, content)),
            (true, Some(bytes)) => drop(writer.bytes(id, bytes.clone())),
            (true, None) => {}
        }
    }
    writer.finish()
}

/// Settings documents: values at and beyond limits, and bytes that are no text.
fn documents() -> Vec<Vec<u8>> {
    let mut documents = vec![
        vec![0xff, 0xfe, 0x00],
        b"{\"\xc3\x28\": 1}".to_vec(),
        b"{\"response\": \"\xf0\x9f\"}".to_vec(),
        b"{\"\\ud800\": 1}".to_vec(),
        vec![b' '; 1 << 20],
        vec![b' '; (1 << 20) + 1],
        [vec![b'['; 100_000], vec![b']'; 100_000]].concat(),
        format!("{{\"{}\": 1}}", "x".repeat(100_000)).into_bytes(),
        [b"{\"response\": \"".to_vec(), "\u{1F455}".repeat(50_000).into_bytes(), b"\"}".to_vec()].concat(),
    ];
    for name in SETTINGS {
        documents.extend(VALUES.iter().map(|value| format!("{{\"{name}\": {value}}}").into_bytes()));
    }
    documents
}
