//! What is refused, and with which words; and the smallest meshes.

use std::{ops::ControlFlow, sync::Arc};

use untangle::{
    frame::{Frame, FrameError},
    mesh::{Mesh, MeshDescription, MeshError, Uvs},
    relax::{RelaxError, RelaxSettings, relax},
    settings::Settings,
    untangler::Untangler,
};
use untangled_proto::{PositionF32, PositionF64, StateHeader};

use crate::intake::{Positions, accept_state};
use crate::numerics::{
    answer::{check_all_responses, frame},
    case::{Case, Chapter, Seen, ensure},
};

const BAD: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

pub(super) fn chapter() -> Chapter {
    let mut cases = number_cases();
    cases.extend(settings_cases());
    cases.push(Case::new(
        "a frame's header with `dt_s` or `simulated_s` NaN or infinite, `dt_s` 0, below 1e-9 or above 1e9",
        "status `BadHeader`, with the value",
        |_| in_header(),
    ));
    cases.extend(mesh_cases());
    Chapter {
        title: "What is refused",
        text: "Every field that holds a number was given each value in each of its places; the words are those of the \
               last one. Files: `tests/command_line/check/formats.rs`. Registrations and frames over the wire, byte by \
               byte: `tests/daemon/fuzz.rs`.",
        cases,
    }
}

/// Numbers in meshes and positions.
fn number_cases() -> Vec<Case> {
    let section = "`MeshError::SectionValue` with section, entry and value";
    let coordinate = "`FrameError::Coordinate` with vertex, axis and value";
    vec![
        Case::new("`MeshDescription::uvs`, NaN and both infinities in each place", section, |_| in_uvs()),
        Case::new("`MeshDescription::rest_positions`, the same", section, |_| in_rest_positions()),
        Case::new("`MeshDescription::masses_kg`, the same, and below zero", section, |_| in_masses()),
        Case::new("positions in f64, the same, and beyond 2^250", coordinate, |_| in_positions()),
        Case::new("positions in f32, the same", coordinate, |_| in_single_positions()),
        Case::new("positions for `relax`, the same", "`RelaxError::Frame` with that error", |_| in_relaxed_positions()),
    ]
}

/// Numbers in settings.
fn settings_cases() -> Vec<Case> {
    let setting = "`SettingsError` with name and value";
    let mut cases = Vec::new();
    cases.push(Case::new("`Settings::stiffness_per_step2`, NaN, both infinities, below zero", setting, |_| {
        in_settings("stiffness_per_step2", &[f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0], |settings, value| {
            settings.stiffness_per_step2 = value;
        })
    }));
    cases.push(Case::new(
        "`Settings::max_step_edge_lengths`, NaN, minus infinity, below zero",
        "`SettingsError`; infinity is no limit",
        |_| {
            in_settings("max_step_edge_lengths", &[f64::NAN, f64::NEG_INFINITY, -1.0], |settings, value| {
                settings.max_step_edge_lengths = value;
            })
        },
    ));
    cases.push(Case::new("`Settings::steps_to_clean`, NaN, below 1", "`SettingsError`; infinity is allowed", |_| {
        in_settings("steps_to_clean", &[f64::NAN, f64::NEG_INFINITY, -1.0, 0.0, 0.99], |settings, value| {
            settings.steps_to_clean = value;
        })
    }));
    cases.push(Case::new("`Settings::thickness_m`, NaN, both infinities, below zero", setting, |_| {
        in_settings("thickness_m", &[f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0], |settings, value| {
            settings.thickness_m = Some(value);
        })
    }));
    cases.push(Case::new(
        "`Settings::min_centres` 0 and 2, `max_centres` 1001 and below `min_centres`",
        setting,
        |_| {
            in_settings("min_centres", &[0.0, 2.0], |settings, value| settings.min_centres = value as usize)?;
            in_settings("max_centres", &[4.0, 1001.0], |settings, value| settings.max_centres = value as usize)
        },
    ));
    cases
}

