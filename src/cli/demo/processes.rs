//! The processes of a demonstration: a daemon, and what it needs to be alone.

use std::{
    cell::RefCell,
    env, fs,
    io::ErrorKind,
    os::unix::fs::DirBuilderExt,
    path::PathBuf,
    process::{Child, Command, Stdio},
};

use rustix::process::{Pid, Signal, kill_process};

use untangled_transport::{Domain, lock::WipeOnLeave};

use super::error::DemoError;

/// A command that runs this program.
pub(super) fn this_program() -> Result<Command, DemoError> {
    env::current_exe().map(Command::new).map_err(DemoError::system("finding this program"))
}

/// A domain and a folder of this process alone. The folder is removed when dropped.
#[derive(Debug)]
pub(super) struct Scratch {
    pub(super) domain: String,
    pub(super) folder: PathBuf,
}

impl Scratch {
    pub(super) fn new() -> Result<Self, DemoError> {
        let domain = format!("demo-{}", std::process::id());
        let mut folder = env::temp_dir().join(format!("untangled-{domain}"));
        // One that is there already may be another user's.
        for attempt in 1.. {
            match fs::DirBuilder::new().mode(0o700).create(&folder) {
                Err(error) if error.kind() == ErrorKind::AlreadyExists && attempt < 100 => {}
                made => {
                    made.map_err(DemoError::system(format!("creating {}", folder.display())))?;
                    break;
                }
            }
            folder.set_file_name(format!("untangled-{domain}-{attempt}"));
        }
        Ok(Self { domain, folder })
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // The system removes temporary files itself, so an error here is ignored.
        let _ = fs::remove_dir_all(&self.folder);
        // A daemon that was killed has left its files.
        if let Ok(domain) = Domain::locate(Some(&self.domain)) {
            drop(WipeOnLeave(domain));
        }
    }
}

/// A daemon in a process of its own. [`stop`](Self::stop) asks it to end; dropping kills it.
#[derive(Debug)]
pub(super) struct Daemon {
    child: RefCell<Child>,
    log: PathBuf,
}

impl Daemon {
    pub(super) fn start(scratch: &Scratch) -> Result<Self, DemoError> {
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

    /// Returns an error if the daemon has ended.
    pub(super) fn check_alive(&self) -> Result<(), DemoError> {
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
    pub(super) fn stop(&self) -> Result<(), DemoError> {
        self.check_alive()?;
        let mut child = self.child.borrow_mut();
        kill_process(Pid::from_child(&child), Signal::TERM)
            .map_err(|error| DemoError::system("stopping the daemon")(error.into()))?;
        child.wait().map_err(DemoError::system("waiting for the daemon"))?;
        Ok(())
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        let child = self.child.get_mut();
        // After `stop` the process has ended already, so errors are ignored.
        let _ = child.kill();
        let _ = child.wait();
    }
}
