//! What each key means, as `untangled config` prints it.

/// Explains `settings.deadline_us`.
pub(super) const DEADLINE: &str = concat!(
    "Time for a frame in microseconds; what it does not suffice for is left out, the shortest paths first, ",
    "or the whole frame, where its intersections are not found in time. ",
    "Without it there is no limit."
);

/// Explains `settings.max_face_pairs`.
pub(super) const FACE_PAIRS: &str = concat!(
    "Most pairs of faces that may intersect in a frame; a frame of more is not analysed. ",
    "Without it: 4 for each face, at least 131072."
);

/// Explains `settings.max_tested_pairs`.
pub(super) const TESTED_PAIRS: &str = concat!(
    "Most pairs of faces whose bounding boxes may overlap in a frame; a frame of more is not analysed. ",
    "Without it: 256 for each face, at least 8388608."
);

/// Explains `settings.thickness_m`.
pub(super) const THICKNESS: &str = concat!(
    "Thickness of the cloth in metres: what is not tangled is kept so far apart. ",
    "Without it the mean edge length stands in where tangles are concerned, and nothing else is kept apart."
);

/// Explains `settings.repair_deadline_us`.
pub(super) const REPAIR_DEADLINE: &str = concat!(
    "Time for a repair in microseconds, from when it is asked for; the best state so far is sent then. ",
    "Without it a repair ends when nothing intersects, or nothing helps any more."
);

/// Keys and sections, each with its explanation. A test checks that every key has one.
pub(super) const EXPLANATIONS: &[(&str, &str)] = &[
    ("domain", "Where clients find the daemon; different domains never meet."),
    ("quality", "The settings below start from `fast`, `balanced` or `accurate`; a session may choose one too."),
    ("num_workers", "Threads that work on frames, at least 2; 0 for as many as there are processors."),
    ("num_repair_workers", "Repairs at a time, 1 to 64; each is spread over all processors, at a lower priority."),
    (
        "instruction_set",
        "`best`, or `portable` for what every processor has: slower, with the same answers; for tests of that.",
    ),
    ("[limits]", "What sessions may ask for."),
    ("limits.max_sessions", "Most sessions at a time, 1 to 64."),
    ("limits.max_sessions_per_client", "Most sessions of one client process at a time, 1 to 64."),
    ("limits.max_vertices", "Most vertices of a session."),
    ("limits.max_faces", "Most faces of a session."),
    (
        "limits.max_session_memory_mb",
        "Most memory of a session in megabytes, estimated from its vertices and faces when it is registered.",
    ),
    ("[telemetry]", "Logs, on standard error, and metrics."),
    (
        "telemetry.filter",
        "What to log: a level, or per module as in `untangled=debug` (a line per frame with stage times).",
    ),
    ("telemetry.format", "`text` or `json`."),
    ("telemetry.metrics", "Loopback address for metrics as Prometheus text, as in 127.0.0.1:9464; empty for none."),
    ("[settings]", "Settings of sessions, where a session does not choose its own by the same names."),
    (
        "settings.response",
        "How corrections are found: `rbf` (fit of targets), `contour` (shorter paths), `displacement` (straight to \
         the targets), `coupled` (all paths together) or `mask` (flags only).",
    ),
    (
        "settings.inside",
        "Which side of a path is inside: the one with fewer vertices, `count`, with less `area`, or the one that \
         takes less `work` to bring back.",
    ),
    (
        "settings.stiffness_per_step2",
        "Part of the distance to its target that a vertex covers in a step, per unit mass and step^2.",
    ),
    ("settings.max_step_edge_lengths", "Largest correction of a vertex in a step, in mean edge lengths."),
    (
        "settings.steps_to_clean",
        "Steps in which forces shall take a free point out of a tangle, whatever the edges are; inf leaves the limit \
         to the edges.",
    ),
    ("settings.thickness_m", THICKNESS),
    ("settings.max_face_pairs", FACE_PAIRS),
    ("settings.max_tested_pairs", TESTED_PAIRS),
    ("settings.deadline_us", DEADLINE),
    (
        "settings.repair",
        "Which frames are repaired, in sessions that asked for repairs: those that are `asked` for, besides those at \
         which a tangle does not shrink (`auto`), or all in which something intersects (`always`).",
    ),
    ("settings.repair_deadline_us", REPAIR_DEADLINE),
    ("settings.layer_order", "Whether layers, where the host gave them, decide what is inside."),
    ("settings.winding", "Whether winding numbers decide what is inside, on closed and oriented pieces."),
    ("settings.pinned_outside", "Whether a side with pinned vertices is outside, where the other side has none."),
    ("settings.min_centres", "Fewest centres of a fit, 3 or more."),
    ("settings.max_centres", "Most centres of a fit, up to 1000."),
    ("settings.path_rings", "Width of the flagged surroundings of the paths, in rings of vertices, up to 64."),
];
