//! A run: steps until the cloth is clean, or a number of steps.

use std::{
    io::Write,
    time::{Duration, Instant},
};

use untangled_checker::{edge_face_hits, face_pairs};

use crate::{
    host::{Host, HostError},
    mesh::Cloth,
    report::{Summary, write_brief_header, write_brief_line, write_line},
};
use untangled_client::CorrectionKind;

/// When a run ends, and which lines it prints.
#[derive(Clone, Copy, Debug)]
pub struct RunOptions {
    /// Most steps.
    pub max_frames: usize,
    /// The run ends when the exact check has found this many states in a row clean. Zero: never before `max_frames`.
    pub num_clean_frames: usize,
    /// A line is written every so many frames, and at the end; never for zero.
    pub report_every: usize,
    /// Shortest time from one step to the next.
    pub least_step: Duration,
    /// Whether lines are short, and become rarer: after one, four, sixteen times `report_every` frames, and so on.
    pub brief: bool,
    /// Unit of the values in the lines.
    pub kind: CorrectionKind,
}

impl RunOptions {
    fn is_reported(&self, frame: usize, done: bool) -> bool {
        if self.report_every == 0 {
            return false;
        }
        let count = frame / self.report_every;
        let is_rare_enough =
            !self.brief || count == 0 || count.is_power_of_two() && count.trailing_zeros().is_multiple_of(2);
        done || frame.is_multiple_of(self.report_every) && is_rare_enough
    }
}

/// Steps a host until it is done. The exact check judges every published state that the daemon takes for clean.
///
/// # Errors
/// [`HostError`].
pub fn run(host: &mut Host, options: RunOptions, out: &mut dyn Write) -> Result<Summary, HostError> {
    let (num_edge_face_before, num_face_pairs_before) = judge(host.solver().cloth())?;
    if options.brief && options.report_every > 0 {
        write_brief_header(out)?;
    }
    let mut clean_frames = 0;
    let (mut num_late_frames, mut num_repaired_frames) = (0, 0);
    let mut frame = 0;
    loop {
        let begin = Instant::now();
        let report = host.exchange()?;
        num_late_frames += usize::from(report.header.is_none());
        num_repaired_frames += usize::from(report.repaired.is_some());
        let seems_clean = report.header.is_some_and(|header| header.num_edge_face_intersections == 0);
        clean_frames = if seems_clean && judge(host.solver().cloth())?.0 == 0 { clean_frames + 1 } else { 0 };
        let done = frame == options.max_frames || (clean_frames > 0 && clean_frames == options.num_clean_frames);
        if options.is_reported(frame, done) || report.repaired.is_some() && options.report_every > 0 {
            if options.brief {
                write_brief_line(out, frame, judge(host.solver().cloth())?.0, &report)?;
            } else {
                write_line(out, frame, &report, options.kind)?;
            }
        }
        if done {
            break;
        }
        host.advance();
        std::thread::sleep(options.least_step.saturating_sub(begin.elapsed()));
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
        num_repaired_frames,
    })
}

/// Edge-face hits and face pairs of a state, by the exact check.
fn judge(cloth: &Cloth) -> Result<(usize, usize), HostError> {
    let hits = edge_face_hits(&cloth.points(), &cloth.triangles)?;
    Ok((hits.len(), face_pairs(&hits, &cloth.triangles).len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_reported_of_a_brief_run_becomes_rarer_and_ends_with_a_line() {
        let options = RunOptions {
            max_frames: 300,
            num_clean_frames: 0,
            report_every: 10,
            least_step: Duration::ZERO,
            brief: true,
            kind: CorrectionKind::Force,
        };
        let reported = |options: RunOptions| {
            (0..=300).filter(|&frame| options.is_reported(frame, frame == 300)).collect::<Vec<usize>>()
        };
        assert_eq!(reported(options), [0, 10, 40, 160, 300]);
        assert_eq!(reported(RunOptions { brief: false, ..options }).len(), 31);
        assert!(reported(RunOptions { report_every: 0, ..options }).is_empty());
    }
}
