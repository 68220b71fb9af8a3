//! Who intersects whom.

use std::{
    collections::BTreeMap,
    fmt::{self, Display, Formatter},
};

use serde::Serialize;

use untangle::analysis::Analysis;

use crate::cli::{owners::Owners, wording::Counted};

/// Two named parts of the world that intersect, or one that intersects itself.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Meeting {
    /// Their names; what has none is "(unnamed)".
    pub between: [String; 2],
    /// Intersecting pairs of triangles.
    pub num_face_pairs: usize,
}

/// Most meetings of which people are told; all are in the JSON document.
const MOST_MEETINGS: usize = 20;

impl Meeting {
    pub(super) fn of(analysis: &Analysis, owners: &Owners<'_>) -> Vec<Self> {
        let mut counts: BTreeMap<[Option<String>; 2], usize> = BTreeMap::new();
        for segment in &analysis.intersections.segments {
            let mut names = segment.faces.map(|face| owners.of_face(face.0));
            names.sort();
            *counts.entry(names).or_default() += 1;
        }
        counts.remove(&[None, None]);
        let word = |name: Option<String>| name.unwrap_or_else(|| "(unnamed)".into());
        let meeting =
            |(names, num_face_pairs): ([Option<String>; 2], usize)| Self { between: names.map(word), num_face_pairs };
        let mut meetings: Vec<Self> = counts.into_iter().map(meeting).collect();
        meetings.sort_by_key(|meeting| std::cmp::Reverse(meeting.num_face_pairs));
        meetings
    }
}

/// The table for people.
pub(super) struct MeetingTable<'a>(pub(super) &'a [Meeting]);

impl Display for MeetingTable<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self(meetings) = self;
        if meetings.is_empty() {
            return Ok(());
        }
        writeln!(f, "\n  face pairs  who meets whom")?;
        for Meeting { between: [first, second], num_face_pairs } in meetings.iter().take(MOST_MEETINGS) {
            let whom = if first == second { "itself" } else { second };
            writeln!(f, "  {num_face_pairs:>10}  {first} and {whom}")?;
        }
        if meetings.len() > MOST_MEETINGS {
            writeln!(f, "  {:>10}  and fewer in {} more", "", Counted(meetings.len() - MOST_MEETINGS, "meeting"))?;
        }
        Ok(())
    }
}
