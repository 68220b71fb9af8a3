//! What is written where.

use std::{
    fs, io,
    ops::Range,
    path::{Path, PathBuf},
};

use untangled_mesh_io::{MeshFile, Output, WriteError};

use crate::cli::{html::page_target, input::Input, roles::Roles};

use super::{args::FixArgs, error::FixError, target::Target};

/// One output file.
#[derive(Debug)]
pub(in crate::cli) struct Job<'a> {
    pub(super) output: Output<'a>,
    pub(super) target: Target,
    /// Its vertices in the world.
    pub(super) vertices: Range<usize>,
}

/// All that is written.
#[derive(Debug)]
pub(super) struct Plan<'a> {
    pub(super) jobs: Vec<Job<'a>>,
    /// The place of the report, if one was asked for.
    pub(super) report: Option<Target>,
    /// The place of the page, if one was asked for.
    pub(super) page: Option<Target>,
}

/// Plans what is written where.
///
/// # Errors
/// [`FixError`] for files that must not be overwritten, and for formats that can't be written.
pub(super) fn plan<'a>(args: &FixArgs, files: &'a [MeshFile], roles: &Roles) -> Result<Plan<'a>, FixError> {
    let inputs: Vec<&Path> = files.iter().flat_map(MeshFile::source_files).chain(args.pin.as_deref()).collect();
    let inputs: Vec<&Path> = inputs.into_iter().chain(roles.bodies.iter().flat_map(MeshFile::source_files)).collect();
    let target = |path: PathBuf| Target::new(path, &inputs, args.overwrite);
    let groups: Vec<(PathBuf, &[MeshFile])> = if fs::metadata(&args.out).is_ok_and(|metadata| metadata.is_dir()) {
        let name = |file: &MeshFile| args.out.join(file.path().file_name().unwrap_or_default());
        files.iter().map(|file| (name(file), std::slice::from_ref(file))).collect()
    } else {
        vec![(args.out.clone(), files)]
    };
    let mut jobs: Vec<Job<'a>> = Vec::new();
    let mut first = 0;
    for (path, group) in groups {
        let target = target(path)?;
        if let Some(other) = jobs.iter().find(|job| job.target.is_same_place(&target)) {
            let inputs = [other.output.files(), group].map(|files| files[0].path().to_path_buf());
            return Err(FixError::Twice { path: target.path, inputs });
        }
        let refused = |source: WriteError| FixError::Target { path: target.path.clone(), reason: source.to_string() };
        let output = Output::new(group, &target.path).map_err(refused)?;
        let vertices = first..first + group.iter().map(|file| file.positions().len()).sum::<usize>();
        first = vertices.end;
        jobs.push(Job { output, target, vertices });
    }
    let report = args.report.clone().map(target).transpose()?;
    if let Some(report) = &report
        && jobs.iter().any(|job| job.target.is_same_place(report))
    {
        let reason = "is an output, and can't be the report as well".to_owned();
        return Err(FixError::Target { path: report.path.clone(), reason });
    }
    let page = args.html.as_deref().map(|path| page_target(path, &inputs, args.overwrite)).transpose()?;
    if let Some(page) = &page
        && report.as_ref().is_some_and(|report| report.is_same_place(page))
    {
        let reason = "is the report, and can't be the page as well".to_owned();
        return Err(FixError::Target { path: page.path.clone(), reason });
    }
    Ok(Plan { jobs, report, page })
}

/// Checks, before any work is done, that its result can be written.
///
/// # Errors
/// [`FixError::Fixed`] for vertices that are not pinned and can't have other positions; [`FixError::Target`] for other
/// reasons.
pub(super) fn check_movable(jobs: &[Job<'_>], input: &Input) -> Result<(), FixError> {
    for Job { output, target, vertices } in jobs {
        for (range, reason) in output.fixed_vertices() {
            let range = range.start + vertices.start..range.end + vertices.start;
            if !range.clone().all(|vertex| input.is_pinned(vertex)) {
                let (path, reason) = (target.path.clone(), reason.to_owned());
                return Err(FixError::Fixed { path, first: range.start, last: range.end - 1, reason });
            }
        }
        output.write(&input.positions[vertices.clone()], &mut io::sink()).map_err(|source| target.failed(&source))?;
    }
    Ok(())
}
