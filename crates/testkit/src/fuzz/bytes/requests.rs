//! Registrations and settings, as the daemon reads them.

use untangle::{frame::Frame, settings::Settings, untangler::Untangler};
use untangled::service::ServeOptions;
use untangled_mesh_io::Printable;
use untangled_proto::{
    limits::MAX_SECTIONS,
    sections::{SectionWriter, Sections, id},
};
use untangled_transport::Domain;

use super::clouds::corner;
use crate::{
    fuzz::checks::{check_frame, check_mesh},
    intake::{read_registration, read_settings},
};

/// Limits that keep what is accepted small.
fn options() -> ServeOptions {
    let domain = Domain::new("fuzz", None, 0).expect("the name is short");
    ServeOptions { max_vertices: 200, max_faces: 200, ..ServeOptions::new(domain) }
}

fn check_words(words: &str) {
    assert!(!words.is_empty(), "a refusal says what is wrong");
    assert_eq!(Printable(words).to_string(), words, "a refusal is one line that a terminal may show");
}

/// One byte of the number of sections, then the payload. Sections that were read, written again, are read the same.
pub(super) fn registration(bytes: &[u8]) -> bool {
    let Some((&num_sections, payload)) = bytes.split_first() else { return false };
    if let Ok(sections) = Sections::parse(payload, usize::from(num_sections)) {
        check_sections(&sections);
    }
    let (mesh, settings) = match read_registration(payload, num_sections.into(), &options()) {
        Ok(accepted) => accepted,
        Err(words) => {
            check_words(&words);
            return false;
        }
    };
    assert_eq!(settings.validate(), Ok(()));
    check_mesh(&mesh);
    let places = (0..mesh.num_vertices()).map(|vertex| corner(vertex as u8));
    let mut frame = Frame::default();
    frame.set(&mesh, places).expect("positions are finite");
    check_frame(&mut Untangler::new(mesh, settings).expect("settings were checked"), &frame);
    true
}

fn check_sections(sections: &Sections<'_>) {
    let mut writer = SectionWriter::default();
    let present: Vec<_> = (0..64).filter_map(|id| Some((id, sections.bytes(id)?))).collect();
    assert!(present.len() <= MAX_SECTIONS);
    for &(id, bytes) in &present {
        writer.bytes(id, bytes.to_vec());
    }
    let (payload, num_sections) = writer.finish();
    let again = Sections::parse(&payload, num_sections as usize).expect("what was written is read");
    for (id, bytes) in present {
        assert_eq!(again.bytes(id), Some(bytes), "section {id} comes back");
    }
}

/// A document of settings. What is accepted can be used, and means the same when it is written and read again.
pub(super) fn settings(bytes: &[u8]) -> bool {
    let read = |document: &[u8]| {
        let (payload, num_sections) = SectionWriter::default().bytes(id::SETTINGS, document.to_vec()).finish();
        read_settings(&payload, num_sections, &options())
    };
    let settings = match read(bytes) {
        Ok(settings) => settings,
        Err(words) => {
            check_words(&words);
            return false;
        }
    };
    assert_eq!(settings.validate(), Ok(()));
    let written = serde_json::to_vec(&settings).expect("settings are written");
    let again: Settings = read(&written).unwrap_or_else(|error| panic!("what was written is read: {error}"));
    assert_eq!(again, settings, "settings come back");
    true
}
