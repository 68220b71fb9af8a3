//! How a simulator talks to untangled. This is the file to read before you integrate your own.
//!
//! One step of a host:
//!
//! 1. write the positions of this instant into the sample that the session lends ([`Session::exchange`] does it in
//!    place);
//! 2. wait for the correction of exactly this frame, but no longer than a deadline, after which the simulation
//!    continues without;
//! 3. take from each vertex the value, in the unit that was asked for at registration, and the flags;
//! 4. add the values to the next step, and in that step **switch self-collision off** where a flag of [`flags::MASK`]
//!    is set.
//!
//! The fourth point is essential. Self-collision keeps each vertex on the side where it is, so where it is on, a force
//! only presses the cloth against itself; see `--force-only`. Without the force nothing moves the cloth back; see
//! `--mask-only`.

use std::{
    io,
    path::PathBuf,
    time::{Duration, Instant},
};

use thiserror::Error;
use untangled_checker::CheckError;
use untangled_client::{
    Client, ClientOptions, ConnectError, Correction, CorrectionHeader, CorrectionKind, ExchangeError, PublishError,
    RegisterError, Registration, RepairError, Session, StepTime, Uvs, WaitError, flags,
};

use crate::{
    mesh::{Vec3, to_f32},
    obj::ObjError,
    repairs::{self, RepairPolicy},
    solver::{Help, Solver},
};

/// Which part of a correction is used. All but the first are controls: none of them untangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Use {
    /// Values and mask.
    #[default]
    Everything,
    /// Values, with self-collision on everywhere.
    ValuesOnly,
    /// The mask, without values.
    MaskOnly,
    /// Nothing: the daemon only watches.
    Nothing,
}

/// How this host exchanges.
#[derive(Clone, Debug)]
pub struct HostOptions {
    /// Domain of the daemon; the default one without it.
    pub domain: Option<String>,
    /// How long to wait for the daemon at the start.
    pub connect_timeout: Duration,
    /// How long to wait for a correction before the simulation goes on without.
    pub deadline: Duration,
    /// Length of a step in seconds.
    pub dt_s: f64,
    /// What corrections shall be.
    pub correction: CorrectionKind,
    /// Which part of them is used.
    pub use_of_corrections: Use,
    /// Which frames the daemon shall repair.
    pub repair: RepairPolicy,
    /// How long to wait for a repair before the simulation goes on without.
    pub repair_deadline: Duration,
    /// Settings of the untangler by name; `null` for its defaults.
    pub settings: serde_json::Value,
}

