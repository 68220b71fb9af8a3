//! A session: one cloth, its states and its corrections.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use untangled_proto::{Precision, RequestKind, names, sections::{SectionWriter, id}};

use crate::{
    client::{RETRY, Shared},
    correction::{Correction, CorrectionSample},
    error::{ExchangeError, FrameRefusal, NewestError, PublishError, RegisterError, RequestError, WaitError},
    link::Link,
    loan::Loan,
    looks::{Looks, SLICE},
    registration::{Registration, settings_bytes},
    request::Pending,
};

/// When a state is from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepTime {
    /// Simulated time in seconds.
    pub simulated_s: f64,
    /// Length of the step in which the correction will be applied, in seconds.
    pub dt_s: f64,
}

/// One cloth that the daemon knows.
///
/// ```text
///            reply                       daemon gone
/// Pending ----------> Live --------------------------------> Lost
///    ^                                                        |
///    +------------------- next call, a daemon is up ----------+
/// ```
///
/// A call never blocks beyond its deadline: a registration that takes longer goes on in the next call. Each time that the
/// session is taken up again [`num_registrations`](Self::num_registrations) grows and a `tracing` event says so.
#[derive(Debug)]
pub struct Session {
    // Dropped first: the daemon must see the ports gone before it is woken.
    state: State,
    registration: Registration,
    frame: u64,
    num_registrations: u32,
    shared: Arc<Shared>,
}

#[derive(Debug)]
enum State {
    Live(Box<Link>),
    Pending(Box<Pending>),
    Lost,
}

impl Session {
    pub(crate) fn open(shared: Arc<Shared>, registration: Registration) -> Result<Self, RegisterError> {
        let deadline = Instant::now() + shared.timeout;
        let (payload, num_sections) = registration.encode();
        let attempt = || {
            let pending = Pending::send(&shared, RequestKind::Register, 0, &payload, num_sections)?;
            let reply = pending.wait(&shared, deadline)?;
            Link::open(&shared.node, &shared.domain, &reply, &registration)
        };
        let link = loop {
            match attempt() {
                Ok(link) => break link,
                Err(error) if error.may_pass() && Instant::now() < deadline => std::thread::sleep(RETRY),
                Err(error) => return Err(error.into()),
            }
        };
        Ok(Self { state: State::Live(Box::new(link)), registration, frame: 0, num_registrations: 1, shared })
    }

    /// Number of vertices.
    #[must_use]
    pub fn num_vertices(&self) -> usize {
        self.registration.num_vertices
    }

    /// Number of the last frame that was published; 0 before the first.
    #[must_use]
    pub fn frame(&self) -> u64 {
        self.frame
    }

    /// How often the session was registered: more than once if a daemon went away.
    #[must_use]
    pub fn num_registrations(&self) -> u32 {
        self.num_registrations
    }

    /// Publishes a state in single precision and returns its frame number. `fill` writes in place into shared memory; the slice
    /// holds what an earlier frame left there, so every position must be written.
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

    /// Lends the memory of the next state, for hosts that can't write all of it in one call; [`send`](Self::send) publishes it. One at
    /// a time: until it is sent or dropped, this and [`publish`](Self::publish) fail. Does not block.
    ///
    /// # Errors
    /// [`PublishError`].
    pub fn loan(&mut self, step: StepTime) -> Result<Loan, PublishError> {
        self.loan_by(step, Instant::now())
    }

    /// Publishes a state that was lent by this session and returns its frame number. Does not block.
    ///
    /// # Errors
    /// [`PublishError::Reconnecting`] where the daemon went away since: what was written is lost.
    pub fn send(&mut self, loan: Loan) -> Result<u64, PublishError> {
        if loan.num_registrations() != self.num_registrations || !matches!(self.state, State::Live(_)) {
            return Err(PublishError::Reconnecting);
        }
        let frame = self.frame + 1;
        // The daemon registered no more than fits.
        loan.send(frame, u32::try_from(self.registration.num_vertices).unwrap_or(u32::MAX))?;
        self.frame = frame;
        self.shared.wake(names::EVENT_STATE);
        Ok(frame)
    }

