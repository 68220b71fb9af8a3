//! From the bytes of a registration to a validated mesh, settings and options.

use std::sync::Arc;

use untangled_proto::{
    CorrectionKind, PayloadLayout, Precision, RegisterParams, SessionOptions, Status, limits, memory,
    sections::{SectionError, Sections, id},
};
use untangled_transport::memory as shared_memory;

use untangle::{
    mesh::{MeshDescription, Uvs},
    settings::{Quality, Repair, Settings},
};

use crate::{
    overlay,
    service::{
        error::Refusal,
        options::ServeOptions,
        session::{Cloth, Registered, memory_bytes},
    },
};

/// Reads and validates a registration of a session with this layout of samples. `reserved_bytes` of shared memory are
/// promised to other sessions already.
///
/// # Errors
/// [`Refusal`] with the element and the value at fault.
pub fn read(
    sections: &Sections<'_>,
    options: &ServeOptions,
    layout: PayloadLayout,
    reserved_bytes: u64,
) -> Result<Registered, Refusal> {
    let params = sections
        .bytes(id::PARAMS)
        .and_then(RegisterParams::from_bytes)
        .ok_or_else(|| Refusal::new(Status::BadRequest, "section 1 (parameters) must be there and have 32 bytes"))?;
    let num_vertices = usize::try_from(params.num_vertices).unwrap_or(usize::MAX);
    let num_faces = sections.bytes(id::TRIANGLES).map_or(0, <[u8]>::len) / 12;
    for (what, count, limit) in
        [("vertices", num_vertices, options.max_vertices), ("faces", num_faces, options.max_faces)]
    {
        if count > limit {
            return Err(Refusal::new(
                Status::TooLarge,
                format_args!("the mesh has {count} {what}; at most {limit} are allowed"),
            ));
        }
    }
    let precision = Precision::from_code(params.precision).ok_or_else(|| {
        Refusal::new(Status::BadRequest, format_args!("precision {} is not 0 (f32) or 1 (f64)", params.precision))
    })?;
    let correction = CorrectionKind::from_code(params.correction).ok_or_else(|| {
        Refusal::new(Status::BadRequest, format_args!("kind of correction {} is not 0 to 3", params.correction))
    })?;
    if correction == CorrectionKind::Force && sections.bytes(id::MASSES).is_none() {
        let message = "corrections as forces need the mass of each vertex; send masses, or ask for another kind";
        return Err(Refusal::new(Status::MassesRequired, message));
    }
    let asked = session_options(sections)?;
    let (estimate, limit) =
        (memory_bytes(num_vertices, num_faces, precision, layout, asked), options.max_session_memory_bytes);
    if estimate > limit {
        return Err(Refusal::new(
            Status::TooLarge,
            format_args!(
                "a session of {num_vertices} vertices and {num_faces} faces takes about {} MB of memory; \
                 at most {} MB are allowed (limits.max_session_memory_mb)",
                estimate.div_ceil(1_000_000),
                limit / 1_000_000
            ),
        ));
    }
    check_memory(memory::session_bytes(num_vertices, precision, layout, asked), reserved_bytes)?;
    let settings = settings(sections, options)?;
    let chosen = settings.repair;
    if chosen != Repair::Asked && chosen != options.settings.repair && !asked.has_repairs() {
        let message = "settings: repair: this session can't receive repairs; ask for them (section 10, option 4)";
        return Err(Refusal::new(Status::BadSettings, message));
    }
    let cloth = Arc::new(cloth(description(sections, num_vertices)?, asked)?);
    Ok(Registered { cloth, settings, precision, correction, layout, options: asked })
}

/// The cloth of a description, welded where that is asked for.
fn cloth(description: MeshDescription, asked: SessionOptions) -> Result<Cloth, Refusal> {
    if !asked.is_welded() {
        return Cloth::new(description).map_err(|error| Refusal::new(Status::BadMesh, error));
    }
    let Some(rest) = &description.rest_positions else {
        let message = "vertices are welded by their rest positions (section 10, option 8): send them (section 5), or \
                       else the positions with which the motion begins";
        return Err(Refusal::new(Status::BadRequest, message));
    };
    Cloth::welded(&description, rest).map_err(|error| Refusal::new(Status::BadMesh, error))
}