/// Meshes that are empty or hardly there.
fn mesh_cases() -> Vec<Case> {
    let mut cases = Vec::new();
    cases.push(Case::new("a mesh without vertices, or without faces", "`MeshError::Empty` with both counts", |_| {
        empty()
    }));
    cases.push(Case::new("a mesh of one face with a repeated index", "`MeshError::NoUsableFace`", |_| {
        let error = Mesh::new(triangles(3, vec![[0, 1, 1]])).unwrap_err();
        ensure(error == MeshError::NoUsableFace { num_faces: 1 }, || error.to_string())?;
        Ok(quoted(&error))
    }));
    cases.push(Case::new(
        "one triangle, also as a line or a point",
        "no intersection, no force with any response",
        |_| one_triangle(),
    ));
    cases
}

fn quoted(error: &dyn std::fmt::Display) -> String {
    format!("\"{error}\"")
}

fn triangles(num_vertices: usize, faces: Vec<[u32; 3]>) -> MeshDescription {
    MeshDescription { num_vertices, faces, ..MeshDescription::default() }
}

/// Whether an error names the value that was given, NaN included.
fn is_value(found: f64, given: f64) -> bool {
    found == given || (found.is_nan() && given.is_nan())
}

/// Refused descriptions of one triangle; `spoil` puts a value into a place of a section.
fn in_section(section: &str, values: &[f64], places: usize, spoil: impl Fn(&mut MeshDescription, usize, f64)) -> Seen {
    let mut words = String::new();
    for place in 0..places {
        for &given in values {
            let mut description = triangles(3, vec![[0, 1, 2]]);
            spoil(&mut description, place, given);
            let Err(error) = Mesh::new(description) else { return Err(format!("{given} was accepted")) };
            let MeshError::SectionValue { section: named, entry, value, .. } = error else {
                return Err(error.to_string());
            };
            let is_named = named == section && entry == place * 3 / places && is_value(value, given);
            ensure(is_named, || error.to_string())?;
            words = quoted(&error);
        }
    }
    Ok(words)
}

fn in_uvs() -> Seen {
    in_section("uv_coordinates", &BAD, 6, |description, place, value| {
        let mut coordinates = vec![[0.0; 2]; 3];
        coordinates[place / 2][place % 2] = value;
        description.uvs = Some(Uvs { coordinates, corners: vec![[0, 1, 2]] });
    })
}

fn in_rest_positions() -> Seen {
    in_section("rest_positions", &BAD, 9, |description, place, value| {
        let mut positions = vec![[0.0; 3]; 3];
        positions[place / 3][place % 3] = value;
        description.rest_positions = Some(positions);
    })
}

fn in_masses() -> Seen {
    in_section("masses", &[f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0], 3, |description, place, value| {
        let mut masses = vec![1.0; 3];
        masses[place] = value;
        description.masses_kg = Some(masses);
    })
}

/// Refused positions; `set` makes a frame of them.
fn in_places(values: &[f64], set: impl Fn(&Mesh, [[f64; 3]; 3]) -> Result<(), FrameError>) -> Seen {
    let mesh = Mesh::new(triangles(3, vec![[0, 1, 2]])).unwrap();
    let mut words = String::new();
    for place in 0..9 {
        for &given in values {
            let mut positions = [[0.0; 3]; 3];
            positions[place / 3][place % 3] = given;
            let Err(error) = set(&mesh, positions) else { return Err(format!("{given} was accepted")) };
            let FrameError::Coordinate { vertex, axis, value } = error else { return Err(error.to_string()) };
            let is_named = vertex == place / 3 && axis == ['x', 'y', 'z'][place % 3] && is_value(value, given);
            ensure(is_named, || error.to_string())?;
            words = quoted(&error);
        }
    }
    Ok(words)
}