    /// Waits for the correction of a frame, up to the deadline.
    ///
    /// # Errors
    /// [`WaitError`].
    pub fn wait(&mut self, frame: u64, deadline: Duration) -> Result<Correction, WaitError> {
        let begin = Instant::now();
        self.wait_until(frame, begin, begin + deadline)
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

    /// Publishes a state in single precision and waits for its correction: lock step. See [`publish`](Self::publish) for `fill`.
    ///
    /// # Errors
    /// [`ExchangeError`]; after [`WaitError::DaemonLost`] and [`PublishError::Reconnecting`] the next call tries to go on.
    pub fn exchange(
        &mut self,
        step: StepTime,
        deadline: Duration,
        fill: impl FnOnce(&mut [[f32; 3]]),
    ) -> Result<Correction, ExchangeError> {
        let begin = Instant::now();
        let frame = self.publish_f32(step, begin + deadline, fill)?;
        Ok(self.wait_until(frame, begin, begin + deadline)?)
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
        let begin = Instant::now();
        let frame = self.publish_f64_by(step, begin + deadline, fill)?;
        Ok(self.wait_until(frame, begin, begin + deadline)?)
    }

    /// Replaces the session's settings from the next frame on; names left out take the daemon's defaults.
    ///
    /// # Errors
    /// [`RequestError`]; the old settings stay in force then.
    pub fn update_settings(&mut self, settings: serde_json::Value, deadline: Duration) -> Result<(), RequestError> {
        let deadline = Instant::now() + deadline;
        let session = match self.live(deadline) {
            Ok(link) => link.session,
            Err(PublishError::Request(error)) => return Err(error),
            Err(_) => return Err(RequestError::NoDaemon { domain: self.shared.domain.name().to_owned() }),
        };
        let document = settings_bytes(&settings).unwrap_or_else(|| b"{}".to_vec());
        let (payload, num_sections) = SectionWriter::default().bytes(id::SETTINGS, document).finish();
        Pending::send(&self.shared, RequestKind::UpdateSettings, session, &payload, num_sections)?
            .wait(&self.shared, deadline)?;
        self.registration.settings = settings;
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
        self.live(deadline)?;
        match &self.state {
            State::Live(link) => Ok(Loan::new(&link.states, step, self.num_registrations)?),
            State::Pending(_) | State::Lost => Err(PublishError::Reconnecting),
        }
    }

    fn wait_until(&mut self, frame: u64, begin: Instant, deadline: Instant) -> Result<Correction, WaitError> {
        let mut looks = Looks::new();
        loop {
            while let Some(sample) = self.receive().map_err(|reason| WaitError::Receive { reason })? {
                let newest = sample.user_header().frame;
                if newest == frame {
                    return Ok(self.correction(sample)?);
                }
                if newest > frame {
                    return Err(WaitError::Overtaken { frame, newest });
                }
            }
            let State::Live(link) = &mut self.state else { return Err(WaitError::DaemonLost { frame }) };
            // Closed, and what it sent before has been received above.
            let silent = link.checked.elapsed() >= SLICE;
            if link.is_closed() || (silent && link.is_dead()) {
                self.lose();
                return Err(WaitError::DaemonLost { frame });
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(WaitError::Timeout { frame, waited: begin.elapsed() });
            }
            looks.sleep(&link.listener, left);
        }
    }

    /// The next correction that has come, whatever its frame; one of the wrong length is none.
    fn receive(&mut self) -> Result<Option<CorrectionSample>, String> {
        let State::Live(link) = &mut self.state else { return Ok(None) };
        loop {
            let Some(sample) = link.corrections.receive().map_err(|error| format!("{error:?}"))? else {
                return Ok(None);
            };
            link.checked = Instant::now();
            if sample.payload().len() == self.registration.num_vertices {
                return Ok(Some(sample));
            }
        }
    }

    /// A sample with what belongs to it.
    fn correction(&mut self, sample: CorrectionSample) -> Result<Correction, FrameRefusal> {
        let frame = sample.user_header().frame;
        let paths = match &mut self.state {
            State::Live(link) => link.paths.as_mut().and_then(|port| port.take(frame)),
            State::Pending(_) | State::Lost => None,
        };
        Correction::new(sample, paths)
    }

    /// The session's ports; registers again where a daemon went away, up to the deadline.
    fn live(&mut self, deadline: Instant) -> Result<&mut Link, PublishError> {
        loop {
            match &mut self.state {
                State::Live(link) => {
                    if link.is_closed() || (link.checked.elapsed() >= SLICE && link.is_dead()) {
                        self.lose();
                    } else {
                        break;
                    }
                }
                State::Lost => {
                    let (payload, num_sections) = self.registration.encode();
                    match Pending::send(&self.shared, RequestKind::Register, 0, &payload, num_sections) {
                        Ok(pending) => self.state = State::Pending(Box::new(pending)),
                        // The transport fails while a dead daemon is being cleaned up, or a new one comes up.
                        Err(error) if error.may_pass() => sleep_or_give_up(deadline)?,
                        Err(error) => return Err(error.into()),
                    }
                }
                State::Pending(pending) => match pending.poll(&self.shared, deadline) {
                    Ok(Some(reply)) => {
                        let link = Link::open(&self.shared.node, &self.shared.domain, &reply, &self.registration);
                        self.state = State::Lost;
                        let link = match link {
                            // That daemon is gone as well.
                            Err(RequestError::Transport { .. }) => continue,
                            link => link?,
                        };
                        self.state = State::Live(Box::new(link));
                        self.num_registrations += 1;
                        tracing::info!(num_registrations = self.num_registrations, "the session is registered again");
                    }
                    // A daemon that died with the request in its hands never answers: ask the next one.
                    Ok(None) if pending.sent.elapsed() > self.shared.timeout => self.state = State::Lost,
                    Ok(None) => return Err(PublishError::Reconnecting),
                    Err(error) if error.may_pass() => self.state = State::Lost,
                    Err(error) => {
                        self.state = State::Lost;
                        return Err(error.into());
                    }
                },
            }
        }
        match &mut self.state {
            State::Live(link) => Ok(link),
            State::Pending(_) | State::Lost => Err(PublishError::Reconnecting),
        }
    }

    fn lose(&mut self) {
        tracing::warn!(domain = self.shared.domain.name(), "the untangled daemon went away");
        self.state = State::Lost;
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        self.state = State::Lost;
        // The daemon looks after its sessions whenever it is woken.
        self.shared.wake(names::EVENT_STATE);
    }
}

fn sleep_or_give_up(deadline: Instant) -> Result<(), PublishError> {
    let left = deadline.saturating_duration_since(Instant::now());
    if left.is_zero() {
        return Err(PublishError::Reconnecting);
    }
    std::thread::sleep(left.min(Duration::from_millis(10)));
    Ok(())
}
