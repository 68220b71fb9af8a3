//! When to choose which: the words are fixed, the figures in them are not.

use super::document::Document;
use crate::measure::study::Measured;

pub(crate) const FINER: &str = "The same scenes with edges half as long, one seed. A step is limited in edges, so that \
                                forces get weaker the finer the mesh is;\n`max_step_edge_lengths` lifts the limit.";
pub(crate) const DEADLINES: &str = "A deadline ends a frame between pairs of paths, the longest first, and leaves the \
                                    others out. So that every run is the same, it is\npairs that are counted here, not \
                                    microseconds. All seven scenes side by side, as `balanced`:";
pub(crate) const EXACT: &str = "Signs are always exact; there is no mode without, since paths could then contradict \
                                each other. This is what exactness costs: `sign` is one\nsign of four points, `search` \
                                finds all intersections of two sheets that cross along a line of the grid, by a \
                                cold search. Nearly all signs\nof a generic frame are decided by the filter; what \
                                degenerate input adds is the most that leaving exactness out could save.";

/// What to say of an axis.
pub(crate) fn on_axis(axis: &str) -> &'static str {
    match axis {
        "response" => {
            "The mask holds in all of them. `coupled` is one displacement for all paths together, the others treat \
             each path alone. Displacements are\napplied as such, forces as changes of velocity."
        }
        "max_centres" => {
            "Paths of these scenes are short, and have few centres anyway; the sheets for targets have paths of up to \
             80 edges. With more centres the fit\nfollows the polygon of the path, not the curve. The sheets are \
             smooth: that 20 come out a little nearer than 30 need not hold for paths that wind."
        }
        "max_step_edge_lengths" => {
            "No preset sets it: it says how hard the host's cloth may be pulled, not how well the pull is aimed. It \
             limits an acceleration too: with steps\nof 1/60 s, 0.2 edges of 0.025 m are 18 m/s^2, and of half of that \
             9 m/s^2, less than gravity."
        }
        "inside" => {
            "The choices differ only where a path leaves it open which side is inside; in these scenes they agree."
        }
        "charts" => {
            "Texture coordinates are the chart; without them charts are computed, from rest positions or, without \
             those, from the frame."
        }
        "every n-th frame" => {
            "In between a host can use the last correction again (as one that runs freely and takes the newest there \
             is), keep its mask alone, or go on\nwithout help."
        }
        "precision" => "Positions are rounded to f32 where the host computes or on the wire, or not at all.",
        _ => "",
    }
}

/// Whether the presets are where they belong.
pub(crate) fn presets_on_front(document: &Document) -> String {
    let front = document.front();
    let (on, off): (Vec<&Measured>, Vec<&Measured>) =
        document.presets.iter().partition(|preset| front.iter().any(|one| one.variant.setup == preset.variant.setup));
    let names = |presets: &[&Measured]| {
        presets.iter().map(|preset| format!("`{}`", preset.variant.value)).collect::<Vec<_>>().join(", ")
    };
    if off.is_empty() {
        format!("All presets are among them: {}.", names(&on))
    } else {
        format!("Among them: {}; not: {}.", names(&on), names(&off))
    }
}

/// What the advice is about.
struct Compared {
    fast: Measured,
    balanced: Measured,
    accurate: Measured,
    contour: Measured,
    displacement: Measured,
    frame_charts: Measured,
    every_fourth_repeated: Measured,
    every_fourth_alone: Measured,
    larger_steps: Measured,
    fine: Measured,
    fine_larger_steps: Measured,
    fine_largest_steps: Measured,
}

