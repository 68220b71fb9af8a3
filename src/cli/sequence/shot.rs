//! The frames of a shot: cloth and bodies at one instant, as `check` and `fix` see files.

use std::{
    ops::RangeInclusive,
    path::{Path, PathBuf},
};

use untangle::analysis::Analysis;
use untangled_mesh_io::{CacheFrame, MeshFile, VertexCache, WriteError};

use super::{args::CacheArgs, error::SequenceError};
use crate::cli::{
    certificate::Certificate,
    fix::Counts,
    gap::{Asked, GapCertificate, GapReport},
    input::{self, Input, analyse_within},
    owners::Owners,
    roles::Roles,
    weld::WeldArg,
    world::WorldArgs,
};

/// What does not change from frame to frame.
pub(super) struct Shot {
    /// The FILEs; their positions say which way the material lies, not where it is.
    pub(super) files: Vec<MeshFile>,
    pub(super) roles: Roles,
    pub(super) cache: VertexCache,
    body_caches: Vec<VertexCache>,
    pub(super) weld: WeldArg,
    pub(super) pins: Vec<u32>,
    pub(super) max_face_pairs: u64,
    pub(super) gap: Option<Asked>,
    /// Whether the judge counts distances too.
    pub(super) certify_gap: bool,
    /// Positions of the FILEs and bodies as they are, `num_vertices x 3`: the pose of reference for directions of the
    /// material.
    pub(super) reference: Vec<[f64; 3]>,
    /// For each face whether it points outwards of its layer, by the first frame of the cache, whatever frames are
    /// asked for; nothing without layers.
    outwards: Option<Vec<bool>>,
    /// The prim in USD, else empty.
    pub(super) prim: String,
    /// The frames that are asked for.
    pub(super) part: RangeInclusive<u64>,
}

/// Cloth and bodies at one instant.
pub(super) struct State {
    pub(super) files: Vec<MeshFile>,
    pub(super) roles: Roles,
    pub(super) input: Input,
}

/// What there is in a state.
#[derive(Clone, Debug)]
pub(super) struct Judgement {
    pub(super) counts: Counts,
    pub(super) gap: Option<GapReport>,
    /// Coordinates that are so small that they count as zero.
    pub(super) num_zeroed_coordinates: usize,
}

impl Shot {
    /// Reads the mesh and the bodies, and opens all caches.
    pub(super) fn open(args: &WorldArgs) -> Result<Self, SequenceError> {
        let WorldArgs { files: paths, roles: role_args, sequence, weld, max_face_pairs, gap } = args;
        let (files, cache) = open_cache(paths, sequence)?;
        let roles = Roles::read(role_args, &files, *weld)?;
        if cache.is_usd() && role_args.layers {
            let reason = "layers are several FILEs, and USD is one";
            return Err(SequenceError::Argument { argument: "--layers", reason });
        }
        let body_caches = open_body_caches(&sequence.body_caches, &roles, &cache)?;
        let [first, last] = [*cache.frames().start(), *cache.frames().end()];
        let part = sequence.frames.clone().map_or_else(|| cache.frames(), |range| range.0);
        for frame in [*part.start(), *part.end()] {
            if !cache.frames().contains(&frame) {
                return Err(SequenceError::out_of_range(cache.path().to_path_buf(), frame, [first, last]));
            }
        }
        let reference = files.iter().chain(&roles.bodies).flat_map(MeshFile::positions).copied().collect();
        let mut shot = Self {
            files,
            roles,
            cache,
            body_caches,
            weld: *weld,
            pins: Vec::new(),
            max_face_pairs: *max_face_pairs,
            gap: gap.asked(),
            certify_gap: false,
            reference,
            outwards: None,
            prim: sequence.prim.clone().unwrap_or_default(),
            part,
        };
        if role_args.layers {
            let first = *shot.cache.frames().start();
            let (own, roles) = shot.read(first)?;
            let State { input, .. } = shot.state(first, &roles, own.positions())?;
            shot.outwards = input.decided().mesh.outwards().map(<[bool]>::to_vec);
        }
        Ok(shot)
    }

    /// All files that are read.
    pub(super) fn source_files(&self) -> Vec<&Path> {
        let files = self.files.iter().chain(&self.roles.bodies);
        files.flat_map(MeshFile::source_files).collect()
    }

    /// All files of the caches that are read.
    pub(super) fn cache_files(&self) -> Vec<PathBuf> {
        std::iter::once(&self.cache).chain(&self.body_caches).flat_map(VertexCache::files).collect()
    }

    /// Reads a frame, and the bodies at its instant.
    pub(super) fn read(&self, frame: u64) -> Result<(CacheFrame, Roles), SequenceError> {
        let own = self.cache.read(frame)?;
        if self.body_caches.is_empty() {
            return Ok((own, self.roles.clone()));
        }
        let index = frame - self.cache.frames().start();
        let mut bodies = Vec::new();
        for (body, cache) in self.roles.bodies.iter().zip(&self.body_caches) {
            let place = cache.read(cache.frames().start() + index)?;
            let at = body.at_positions(place.positions());
            bodies.push(at.map_err(|source| self.failed(frame, source))?);
        }
        Ok((own, self.roles.with_bodies(bodies)))
    }

