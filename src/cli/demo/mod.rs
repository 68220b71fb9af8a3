//! `untangled demo`: a daemon and a host as two processes, a tangle, and what becomes of it.

use std::{
    env, fs,
    io::{self, Write},
    path::{Path, PathBuf},
    process::{Child, Command, ExitStatus, Stdio},
};

use clap::Args;
use thiserror::Error;
use untangled_publisher::{
    cli::{self, PublishArgs},
    host::HostError,
    obj::{self, ObjError},
    report::Summary,
};

use super::{
    Outcome,
    picture::{Picture, View},
};
use untangle::{analysis::analyse, frame::{Frame, FrameError}, mesh::{Mesh, MeshDescription, MeshError, Uvs}};

/// Size of the pictures in pixels.
const PICTURE: [usize; 2] = [1600, 1000];

/// Untangle a generated scene, or a file, through a daemon and a simulator as two processes.
///
/// A control comes first: the same run with corrections ignored. Pictures and meshes of before and after are written. Exit code 0: the exact check
/// finds the last state clean; 1: intersections remain.
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

/// Why the demonstration could not be given.
#[derive(Debug, Error)]
pub enum DemoError {
    /// A file or a process failed.
    #[error("{what}: {source}")]
    System {
        /// What was tried.
        what: String,
        /// What the system said.
        source: io::Error,
    },
    /// The publisher ended with an error, which it has printed.
    #[error("the publisher failed ({0})")]
    Publisher(ExitStatus),
    /// The daemon ended before its time.
    #[error("the daemon ended ({status}): {log}")]
    Daemon {
        /// How it ended.
        status: ExitStatus,
        /// The last line that it wrote.
        log: String,
    },
    /// The publisher's summary is not one.
    #[error("the publisher's summary: {0}")]
    Summary(#[from] serde_json::Error),
    /// A mesh can't be read.
    #[error(transparent)]
    Obj(#[from] ObjError),
    /// A mesh is no cloth.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A state is no state of the mesh.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// A picture can't be written.
    #[error("writing {path}: {source}")]
    Picture {
        /// The picture.
        path: PathBuf,
        /// What the encoder said.
        source: png::EncodingError,
    },
}

impl DemoError {
    fn system(what: impl Into<String>) -> impl FnOnce(io::Error) -> Self {
        let what = what.into();
        move |source| Self::System { what, source }
    }
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

/// Runs the demonstration.
///
/// # Errors
/// [`DemoError`].
pub fn run(args: &DemoArgs, out: &mut dyn Write) -> Result<Outcome, DemoError> {
    let say = |out: &mut dyn Write, text: &str| {
        writeln!(out, "{text}").and_then(|()| out.flush()).map_err(DemoError::system("writing to standard output"))
    };
    fs::create_dir_all(&args.out).map_err(DemoError::system(format!("creating {}", args.out.display())))?;
    let scratch = Scratch::new()?;
    let daemon = Daemon::start(&scratch)?;
    let before = if args.no_control {
        None
    } else {
        say(out, &format!("control: {} steps with corrections ignored", args.frames))?;
        let control = start_publisher(args, &scratch, &daemon, &["--no-corrections", "--clean-frames", "0"])?;
        let verdict = if control.clean { "it fell out of its tangle by itself" } else { "it stays tangled" };
        let (first, last) = (control.num_edge_face_before, control.num_edge_face_after);
        say(out, &format!("control: {first} edge-face intersections became {last}: {verdict}\n"))?;
        Some(control)
    };
    say(out, "untangling: the same again, with corrections applied")?;
    let folder = args.out.to_string_lossy().into_owned();
    let summary = start_publisher(args, &scratch, &daemon, &["--out", &folder])?;
    daemon.stop()?;
    let (first, last) = (summary.num_edge_face_before, summary.num_edge_face_after);
    let verdict = if summary.clean { "clean" } else { "not clean" };
    say(
        out,
        &format!(
            "untangling: {first} edge-face intersections became {last} in {} frames: {verdict}",
            summary.num_frames
        ),
    )?;
    if let Some(control) = before
        && control.clean
    {
        say(out, "note: the control came clean as well, so this shows nothing about the corrections")?;
    }
    draw(&args.out, &summary)?;
    say(out, &format!("wrote before.obj, after.obj, before.png and after.png into {}", args.out.display()))?;
    Ok(outcome(&summary))
}

/// Runs the publisher as a process of its own. It prints its lines itself.
fn start_publisher(args: &DemoArgs, scratch: &Scratch, daemon: &Daemon, more: &[&str]) -> Result<Summary, DemoError> {
    let summary = scratch.folder.join("summary.json");
    let mut command = this_program()?;
    command.arg("publish").args(&args.file).args(["--domain", &scratch.domain]).arg("--summary").arg(&summary);
    command.args(["--frames", &args.frames.to_string()]).args(more).args(&args.publisher);
    let status = command.status().map_err(DemoError::system("starting the publisher"))?;
    if !matches!(status.code(), Some(0 | 1)) {
        daemon.check_alive()?;
        return Err(DemoError::Publisher(status));
    }
    let text = fs::read(&summary).map_err(DemoError::system(format!("reading {}", summary.display())))?;
    Ok(serde_json::from_slice(&text)?)
}

/// Draws both states, seen from the same place.
fn draw(folder: &Path, summary: &Summary) -> Result<(), DemoError> {
    let mut view = None;
    for (name, count) in [("before", summary.num_edge_face_before), ("after", summary.num_edge_face_after)] {
        let cloth = obj::read(&folder.join(name).with_extension("obj"))?;
        let positions = cloth.points();
        let mesh = Mesh::new(MeshDescription {
            num_vertices: positions.len(),
            faces: cloth.triangles,
            uvs: cloth.uvs.map(|uvs| Uvs { coordinates: uvs.coordinates, corners: uvs.corners }),
            ..MeshDescription::default()
        })?;
        let frame = Frame::new(&mesh, &positions)?;
        let view = view.get_or_insert_with(|| View::of(frame.positions(), PICTURE[0], PICTURE[1]));
        let title = format!("{name}: {count} edge-face intersections");
        let picture = Picture::draw(view, &mesh, &frame, &analyse(&mesh, &frame), &title);
        let path = folder.join(name).with_extension("png");
        picture.write_png(&path).map_err(|source| DemoError::Picture { path, source })?;
    }
    Ok(())
}

fn this_program() -> Result<Command, DemoError> {
    env::current_exe().map(Command::new).map_err(DemoError::system("finding this program"))
}

/// A domain and a folder that nobody else has.
#[derive(Debug)]
struct Scratch {
    domain: String,
    folder: PathBuf,
}

impl Scratch {
    fn new() -> Result<Self, DemoError> {
        let domain = format!("demo-{}", std::process::id());
        let folder = env::temp_dir().join(format!("untangled-{domain}"));
        fs::create_dir_all(&folder).map_err(DemoError::system(format!("creating {}", folder.display())))?;
        Ok(Self { domain, folder })
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // What can't be removed is left to the system's own cleaning of temporary files.
        let _ = fs::remove_dir_all(&self.folder);
    }
}

/// A daemon of our own. Dropped, it is killed; [`stop`](Self::stop) asks it to end.
#[derive(Debug)]
struct Daemon {
    child: std::cell::RefCell<Child>,
    log: PathBuf,
}

impl Daemon {
    fn start(scratch: &Scratch) -> Result<Self, DemoError> {
        let log = scratch.folder.join("daemon.log");
        let file = fs::File::create(&log).map_err(DemoError::system(format!("creating {}", log.display())))?;
        let child = this_program()?
            .args(["serve", "--domain", &scratch.domain])
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(file)
            .spawn()
            .map_err(DemoError::system("starting the daemon"))?;
        Ok(Self { child: child.into(), log })
    }

    /// An error if the daemon has ended.
    fn check_alive(&self) -> Result<(), DemoError> {
        let ended = self.child.borrow_mut().try_wait().map_err(DemoError::system("watching the daemon"))?;
        match ended {
            None => Ok(()),
            Some(status) => {
                let log = fs::read_to_string(&self.log).unwrap_or_default();
                Err(DemoError::Daemon { status, log: log.lines().last().unwrap_or("it said nothing").into() })
            }
        }
    }

    /// Asks the daemon to end, as a supervisor would, and waits until it has cleaned up.
    fn stop(&self) -> Result<(), DemoError> {
        self.check_alive()?;
        let mut child = self.child.borrow_mut();
        rustix::process::kill_process(rustix::process::Pid::from_child(&child), rustix::process::Signal::TERM)
            .map_err(|error| DemoError::system("stopping the daemon")(error.into()))?;
        child.wait().map_err(DemoError::system("waiting for the daemon"))?;
        Ok(())
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        let child = self.child.get_mut();
        // After `stop` there is nothing left to kill, and that is no error.
        let _ = child.kill();
        let _ = child.wait();
    }
}
