//! A run: steps until the cloth is clean, or until there were enough of them.

use std::io::Write;

use crate::{
    check::{edge_face_hits, face_pairs},
    host::{Host, HostError},
    mesh::Cloth,
    report::{Summary, write_line},
};
use untangled_client::CorrectionKind;

/// When a run ends and what it says on the way.
#[derive(Clone, Copy, Debug)]
pub struct RunOptions {
    /// Most steps.
    pub max_frames: usize,
    /// The run ends when the exact check has found this many states in a row clean. Zero: never before `max_frames`.
    pub num_clean_frames: usize,
    /// A line is written every so many frames, and at the end; never for zero.
    pub report_every: usize,
    /// Unit of the values in the lines.
    pub kind: CorrectionKind,
}

/// Steps a host until it is done. The exact check judges every published state that the daemon takes for clean.
///
/// # Errors
/// [`HostError`].
pub fn run(host: &mut Host, options: RunOptions, out: &mut dyn Write) -> Result<Summary, HostError> {
    let (num_edge_face_before, num_face_pairs_before) = judge(host.solver().cloth())?;
    let mut clean_frames = 0;
    let mut num_late_frames = 0;
    let mut frame = 0;
    loop {
        let report = host.exchange()?;
        num_late_frames += usize::from(report.header.is_none());
        let seems_clean = report.header.is_some_and(|header| header.num_edge_face_intersections == 0);
        clean_frames = if seems_clean && judge(host.solver().cloth())?.0 == 0 { clean_frames + 1 } else { 0 };
        let done = frame == options.max_frames || (clean_frames > 0 && clean_frames == options.num_clean_frames);
        if options.report_every > 0 && (done || frame % options.report_every == 0) {
            write_line(out, frame, &report, options.kind)?;
        }
        if done {
            break;
        }
        host.advance();
        frame += 1;
    }
    let (num_edge_face_after, num_face_pairs_after) = judge(host.solver().cloth())?;
    Ok(Summary {
        clean: num_edge_face_after == 0,
        num_frames: frame,
        num_edge_face_before,
        num_edge_face_after,
        num_face_pairs_before,
        num_face_pairs_after,
        num_late_frames,
    })
}

/// Edge-face hits and face pairs of a state, by the exact check.
fn judge(cloth: &Cloth) -> Result<(usize, usize), HostError> {
    let hits = edge_face_hits(&cloth.points(), &cloth.triangles)?;
    Ok((hits.len(), face_pairs(&hits, &cloth.triangles).len()))
}