    /// The error of a frame that can't hold what it should.
    pub(super) fn failed(&self, frame: u64, source: WriteError) -> SequenceError {
        SequenceError::FrameWrite { path: self.cache.file(frame), frame, source }
    }

    /// The cloth at some positions, with bodies.
    pub(super) fn state(&self, frame: u64, roles: &Roles, positions: &[[f64; 3]]) -> Result<State, SequenceError> {
        let files = split(&self.files, positions).map_err(|source| self.failed(frame, source))?;
        let input = roles.join(&[self.cache.file(frame)], &files).and_then(|mut world| {
            world.description.pins.clone_from(&self.pins);
            Ok(Input::new(&files, world, self.weld)?.with_outwards(self.outwards.as_deref()))
        });
        let input = input.map_err(|source| self.bad_input(frame, source))?;
        Ok(State { files, roles: roles.clone(), input })
    }

    fn bad_input(&self, frame: u64, source: input::InputError) -> SequenceError {
        SequenceError::FrameInput { path: self.cache.file(frame), frame, source: Box::new(source) }
    }

    /// Analyses a state.
    pub(super) fn analyse(&self, frame: u64, State { input, .. }: &State) -> Result<Analysis, SequenceError> {
        let path = self.cache.file(frame);
        analyse_within(std::slice::from_ref(&path), input, self.max_face_pairs, &mut ())
            .map_err(|source| self.bad_input(frame, source))
    }

    /// Analyses and judges a state.
    pub(super) fn judge(&self, frame: u64, state: &State) -> Result<Judgement, SequenceError> {
        self.judge_found(frame, state, &self.analyse(frame, state)?)
    }

    /// Judges a state that was analysed.
    pub(super) fn judge_found(
        &self,
        frame: u64,
        State { files, roles, input }: &State,
        analysis: &Analysis,
    ) -> Result<Judgement, SequenceError> {
        let path = self.cache.file(frame);
        let counts = Counts::new(analysis, roles, input, Certificate::of(files, roles, input));
        let owners = Owners::new(files.iter().chain(&roles.bodies));
        let gap = self.gap.as_ref().map(|asked| GapReport::of(asked, input, &owners)).transpose();
        let mut gap = gap.map_err(|source| SequenceError::FrameGap { path, frame, source })?;
        if let Some(gap) = gap.as_mut().filter(|_| self.certify_gap) {
            gap.certificate = Some(GapCertificate::of(files, roles, input, gap.asked_m));
        }
        Ok(Judgement { counts, gap, num_zeroed_coordinates: input.num_zeroed_coordinates() })
    }
}

/// The files at positions, those of all files one after the other.
pub(super) fn split(files: &[MeshFile], positions: &[[f64; 3]]) -> Result<Vec<MeshFile>, WriteError> {
    let mut first = 0;
    let at = |file: &MeshFile| {
        let own = first..first + file.positions().len();
        first = own.end;
        file.at_positions(positions.get(own).unwrap_or_default())
    };
    files.iter().map(at).collect()
}

/// The mesh, and the positions of its frames.
fn open_cache(paths: &[PathBuf], args: &CacheArgs) -> Result<(Vec<MeshFile>, VertexCache), SequenceError> {
    if let Some(prim) = &args.prim {
        let [path] = paths else {
            let reason = "USD is one FILE; a prim above all meshes brings in all of them";
            return Err(SequenceError::Argument { argument: "more than one FILE", reason });
        };
        let (file, cache) = VertexCache::open_usd(path, prim)?;
        return Ok((vec![file], cache));
    }
    let files = input::read_files(paths)?;
    let path = args.cache.as_deref().unwrap_or_else(|| Path::new(""));
    let cache = VertexCache::open(path, &files)?;
    Ok((files, cache))
}

fn open_body_caches(paths: &[PathBuf], roles: &Roles, cache: &VertexCache) -> Result<Vec<VertexCache>, SequenceError> {
    if !paths.is_empty() && paths.len() != roles.bodies.len() {
        return Err(SequenceError::BodyCaches { given: paths.len(), bodies: roles.bodies.len() });
    }
    let num_frames = |cache: &VertexCache| cache.frames().end() - cache.frames().start() + 1;
    let mut caches = Vec::new();
    for (path, body) in paths.iter().zip(&roles.bodies) {
        let own = VertexCache::open(path, std::slice::from_ref(body))?;
        let (given, expected) = (num_frames(&own), num_frames(cache));
        if given != expected {
            let cache = cache.path().to_path_buf();
            return Err(SequenceError::BodyFrames { path: path.clone(), given, cache, expected });
        }
        caches.push(own);
    }
    Ok(caches)
}
