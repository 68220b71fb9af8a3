//! Repairs of a session: how they are asked for and waited for.

use std::time::{Duration, Instant};

use super::{Repair, Session, StepTime};
use crate::{
    control::{Backoff, deadline_in},
    error::{PublishError, RepairError},
};

impl Session {
    /// Whether the session has repairs: where it was registered with them, by a daemon that knows them.
    pub fn has_repairs(&mut self) -> bool {
        self.link.current().is_some_and(|link| link.repairs.is_some())
    }

    /// Asks for a repair of the next state that is published, by whatever call. The correction of that frame comes as
    /// ever; the repair comes beside it when it is done, see [`poll_repair`](Self::poll_repair). With `time` the daemon
    /// sends the best state so far early enough to be here within that time; otherwise the setting
    /// `repair_deadline_us` limits it.
    pub fn ask_for_repair(&mut self, time: Option<Duration>) {
        self.wishes.ask(time);
    }

    /// The newest repair that has come since the last call, if any: of a frame that asked for one, or that the setting
    /// `repair` chose. Does not block.
    ///
    /// Add its displacements to the positions of its frame, or to those of now: a displacement of the cloth stays right
    /// for as long as it hangs as it hung then. What was handed out is taken as added, so repairs of frames that were
    /// published before are dropped.
    ///
    /// # Errors
    /// [`RepairError::Refused`] and [`RepairError::Receive`].
    pub fn poll_repair(&mut self) -> Result<Option<Repair>, RepairError> {
        let num_vertices = self.link.num_vertices();
        let Some(port) = self.link.current().and_then(|link| link.repairs.as_ref()) else { return Ok(None) };
        let mut newest = None;
        while let Some(sample) = port.receive(num_vertices).map_err(|reason| RepairError::Receive { reason })? {
            newest = Some(sample);
        }
        let Some(sample) = newest.filter(|sample| sample.header().frame > self.wishes.obsolete) else {
            return Ok(None);
        };
        let repair = Repair::new(sample)?;
        self.wishes.obsolete = self.frame;
        Ok(Some(repair))
    }

    /// Waits for the repair of a frame, up to the deadline.
    ///
    /// # Errors
    /// [`RepairError`].
    pub fn wait_repair(&mut self, frame: u64, deadline: Duration) -> Result<Repair, RepairError> {
        self.wait_repair_until(frame, Instant::now(), deadline_in(deadline))
    }

    /// Publishes a state in single precision that asks for a repair, and waits for that: one exchange from a tangled
    /// cloth to one that is certified clean, or to the best that the daemon reaches within the deadline.
    ///
    /// # Errors
    /// [`RepairError`].
    pub fn repair(
        &mut self,
        step: StepTime,
        deadline: Duration,
        fill: impl FnOnce(&mut [[f32; 3]]),
    ) -> Result<Repair, RepairError> {
        let (begin, deadline) = self.begin_repair(deadline)?;
        let frame = self.publish_f32(step, deadline, fill);
        let frame = self.asked(frame)?;
        self.wait_repair_until(frame, begin, deadline)
    }

    /// [`repair`](Self::repair) in double precision.
    ///
    /// # Errors
    /// [`RepairError`].
    pub fn repair_f64(
        &mut self,
        step: StepTime,
        deadline: Duration,
        fill: impl FnOnce(&mut [[f64; 3]]),
    ) -> Result<Repair, RepairError> {
        let (begin, deadline) = self.begin_repair(deadline)?;
        let frame = self.publish_f64_by(step, deadline, fill);
        let frame = self.asked(frame)?;
        self.wait_repair_until(frame, begin, deadline)
    }

    /// Says that the next state is no continuation of those before: with the setting `repair` = `auto` the daemon then
    /// begins anew to judge progress.
    pub fn begin_motion(&mut self) {
        self.wishes.progress = [0; 2];
    }

    /// Asks for a repair of the next state.
    fn begin_repair(&mut self, time: Duration) -> Result<(Instant, Instant), RepairError> {
        let (begin, deadline) = (Instant::now(), deadline_in(time));
        if self.link.live(deadline)?.repairs.is_none() {
            return Err(RepairError::NotOffered);
        }
        self.wishes.ask(Some(time));
        Ok((begin, deadline))
    }

    /// The frame that was published; nothing is asked for any more where it was not.
    fn asked(&mut self, frame: Result<u64, PublishError>) -> Result<u64, PublishError> {
        if frame.is_err() {
            self.wishes.take();
        }
        frame
    }

    fn wait_repair_until(&mut self, frame: u64, begin: Instant, deadline: Instant) -> Result<Repair, RepairError> {
        let num_vertices = self.link.num_vertices();
        let mut backoff = Backoff::new();
        loop {
            if let Some(port) = self.link.current().and_then(|link| link.repairs.as_ref()) {
                while let Some(sample) = port.receive(num_vertices).map_err(|reason| RepairError::Receive { reason })? {
                    let newest = sample.header().frame;
                    if newest == frame {
                        let repair = Repair::new(sample)?;
                        self.wishes.obsolete = self.frame;
                        return Ok(repair);
                    }
                    if newest > frame {
                        return Err(RepairError::Overtaken { frame, newest });
                    }
                }
            }
            self.link.lose_if_gone();
            let Some(link) = self.link.current() else { return Err(RepairError::DaemonLost { frame }) };
            if link.repairs.is_none() {
                return Err(RepairError::NotOffered);
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(RepairError::Timeout { frame, waited: begin.elapsed() });
            }
            backoff.sleep(&link.listener, left);
        }
    }
}
