//! What a host end says of itself: beside a daemon's report, and as a document of its own.

use serde_json::{Value, json};
use untangled_proto::{LIBRARY_VERSION, ReplyHeader, Status};

use super::shared::Shared;

/// The report of this host end.
pub(crate) fn report(shared: &Shared) -> Value {
    let mut sessions = Vec::new();
    shared.sessions.for_each(|session| {
        sessions.push(json!({
            "session": session.id,
            "daemon": &*session.remote.daemon,
            "remote_session": session.remote.session,
            "num_faces": session.num_faces,
            "num_frames": session.num_frames(),
        }));
    });
    let daemons = shared.directory.list().into_iter().map(|listed| {
        json!({
            "name": &*listed.name,
            "serves": listed.serves,
            "silent_s": listed.silent_s,
            "library_version": listed.beacon.versions.library,
            "iceoryx2_version": listed.beacon.versions.iceoryx2,
            "num_faces": listed.beacon.num_faces,
            "num_workers": listed.beacon.num_workers,
        })
    });
    let mut report = shared.metrics.report();
    report["end"] = "host".into();
    report["name"] = shared.name.as_str().into();
    report["domain"] = shared.domain.name().into();
    report["pid"] = std::process::id().into();
    report["library_version"] = LIBRARY_VERSION.into();
    report["daemons"] = daemons.collect();
    report["sessions"] = sessions.into();
    report
}

/// A daemon's status reply with the report of this end in it, as `bridge`; all else stays as it came.
pub(crate) fn add(shared: &Shared, mut payload: Vec<u8>, header: ReplyHeader) -> (Vec<u8>, ReplyHeader) {
    if header.status == Status::Ok.code() && payload.last() == Some(&b'}') && payload.len() > 2 {
        payload.pop();
        payload.extend_from_slice(b",\"bridge\":");
        payload.extend_from_slice(report(shared).to_string().as_bytes());
        payload.push(b'}');
    }
    (payload, header)
}
