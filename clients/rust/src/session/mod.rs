//! A session: one cloth, its states and its corrections.

mod correction;
mod dense;
mod link;
mod loan;
mod paths;
mod reconnect;
mod repair;
mod repairs;
mod samples;

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use untangled_proto::{
    Precision, RequestKind, names,
    sections::{SectionWriter, id},
};

use crate::{
    control::{Backoff, Connection, Pending, deadline_in},
    error::{
        ExchangeError, FrameRefusal, NewestError, PublishError, RegisterError, RequestError, WaitError, iceoryx2_says,
    },
    registration::{Registration, settings_bytes},
};
pub use correction::Correction;
pub(crate) use correction::refusal;
use dense::DenseViews;
pub use loan::{Loan, LoanMemory, StepTime};
pub use paths::Paths;
use reconnect::ReconnectingLink;
pub use repair::Repair;
use repair::Wishes;
use samples::CorrectionSample;

/// One cloth that the daemon knows.
///
/// A session is registered again by its next call after the daemon went away and another one is up. A call never blocks
/// beyond its deadline: a registration that takes longer goes on in the next call. Each time that the session is
/// registered again
/// [`num_registrations`](Self::num_registrations) grows and a `tracing` event says so.
#[derive(Debug)]
pub struct Session {
    link: ReconnectingLink,
    frame: u64,
    wishes: Wishes,
    dense: Arc<DenseViews>,
}

impl Session {
    pub(crate) fn open(connection: Arc<Connection>, registration: Registration) -> Result<Self, RegisterError> {
        let fixed = [registration.pins.as_slice(), &registration.body].concat();
        let dense = Arc::new(DenseViews::new(registration.num_vertices, &fixed));
        let link = ReconnectingLink::open(connection, registration)?;
        Ok(Self { link, frame: 0, wishes: Wishes::default(), dense })
    }

    /// Number of vertices.
    #[must_use]
    pub fn num_vertices(&self) -> usize {
        self.link.num_vertices()
    }

    /// Number of the last frame that was published; 0 before the first.
    #[must_use]
    pub fn frame(&self) -> u64 {
        self.frame
    }

    /// How often the session was registered: more than once if a daemon went away.
    #[must_use]
    pub fn num_registrations(&self) -> u32 {
        self.link.num_registrations()
    }

    /// Whether the daemon sends sparse corrections, as asked for at registration: not where it is too old. It may
    /// change when the session is registered again.
    #[must_use]
    pub fn is_sparse(&self) -> bool {
        self.link.options().is_sparse()
    }

    /// Whether corrections have labels, as asked for at registration: not where the daemon is too old. It may change
    /// when the session is registered again.
    #[must_use]
    pub fn has_labels(&self) -> bool {
        self.link.options().has_labels()
    }

    /// Vertices that became one with an earlier one in their place, where [`Registration::weld`] asked for that.
    #[must_use]
    pub fn num_welded_vertices(&self) -> usize {
        self.link.num_welded()
    }

    /// A deadline for hosts that have no frame rate to keep: 0.2 s, and 20 microseconds for each triangle, which leaves
    /// room for a busy machine.
    #[must_use]
    pub fn default_deadline(&self) -> Duration {
        let num_faces = u32::try_from(self.link.num_faces()).unwrap_or(u32::MAX);
        Duration::from_millis(200) + num_faces * Duration::from_micros(20)
    }

    /// Ends the session and tells the daemon, which has up to the deadline to take note. A session that is dropped ends
    /// too: the daemon finds out that its host is gone.
    ///
    /// # Errors
    /// [`RequestError`]; the session has ended on this side in any case.
    pub fn close(mut self, deadline: Duration) -> Result<(), RequestError> {
        self.link.close(deadline_in(deadline))
    }

