//! Intersection paths as they are on the wire.

use untangled_proto::paths::{PathPoint, PathRecord, path_type};

use untangle::paths::{IntersectionPaths, PathCopy, PathType};

use crate::service::session::publish::pair_index;

/// Writes records, then points, behind what is there. `state` says what became of a path, by its index. Gives back how
/// many of each there are.
pub(super) fn write(paths: &IntersectionPaths, state: impl Fn(usize) -> u32, bytes: &mut Vec<u8>) -> [u32; 2] {
    let count = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
    let mut num_points = 0;
    for (index, copy) in paths.copies.iter().enumerate() {
        let record = PathRecord {
            pair: count(copy.pair),
            pair_type: count(pair_index(paths.pairs[copy.pair].pair_type)),
            path_type: path_type_code(copy.path_type),
            partner: count(copy.partner),
            closed: u32::from(copy.closed),
            first_point: num_points,
            num_points: count(copy.points.len()),
            state: state(index),
        };
        num_points += record.num_points;
        bytes.extend_from_slice(&record.to_bytes());
    }
    for point in paths.copies.iter().flat_map(|copy| points(paths, copy)) {
        bytes.extend_from_slice(&point.to_bytes());
    }
    [count(paths.copies.len()), num_points]
}

fn points<'a>(paths: &'a IntersectionPaths, copy: &'a PathCopy) -> impl Iterator<Item = PathPoint> + 'a {
    let segments = &paths.segments[copy.segments.clone()];
    paths.points[copy.points.clone()].iter().enumerate().map(|(k, point)| PathPoint {
        position_m: point.position.coords.into(),
        faces: segments.get(k).or(segments.last()).map_or([u32::MAX; 2], |s| [s.own.0, s.partner.0]),
    })
}

fn path_type_code(kind: PathType) -> u32 {
    match kind {
        PathType::Closed => path_type::CLOSED,
        PathType::LoopLoop => path_type::LOOP_LOOP,
        PathType::BoundaryLoopInside => path_type::BOUNDARY_LOOP_INSIDE,
        PathType::BoundaryLoopBoundary => path_type::BOUNDARY_LOOP_BOUNDARY,
        PathType::BoundaryBoundary => path_type::BOUNDARY_BOUNDARY,
        PathType::BoundaryInside => path_type::BOUNDARY_INSIDE,
        PathType::InsideInside => path_type::INSIDE_INSIDE,
    }
}
