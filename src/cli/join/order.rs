//! Whether parts are those of one shot, each once, in the order of their frames, and none is missing.

use super::{error::JoinError, part::Part};
use crate::cli::{input::is_same_file, wording::Counted};

/// Checks that all parts belong together, and that each comes right after the one before it.
pub(super) fn check(parts: &[Part]) -> Result<(), JoinError> {
    for (number, part) in parts.iter().enumerate() {
        if let Some(earlier) = parts[..number].iter().find(|earlier| is_same_file(&earlier.path, &part.path)) {
            let name = if earlier.path == part.path { String::new() } else { format!(", as {} too", named(earlier)) };
            return Err(JoinError::of(&part.path, format!("is given twice{name}")));
        }
    }
    let pairs = || parts.iter().zip(&parts[1..]);
    pairs().try_for_each(|(before, part)| fits(part, before))?;
    for (number, part) in parts.iter().enumerate() {
        if let Some(earlier) = parts[..number].iter().find(|earlier| has_frames_of(part, earlier)) {
            let ([start, end], earlier) = (part.times(), named(earlier));
            let reason = format!("has the frames of {earlier}, {start} to {end}: it is the same part a second time");
            return Err(JoinError::of(&part.path, reason));
        }
    }
    pairs().try_for_each(|(before, part)| follows(part, before, parts))
}

/// How far the time of a frame may be off.
fn slack(part: &Part) -> f64 {
    part.step().map_or(0.0, |step| step / 4.0)
}

/// Whether two parts begin and end at the same times.
fn has_frames_of(part: &Part, other: &Part) -> bool {
    let ends = part.times().into_iter().zip(other.times());
    ends.into_iter().all(|(a, b)| (a - b).abs() <= slack(other))
}

/// Checks that a part is of the same format and mesh as another.
fn fits(part: &Part, before: &Part) -> Result<(), JoinError> {
    let earlier = named(before);
    if part.format != before.format {
        return Err(JoinError::of(&part.path, format!("is of another format than {earlier}")));
    }
    if part.num_vertices != before.num_vertices {
        let reason = format!("has {} vertices, and {earlier} has {}", part.num_vertices, before.num_vertices);
        return Err(JoinError::of(&part.path, reason));
    }
    Ok(())
}

/// Checks that a part comes right after another; in MDD, whose times may have any steps, that it comes after it.
fn follows(part: &Part, before: &Part, parts: &[Part]) -> Result<(), JoinError> {
    let error = |reason: String| Err(JoinError::of(&part.path, reason));
    let ([first, last], [start, _], earlier) = (before.times(), part.times(), named(before));
    let slack = slack(before);
    if start < first - slack {
        return error(format!(
            "starts at {start}, and {earlier}, which is given before it, at {first}: parts are needed in the order of \
             their frames"
        ));
    }
    if start <= last + slack {
        return error(format!("starts at {start}, and {earlier} ends at {last}: frames are in both"));
    }
    let Some(step) = before.step() else { return Ok(()) };
    let next = last + step;
    if (start - next).abs() <= slack {
        return Ok(());
    }
    if let Some(other) = parts.iter().find(|other| (other.times()[0] - next).abs() <= slack) {
        let reason = format!("is given right after {earlier}, and {} comes between them", named(other));
        return error(format!("{reason}: parts are needed in the order of their frames"));
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "rounded, more than 0, and for words")]
    let missing = Counted(((start - next) / step).round() as usize, "frame");
    error(format!("starts at {start}, and {earlier} ends at {last}: a part with {missing} between them is missing"))
}

fn named(part: &Part) -> impl std::fmt::Display {
    part.path.display().to_string()
}
