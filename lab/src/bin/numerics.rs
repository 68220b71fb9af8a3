//! Makes the document of limits: for each extreme what is promised and what was seen. Ends in failure where a promise
//! is broken.
//!
//! ```sh
//! cargo run --release -p untangled-lab --bin numerics > docs/results/numerics.md
//! cargo run --release -p untangled-lab --bin numerics -- --quick      # at the sizes of the test
//! ```

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "prints a document, and on standard error how far it is")]

use std::{hint::black_box, process::ExitCode, time::Instant};

use cpu_time::ThreadTime;
use untangled_lab::table::{print_header, print_text};
use untangled_testkit::numerics::{Effort, chapters, single};

const HEAD: &str = "# Numbers at their limits

Made by `cargo run --release -p untangled-lab --bin numerics > docs/results/numerics.md`; do not edit. \
`tests/response/numerics.rs` holds each promise at smaller sizes, and fails where one is broken. \"Finite\" means \
every correction, path point, condition number and target.
";

fn main() -> ExitCode {
    let effort = if std::env::args().any(|argument| argument == "--quick") { Effort::Quick } else { Effort::Full };
    print_text(HEAD);
    let mut num_broken = 0;
    for chapter in chapters() {
        print_text(&format!("## {}\n\n{}\n", chapter.title, chapter.text));
        print_header(&["what", "promised", "seen"]);
        for case in chapter.cases {
            let begin = Instant::now();
            let seen = case.measure(effort).unwrap_or_else(|words| {
                num_broken += 1;
                format!("**broken**: {words}")
            });
            println!("| {} | {} | {seen} |", case.what, case.promise);
            eprintln!("{:.1} s: {}", begin.elapsed().as_secs_f64(), case.what);
        }
        println!();
    }
    single_precision(effort);
    if num_broken > 0 {
        eprintln!("{num_broken} promises are broken: see above");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}

fn single_precision(effort: Effort) {
    print_text(&format!("## Single precision inside\n\n{}\n", single::TEXT));
    print_header(&["centres", "condition", "all in f32", "images in f32", "input in f32", "fit, f64 time / f32 time"]);
    for problem in single::problems(if effort == Effort::Quick { 100 } else { 1000 }) {
        let single::Loss { condition, all, images, input } = problem.loss();
        let ratio = time(&problem, false) / time(&problem, true);
        println!("| {} | {condition:.0e} | {all:.0e} | {images:.0e} | {input:.0e} | {ratio:.1} |", problem.name);
    }
}

/// The least processor time of some fits, in seconds.
fn time(problem: &single::Problem, single: bool) -> f64 {
    let mut least = f64::INFINITY;
    let begin = ThreadTime::now();
    while begin.elapsed().as_secs_f64() < 0.2 {
        let start = ThreadTime::now();
        black_box(problem.fit(single));
        least = least.min(start.elapsed().as_secs_f64());
    }
    least
}
