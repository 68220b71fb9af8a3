//! Rows of the fault table at full length.

use std::time::Duration;

use untangled_lab::daemon::this_program;
use untangled_testkit::{
    faults::{self, Row},
    fuzz::{self, Target},
};

use crate::{plan::Plan, programs::PROGRAMS};

/// Names of all rows, in the order of the table.
pub(crate) const ROWS: [&str; 17] = [
    "client-kills",
    "daemon-kills",
    "all-killed",
    "stopped",
    "observers",
    "open-close",
    "full-memory",
    "after-sending",
    "lying-headers",
    "lying-repairs",
    "request-limits",
    "fuzz-ingest",
    "fuzz-register",
    "fuzz-settings",
    "fuzz-mesh-file",
    "fuzz-stage",
    "many-sessions",
];

/// Makes one row; none where it can't be tried on this machine.
pub(crate) fn make_row(name: &str, plan: &Plan) -> Option<Row> {
    let row = match name {
        "client-kills" => faults::client_kills(PROGRAMS, plan.count(1000), plan.seed),
        "daemon-kills" => faults::daemon_kills(PROGRAMS, plan.count(200), plan.seed),
        "all-killed" => faults::all_killed(PROGRAMS, plan.count(100), plan.seed),
        "stopped" => faults::stopped_clients(PROGRAMS, plan.count(200), plan.seed),
        "observers" => faults::observer_faults(PROGRAMS, plan.count(300), plan.seed),
        "open-close" => faults::open_and_close(PROGRAMS, plan.count(1000)),
        "full-memory" => return faults::full_memory(this_program("full-memory", &[])),
        "after-sending" => faults::writing_after_sending(PROGRAMS, plan.count(2000), plan.seed),
        "lying-headers" => faults::lying_headers(PROGRAMS, plan.count(20_000), plan.seed),
        "lying-repairs" => faults::lying_repair_requests(PROGRAMS, plan.count(20_000), plan.seed),
        "request-limits" => faults::request_limits(PROGRAMS),
        "fuzz-ingest" => fuzzed(plan, Target::Ingest, 150_000),
        "fuzz-register" => fuzzed(plan, Target::Register, 225_000),
        "fuzz-settings" => fuzzed(plan, Target::Settings, 400_000),
        "fuzz-mesh-file" => fuzzed(plan, Target::MeshFile, 225_000),
        "fuzz-stage" => fuzzed(plan, Target::Stage, 225_000),
        "many-sessions" => {
            let time = Duration::from_secs_f64((600.0 * plan.scale).max(2.0));
            faults::many_sessions(PROGRAMS, 32, time)
        }
        other => unreachable!("a row named {other}"),
    };
    Some(row)
}

fn fuzzed(plan: &Plan, target: Target, full: u64) -> Row {
    let num_tries = plan.count(full);
    let what = format!("fuzzed input: {target:?}");
    match fuzz::run(target, plan.seed, 0, num_tries) {
        Ok(accepted) => Row {
            what,
            num_tries,
            note: format!("{accepted} accepted and held the invariants, the others refused in words"),
            ..Row::default()
        },
        Err(find) => Row { what, num_tries, num_wrong: 1, note: find, ..Row::default() },
    }
}
