//! The files of a shot.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use untangled_lab::Failure;
use untangled_testkit::{
    files::formats::obj,
    generate::Sheet,
    process::untangled,
    shots::{FlapShot, pc2},
};

/// A folder with a shot: `cloth.obj`, `cloth.pc2`, `ball.obj`, `ball.pc2`.
pub(crate) struct Scene {
    pub(crate) folder: PathBuf,
    pub(crate) num_frames: usize,
    pub(crate) num_faces: usize,
    pub(crate) num_vertices: usize,
}

impl Scene {
    pub(crate) fn write(folder: &Path, shot: &FlapShot) -> Result<Self, Failure> {
        let cloth: Vec<Sheet> = (0..shot.num_frames).map(|frame| shot.cloth(frame)).collect();
        let balls: Vec<Sheet> = (0..shot.num_frames).map(|frame| shot.ball(frame)).collect();
        for (name, frames) in [("cloth", &cloth), ("ball", &balls)] {
            fs::write(folder.join(format!("{name}.obj")), obj(&frames[0], false))?;
            fs::write(folder.join(format!("{name}.pc2")), pc2(frames))?;
        }
        Ok(Self {
            folder: folder.to_path_buf(),
            num_frames: cloth.len(),
            num_faces: cloth[0].faces.len(),
            num_vertices: cloth[0].positions.len(),
        })
    }

    /// A subcommand on the cloth of a cache.
    pub(crate) fn command(&self, subcommand: &str, cache: &str) -> Command {
        let mut command = Command::new(untangled());
        command.current_dir(&self.folder).args([subcommand, "cloth.obj", "--cache", cache, "--json"]);
        command.args(["--body", "ball.obj", "--body-cache", "ball.pc2"]);
        command
    }

    pub(crate) fn read(&self, name: &str) -> Result<Vec<u8>, Failure> {
        Ok(fs::read(self.folder.join(name))?)
    }
}
