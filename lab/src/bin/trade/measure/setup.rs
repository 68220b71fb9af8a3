//! What is compared: settings of the untangler, and what a host does with it.

use untangle::settings::{InsideChoice, Quality, Response, Settings};
use untangled_testkit::generate::mirrored::Knowledge;

/// What a host does in the frames for which it asks nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Between {
    /// It uses the last correction again, values and mask.
    Repeat,
    /// It keeps the last mask, and uses the values once.
    KeepMask,
    /// It goes on without help, all contacts on.
    Nothing,
}

/// Precision of the host and of the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wire {
    /// The host computes in single precision, so that nothing is lost on the wire.
    SingleHost,
    /// The host computes in double precision, and the wire rounds.
    Rounded,
    /// Double precision throughout.
    Double,
}

/// One way to use the untangler.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Setup {
    pub(crate) settings: Settings,
    pub(crate) knowledge: Knowledge,
    /// The host asks for every n-th frame.
    pub(crate) every: usize,
    pub(crate) between: Between,
    pub(crate) wire: Wire,
    /// Pairs of paths that a frame's time suffices for, the longest first: a deadline that is the same every time.
    pub(crate) max_pairs: Option<usize>,
}

impl Default for Setup {
    fn default() -> Self {
        Self {
            settings: Settings::default(),
            knowledge: Knowledge::Uvs,
            every: 1,
            between: Between::Repeat,
            wire: Wire::SingleHost,
            max_pairs: None,
        }
    }
}

/// A setup with its place in the tables.
#[derive(Clone, Debug)]
pub(crate) struct Variant {
    pub(crate) axis: &'static str,
    pub(crate) value: String,
    pub(crate) setup: Setup,
}

const RESPONSES: [(Response, &str); 5] = [
    (Response::Rbf, "rbf"),
    (Response::Contour, "contour"),
    (Response::Displacement, "displacement"),
    (Response::Coupled, "coupled"),
    (Response::Mask, "mask"),
];
const CENTRES: [usize; 4] = [5, 10, 30, 100];
/// Limits of a step in edges; 0.2 by default.
const STEPS: [f64; 4] = [0.1, 0.2, 0.4, 0.8];
const PRESETS: [(Quality, &str); 3] =
    [(Quality::Fast, "fast"), (Quality::Balanced, "balanced"), (Quality::Accurate, "accurate")];

fn variant(axis: &'static str, value: impl Into<String>, change: impl FnOnce(&mut Setup)) -> Variant {
    let mut setup = Setup::default();
    change(&mut setup);
    Variant { axis, value: value.into(), setup }
}

/// The presets as a session gets them.
pub(crate) fn presets() -> Vec<Variant> {
    PRESETS.map(|(quality, name)| variant("preset", name, |setup| quality.apply(&mut setup.settings))).to_vec()
}

/// One factor at a time, from `balanced`.
pub(crate) fn single_factors() -> Vec<Variant> {
    let mut all = Vec::new();
    for (response, name) in RESPONSES {
        all.push(variant("response", name, |setup| setup.settings.response = response));
    }
    for most in [5, 10, 20, 30, 100] {
        all.push(variant("max_centres", most.to_string(), |setup| setup.settings.max_centres = most));
    }
    for edges in STEPS {
        all.push(variant("max_step_edge_lengths", edges.to_string(), |setup| {
            setup.settings.max_step_edge_lengths = edges;
        }));
    }
    for (inside, name) in [(InsideChoice::Count, "count"), (InsideChoice::Area, "area"), (InsideChoice::Work, "work")] {
        all.push(variant("inside", name, |setup| setup.settings.inside = inside));
    }
    for (knowledge, name) in [
        (Knowledge::Uvs, "UVs"),
        (Knowledge::Rest, "computed, rest lengths"),
        (Knowledge::Nothing, "computed, current lengths"),
    ] {
        all.push(variant("charts", name, |setup| setup.knowledge = knowledge));
    }
    all.push(variant("every n-th frame", "1", |_| {}));
    for every in [2, 4] {
        for (between, name) in [
            (Between::Repeat, "all used again"),
            (Between::KeepMask, "mask kept"),
            (Between::Nothing, "nothing between"),
        ] {
            all.push(variant("every n-th frame", format!("{every}, {name}"), |setup| {
                (setup.every, setup.between) = (every, between);
            }));
        }
    }
    for (wire, name) in [
        (Wire::SingleHost, "f32 host, f32 wire"),
        (Wire::Rounded, "f64 host, f32 wire"),
        (Wire::Double, "f64 host, f64 wire"),
    ] {
        all.push(variant("precision", name, |setup| setup.wire = wire));
    }
    all
}

/// Responses, numbers of centres where they matter, and every n-th frame.
pub(crate) fn grid() -> Vec<Variant> {
    let mut all = Vec::new();
    for (response, name) in RESPONSES {
        let fits = !matches!(response, Response::Contour | Response::Mask);
        for most in CENTRES.into_iter().filter(|&most| fits || most == Settings::default().max_centres) {
            for every in [1, 2, 4] {
                let centres = if fits { format!(" {most}") } else { String::new() };
                let frames = if every > 1 { format!(", every {every}") } else { String::new() };
                all.push(variant("grid", format!("{name}{centres}{frames}"), |setup| {
                    setup.settings.response = response;
                    setup.settings.max_centres = most;
                    setup.every = every;
                }));
            }
        }
    }
    all
}

/// All presets and responses: for scenes beside the main ones.
pub(crate) fn responses() -> Vec<Variant> {
    let mut all = presets();
    all.extend(single_factors().into_iter().filter(|variant| variant.axis == "response"));
    all.retain(|variant| variant.axis == "preset" || !presets().iter().any(|preset| preset.setup == variant.setup));
    for edges in STEPS.into_iter().filter(|&edges| edges > Settings::default().max_step_edge_lengths) {
        all.push(variant("", format!("balanced, steps of {edges} edges"), |setup| {
            setup.settings.max_step_edge_lengths = edges;
        }));
    }
    all.into_iter().map(|variant| Variant { axis: "half the edge", ..variant }).collect()
}

/// Less and less time for a frame.
pub(crate) fn deadlines() -> Vec<Variant> {
    [None, Some(8), Some(4), Some(2), Some(1)]
        .map(|pairs| {
            let value = match pairs {
                None => "all pairs".into(),
                Some(1) => "1 pair".into(),
                Some(pairs) => format!("{pairs} pairs"),
            };
            variant("time for", value, |setup| setup.max_pairs = pairs)
        })
        .to_vec()
}
