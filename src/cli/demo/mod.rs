//! `untangled demo`: a daemon and a simulator as two processes, a tangled cloth, and a control without corrections.
//!
//! | module | purpose |
//! |---|---|
//! | `error` | why the demonstration could not be given |
//! | `processes` | the daemon, on a domain of its own |
//! | `pictures` | before.png and after.png |
//! | `words` | what is said at the end |

mod error;
mod pictures;
mod processes;
mod words;

use std::{
    fs,
    io::{self, Write},
    path::PathBuf,
};

use clap::Args;
use untangled_publisher::{
    cli::{self, PublishArgs},
    host::HostError,
    report::Summary,
};

pub use error::DemoError;

use super::outcome::Outcome;
use processes::{Daemon, Scratch, this_program};

/// Untangle a generated scene, or a file, through a daemon and a simulator as two processes.
///
/// A control follows: the same run with corrections ignored. Pictures and meshes of before and after are written. Exit
/// code 0: the exact check finds the last state clean; 1: intersections remain.
#[derive(Clone, Debug, Args)]
pub struct DemoArgs {
    /// Wavefront OBJ file to untangle, without gravity and with its own shape at rest, instead of the generated scene.
    pub file: Option<PathBuf>,
    /// Folder for before.obj, after.obj, before.png and after.png.
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub out: PathBuf,
    /// Most steps to simulate, in the control and in the run with corrections.
    #[arg(long, value_name = "N", default_value_t = 300)]
    pub frames: usize,
    /// Leave out the control: the same run without corrections.
    #[arg(long)]
    pub no_control: bool,
    /// More arguments for the publisher, after `--`; see `untangled publish --help`.
    #[arg(last = true)]
    pub publisher: Vec<String>,
}

/// Runs the publisher's own command line in this process.
///
/// # Errors
/// [`HostError`].
pub fn publish(args: &PublishArgs) -> Result<Outcome, HostError> {
    Ok(outcome(&cli::publish(args, &mut io::stdout())?))
}

fn outcome(summary: &Summary) -> Outcome {
    if summary.clean { Outcome::Clean } else { Outcome::Remaining }
}

/// Runs the demonstration. Its text fits a screen of 24 lines of 100 columns, but for very long runs.
///
/// # Errors
/// [`DemoError`].
pub fn run(args: &DemoArgs, out: &mut dyn Write) -> Result<Outcome, DemoError> {
    let mut say = |text: &str| {
        writeln!(out, "{text}").and_then(|()| out.flush()).map_err(DemoError::system("writing to standard output"))
    };
    fs::create_dir_all(&args.out).map_err(DemoError::system(format!("creating {}", args.out.display())))?;
    let scratch = Scratch::new()?;
    let daemon = Daemon::start(&scratch)?;
    say("Untangling: a simulator sends each step to the daemon, another process, and applies its answer.")?;
    let folder = args.out.to_string_lossy().into_owned();
    let summary = run_publisher(args, &scratch, &daemon, &["--out", &folder])?;
    say(&words::untangled(&summary))?;
    let control = if args.no_control {
        None
    } else {
        say(&format!("\nControl: the same for {} steps, with all corrections ignored.", args.frames))?;
        let control = run_publisher(args, &scratch, &daemon, &["--no-corrections", "--clean-frames", "0"])?;
        say(&words::control(&control))?;
        Some(control)
    };
    daemon.stop()?;
    let mesh = pictures::draw(&args.out, &summary)?;
    say("")?;
    say(&words::shown(&mesh, &summary, control.as_ref(), &args.out))?;
    Ok(outcome(&summary))
}

/// Runs the publisher as a process of its own, which prints its table itself.
fn run_publisher(args: &DemoArgs, scratch: &Scratch, daemon: &Daemon, more: &[&str]) -> Result<Summary, DemoError> {
    let summary = scratch.folder.join("summary.json");
    let mut command = this_program()?;
    command.args(["publish", "--brief"]).args(&args.file).args(["--domain", &scratch.domain]);
    command.arg("--summary").arg(&summary).args(["--frames", &args.frames.to_string()]);
    command.args(more).args(&args.publisher);
    let status = command.status().map_err(DemoError::system("starting the publisher"))?;
    if !matches!(status.code(), Some(0 | 1)) {
        daemon.check_alive()?;
        return Err(DemoError::Publisher(status));
    }
    let text = fs::read(&summary).map_err(DemoError::system(format!("reading {}", summary.display())))?;
    Ok(serde_json::from_slice(&text)?)
}
