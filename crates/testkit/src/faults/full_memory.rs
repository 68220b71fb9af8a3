//! A `/dev/shm` that is too small: a refusal in words, never SIGBUS. Runs in a mount namespace of its own, with 64 MiB
//! of shared memory, as containers have it.

use std::{
    io::Write,
    process::{Command, Stdio},
    time::Duration,
};

use rustix::process::Signal;
use untangled_client::{Client, RegisterError, Registration, RequestError, Session, Status};
use untangled_transport::memory;

use super::row::Row;
use crate::process::{KnownCloth, Programs, TestDomain, eventually, sheet};

/// What the inner process says when all went well.
const DONE: &str = "full-memory: ";

/// Runs [`full_memory_main`] where `/dev/shm` is small; nothing where this user can't make such a place. `program` must
/// lead to it.
pub fn full_memory(program: Command) -> Option<Row> {
    let mut outer = Command::new("unshare");
    if !rustix::process::getuid().is_root() {
        outer.args(["--user", "--map-root-user"]);
    }
    outer.args(["--mount", "sh", "-c", "mount -t tmpfs -o size=64m tmpfs /dev/shm || exit 77; exec \"$0\" \"$@\""]);
    outer.arg(program.get_program()).args(program.get_args());
    outer.envs(program.get_envs().filter_map(|(name, value)| Some((name, value?))));
    // In the namespace this user is root, but root's own folder of domains is not this user's to make.
    let runtime = format!("/tmp/full-memory-{}", std::process::id());
    outer.env("XDG_RUNTIME_DIR", &runtime);
    let output = outer.stdin(Stdio::null()).stderr(Stdio::inherit()).output();
    let _ = std::fs::remove_dir_all(&runtime);
    let output = output.ok()?;
    let text = String::from_utf8_lossy(&output.stdout);
    match (text.lines().find_map(|line| Some(line.split_once(DONE)?.1)), output.status.code()) {
        (Some(line), Some(0)) => {
            let (num_tries, note) = line.split_once(' ')?;
            let num_tries = num_tries.parse().ok()?;
            Some(Row {
                what: "`/dev/shm` too small or filled by others".into(),
                num_tries,
                note: note.into(),
                ..Row::default()
            })
        }
        // No right to a namespace or to mount, or no such program.
        (None, Some(77 | 1 | 126 | 127)) if !text.contains("panicked") => None,
        (_, code) => panic!("the process with little shared memory ended with {code:?} (none is a signal): {text}"),
    }
}

/// Opens sessions until there is no room, then fills the rest with a file that is none of the daemon's: open sessions
/// continue, registrations are refused.
pub fn full_memory_main(programs: Programs) {
    let domain = TestDomain::new();
    let mut daemon = programs.start_daemon(&domain);
    let client = domain.connect();
    let garment = KnownCloth::new(40_000);
    let mut session = client.register(garment.registration()).expect("a session of 40,000 vertices fits");
    assert!(garment.is_right(&garment.exchange(&mut session, Duration::from_secs(30)).expect("an answer")));
    drop(session);
    let cloth = KnownCloth::new(10_000);
    let (mut sessions, mut num_refused) = fill_with_sessions(&client, &cloth, &sheet(720));
    assert!(!sessions.is_empty() && num_refused > 1, "the test shows nothing");
    let filler = take_every_page();
    let mut num_frames = 0;
    for _ in 0..30 {
        for session in &mut sessions {
            let correction = cloth.exchange(session, Duration::from_secs(30)).expect("open sessions go on");
            assert!(cloth.is_right(&correction));
            num_frames += 1;
        }
    }
    for _ in 0..10 {
        num_refused += u64::from(is_refused(client.register(cloth.registration())));
    }
    assert!(daemon.is_running());
    drop(std::fs::remove_file(&filler));
    let num_open = sessions.len();
    drop(sessions);
    eventually("there is room again", || client.register(cloth.registration()).is_ok());
    drop(client);
    assert!(daemon.stop(Signal::TERM).success());
    println!(
        "{DONE}{num_refused} {num_refused} registrations refused in words; {num_open} open sessions exchanged \
         {num_frames} frames with not a page left; there was room again afterwards"
    );
}

/// Registers a huge cloth, which is refused, and a small one in turns, until that is refused too; returns the open
/// sessions and the number of refusals.
fn fill_with_sessions(client: &Client, cloth: &KnownCloth, huge: &Registration) -> (Vec<Session>, u64) {
    let (mut sessions, mut num_refused) = (Vec::new(), 0);
    loop {
        num_refused += u64::from(is_refused(client.register(huge.clone())));
        match client.register(cloth.registration()) {
            Ok(session) => sessions.push(session),
            error => {
                assert!(is_refused(error));
                return (sessions, num_refused + 1);
            }
        }
    }
}

/// Whether a registration was refused for want of memory; panics on any other error.
fn is_refused(result: Result<Session, RegisterError>) -> bool {
    match result {
        Err(RegisterError::Request(
            RequestError::Refused { status: Status::NotEnoughMemory, .. } | RequestError::NotEnoughMemory { .. },
        )) => true,
        Err(error) => panic!("{error}"),
        Ok(_) => false,
    }
}

/// Fills shared memory to the last page with a file that is none of the daemon's, and returns its path.
fn take_every_page() -> String {
    let filler = format!("{}/filler-{}", memory::FOLDER, std::process::id());
    let mut file = std::fs::File::create(&filler).expect("a file");
    let page = [1; 4096];
    while file.write_all(&page).is_ok() {}
    filler
}