/// What a session asks for beyond what protocol 1 began with.
fn session_options(sections: &Sections<'_>) -> Result<SessionOptions, Refusal> {
    let refused = |message: &dyn std::fmt::Display| Err(Refusal::new(Status::BadRequest, message));
    let bits = match sections.u32s::<1>(id::OPTIONS).map_err(|error| Refusal::new(Status::BadRequest, error))? {
        None => 0,
        Some(bits) => match bits[..] {
            [[bits]] => bits,
            _ => return refused(&"section 10 (options) must have 4 bytes"),
        },
    };
    SessionOptions::from_bits(bits)
        .map_or_else(|| refused(&format_args!("options {bits} have bits that are not known")), Ok)
}

/// The settings of a request, merged over the daemon's own.
///
/// # Errors
/// [`Refusal`] with [`Status::BadSettings`] for a document that is too long or not JSON, or a bad name or value.
pub fn settings(sections: &Sections<'_>, options: &ServeOptions) -> Result<Settings, Refusal> {
    let Some(bytes) = sections.bytes(id::SETTINGS) else { return Ok(options.settings.clone()) };
    let refused = |error: &dyn std::fmt::Display| Refusal::new(Status::BadSettings, format_args!("settings: {error}"));
    if bytes.len() > limits::MAX_SETTINGS_BYTES {
        return Err(refused(&format_args!(
            "{} bytes; at most {} are allowed",
            bytes.len(),
            limits::MAX_SETTINGS_BYTES
        )));
    }
    // Copied first: the parser may read a byte more than once, and the peer may go on writing.
    let copy = bytes.to_vec();
    let chosen: serde_json::Map<String, serde_json::Value> =
        serde_json::from_slice(&copy).map_err(|error| refused(&error))?;
    merge(&options.settings, chosen).map_err(|words| refused(&words))
}

fn description(sections: &Sections<'_>, num_vertices: usize) -> Result<MeshDescription, Refusal> {
    let refused = |error: SectionError| Refusal::new(Status::BadRequest, error);
    let u32s = |id| {
        let values = sections.u32s::<1>(id).map_err(refused)?;
        Ok::<_, Refusal>(values.map(|values| values.as_flattened().to_vec()))
    };
    let coordinates = sections.f64s::<2>(id::UV_COORDINATES).map_err(refused)?;
    let corners = sections.u32s::<3>(id::UV_CORNERS).map_err(refused)?;
    let uvs = match (coordinates, corners) {
        (Some(coordinates), Some(corners)) => Some(Uvs { coordinates, corners }),
        (None, None) => None,
        _ => return Err(Refusal::new(Status::BadRequest, "sections 3 and 4 (texture coordinates) need each other")),
    };
    Ok(MeshDescription {
        num_vertices,
        faces: sections.u32s(id::TRIANGLES).map_err(refused)?.unwrap_or_default(),
        uvs,
        rest_positions: sections.f64s(id::REST_POSITIONS).map_err(refused)?,
        masses_kg: sections.f64s::<1>(id::MASSES).map_err(refused)?.map(|masses| masses.as_flattened().to_vec()),
        pins: u32s(id::PINS)?.unwrap_or_default(),
        layers: u32s(id::LAYERS)?,
        body: u32s(id::BODY)?.unwrap_or_default(),
    })
}

fn check_memory(needed: u64, reserved_bytes: u64) -> Result<(), Refusal> {
    match shared_memory::free() {
        Ok(free) if free < needed.saturating_add(reserved_bytes) => Err(Refusal::new(
            Status::NotEnoughMemory,
            format_args!(
                "the session needs {needed} bytes of shared memory; /dev/shm has {} left \
                 ({free} free, of which {reserved_bytes} are promised to sessions whose hosts have yet to take them)",
                free.saturating_sub(reserved_bytes)
            ),
        )),
        Ok(_) => Ok(()),
        Err(error) => Err(Refusal::new(Status::Internal, format_args!("/dev/shm: {error}"))),
    }
}

/// Merges `chosen`, settings by name, over `settings`. The name `quality` sets several settings first; the others
/// override it. The error says in words what is wrong.
fn merge(settings: &Settings, mut chosen: serde_json::Map<String, serde_json::Value>) -> Result<Settings, String> {
    let mut merged = settings.clone();
    if let Some(quality) = chosen.remove("quality") {
        let quality: Quality = serde_json::from_value(quality).map_err(|error| format!("quality: {error}"))?;
        quality.apply(&mut merged);
    }
    for (name, value) in chosen {
        merged = with_setting(&merged, &name, value)?;
    }
    merged.validate().map_err(|error| error.to_string())?;
    Ok(merged)
}

