//! `--body` and `--layers`: reading bodies, and putting cloth and bodies into one world.

use std::path::PathBuf;

use serde::Serialize;

use untangle::intersect::{Intersections, Intersector};
use untangled_mesh_io::{MeshFile, World, concatenate};

use crate::cli::{
    input::{self, Input, InputError, names},
    weld::WeldArg,
};

/// What files are beside cloth.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct RoleArgs {
    /// A body: the cloth belongs outside of it; it stays where it is, is not written, and what it intersects of itself
    /// does not count. Its closed pieces have an inside, however their faces point. May be given several times
    #[arg(long = "body", value_name = "FILE")]
    pub bodies: Vec<PathBuf>,
    /// The FILEs are layers, the innermost first: each belongs outside of those before it, as far as they lie over each
    /// other. Outside is away from the bodies, else out of the tube that a garment forms; a flat sheet has its outside
    /// where its faces point
    #[arg(long)]
    pub layers: bool,
}

/// A body and what it intersects of itself.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct BodyReport {
    /// The file as it was named; bytes that are not UTF-8 are replaced.
    pub file: String,
    /// Pairs of its own triangles that intersect, and count nowhere else.
    pub num_own_face_pairs: usize,
}

/// Bodies as they were read, and whether the cloth is in layers.
#[derive(Clone, Debug, Default)]
pub(in crate::cli) struct Roles {
    pub(in crate::cli) bodies: Vec<MeshFile>,
    reports: Vec<BodyReport>,
    /// For each layer the name of its file and the number of its vertices; empty where files are no layers.
    pub(super) layers: Vec<(String, usize)>,
}

impl Roles {
    /// Reads bodies, and counts what each intersects of itself. `cloth` are the FILEs.
    ///
    /// # Errors
    /// [`InputError`], naming the file and the element at fault.
    pub(in crate::cli) fn read(args: &RoleArgs, cloth: &[MeshFile], weld: WeldArg) -> Result<Self, InputError> {
        let layer = |file: &MeshFile| (file.path().display().to_string(), file.positions().len());
        let layers = if args.layers { cloth.iter().map(layer).collect() } else { Vec::new() };
        let files = input::read_files(&args.bodies)?;
        let mut reports = Vec::new();
        for file in files.chunks(1) {
            let path = file[0].path().to_path_buf();
            let world = input::join(std::slice::from_ref(&path), file)?;
            let Input { mesh, frame, .. } = Input::new(file, world, weld)?;
            let mut found = Intersections::default();
            Intersector::default().intersect(&mesh, &frame, &mut found);
            let num_own_face_pairs = found.segments.len();
            reports.push(BodyReport { file: path.display().to_string(), num_own_face_pairs });
        }
        Ok(Self { bodies: files, reports, layers })
    }

    /// The same roles with the bodies at other places.
    pub(in crate::cli) fn with_bodies(&self, bodies: Vec<MeshFile>) -> Self {
        Self { bodies, reports: self.reports.clone(), layers: self.layers.clone() }
    }

    /// Whether there is no body.
    pub(in crate::cli) fn has_no_body(&self) -> bool {
        self.bodies.is_empty()
    }

    /// Whether the FILEs are layers.
    pub(in crate::cli) fn has_layers(&self) -> bool {
        !self.layers.is_empty()
    }

    /// One entry for each body; nothing without any.
    pub(in crate::cli) fn reports(&self) -> Option<Vec<BodyReport>> {
        (!self.has_no_body()).then(|| self.reports.clone())
    }

    /// Puts cloth and bodies into one world, the bodies last; `paths` are the names of the cloth in messages.
    pub(in crate::cli) fn join(&self, paths: &[PathBuf], cloth: &[MeshFile]) -> Result<World, InputError> {
        let mut world = concatenate(cloth.iter().chain(&self.bodies))
            .map_err(|source| InputError::World { files: names(paths), source })?;
        let first = cloth.iter().map(|file| file.positions().len()).sum::<usize>();
        let index = |vertex: usize| u32::try_from(vertex).unwrap_or(u32::MAX);
        if !self.has_no_body() {
            world.description.body = (index(first)..index(world.positions.len())).collect();
        }
        if !self.layers.is_empty() {
            // Several inputs may have become one file.
            let numbered = self.layers.iter().zip(0..);
            let mut layers: Vec<u32> =
                numbered.flat_map(|((_, count), number)| std::iter::repeat_n(number, *count)).collect();
            layers.resize(world.positions.len(), 0);
            world.description.layers = Some(layers);
        }
        Ok(world)
    }
}
