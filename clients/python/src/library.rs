//! The library without a daemon: analysis and repair of one state.

use std::ops::ControlFlow;

use pyo3::{
    exceptions::{PyRuntimeError, PyValueError},
    prelude::*,
    types::{PyByteArray, PyDict, PyList, PyString},
};
use untangle::{
    analysis::Analyser,
    frame::Frame,
    mesh::{Mesh, MeshDescription, Uvs},
    relax::{Effort, Iteration, RelaxSettings},
    settings::Settings,
    sides::{Layers, Sides},
};

use crate::{
    bytes::{f64s, of_f64s, of_u32s, u32s},
    repaired::{Repaired, Verdict, count_edge_face},
};

/// A mesh from Python: arrays as bytes, indices of u32 and numbers of f64.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Cloth {
    vertices: Vec<u8>,
    triangles: Vec<u8>,
    uvs: Option<Vec<u8>>,
    uv_corners: Option<Vec<u8>>,
    rest_positions: Option<Vec<u8>>,
    pins: Vec<u8>,
    layers: Option<Vec<u8>>,
    body: Vec<u8>,
}

impl Cloth {
    fn read(&self) -> PyResult<(Mesh, Vec<[f64; 3]>)> {
        let positions: Vec<[f64; 3]> = f64s("vertices", &self.vertices)?;
        let uvs = match (&self.uvs, &self.uv_corners) {
            (Some(uvs), Some(corners)) => {
                Some(Uvs { coordinates: f64s("uv", uvs)?, corners: u32s("uv_triangles", corners)? })
            }
            _ => None,
        };
        let rest_positions = self.rest_positions.as_deref().map(|rest| f64s("rest_positions", rest)).transpose()?;
        let layers = self.layers.as_deref().map(|layers| u32s::<1>("layers", layers)).transpose()?;
        let description = MeshDescription {
            num_vertices: positions.len(),
            faces: u32s("triangles", &self.triangles)?,
            uvs,
            rest_positions,
            masses_kg: None,
            pins: u32s::<1>("pins", &self.pins)?.into_flattened(),
            layers: layers.map(|layers| layers.into_flattened()),
            body: u32s::<1>("body", &self.body)?.into_flattened(),
        };
        let mesh = Mesh::new(description).map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok((mesh, positions))
    }
}

/// Analyses one state: counts, pairs, paths and inside vertices, by name; arrays are bytes.
#[pyfunction]
pub(crate) fn analyse<'py>(py: Python<'py>, cloth: Cloth, settings: &str) -> PyResult<Bound<'py, PyDict>> {
    let settings: Settings =
        serde_json::from_str(settings).map_err(|error| PyValueError::new_err(format!("settings: {error}")))?;
    settings.validate().map_err(|error| PyValueError::new_err(error.to_string()))?;
    let (mesh, positions) = cloth.read()?;
    let frame = Frame::new(&mesh, &positions).map_err(|error| PyValueError::new_err(error.to_string()))?;
    let mut analyser = Analyser::default();
    let analysis = py.detach(|| analyser.analyse(&mesh, &frame, &settings, &mut ()));

    let mut inside = vec![0u8; mesh.num_vertices()];
    for vertex in &analysis.regions.vertices {
        inside[vertex.index()] = 1;
    }
    let paths = PyList::empty(py);
    for (copy, path) in analysis.paths.copies.iter().enumerate() {
        let points = &analysis.paths.points[path.points.clone()];
        let segments = &analysis.paths.segments[path.segments.clone()];
        let faces = (0..points.len()).map(|k| segments.get(k).or(segments.last()));
        let record = PyDict::new(py);
        record.set_item("pair", path.pair)?;
        record.set_item("pair_type", analysis.paths.pairs[path.pair].pair_type.name())?;
        record.set_item("type", path.path_type.name())?;
        record.set_item("partner", path.partner)?;
        record.set_item("closed", path.closed)?;
        let coordinates = points.iter().flat_map(|point| <[f64; 3]>::from(point.position.coords));
        record.set_item("points", PyByteArray::new(py, &of_f64s(coordinates)))?;
        let faces = faces.flat_map(|segment| segment.map_or([u32::MAX; 2], |s| [s.own.0, s.partner.0]));
        record.set_item("faces", PyByteArray::new(py, &of_u32s(faces)))?;
        let region = analysis.regions.vertices_of(copy).iter().map(|vertex| vertex.0);
        record.set_item("inside", PyByteArray::new(py, &of_u32s(region)))?;
        paths.append(record)?;
    }
    let intersections = &analysis.intersections;
    let edges = intersections.edge_face.iter().flat_map(|hit| {
        let [p, q] = mesh.edge(hit.edge);
        [p.0, q.0, hit.face.0]
    });
    let pairs = intersections.segments.iter().flat_map(|segment| segment.faces.map(|face| face.0));
    let found = PyDict::new(py);
    found.set_item("edge_face", PyByteArray::new(py, &of_u32s(edges)))?;
    found.set_item("face_pairs", PyByteArray::new(py, &of_u32s(pairs)))?;
    found.set_item("contour_length_m", analysis.paths.pairs.iter().map(|pair| pair.length_m).sum::<f64>())?;
    let [inside_body, behind] = py.detach(|| wrong_vertices(&mesh, &frame));
    found.set_item("inside_body", PyByteArray::new(py, &of_u32s(inside_body)))?;
    found.set_item("behind", PyByteArray::new(py, &of_u32s(behind)))?;
    found.set_item("inside", PyByteArray::new(py, &inside))?;
    found.set_item("paths", paths)?;
    Ok(found)
}