    /// Publishes a state in single precision and returns its frame number. `fill` writes in place into shared memory;
    /// the slice holds positions of an earlier frame, so every position must be written.
    ///
    /// Does not block; after a restart of the daemon it may take some calls until the session is registered again.
    ///
    /// # Errors
    /// [`PublishError`]; `fill` was not called then.
    pub fn publish(&mut self, step: StepTime, fill: impl FnOnce(&mut [[f32; 3]])) -> Result<u64, PublishError> {
        self.publish_f32(step, Instant::now(), fill)
    }

    /// [`publish`](Self::publish) in double precision.
    ///
    /// # Errors
    /// [`PublishError`]; `fill` was not called then.
    pub fn publish_f64(&mut self, step: StepTime, fill: impl FnOnce(&mut [[f64; 3]])) -> Result<u64, PublishError> {
        self.publish_f64_by(step, Instant::now(), fill)
    }

    /// Lends the memory of the next state, for hosts that can't write all of it in one call; [`send`](Self::send)
    /// publishes it. One at a time: until it is sent or dropped, this and [`publish`](Self::publish) fail. Does not
    /// block.
    ///
    /// # Errors
    /// [`PublishError`].
    pub fn loan(&mut self, step: StepTime) -> Result<Loan, PublishError> {
        self.loan_by(step, Instant::now())
    }

    /// Publishes a state that was lent by this session and returns its frame number. Does not block.
    ///
    /// # Errors
    /// [`PublishError::Reconnecting`] where the daemon went away since; the positions that were written are lost.
    pub fn send(&mut self, loan: Loan) -> Result<u64, PublishError> {
        if loan.num_registrations() != self.link.num_registrations() || self.link.current().is_none() {
            return Err(PublishError::Reconnecting);
        }
        let frame = self.frame + 1;
        // The daemon registered no more than fits.
        loan.send(frame, u32::try_from(self.link.num_vertices()).unwrap_or(u32::MAX), self.wishes.take())?;
        self.frame = frame;
        self.link.connection().wake(names::EVENT_STATE);
        Ok(frame)
    }

    /// Waits for the correction of a frame, up to the deadline.
    ///
    /// # Errors
    /// [`WaitError`].
    pub fn wait(&mut self, frame: u64, deadline: Duration) -> Result<Correction, WaitError> {
        self.wait_until(frame, Instant::now(), deadline_in(deadline))
    }

    /// The newest correction that has come since the last call, if any. Does not block.
    ///
    /// # Errors
    /// [`NewestError`].
    pub fn newest(&mut self) -> Result<Option<Correction>, NewestError> {
        let mut newest = None;
        while let Some(sample) = self.receive().map_err(|reason| NewestError::Receive { reason })? {
            newest = Some(sample);
        }
        Ok(newest.map(|sample| self.correction(sample)).transpose()?)
    }

    /// Publishes a state in single precision and waits for its correction: lock step. See [`publish`](Self::publish)
    /// for `fill`.
    ///
    /// # Errors
    /// [`ExchangeError`]; after [`WaitError::DaemonLost`] and [`PublishError::Reconnecting`] the next call retries.
    pub fn exchange(
        &mut self,
        step: StepTime,
        deadline: Duration,
        fill: impl FnOnce(&mut [[f32; 3]]),
    ) -> Result<Correction, ExchangeError> {
        let (begin, deadline) = (Instant::now(), deadline_in(deadline));
        let frame = self.publish_f32(step, deadline, fill)?;
        Ok(self.wait_until(frame, begin, deadline)?)
    }

    /// [`exchange`](Self::exchange) in double precision.
    ///
    /// # Errors
    /// [`ExchangeError`].
    pub fn exchange_f64(
        &mut self,
        step: StepTime,
        deadline: Duration,
        fill: impl FnOnce(&mut [[f64; 3]]),
    ) -> Result<Correction, ExchangeError> {
        let (begin, deadline) = (Instant::now(), deadline_in(deadline));
        let frame = self.publish_f64_by(step, deadline, fill)?;
        Ok(self.wait_until(frame, begin, deadline)?)
    }