fn with_setting(settings: &Settings, name: &str, value: serde_json::Value) -> Result<Settings, String> {
    // As JSON, in which a setting without a value is null, so that all names are there.
    let all = serde_json::to_value(Settings::default()).map_err(|error| error.to_string())?;
    let known = all.as_object().ok_or("the settings are no object")?;
    let names = || ["quality"].into_iter().chain(known.keys().map(String::as_str));
    if !known.contains_key(name) {
        return Err(match overlay::nearest(name, names()) {
            Some(nearest) => format!("there is no setting `{name}`; did you mean `{nearest}`?"),
            None => format!("there is no setting `{name}`; there are {}", names().collect::<Vec<_>>().join(", ")),
        });
    }
    if value.is_null() {
        // A host that has no value may say so.
        if !known[name].is_null() {
            return Err(format!("{name}: null is no value"));
        }
        let mut table = toml::Table::try_from(settings).map_err(|error| error.to_string())?;
        table.remove(name);
        return table.try_into().map_err(|error: toml::de::Error| format!("{name}: {error}"));
    }
    let value = toml::Value::try_from(value).map_err(|error| format!("{name}: {error}"))?;
    overlay::replace(settings, &[name], value).map_err(|reason| format!("{name}: {reason}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use untangle::settings::Response;

    #[test]
    fn merge_takes_every_setting_by_its_name_and_null_where_it_needs_no_value() {
        let some = Settings {
            thickness_m: Some(0.1),
            deadline_us: Some(7),
            repair_deadline_us: Some(7),
            max_face_pairs: Some(7),
            max_tested_pairs: Some(7),
            ..Settings::default()
        };
        let values = serde_json::to_value(&some).unwrap();
        let values = values.as_object().unwrap();
        assert!(values.values().all(|value| !value.is_null()), "a setting without a value: {values:?}");
        assert_eq!(merge(&Settings::default(), values.clone()), Ok(some.clone()));
        let defaults = serde_json::to_value(Settings::default()).unwrap();
        for (name, default) in defaults.as_object().unwrap() {
            let chosen = serde_json::Map::from_iter([(name.clone(), serde_json::Value::Null)]);
            let merged = merge(&some, chosen);
            assert_eq!(merged.is_ok(), default.is_null(), "{name}: {merged:?}");
            if let Ok(merged) = merged {
                assert!(serde_json::to_value(merged).unwrap()[name].is_null(), "{name}");
            }
        }
    }

    #[test]
    fn merge_overrides_defaults_by_quality_and_quality_by_single_settings() {
        let chosen = |text: &str| merge(&Settings::default(), serde_json::from_str(text).unwrap());
        let mut fast = Settings::default();
        Quality::Fast.apply(&mut fast);
        assert_eq!(chosen(r#"{"quality": "fast"}"#).unwrap(), fast);
        let settings = chosen(r#"{"path_rings": 9, "quality": "fast", "response": "mask"}"#).unwrap();
        assert_eq!(settings, Settings { path_rings: 9, response: Response::Mask, ..fast });
        assert_eq!(chosen("{}").unwrap(), Settings::default());
        for bad in [r#"{"quality": "best"}"#, r#"{"quality": 3}"#, r#"{"deadline_us": 0}"#, r#"{"deadline_us": -1}"#] {
            assert!(chosen(bad).is_err(), "{bad}");
        }
        let words = |text: &str| chosen(text).unwrap_err();
        assert_eq!(words(r#"{"path_ring": 3}"#), "there is no setting `path_ring`; did you mean `path_rings`?");
        let all = words(r#"{"gravity": 3}"#);
        assert!(all.contains("there are quality, ") && all.contains("deadline_us"), "{all}");
        for (bad, name) in [(r#"{"path_rings": -1}"#, "path_rings"), (r#"{"quality": "best"}"#, "quality")] {
            let words = words(bad);
            assert!(words.starts_with(&format!("{name}: ")), "{words}");
            for internal in ["src/", "serde", "usize", "u32", "default."] {
                assert!(!words.contains(internal), "{words}");
            }
        }
        let none = chosen(r#"{"deadline_us": null}"#).unwrap();
        assert_eq!(none.deadline_us, None);
    }
}