impl Compared {
    /// None where one of them was not measured.
    fn find(document: &Document) -> Option<Self> {
        let find = |all: &[Measured], axis: &str, value: &str| {
            all.iter().find(|one| one.variant.axis == axis && one.variant.value == value).cloned()
        };
        let factor = |axis, value| find(&document.factors, axis, value);
        let preset = |value| find(&document.presets, "preset", value);
        let finer = |value| find(&document.finer, "half the edge", value);
        Some(Self {
            fast: preset("fast")?,
            balanced: preset("balanced")?,
            accurate: preset("accurate")?,
            contour: factor("response", "contour")?,
            displacement: factor("response", "displacement")?,
            frame_charts: factor("charts", "computed, current lengths")?,
            every_fourth_repeated: factor("every n-th frame", "4, all used again")?,
            every_fourth_alone: factor("every n-th frame", "4, nothing between")?,
            larger_steps: factor("max_step_edge_lengths", "0.4")?,
            fine: finer("balanced")?,
            fine_larger_steps: finer("balanced, steps of 0.4 edges")?,
            fine_largest_steps: finer("balanced, steps of 0.8 edges")?,
        })
    }
}

/// Time of a frame, as a multiple of another's.
fn times(a: &Measured, b: &Measured) -> f64 {
    a.all.ms_per_frame / b.all.ms_per_frame
}

fn mean_error(one: &Measured) -> f64 {
    one.targets.map_or(f64::NAN, |errors| errors.mean)
}

fn tangled(one: &Measured) -> String {
    format!("{} of {}", one.all.num_tangled, one.all.num_runs)
}

/// The advice; empty where not everything was measured.
pub(crate) fn text(document: &Document) -> String {
    let Some(found) = Compared::find(document) else { return String::new() };
    format!("## When to choose which\n\n{}{}", on_presets(&found), on_settings(&found))
}

fn on_presets(
    Compared { fast, balanced, accurate, larger_steps, fine, fine_larger_steps, fine_largest_steps, .. }: &Compared,
) -> String {
    format!(
        "- **`balanced`** to begin with: forces that keep momentum, {:.1} frames, {} runs not clean.\n- **`fast`** \
         where paths are long or many and time is short. It takes {:.2} of the time here, {:.1} frames, and targets \
         are off by {:.3}\n  edges instead of {:.3}. Where paths are short, it changes little.\n- **Stuck?** On fine \
         meshes, and where cloth is stiff or heavy, first lift the limit of a step, which costs no time: with\n  \
         `max_step_edge_lengths` 0.4 it is {:.1} frames here, and on the finer meshes below {:.1} instead of {:.1}; \
         with 0.8, {:.1}.\n- **`accurate`** where a tangle has to go at once whatever it costs: {:.1} frames, for \
         {:.0} times the time. It keeps no momentum: for\n  repairs, and for cloth that is held somewhere, not for the \
         flight of a free piece. Once begun, its one motion is not cut short by a\n  deadline.\n",
        balanced.all.frames,
        tangled(balanced),
        times(fast, balanced),
        fast.all.frames,
        mean_error(fast),
        mean_error(balanced),
        larger_steps.all.frames,
        fine_larger_steps.all.frames,
        fine.all.frames,
        fine_largest_steps.all.frames,
        accurate.all.frames,
        times(accurate, balanced),
    )
}

fn on_settings(found: &Compared) -> String {
    let Compared { balanced, contour, displacement, frame_charts, every_fourth_repeated, every_fourth_alone, .. } =
        found;
    format!(
        "- `contour` and `mask`, which no preset takes, cost {:.2} and less of the time of `balanced` and leave {} \
         runs tangled: for a host that\n  knows its tangles to be shallow.\n- `displacement` keeps no momentum either, \
         and asked for in every frame it leaves {} runs tangled: for repairs.\n- **Short of time?** Ask less often \
         before you ask for less: every fourth frame, with the last correction used again until the next one,\n  takes \
         {:.2} of the time and {:.1} frames. Without it in between {} runs are not clean.\n- **Send texture \
         coordinates or rest positions.** Charts from the lengths of the frame take {:.1} times the time, and targets \
         are off by\n  {:.3} edges instead of {:.3}.\n- Single precision on the wire costs nothing that can be seen \
         here.\n",
        times(contour, balanced),
        tangled(contour),
        tangled(displacement),
        times(every_fourth_repeated, balanced),
        every_fourth_repeated.all.frames,
        tangled(every_fourth_alone),
        times(frame_charts, balanced),
        mean_error(frame_charts),
        mean_error(balanced),
    )
}