    /// Replaces the session's settings from the next frame on; names left out take the daemon's defaults.
    ///
    /// # Errors
    /// [`RequestError`]; the old settings stay in force then.
    pub fn update_settings(&mut self, settings: serde_json::Value, deadline: Duration) -> Result<(), RequestError> {
        let deadline = deadline_in(deadline);
        let session = match self.link.live(deadline) {
            Ok(link) => link.session,
            Err(PublishError::Request(error)) => return Err(error),
            Err(_) => return Err(RequestError::no_daemon(&self.link.connection().domain)),
        };
        let document = settings_bytes(&settings).unwrap_or_else(|| b"{}".to_vec());
        let (payload, num_sections) = SectionWriter::default().bytes(id::SETTINGS, document).finish();
        let connection = self.link.connection();
        Pending::send(connection, RequestKind::UpdateSettings, session, &payload, num_sections)?
            .wait(connection, deadline)?;
        self.link.set_settings(settings);
        Ok(())
    }

    fn publish_f32(
        &mut self,
        step: StepTime,
        deadline: Instant,
        fill: impl FnOnce(&mut [[f32; 3]]),
    ) -> Result<u64, PublishError> {
        let mut loan = self.loan_by(step, deadline)?;
        fill(loan.positions_f32().ok_or(PublishError::Precision { registered: Precision::F64 })?);
        self.send(loan)
    }

    fn publish_f64_by(
        &mut self,
        step: StepTime,
        deadline: Instant,
        fill: impl FnOnce(&mut [[f64; 3]]),
    ) -> Result<u64, PublishError> {
        let mut loan = self.loan_by(step, deadline)?;
        fill(loan.positions_f64().ok_or(PublishError::Precision { registered: Precision::F32 })?);
        self.send(loan)
    }

    fn loan_by(&mut self, step: StepTime, deadline: Instant) -> Result<Loan, PublishError> {
        let link = self.link.live(deadline)?;
        let states = Arc::clone(&link.states);
        Ok(Loan::new(&states, step, self.link.num_registrations())?)
    }

    fn wait_until(&mut self, frame: u64, begin: Instant, deadline: Instant) -> Result<Correction, WaitError> {
        let mut backoff = Backoff::new();
        loop {
            while let Some(sample) = self.receive().map_err(|reason| WaitError::Receive { reason })? {
                let newest = sample.header().frame;
                if newest == frame {
                    return Ok(self.correction(sample)?);
                }
                if newest > frame {
                    return Err(WaitError::Overtaken { frame, newest });
                }
            }
            // All corrections that the daemon sent before it ended have been received above.
            self.link.lose_if_gone();
            let Some(link) = self.link.current() else { return Err(WaitError::DaemonLost { frame }) };
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(WaitError::Timeout { frame, waited: begin.elapsed() });
            }
            backoff.sleep(&link.listener, left);
        }
    }

    /// The next correction that has come, of any frame; one whose lengths or vertices are wrong is dropped.
    fn receive(&mut self) -> Result<Option<CorrectionSample>, String> {
        let num_vertices = self.link.num_vertices();
        let Some(link) = self.link.current() else { return Ok(None) };
        loop {
            let Some(sample) = link.corrections.receive().map_err(|error| iceoryx2_says(&error))? else {
                return Ok(None);
            };
            link.checked = Instant::now();
            if sample.is_whole(num_vertices) {
                return Ok(Some(sample));
            }
        }
    }

    /// A sample with the paths of its frame.
    fn correction(&mut self, sample: CorrectionSample) -> Result<Correction, FrameRefusal> {
        let frame = sample.header().frame;
        self.wishes.progress = sample.header().progress;
        let link = self.link.current();
        let paths = link.and_then(|link| link.paths.as_mut()).and_then(|port| port.take(frame));
        Correction::new(sample, paths, Arc::clone(&self.dense))
    }
}