/// The vertices of cloth inside of a body, and those behind an inner layer, ascending.
fn wrong_vertices(mesh: &Mesh, frame: &Frame) -> [Vec<u32>; 2] {
    let bodies = Sides::of(mesh, frame);
    let inside = bodies.as_ref().map(|bodies| bodies.wrong_vertices(mesh, frame)).unwrap_or_default();
    let layers = Layers::of(mesh, frame, bodies.as_ref());
    let behind = layers.map(|layers| layers.behind(mesh, frame.positions())).unwrap_or_default();
    [inside, behind].map(|wrong| {
        let mut vertices: Vec<u32> = wrong.iter().map(|wrong| wrong.vertex.0).collect();
        vertices.sort_unstable();
        vertices.dedup();
        vertices
    })
}

/// Repairs one state: positions as bytes, what a judge that shares no code with the repair counts, and blocked paths,
/// by name. With a gap, what nothing intersects is set apart. `progress` is called after each iteration, with how many
/// there were, the intersections, the length of the paths and the method; it ends the work where it returns `False` or
/// raises.
#[pyfunction]
pub(crate) fn fix<'py>(
    py: Python<'py>,
    cloth: Cloth,
    quality: &str,
    max_iterations: usize,
    single_precision: bool,
    gap_m: Option<f64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let effort = effort(quality)?;
    if gap_m.is_some_and(|gap_m| !(gap_m.is_finite() && gap_m > 0.0)) {
        return Err(PyValueError::new_err("gap must be a positive number of metres"));
    }
    let (mesh, positions) = cloth.read()?;
    let start = Frame::new(&mesh, &positions).map_err(|error| PyValueError::new_err(error.to_string()))?;
    let mesh = Layers::decide(mesh, &start);
    let settings = RelaxSettings { effort, max_iterations, single_precision, other_attempts: true };
    let mut raised = None;
    let (repaired, verdict) = py.detach(|| {
        let mut num_iterations = 0;
        let mut report = |iteration: &Iteration| {
            num_iterations += 1;
            match reported(progress.as_ref(), num_iterations, iteration) {
                Ok(flow) => flow,
                Err(error) => {
                    raised = Some(error);
                    ControlFlow::Break(())
                }
            }
        };
        let repaired = Repaired::of(&mesh, &positions, &settings, gap_m, &mut report)
            .map_err(|error| PyValueError::new_err(error.to_string()))?;
        let verdict = Verdict::of(&mesh, &repaired.positions, gap_m)
            .map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
        Ok::<_, PyErr>((repaired, verdict))
    })?;
    if let Some(error) = raised {
        return Err(error);
    }
    described(py, repaired, verdict)
}

/// The effort of a name.
fn effort(quality: &str) -> PyResult<Effort> {
    match quality {
        "fast" => Ok(Effort::Fast),
        "balanced" => Ok(Effort::Balanced),
        "accurate" => Ok(Effort::Accurate),
        other => {
            let message = format!("quality must be one of fast, balanced, accurate, not '{other}'");
            Err(PyValueError::new_err(message))
        }
    }
}

/// A repaired state as Python reads it.
fn described(py: Python<'_>, repaired: Repaired, verdict: Verdict) -> PyResult<Bound<'_, PyDict>> {
    let result = PyDict::new(py);
    result.set_item("vertices", PyByteArray::new(py, &of_f64s(repaired.positions.into_iter().flatten())))?;
    result.set_item("num_edge_face_intersections", verdict.num_edge_face)?;
    result.set_item("num_inside_body", verdict.num_inside)?;
    result.set_item("num_behind", verdict.num_behind)?;
    result.set_item("num_pairs_below", verdict.num_pairs_below)?;
    result.set_item("num_iterations", repaired.num_iterations)?;
    let blocked = PyList::empty(py);
    for path in repaired.blocked {
        blocked.append((path.pair_type.name(), path.vertex, path.length_m, path.reason))?;
    }
    result.set_item("blocked", blocked)?;
    let infeasible = PyList::empty(py);
    for place in repaired.infeasible {
        infeasible.append((place.vertices, place.num_pairs, place.distance_m, place.obstacle.to_string()))?;
    }
    result.set_item("infeasible", infeasible)?;
    Ok(result)
}

/// Looks for Ctrl-C, and calls back; says whether to go on.
fn reported(progress: Option<&Py<PyAny>>, num_iterations: usize, state: &Iteration) -> PyResult<ControlFlow<()>> {
    Python::attach(|py| {
        py.check_signals()?;
        let Some(progress) = progress else { return Ok(ControlFlow::Continue(())) };
        let method = serde_json::to_value(state.method).ok();
        let method = PyString::new(py, method.as_ref().and_then(serde_json::Value::as_str).unwrap_or_default());
        let arguments = (num_iterations, state.num_edge_face_intersections, state.path_length_m, method);
        let answer = progress.bind(py).call1(arguments)?;
        let goes_on = answer.is_none() || answer.is_truthy()?;
        Ok(if goes_on { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
    })
}

/// Edges that pierce a face, by a check that shares no code with the untangler; not those of two faces of bodies.
#[pyfunction]
pub(crate) fn count_intersections(py: Python<'_>, vertices: &[u8], triangles: &[u8], body: &[u8]) -> PyResult<usize> {
    let (positions, triangles) = (f64s("vertices", vertices)?, u32s("triangles", triangles)?);
    let body = u32s::<1>("body", body)?.into_flattened();
    py.detach(|| count_edge_face(&positions, &triangles, &body))
        .map_err(|error| PyValueError::new_err(error.to_string()))
}