fn in_positions() -> Seen {
    let values = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -f64::MAX, 2f64.powi(250).next_up()];
    in_places(&values, |mesh, positions| Frame::new(mesh, &positions).map(|_| ()))
}

fn in_single_positions() -> Seen {
    in_places(&BAD, |mesh, positions| {
        Frame::default().set(mesh, positions.iter().map(|position| position.map(|x| x as f32)))
    })
}

fn in_relaxed_positions() -> Seen {
    in_places(&BAD, |mesh, positions| {
        let end = relax(mesh, &positions, &RelaxSettings::default(), &mut |_| ControlFlow::Continue(()));
        end.map(|_| ()).map_err(|RelaxError::Frame(error)| error)
    })
}

fn in_settings(name: &str, values: &[f64], set: impl Fn(&mut Settings, f64)) -> Seen {
    let mesh = Arc::new(Mesh::new(triangles(3, vec![[0, 1, 2]])).unwrap());
    let mut words = String::new();
    for &given in values {
        let mut settings = Settings::default();
        set(&mut settings, given);
        let Err(error) = Untangler::new(mesh.clone(), settings) else { return Err(format!("{given} was accepted")) };
        ensure(error.name == name && is_value(error.value, given), || error.to_string())?;
        words = quoted(&error);
    }
    Ok(words)
}

fn in_header() -> Seen {
    let mesh = Mesh::new(triangles(3, vec![[0, 1, 2]])).unwrap();
    let good = StateHeader { frame: 1, dt_s: 0.01, num_vertices: 3, ..StateHeader::default() };
    let accepts = |header: StateHeader| {
        let [single, double] =
            [Positions::F32(&[PositionF32([0.0; 3]); 3]), Positions::F64(&[PositionF64([0.0; 3]); 3])];
        let accepted = [single, double].map(|positions| accept_state(&header, positions, &mesh, &mut Frame::default()));
        accepted.into_iter().all(|accepted| accepted)
    };
    for dt_s in [1e-9, 1e-3, 1.0, 1e9] {
        ensure(accepts(StateHeader { dt_s, ..good }), || format!("dt_s = {dt_s} was refused"))?;
    }
    for dt_s in BAD.into_iter().chain([0.0, -1.0, 0.9e-9, 1.1e9, f64::MAX]) {
        ensure(!accepts(StateHeader { dt_s, ..good }), || format!("dt_s = {dt_s} was accepted"))?;
    }
    for simulated_s in BAD {
        ensure(!accepts(StateHeader { simulated_s, ..good }), || format!("simulated_s = {simulated_s} was accepted"))?;
    }
    Ok("each refused; 1e-9, 1e-3, 1 and 1e9 accepted".into())
}

fn empty() -> Seen {
    let mut words = String::new();
    for (num_vertices, faces) in [(0, vec![]), (0, vec![[0, 1, 2]]), (3, vec![])] {
        let expected = MeshError::Empty { num_vertices, num_faces: faces.len() };
        let error = Mesh::new(triangles(num_vertices, faces)).unwrap_err();
        ensure(error == expected, || error.to_string())?;
        words = quoted(&error);
    }
    Ok(words)
}

fn one_triangle() -> Seen {
    let mesh = Arc::new(Mesh::new(triangles(3, vec![[0, 1, 2]])).unwrap());
    for positions in [
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]],
        [[1.0; 3]; 3],
    ] {
        let num_segments = check_all_responses(&mesh, &frame(&mesh, &positions)?)?;
        ensure(num_segments == 0, || format!("{num_segments} intersections"))?;
        let end = relax(&mesh, &positions, &RelaxSettings::default(), &mut |_| ControlFlow::Continue(()));
        let end = end.map_err(|error| error.to_string())?;
        ensure(end.positions == positions && end.blocked.is_empty(), || "`relax` moved it".into())?;
    }
    Ok("no intersection; `relax` returns it bit for bit".into())
}
