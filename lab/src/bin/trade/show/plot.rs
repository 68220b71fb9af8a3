//! Time of a frame against frames to clean, as a picture.
//!
//! Written by hand. With `plotters` 0.3 (SVG only, three more crates) the same picture takes 184 lines instead of 210,
//! but stands on whole pixels, with boxes instead of halos behind its labels and without dashes in its legend; placing
//! labels, markers and legend has to be written all the same.

use std::fmt::Write;

use untangle::settings::Response;

use super::front::pareto_front;
use crate::measure::study::Measured;

const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 600.0;
/// Left, right, top and bottom of the field.
const FIELD: [f64; 4] = [70.0, 760.0, 50.0, 530.0];
/// Colours that those who see red and green alike can tell apart (Okabe and Ito 2008).
const COLOURS: [(Response, &str, &str); 5] = [
    (Response::Rbf, "rbf", "#0072b2"),
    (Response::Contour, "contour", "#e69f00"),
    (Response::Displacement, "displacement", "#009e73"),
    (Response::Coupled, "coupled", "#cc79a7"),
    (Response::Mask, "mask", "#777777"),
];
const LETTER: f64 = 6.3;
const INK: &str = "#222222";

/// A logarithmic axis.
#[derive(Clone, Copy)]
struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    /// An axis that shows all values, with some room.
    fn over(values: impl Iterator<Item = f64> + Clone, from: f64, to: f64) -> Self {
        let low = values.clone().fold(f64::INFINITY, f64::min).max(1e-3);
        let high = values.fold(low, f64::max);
        Self { low: low / 1.35, high: high * 1.35, from, to }
    }

    fn at(self, value: f64) -> f64 {
        self.from + (self.to - self.from) * (value.max(self.low) / self.low).ln() / (self.high / self.low).ln()
    }

    /// 1, 2 and 5 times powers of ten.
    fn ticks(self) -> Vec<f64> {
        let all = (-3..6).flat_map(|power| [1.0, 2.0, 5.0].map(|digit| digit * 10f64.powi(power)));
        all.filter(|tick| (self.low..=self.high).contains(tick)).collect()
    }
}

/// The picture: a point for each of the grid, rings for the presets, a line along the front of what a session chooses,
/// a dashed one along that of what the host chooses besides.
pub(crate) fn svg(grid: &[Measured], presets: &[Measured], limit: usize) -> String {
    let [left, right, top, bottom] = FIELD;
    let all = || grid.iter().chain(presets);
    let axes = [
        Axis::over(all().map(|one| one.all.ms_per_frame), left, right),
        Axis::over(all().map(|one| one.all.frames), bottom, top),
    ];
    let place = |one: &Measured| [axes[0].at(one.all.ms_per_frame), axes[1].at(one.all.frames)];
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"Helvetica, Arial, \
         sans-serif\" font-size=\"12\" fill=\"{INK}\">\n<rect width=\"{WIDTH}\" height=\"{HEIGHT}\" \
         fill=\"#ffffff\"/>\n"
    );
    draw_axes(&mut text, axes, limit);

    let places: Vec<[f64; 2]> = grid.iter().map(place).collect();
    let session = front(grid, |one| one.asks_always());
    let everything = front(grid, |_| true);
    draw_front(&mut text, &session, &places, "");
    draw_front(&mut text, &everything, &places, " stroke-dasharray=\"2 4\"");
    for (one, &at) in grid.iter().zip(&places) {
        text += &marker(one.variant.setup.every, colour(one), at);
    }

    let mut labels = Labels { taken: places.iter().map(|&[x, y]| [x - 5.0, y - 5.0, x + 5.0, y + 5.0]).collect() };
    for one in presets {
        let [x, y] = place(one);
        let _ = writeln!(
            text,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"10\" fill=\"none\" stroke=\"#d55e00\" stroke-width=\"2.5\"/>"
        );
        labels.taken.push([x - 10.0, y - 10.0, x + 10.0, y + 10.0]);
    }
    for one in presets {
        text += &labels.label(&one.variant.value, place(one), 13.0, "font-weight=\"bold\" fill=\"#d55e00\"");
    }
    let mut named: Vec<usize> = session.iter().chain(&everything).copied().collect();
    named.sort_unstable();
    named.dedup();
    for index in named {
        if presets.iter().any(|preset| preset.variant.setup == grid[index].variant.setup) {
            continue;
        }
        text += &labels.label(&grid[index].variant.value, places[index], 8.0, "font-size=\"11\"");
    }
    draw_legend(&mut text);
    text + "</svg>\n"
}

/// The points of the grid for which `counts` holds and that no other such point beats in time and in frames.
fn front(grid: &[Measured], counts: impl Fn(&Measured) -> bool) -> Vec<usize> {
    let among: Vec<usize> = (0..grid.len()).filter(|&index| counts(&grid[index])).collect();
    let costs: Vec<[f64; 2]> =
        among.iter().map(|&index| [grid[index].all.ms_per_frame, grid[index].all.frames]).collect();
    pareto_front(&costs).into_iter().map(|index| among[index]).collect()
}

/// Draws a front in steps: what it dominates lies above and to the right of them.
fn draw_front(text: &mut String, front: &[usize], places: &[[f64; 2]], dashes: &str) {
    let mut line = String::new();
    for (rank, &index) in front.iter().enumerate() {
        let [x, y] = places[index];
        let _ = if rank == 0 { write!(line, "M{x:.1} {y:.1}") } else { write!(line, "H{x:.1}V{y:.1}") };
    }
    let _ = writeln!(text, "<path d=\"{line}\" fill=\"none\" stroke=\"{INK}\" stroke-width=\"1.3\"{dashes}/>");
}

