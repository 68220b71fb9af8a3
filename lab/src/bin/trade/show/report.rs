//! The document: figures with what is said of them.

use super::{
    advice,
    document::Document,
    table::{self, Table},
};
use crate::measure::run::{HELD, REMAINING_AFTER};

/// The whole document in Markdown, for scenes with edges of `edge_m` metres.
pub(crate) fn markdown(document: &Document, edge_m: f64, seeds: u64) -> String {
    let figures = |axis, measured: &[_]| table::figures(axis, measured).markdown();
    let mut text = head(document.limit, edge_m, seeds);
    text += &format!("## The presets\n\n{}\n", figures("preset", &document.presets));
    text += &advice::text(document);
    text += &format!(
        "\n## The front\n\nA session chooses response and centres, and with the host asking for every frame these \
         points are beaten by no other in time, frames,\nwhat remains and target error together:\n\n{}\n{}\n\n## One \
         factor at a time\n\nAll else as in `balanced`.\n",
        figures("front", &document.front()),
        advice::presets_on_front(document)
    );
    for (axis, table) in document.factor_tables() {
        text += &format!("\n{}\n\n{}", advice::on_axis(axis), table.markdown());
    }
    text + &format!(
        "\n## Finer meshes\n\n{}\n\n{}\n## Less time for a frame\n\n{}\n\n{}\n## What exact signs cost\n\n{}\n\n{}\n## \
         The grid\n\nEvery response, number of centres and n-th frame, the last correction used again in \
         between.\n\n{}",
        advice::FINER,
        figures("half the edge", &document.finer),
        advice::DEADLINES,
        figures("time for", &document.deadlines),
        advice::EXACT,
        Table::markdown(&document.exact),
        figures("grid", &document.grid)
    )
}

/// How it was made, and what the columns mean.
fn head(limit: usize, edge_m: f64, seeds: u64) -> String {
    format!(
        "# Speed against accuracy\n\nMade by `cargo run --release -p untangled-lab --bin trade -- --out docs/results \
         --markdown > docs/results/trade.md`; do not edit. The same command writes the\npicture, and `trade.csv` with \
         a row for each setting and scene. Times are of one busy machine's processor, to be compared within\nthis page \
         only; all else is the same every time.\n\nScenes, simulator and exact check are those of `clients/publisher`: \
         one scene for each type of path, {seeds} seeds, edges of {edge_m} m,\nsteps of 1/60 s, at most {limit}. The \
         figures are means over all runs:\n\n- `ms/frame`: analysis and response of a frame that is not clean, whether \
         or not the host asked in it;\n- `frames`: to the first clean frame that is followed by {HELD} more; a run \
         that never was counts {limit}, and is counted in `not clean`;\n- `remaining`: edge-face intersections after \
         {REMAINING_AFTER} frames;\n- `target error`, `worst`: distance of a target from the true one in edges, where \
         the truth is known (the sheets of [targets.md](targets.md)):\n  mean over the sheets, and the worst target; \
         none for responses without targets;\n- `distortion`: how far the worst edge is from its length at rest, as a \
         factor, at the end;\n- `force left`, `torque left`: what is left of momenta, as a part of the sum of lengths, \
         at worst: of forces before the limit and the\n  pins, of displacements as they are.\n\n![Time of a frame \
         against frames to clean](trade.svg)\n\n"
    )
}
