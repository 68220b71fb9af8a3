//! The arguments of a command as its page lists them.

use std::path::Path;

use clap::ValueEnum;
use serde::Serialize;

use crate::cli::{check::args::CheckArgs, fix::args::FixArgs, weld::WeldArg, world::WorldArgs};

/// An argument and its value in words.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(in crate::cli) struct Setting {
    /// As it is given.
    name: &'static str,
    value: String,
}

fn setting(name: &'static str, value: impl ToString) -> Setting {
    Setting { name, value: value.to_string() }
}

/// What a check was asked for.
pub(in crate::cli) fn settings_of_check(args: &CheckArgs) -> Vec<Setting> {
    let mut settings = shared(&args.world);
    settings.push(setting("--max-face-pairs", args.world.max_face_pairs));
    settings
}

/// What a repair was asked for.
pub(in crate::cli) fn settings_of_fix(args: &FixArgs) -> Vec<Setting> {
    let mut settings = shared(&args.world);
    let quality = args.quality.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned());
    settings.push(setting("--quality", quality));
    settings.push(setting("--max-iterations", args.max_iterations));
    if let Some(limit) = args.time_limit {
        settings.push(setting("--time-limit", format!("{} s", limit.as_secs_f64())));
    }
    settings.extend(args.pin.as_deref().map(|path| setting("--pin", name(path))));
    settings.push(setting("--max-face-pairs", args.world.max_face_pairs));
    settings
}

fn shared(WorldArgs { weld, roles, gap, sequence, .. }: &WorldArgs) -> Vec<Setting> {
    let mut settings: Vec<Setting> = roles.bodies.iter().map(|path| setting("--body", name(path))).collect();
    if roles.layers {
        settings.push(setting("--layers", "the first file is the innermost"));
    }
    settings.push(match weld {
        WeldArg::Exact => setting("--weld", "exact"),
        WeldArg::Off => setting("--weld", "off"),
        WeldArg::Metres(metres) => setting("--weld", format!("{metres} m")),
    });
    if let Some(preset) = &gap.gap_for {
        settings.push(setting("--gap-for", preset));
    }
    settings.extend(gap.gap.map(|metres| setting("--gap", format!("{metres} m"))));
    settings.extend(sequence.cache.as_deref().map(|path| setting("--cache", name(path))));
    settings.extend(sequence.prim.as_deref().map(|prim| setting("--prim", prim)));
    settings.extend(sequence.body_caches.iter().map(|path| setting("--body-cache", name(path))));
    if let Some(range) = &sequence.frames {
        settings.push(setting("--frames", format!("{}..{}", range.0.start(), range.0.end())));
    }
    settings
}

fn name(path: &Path) -> String {
    path.display().to_string()
}