fn colour(one: &Measured) -> &'static str {
    let own = COLOURS.iter().find(|(response, ..)| *response == one.variant.setup.settings.response);
    own.map_or(INK, |&(.., colour)| colour)
}

/// A disc for every frame, a square for every second, a triangle for every fourth.
fn marker(every: usize, colour: &str, [x, y]: [f64; 2]) -> String {
    let style = format!("fill=\"{colour}\" stroke=\"#ffffff\" stroke-width=\"0.8\"");
    match every {
        1 => format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"5\" {style}/>\n"),
        2 => format!("<rect x=\"{:.1}\" y=\"{:.1}\" width=\"9\" height=\"9\" {style}/>\n", x - 4.5, y - 4.5),
        _ => format!("<path d=\"M{x:.1} {:.1}l5.5 9.5h-11z\" {style}/>\n", y - 6.0),
    }
}

fn draw_axes(text: &mut String, [across, up]: [Axis; 2], limit: usize) {
    let [left, right, top, bottom] = FIELD;
    let grid = "stroke=\"#e4e4e4\"";
    for tick in across.ticks() {
        let x = across.at(tick);
        let _ = writeln!(text, "<path d=\"M{x:.1} {top}V{bottom}\" {grid}/>");
        let _ = writeln!(text, "<text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{tick}</text>", bottom + 18.0);
    }
    for tick in up.ticks() {
        let y = up.at(tick);
        let _ = writeln!(text, "<path d=\"M{left} {y:.1}H{right}\" {grid}/>");
        let _ = writeln!(text, "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{tick}</text>", left - 8.0, y + 4.0);
    }
    let _ = writeln!(text, "<path d=\"M{left} {top}V{bottom}H{right}\" fill=\"none\" stroke=\"{INK}\"/>");
    let middle = 0.5 * (left + right);
    let _ = writeln!(
        text,
        "<text x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">time of a tangled frame, ms</text>",
        bottom + 42.0
    );
    let _ = writeln!(
        text,
        "<text transform=\"translate(22 {}) rotate(-90)\" text-anchor=\"middle\">frames to clean (not clean: \
         {limit})</text>",
        0.5 * (top + bottom)
    );
    let _ = writeln!(
        text,
        "<text x=\"{left}\" y=\"28\" font-size=\"15\" font-weight=\"bold\">Time of a frame against frames to clean, \
         mean over all scenes</text>"
    );
}

fn draw_legend(text: &mut String) {
    let x = FIELD[1] + 34.0;
    let mut y = FIELD[2] + 14.0;
    let mut line = |symbol: String, name: &str| {
        let _ = writeln!(text, "{symbol}<text x=\"{}\" y=\"{:.1}\">{name}</text>", x + 16.0, y + 4.0);
        y += 22.0;
        y
    };
    let mut next = FIELD[2] + 14.0;
    for (_, name, colour) in COLOURS {
        next = line(marker(1, colour, [x, next]), name);
    }
    for (every, name) in [(1, "every frame"), (2, "every second frame"), (4, "every fourth frame")] {
        next = line(marker(every, INK, [x, next]), name);
    }
    let ring =
        format!("<circle cx=\"{x}\" cy=\"{next}\" r=\"8\" fill=\"none\" stroke=\"#d55e00\" stroke-width=\"2.5\"/>");
    next = line(ring, "preset");
    for (dashes, name) in [("", "front, every frame"), (" stroke-dasharray=\"2 4\"", "front, all")] {
        let step = format!("<path d=\"M{} {}h8v8h8\" fill=\"none\" stroke=\"{INK}\"{dashes}/>", x - 8.0, next - 4.0);
        next = line(step, name);
    }
}

/// Places that labels must keep off, as left, top, right and bottom.
struct Labels {
    taken: Vec<[f64; 4]>,
}

impl Labels {
    /// A label beside its point, where it covers least of what is there already.
    fn label(&mut self, name: &str, [x, y]: [f64; 2], gap: f64, style: &str) -> String {
        let width = LETTER * name.chars().count() as f64;
        let aside = [gap, -gap - width, -0.5 * width];
        let spots = [0.0, -1.0, 1.0, -2.0, 2.0, -3.0, 3.0].iter().flat_map(|&rows: &f64| {
            let dy = rows * (gap + 5.0);
            aside.iter().map(move |&dx| [x + dx, y + dy - 7.0, x + dx + width, y + dy + 6.0])
        });
        let covered = |spot: &[f64; 4]| {
            let outside = (FIELD[0] - spot[0]).max(0.0)
                + (spot[2] - FIELD[1]).max(0.0)
                + (spot[3] - FIELD[3]).max(0.0)
                + (FIELD[2] - spot[1]).max(0.0);
            let overlap = |other: &[f64; 4]| {
                let across = (spot[2].min(other[2]) - spot[0].max(other[0])).max(0.0);
                across * (spot[3].min(other[3]) - spot[1].max(other[1])).max(0.0)
            };
            self.taken.iter().map(overlap).sum::<f64>() + 20.0 * outside
        };
        let Some(spot) = spots.min_by(|a, b| covered(a).total_cmp(&covered(b))) else { return String::new() };
        self.taken.push(spot);
        let at = format!("x=\"{:.1}\" y=\"{:.1}\" {style}", spot[0], spot[3] - 2.0);
        // First a halo that keeps lines off the letters.
        format!("<text {at} stroke=\"#ffffff\" stroke-width=\"4\">{name}</text>\n<text {at}>{name}</text>\n")
    }
}
