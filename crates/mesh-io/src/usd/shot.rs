//! A shot in USD as a cache of positions: the meshes below a prim, and where their points are at each time code.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use super::{
    compose::Stage,
    fault::{Fault, UsdError},
    gather::{Gathering, StageMesh},
    layers::value::Value,
    place::Place,
};
use crate::formats::mesh_data::MeshData;

/// Metres in a unit where a stage says nothing.
const METRES_PER_UNIT: f64 = 0.01;

/// The meshes of a prim.
#[derive(Debug)]
pub(crate) struct UsdShot {
    stage: Stage,
    meshes: Vec<StageMesh>,
    /// The time codes of the points; none where they have no samples.
    times: Vec<f64>,
    /// The number of the first frame.
    pub(super) first: u64,
    scale: f64,
    /// The places of all frames, where transforms do not move.
    places: Option<Arc<[Place]>>,
}

/// The length of a unit of a stage in metres.
fn metres_per_unit(stage: &Stage) -> Result<f64, UsdError> {
    match stage.metadata().get("metersPerUnit").and_then(Value::as_number) {
        None => Ok(METRES_PER_UNIT),
        Some(metres) if metres > 0.0 && metres.is_finite() => Ok(metres),
        Some(metres) => {
            Err(Fault::new(format!("metersPerUnit is {metres}, and must be more than 0")).at(stage.path.clone()))
        }
    }
}

/// The points of a frame, as singles one mesh after the other, and where they are.
pub(super) type UsdFrame = (Vec<u8>, Arc<[Place]>);

impl UsdShot {
    /// Opens the stage of a file, and gathers the meshes at a prim and below it. Their positions are those of the first
    /// frame.
    pub(crate) fn open(path: &Path, prim: &str) -> Result<(MeshData, Self), UsdError> {
        let mut stage = Stage::open(path)?;
        let Gathering { meshes, mut data, .. } = Gathering::run(&mut stage, prim)?;
        let times = times(&stage, &meshes)?;
        let scale = metres_per_unit(&stage)?;
        let first = first_number(&times);
        let mut shot = Self { stage, meshes, times, first, scale, places: None };
        if shot.meshes.iter().all(|mesh| mesh.xform.is_static()) {
            shot.places = Some(shot.places_at(None)?);
        }
        let (bytes, places) = shot.read(0)?;
        data.positions = positions(&bytes, &places);
        Ok((data, shot))
    }

    /// Its layers.
    pub(crate) fn files(&self) -> Vec<PathBuf> {
        self.stage.files()
    }

    pub(crate) fn num_frames(&self) -> u64 {
        self.times.len().max(1) as u64
    }

    /// The number of the first frame: its time code, where all are whole numbers without a gap.
    pub(crate) fn first(&self) -> u64 {
        self.first
    }

    /// The time code of a frame, counted from 0; nothing where points have no samples.
    pub(crate) fn time(&self, frame: u64) -> Option<f64> {
        usize::try_from(frame).ok().and_then(|frame| self.times.get(frame)).copied()
    }

    /// Reads the points of a frame, counted from 0.
    pub(crate) fn read(&self, frame: u64) -> Result<UsdFrame, UsdError> {
        let mut bytes = Vec::new();
        for mesh in &self.meshes {
            let slot = usize::try_from(frame).ok().and_then(|frame| mesh.points.samples.get(frame));
            let value = match slot {
                Some((_, slot)) => Some(self.stage.value(&mesh.points, slot)?),
                None => self.stage.default(&mesh.points)?,
            };
            let Some(Value::Singles(coordinates)) = value else {
                return Err(self.stage.error(&mesh.path, "has no points here"));
            };
            if coordinates.len() != 3 * mesh.num_vertices {
                let reason = format!("has {} points here, and {} before", coordinates.len() / 3, mesh.num_vertices);
                return Err(self.stage.error(&mesh.path, reason));
            }
            if let Some(at) = coordinates.iter().position(|value| !value.is_finite()) {
                let reason = format!("point {} (from 0) has a coordinate that is not finite", at / 3);
                return Err(self.stage.error(&mesh.path, reason));
            }
            bytes.extend(coordinates.iter().flat_map(|value| value.to_le_bytes()));
        }
        Ok((bytes, self.places(frame)?))
    }

    /// Where the meshes are in a frame.
    pub(crate) fn places(&self, frame: u64) -> Result<Arc<[Place]>, UsdError> {
        match &self.places {
            Some(places) => Ok(Arc::clone(places)),
            None => self.places_at(self.time(frame)),
        }
    }

    fn places_at(&self, time: Option<f64>) -> Result<Arc<[Place]>, UsdError> {
        let mut first = 0;
        let mut places = Vec::new();
        for mesh in &self.meshes {
            let vertices = first..first + mesh.num_vertices;
            first = vertices.end;
            let mut matrix = mesh.xform.matrix(&self.stage, time)?;
            matrix.fixed_view_mut::<3, 4>(0, 0).scale_mut(self.scale);
            let place = Place::new(vertices, matrix);
            places.push(place.ok_or_else(|| self.stage.error(&mesh.path, "has a transform that can't be inverted"))?);
        }
        Ok(places.into())
    }

    /// What the layer over it needs: the metadata of the stage, and the path, the points and the range of vertices of
    /// each mesh.
    pub(super) fn meshes(&self) -> &[StageMesh] {
        &self.meshes
    }

    pub(super) fn stage(&self) -> &Stage {
        &self.stage
    }
}

/// The positions of points in the world.
pub(crate) fn positions(bytes: &[u8], places: &[Place]) -> Vec<[f64; 3]> {
    let points = bytes.as_chunks::<12>().0;
    let point = |bytes: &[u8; 12]| {
        let mut point = [0.0; 3];
        for (slot, bytes) in point.iter_mut().zip(bytes.as_chunks::<4>().0) {
            *slot = f32::from_le_bytes(*bytes);
        }
        point
    };
    let mut positions = Vec::with_capacity(points.len());
    for place in places {
        let own = points.get(place.vertices.clone()).unwrap_or_default();
        positions.extend(own.iter().map(|bytes| place.to_world(point(bytes))));
    }
    positions
}

/// The time codes that all meshes with samples have.
fn times(stage: &Stage, meshes: &[StageMesh]) -> Result<Vec<f64>, UsdError> {
    let of = |mesh: &StageMesh| mesh.points.samples.iter().map(|(time, _)| *time).collect::<Vec<f64>>();
    let mut animated = meshes.iter().filter(|mesh| !mesh.points.samples.is_empty());
    let Some(first) = animated.next() else { return Ok(Vec::new()) };
    let times = of(first);
    for mesh in animated {
        if of(mesh) != times {
            let reason = format!("has points at other time codes than {}; resample them first", first.path);
            return Err(stage.error(&mesh.path, reason));
        }
    }
    Ok(times)
}

/// The number of the first frame: frames are numbered by their time codes where these are whole, not negative and
/// without a gap, else from 0.
fn first_number(times: &[f64]) -> u64 {
    let Some(&first) = times.first() else { return 0 };
    let is_numbered = (0u32..).zip(times).all(|(index, time)| (*time - first).to_bits() == f64::from(index).to_bits());
    if !is_numbered || first.fract() != 0.0 || !(0.0..=9e15).contains(&first) {
        return 0;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is whole, and within the range")]
    let number = first as u64;
    number
}