/// Why the host can't continue.
#[derive(Debug, Error)]
pub enum HostError {
    /// No daemon to talk to.
    #[error(transparent)]
    Connect(#[from] ConnectError),
    /// The daemon does not take the cloth.
    #[error(transparent)]
    Register(#[from] RegisterError),
    /// The exchange failed for good.
    #[error(transparent)]
    Exchange(#[from] ExchangeError),
    /// Repairs failed for good.
    #[error(transparent)]
    Repair(#[from] RepairError),
    /// The simulation went wrong.
    #[error(transparent)]
    Check(#[from] CheckError),
    /// A mesh file can't be used.
    #[error(transparent)]
    Obj(#[from] ObjError),
    /// A result can't be written into a file or folder.
    #[error("{}: {source}", path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A line can't be printed.
    #[error("writing to standard output: {0}")]
    Output(#[from] io::Error),
}

/// The result of one exchange.
#[derive(Clone, Copy, Debug)]
pub struct StepReport {
    /// What the daemon says of the state that was published; `None` if its answer did not come in time.
    pub header: Option<CorrectionHeader>,
    /// Length of the longest value, in the unit of the kind of correction.
    pub largest_value: f64,
    /// Number of vertices whose self-collision is off.
    pub num_masked: usize,
    /// From publishing to having the correction.
    pub round_trip: Duration,
    /// Whether the cloth was repaired; then whether nothing intersects any more, for certain.
    pub repaired: Option<bool>,
}

/// A simulator with its session.
#[derive(Debug)]
pub struct Host {
    solver: Solver,
    session: Session,
    options: HostOptions,
    simulated_s: f64,
    velocity_change_m_s: Vec<Vec3>,
    displacement_m: Vec<Vec3>,
    no_contact: Vec<bool>,
}

impl Host {
    /// Connects to the daemon and registers the cloth.
    ///
    /// # Errors
    /// [`HostError::Connect`] and [`HostError::Register`].
    pub fn new(solver: Solver, options: HostOptions) -> Result<Self, HostError> {
        let client =
            Client::connect(ClientOptions { domain: options.domain.clone(), timeout: options.connect_timeout })?;
        let is_offered = client.daemon().features.iter().any(|feature| feature == "repair");
        let repair = if is_offered { options.repair } else { RepairPolicy::Never };
        let cloth = solver.cloth();
        let session = client.register(Registration {
            num_vertices: cloth.positions.len(),
            triangles: cloth.triangles.clone(),
            uvs: cloth
                .uvs
                .as_ref()
                .map(|uvs| Uvs { coordinates: uvs.coordinates.clone(), corners: uvs.corners.clone() }),
            rest_positions: Some(cloth.rest_positions.iter().map(|&position| position.into()).collect()),
            // A force needs masses; the other kinds are better for them too.
            masses_kg: Some(solver.masses_kg().to_vec()),
            pins: cloth.pins.clone(),
            correction: options.correction,
            repairs: repair != RepairPolicy::Never,
            settings: repair.complete(&options.settings, options.repair_deadline),
            ..Registration::default()
        })?;
        let num_vertices = cloth.positions.len();
        Ok(Self {
            solver,
            session,
            options,
            simulated_s: 0.0,
            velocity_change_m_s: vec![Vec3::zeros(); num_vertices],
            displacement_m: vec![Vec3::zeros(); num_vertices],
            no_contact: vec![false; num_vertices],
        })
    }

    /// The simulator.
    #[must_use]
    pub fn solver(&self) -> &Solver {
        &self.solver
    }

    /// Publishes the current state and takes its correction. The state changes in [`advance`](Self::advance), and where
    /// the daemon repairs it.
    ///
    /// # Errors
    /// [`HostError::Exchange`] and [`HostError::Repair`] for errors that would repeat in the next frame.
    pub fn exchange(&mut self) -> Result<StepReport, HostError> {
        let step = StepTime { simulated_s: self.simulated_s, dt_s: self.options.dt_s };
        let begin = Instant::now();
        let answer = self.session.exchange(step, self.options.deadline, |slots| {
            for (slot, position) in slots.iter_mut().zip(&self.solver.cloth().positions) {
                *slot = position.map(to_f32).into();
            }
        });
        let round_trip = begin.elapsed();
        let correction = match answer {
            Ok(correction) => Some(correction),
            // The simulation continues while the daemon is slow, gone or restarting, since the session reconnects
            // without help.
            Err(
                ExchangeError::Publish(PublishError::Reconnecting)
                | ExchangeError::Wait(
                    WaitError::Timeout { .. } | WaitError::DaemonLost { .. } | WaitError::Overtaken { .. },
                ),
            ) => None,
            // As late as one that did not come in time.
            Err(ExchangeError::Wait(WaitError::Refused(refusal))) if refusal.is_transient() => None,
            Err(error) => return Err(error.into()),
        };
        let is_being_repaired = correction.as_ref().is_some_and(Correction::is_being_repaired);
        let mut repaired = None;
        if is_being_repaired && self.options.use_of_corrections == Use::Everything {
            let Self { session, solver, options, .. } = self;
            let frame = session.frame();
            repaired = repairs::take(session, solver, frame, options.repair_deadline)?;
        }
        // What helps against a tangle would bring another one where it is gone.
        let largest_value = self.take(correction.as_ref().filter(|_| repaired != Some(true)));
        Ok(StepReport {
            repaired,
            header: correction.as_ref().map(|correction| *correction.header()),
            largest_value,
            num_masked: self.no_contact.iter().filter(|&&off| off).count(),
            round_trip,
        })
    }

    /// Simulates one step with the correction of the last exchange.
    pub fn advance(&mut self) {
        let help = Help {
            velocity_change_m_s: &self.velocity_change_m_s,
            displacement_m: &self.displacement_m,
            no_contact: &self.no_contact,
            contact_filter: None,
        };
        self.solver.step(self.options.dt_s, help);
        self.simulated_s += self.options.dt_s;
    }

    /// Converts a correction to [`Help`] of the solver and returns the length of its longest value. Without a
    /// correction there is no help.
    fn take(&mut self, correction: Option<&Correction>) -> f64 {
        self.velocity_change_m_s.fill(Vec3::zeros());
        self.displacement_m.fill(Vec3::zeros());
        self.no_contact.fill(false);
        let Some(correction) = correction else { return 0.0 };
        let (values, mask) = match self.options.use_of_corrections {
            Use::Everything => (true, true),
            Use::ValuesOnly => (true, false),
            Use::MaskOnly => (false, true),
            Use::Nothing => (false, false),
        };
        let dt_s = self.options.dt_s;
        let mut largest: f64 = 0.0;
        for (vertex, correction) in correction.vertices().iter().enumerate() {
            let value = Vec3::from(correction.value.map(f64::from));
            largest = largest.max(value.norm());
            self.no_contact[vertex] = mask && correction.flags & flags::MASK != 0;
            if !values {
                continue;
            }
            match self.options.correction {
                CorrectionKind::Force => {
                    self.velocity_change_m_s[vertex] = value * (dt_s / self.solver.masses_kg()[vertex]);
                }
                CorrectionKind::Acceleration => self.velocity_change_m_s[vertex] = value * dt_s,
                CorrectionKind::VelocityChange => self.velocity_change_m_s[vertex] = value,
                CorrectionKind::Displacement => self.displacement_m[vertex] = value,
            }
        }
        largest
    }
}
