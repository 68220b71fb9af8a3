//! The files of a shot.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use untangled_lab::{Failure, simulated_shot::SimulatedShot};
use untangled_testkit::{
    files::formats::obj,
    generate::Sheet,
    process::untangled,
    shots::{FlapShot, mdd, numbered_obj, pc2, usda},
};

/// A shot, frame by frame, and what it is.
pub(crate) struct Shot {
    pub(crate) words: &'static str,
    pub(crate) cloth: Vec<Sheet>,
    pub(crate) body: Vec<Sheet>,
}

impl Shot {
    pub(crate) fn generated(shot: &FlapShot) -> Self {
        Self {
            words: "A generated cloth, folded once, swings over a moving ball. In three runs of frames its layers pass \
                    through each other, in one the ball passes through it. As PC2, made by",
            cloth: (0..shot.num_frames).map(|frame| shot.cloth(frame)).collect(),
            body: (0..shot.num_frames).map(|frame| shot.ball(frame)).collect(),
        }
    }

    pub(crate) fn simulated(shot: &SimulatedShot) -> Result<Self, Failure> {
        let [cloth, body] = shot.simulate()?;
        Ok(Self {
            words: "Two skirts over each other on a body that sways and turns, simulated by the example host's solver, \
                    which forgets all contact in four lapses; afterwards the untangler's forces bring them apart \
                    again, step by step. As PC2, made by",
            cloth,
            body,
        })
    }
}

/// A folder with a shot: `cloth.obj`, `cloth.pc2`, `body.obj`, `body.pc2`.
pub(crate) struct Scene {
    pub(crate) folder: PathBuf,
    pub(crate) num_frames: usize,
    pub(crate) num_faces: usize,
    pub(crate) num_vertices: usize,
}

impl Scene {
    pub(crate) fn write(folder: &Path, shot: &Shot) -> Result<Self, Failure> {
        fs::create_dir_all(folder)?;
        let Shot { cloth, body, .. } = shot;
        for (name, frames) in [("cloth", cloth), ("body", body)] {
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

    /// The same cloth in the other formats: `cloth.mdd`, `NNN.obj`, `cloth.usda`.
    pub(crate) fn write_formats(&self, shot: &Shot) -> Result<(), Failure> {
        fs::write(self.folder.join("cloth.mdd"), mdd(&shot.cloth))?;
        fs::write(self.folder.join("cloth.usda"), usda(&shot.cloth))?;
        for (name, bytes) in numbered_obj(&shot.cloth, 0) {
            fs::write(self.folder.join(name), bytes)?;
        }
        Ok(())
    }

    /// A subcommand on the cloth of a cache.
    pub(crate) fn command(&self, subcommand: &str, cache: &str) -> Command {
        let mut command = Command::new(untangled());
        command.current_dir(&self.folder).arg(subcommand);
        match cache.ends_with(".usda") {
            true => command.args([cache, "--prim", "/garment"]),
            false => command.args(["cloth.obj", "--cache", cache]),
        };
        command.args(["--json", "--body", "body.obj", "--body-cache", "body.pc2"]);
        command
    }

    pub(crate) fn read(&self, name: &str) -> Result<Vec<u8>, Failure> {
        Ok(fs::read(self.folder.join(name))?)
    }
}
